"""A daemon with simulated benches, on a free port of loopback with a temporary store."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

import jointbench

# Without `pace` a mock bench runs as fast as it can.
BENCHES = """
[[bench]]
name = "joint-a-mock"
[bench.mock]
joint = "a"
seed = 1
effects = ["stribeck"]

[[bench]]
name = "slow"
[bench.mock]
joint = "a"
seed = 1
pace = 1.0
"""


class Daemon:
    """The program of JOINTBENCH_PROGRAM, or the installed one. Killed by `close`."""

    def __init__(self, folder: Path, benches: str = BENCHES, **environment: str) -> None:
        config = folder / "bench.toml"
        config.write_text(benches, encoding="utf-8")
        program = os.environ.get("JOINTBENCH_PROGRAM", "jointbench")
        arguments = ["serve", "--listen", "127.0.0.1:0", "--config", str(config), "--data", str(folder / "data")]
        with (folder / "log").open("w") as log:
            self._process = subprocess.Popen(
                [program, *arguments], stdout=subprocess.PIPE, stderr=log, text=True, env={**os.environ, **environment}
            )
        assert self._process.stdout
        line = self._process.stdout.readline()
        words = [word for word in line.split() if word.startswith("http://")]
        assert words, (folder / "log").read_text()
        self.url = words[0]

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


@pytest.fixture(autouse=True)
def bare_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("URL", "TOKEN", "TOKEN_FILE", "CA_FILE", "DATA"):
        monkeypatch.delenv(f"JOINTBENCH_{name}", raising=False)


@pytest.fixture(scope="session")
def daemon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    daemon = Daemon(tmp_path_factory.mktemp("daemon"))
    yield daemon
    daemon.close()


@pytest.fixture
def lab(daemon: Daemon) -> Iterator[jointbench.Lab]:
    with jointbench.connect(daemon.url) as lab:
        yield lab


@pytest.fixture(scope="session")
def measured(daemon: Daemon) -> int:
    """A completed friction run with a missing effect."""
    with jointbench.connect(daemon.url) as lab:
        unit = jointbench.Unit(serial="SN1", part="JA-100")
        run = lab.bench("joint-a-mock").run("friction", unit=unit, note="first", repeats=2, load_levels=1)
        return run.wait(timeout=60).id

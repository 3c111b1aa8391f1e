"""Errors say what to do."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

import jointbench
from conftest import Daemon
from jointbench import models

TOKEN = "a-token-of-the-tests-7f3a"


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    daemon = Daemon(tmp_path_factory.mktemp("guarded"), JOINTBENCH_TOKEN=TOKEN)
    yield daemon
    daemon.close()


def test_no_daemon() -> None:
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{held.getsockname()[1]}"
        with pytest.raises(jointbench.NoDaemon, match=f"no daemon answers at http://{address} .*jointbench serve"):
            jointbench.connect(address)


def test_a_daemon_of_another_version(daemon: Daemon, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(models, "API_VERSION", "9.0.0")
    with pytest.raises(jointbench.NoDaemon, match=r"has version .*, this package 9.0.0: pip install jointbench=="):
        jointbench.connect(daemon.url)


def test_a_token_is_required(guarded: Daemon, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for token in (None, "a-wrong-token-0123456789"):
        with pytest.raises(jointbench.Refused, match="requires a valid token: .*JOINTBENCH_TOKEN") as refused:
            jointbench.connect(guarded.url, token)
        assert refused.value.kind == "unauthorized"
    monkeypatch.setenv("JOINTBENCH_URL", guarded.url)
    monkeypatch.setenv("JOINTBENCH_TOKEN", TOKEN)
    with jointbench.connect() as lab:
        assert [bench.name for bench in lab.benches()] == ["joint-a-mock", "slow"]
    # The file has priority, as for the command line.
    file = tmp_path / "token"
    file.write_text("a-wrong-token-0123456789\n")
    monkeypatch.setenv("JOINTBENCH_TOKEN_FILE", str(file))
    with pytest.raises(jointbench.Refused):
        jointbench.connect()
    monkeypatch.setenv("JOINTBENCH_TOKEN_FILE", str(tmp_path / "none"))
    with pytest.raises(jointbench.JointbenchError, match="JOINTBENCH_TOKEN_FILE: .*none cannot be read"):
        jointbench.connect()


def test_unknown_names(lab: jointbench.Lab) -> None:
    bench = lab.bench("joint-a-mock")
    with pytest.raises(jointbench.Refused, match="bench nope does not exist; this daemon has joint-a-mock"):
        lab.bench("nope")
    with pytest.raises(jointbench.Refused, match=r"bench a/b\? does not exist"):
        lab.bench("a/b?")
    with pytest.raises(jointbench.Refused, match="procedure dance does not exist; available: friction") as refused:
        bench.run("dance")
    assert refused.value.kind == "not_found"
    with pytest.raises(jointbench.Refused, match="unknown parameter speed: expected one of top_speed_rad_s"):
        bench.run("friction", speed=1.0)
    settings = next(procedure for procedure in bench.procedures() if procedure.id == "friction").parameters
    assert "top_speed_rad_s" in [setting.name for setting in settings]

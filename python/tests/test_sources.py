"""The generated models agree with the daemon's API, and the types are strict."""

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]


@pytest.mark.parametrize(
    ("tool", "arguments"),
    [
        ("datamodel_code_generator", ["generate", "--check"]),
        ("mypy", ["-m", "mypy"]),
        ("ruff", ["-m", "ruff", "check"]),
        ("ruff", ["-m", "ruff", "format", "--check"]),
    ],
)
def test_a_check_of_the_sources_passes(tool: str, arguments: list[str]) -> None:
    pytest.importorskip(tool)
    done = subprocess.run([sys.executable, *arguments], cwd=PACKAGE, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stdout + done.stderr

"""Each notebook runs from top to bottom on a daemon of its own, and is stored without outputs."""

import json
from pathlib import Path
from typing import Any

import pytest

import jointbench
from conftest import BENCHES, Daemon

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
CELL_S = 300
# What each notebook shows, and the number of its figures.
SHOWN = {
    "batch": (["SN6", "fail", "pass", "Capability(", "temperature_c"], 2),
    "measured-file": (["Missing effect: stribeck", "The model explains this run", "stribeck  omega_s"], 3),
    "mock-bench": (["identified", "tau_c_positive", "link_torque_nm: double", "validation error"], 3),
}


def code_cells(notebook: Path) -> list[dict[str, Any]]:
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def test_each_notebook_is_known() -> None:
    assert [notebook.stem for notebook in NOTEBOOKS] == sorted(SHOWN)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(notebook: Path) -> None:
    cells = code_cells(notebook)
    assert cells
    assert [cell["outputs"] for cell in cells] == [[]] * len(cells)
    assert [cell["execution_count"] for cell in cells] == [None] * len(cells)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(notebook: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("nbclient", "ipykernel", "pandas", "pyarrow", "matplotlib"):
        pytest.importorskip(module)
    import nbclient
    import nbformat

    benches = notebook.with_suffix(".toml")
    daemon = Daemon(tmp_path, benches.read_text(encoding="utf-8") if benches.is_file() else BENCHES)
    monkeypatch.setenv("JOINTBENCH_URL", daemon.url)
    monkeypatch.setenv("PYTHONPATH", str(Path(jointbench.__file__).parents[1]))
    monkeypatch.delenv("MPLBACKEND", raising=False)
    for variable in ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    book = nbformat.read(notebook, as_version=4)
    try:
        nbclient.NotebookClient(book, timeout=CELL_S, resources={"metadata": {"path": str(tmp_path)}}).execute()
    finally:
        daemon.close()

    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    data = [output.data for output in outputs if "data" in output]
    printed = [output.text for output in outputs if output.get("name") == "stdout"]
    text = "\n".join(printed + [part["text/plain"] for part in data if "text/plain" in part])
    expected, figures = SHOWN[notebook.stem]
    assert [part for part in expected if part not in text] == [], text
    assert sum("image/png" in part for part in data) == figures
    # Progress is on standard error too.
    warnings = [output.text for output in outputs if output.get("name") == "stderr" and "Warning" in output.text]
    assert warnings == []

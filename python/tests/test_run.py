"""The whole job: a run, its result, its samples and its diagnosis."""

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import jointbench
from conftest import Daemon

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


def test_a_result_has_quantities_with_intervals(lab: jointbench.Lab, measured: int) -> None:
    result = lab.run(measured).result
    coulomb = result["tau_c"]
    assert result.verdict == "identified"
    assert coulomb.ci95 and coulomb.ci95[0] < coulomb.value < coulomb.ci95[1]
    assert coulomb.unit == "Nm"
    with pytest.raises(KeyError, match="no quantity tau_x; available: tau_c"):
        result["tau_x"]


def test_runs_and_units_are_found(lab: jointbench.Lab, measured: int) -> None:
    runs = list(lab.runs("unit:SN1 kind:friction note:first"))
    assert [run.id for run in runs] == [measured]
    assert repr(runs[0]) == f"<Run {measured}: friction on joint-a-mock, completed>"
    units = lab.units("part:JA-100")
    assert [(unit.serial, unit.runs) for unit in units] == [("SN1", 1)]
    assert list(lab.runs("unit:none")) == []


def test_samples_are_tables(lab: jointbench.Lab, measured: int) -> None:
    for module in ("polars", "pandas", "pyarrow"):
        pytest.importorskip(module)
    run = lab.run(measured)
    frame = run.to_polars()
    assert frame.height == run.info.rows
    assert {"time_s", "motor_current_a", "link_torque_nm"} <= set(frame.columns)
    assert frame["time_s"].is_sorted()
    for other in (run.to_pandas(), run.to_numpy()):
        assert list(other["time_s"]) == frame["time_s"].to_list()
    assert run.to_arrow().num_rows == frame.height


def test_a_missing_library_is_named(lab: jointbench.Lab, measured: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(ImportError, match=r"pip install 'jointbench\[polars\]'"):
        lab.run(measured).to_polars()


def test_a_diagnosis_names_the_missing_effect(lab: jointbench.Lab, measured: int) -> None:
    diagnosis = lab.run(measured).diagnose()
    assert diagnosis.verdict == "missing_effect"
    assert [effect.effect for effect in diagnosis.effects] == ["stribeck"]
    assert diagnosis.effects[0].validation_rms < diagnosis.found.fit.validation_rms
    assert "stribeck" in diagnosis.summary
    complete = lab.run(measured).diagnose([*diagnosis.found.model, "stribeck"])
    assert (complete.verdict, complete.effects) == ("adequate", [])


def test_a_diagnosis_is_drawn(lab: jointbench.Lab, measured: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    diagnosis = lab.run(measured).diagnose()
    left, right = diagnosis.plot().axes
    assert left.get_xlabel() == "motor_velocity_rad_s [rad/s]"
    assert left.get_ylabel() == "residual [Nm]"
    assert [label.get_text() for label in right.get_yticklabels()] == ["model", "+ stribeck"]
    with pytest.raises(ValueError, match="no axis speed; available: motor_velocity_rad_s"):
        diagnosis.plot("speed")


def test_limits_are_reported_as_junit(lab: jointbench.Lab, tmp_path: Path) -> None:
    limits = tmp_path / "limits.toml"
    limits.write_text('[[limit]]\npart = "JA-100"\nquantity = "tau_c"\nupper = 0.001\nunit = "Nm"\n')
    unit = jointbench.Unit(serial="SN2", part="JA-100")
    bench = lab.bench("joint-a-mock")
    run = bench.run("friction", unit=unit, limits=limits, repeats=2, load_levels=1).wait(timeout=60)
    assert run.result.limits and run.result.limits.outcome == "fail"
    assert ElementTree.fromstring(run.junit()).findall(".//failure")
    (yielded,) = (group for group in lab.yields("unit:SN2") if group.group == "part")
    assert (yielded.part, yielded.units, yielded.passed, yielded.fraction) == ("JA-100", 1, 0, 0.0)
    chart = lab.chart("friction", "tau_c", "part:JA-100")
    assert [(point.unit, point.run) for point in chart.points][-1] == ("SN2", run.id)
    assert (chart.points[-1].value, chart.unit, chart.pending) == (run.result["tau_c"].value, "Nm", 0)
    unknown = lab.chart("friction", "tau_x", "part:JA-100")
    assert (unknown.points, unknown.empty) == ([], "no_quantity")
    assert "tau_c" in [quantity.name for quantity in unknown.quantities]


def test_trends_have_the_results_of_runs(lab: jointbench.Lab, measured: int) -> None:
    trends = lab.trends("unit:SN1 kind:friction")
    assert [(run.run, run.unit) for run in trends.runs] == [(measured, "SN1")]
    assert trends.runs[0].quantities == lab.run(measured).result.quantities
    assert lab.trends("unit:none").runs == []


def test_a_file_is_imported_with_its_metadata(lab: jointbench.Lab, measured: int, tmp_path: Path) -> None:
    pytest.importorskip("polars")
    run = lab.run(measured)
    file = tmp_path / "run.csv"
    run.to_polars().write_csv(file)
    imported = lab.import_run(file, run.refresh().meta, name="copy").wait(timeout=10)
    assert (imported.info.bench, imported.info.rows) == ("copy", run.info.rows)
    assert imported.fit(["coulomb", "viscous"]).rms == pytest.approx(run.fit(["coulomb", "viscous"]).rms, rel=1e-3)
    with pytest.raises(jointbench.Refused, match=r"kind"):
        lab.import_run(file)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(example: Path, daemon: Daemon, tmp_path: Path) -> None:
    for module in ("polars", "matplotlib"):
        pytest.importorskip(module)
    source = Path(jointbench.__file__).parents[1]
    environment = {**os.environ, "JOINTBENCH_URL": daemon.url, "MPLBACKEND": "Agg", "PYTHONPATH": str(source)}
    done = subprocess.run(
        [sys.executable, example], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=400
    )
    assert done.returncode == 0, done.stderr
    assert "Coulomb friction (motor): " in done.stdout and "Missing effect: stribeck" in done.stdout
    assert "step " in done.stderr
    assert list(tmp_path.glob("diagnosis-*.png"))

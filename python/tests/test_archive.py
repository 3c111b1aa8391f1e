"""The archive of ended runs, as other programs read it."""

import hashlib
import json
import time
from pathlib import Path

import pytest

import jointbench
from conftest import Daemon

BENCH = """
[[bench]]
name = "joint-a-mock"
[bench.mock]
joint = "a"
seed = 1
"""


def test_other_programs_read_the_archive(tmp_path: Path) -> None:
    dataset = pytest.importorskip("pyarrow.dataset")
    parquet = pytest.importorskip("pyarrow.parquet")
    archive = tmp_path / "archive"
    archive.mkdir()
    daemon = Daemon(tmp_path, f'[archive]\nurl = "file://{archive}"\nraw = true\n{BENCH}')
    try:
        with jointbench.connect(daemon.url) as lab:
            units = [jointbench.Unit(serial="SN1", part="JA/1", batch="7"), jointbench.Unit(serial="SN2")]
            bench = lab.bench("joint-a-mock")
            runs = [bench.run("friction", unit=unit, repeats=2, load_levels=1).wait(timeout=120) for unit in units]
            until = time.monotonic() + 120
            while len(list(archive.glob("**/*.parquet"))) < 4:
                assert time.monotonic() < until, list(archive.glob("**/*"))
                time.sleep(0.1)
            rows = {run.info.unit.serial: run.info.rows for run in runs if run.info.unit}
    finally:
        daemon.close()

    means = dataset.dataset(archive / "means", partitioning="hive").to_table().to_pandas()
    assert {name: set(means[name]) for name in ("bench", "serial", "procedure")} == {
        "bench": {"joint-a-mock"},
        "serial": {"SN1", "SN2"},
        "procedure": {"friction"},
    }
    first = means[means.part == "JA/1"]
    assert set(first.serial) == {"SN1"} and len(first) > 8
    assert means[means.serial == "SN2"].part.isna().all()
    samples = dataset.dataset(archive / "samples", partitioning="hive")
    assert samples.count_rows() == sum(rows.values())

    for path in archive.glob("**/*.parquet"):
        table = parquet.ParquetFile(path).read()
        footer = {key.decode(): value.decode() for key, value in table.schema.metadata.items()}
        digest = hashlib.sha256()
        for column in table.itercolumns():
            if column.type == "double":
                digest.update(column.to_numpy().astype("<f8").tobytes())
        assert footer["jointbench.sha256"] == digest.hexdigest()
        assert footer["jointbench.schema_version"] == "1"
        assert footer["jointbench.serial"] in rows
        assert json.loads(footer["jointbench.calibrations"]) == {"certificates": {}}
        times = table["time_s"].to_pylist()
        assert times == sorted(times)

    duckdb = pytest.importorskip("duckdb", reason="SKIPPED: DuckDB did NOT read the archive")
    tables = f"read_parquet('{archive}/means/**/*.parquet', hive_partitioning = true)"
    query = f"SELECT serial, count(*) FROM {tables} GROUP BY 1"
    assert dict(duckdb.sql(query).fetchall())["SN1"] == len(first)

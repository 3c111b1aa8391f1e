"""A busy bench, its queue, and clients that die."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import jointbench
from conftest import Daemon

HOLDS_A_LEASE = """
import jointbench
run = jointbench.connect().bench("slow").run("friction", lease=4)
print(run.id, flush=True)
run.wait()
"""


def test_a_busy_bench_has_a_queue(lab: jointbench.Lab) -> None:
    bench = lab.bench("slow")
    run = bench.run("friction", lease=60)
    assert (bench.refresh().state, bench.info.run) == ("running", run.id)
    with pytest.raises(jointbench.Refused, match="a run is in progress on bench slow") as refused:
        bench.run("friction")
    assert refused.value.kind == "conflict"
    entry, again = (bench.queue("friction", key="once", priority=3) for _ in range(2))
    assert (again.id, entry.info.priority) == (entry.id, 3)
    with pytest.raises(TimeoutError, match=f"queue entry {entry.id} has not ended after 0.5 s"):
        entry.until_started(timeout=0.5)
    entry.remove()
    with pytest.raises(jointbench.JointbenchError, match=f"queue entry {entry.id} removed"):
        entry.until_started()
    with pytest.raises(TimeoutError, match=f"run {run.id} has not ended after 0.5 s; it continues"):
        run.wait(timeout=0.5)
    run.stop()
    with pytest.raises(jointbench.RunNotCompleted, match=f"run {run.id} stopped .friction on slow.: ") as stopped:
        run.wait(timeout=60)
    assert stopped.value.run.safe == "safe_verified"


def test_a_queued_run_starts(lab: jointbench.Lab) -> None:
    entry = lab.bench("joint-a-mock").queue("friction", lease=30, repeats=2, load_levels=1)
    run = entry.until_started(timeout=30).wait(timeout=60)
    assert run.info.state == "completed"


def test_a_lease_is_renewed_while_the_client_lives(daemon: Daemon, lab: jointbench.Lab) -> None:
    source = Path(jointbench.__file__).parents[1]
    environment = {**os.environ, "JOINTBENCH_URL": daemon.url, "PYTHONPATH": str(source)}
    with subprocess.Popen(
        [sys.executable, "-c", HOLDS_A_LEASE], env=environment, stdout=subprocess.PIPE, text=True
    ) as client:
        assert client.stdout
        run = lab.run(int(client.stdout.readline()))
        with pytest.raises(TimeoutError):
            run.wait(timeout=6.0)
        client.kill()
    with pytest.raises(jointbench.RunNotCompleted, match="no client controlled the run"):
        run.wait(timeout=60)
    assert run.info.safe == "safe_verified"

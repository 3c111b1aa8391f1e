"""Client of the test-bench daemon jointbench. Quantities are in SI units.

with jointbench.connect() as lab:
    run = lab.bench("joint-a-mock").run("friction", unit="SN1").wait(progress=True)
    print(run.result["tau_c"], run.diagnose().summary)
"""

from .bench import Bench
from .diagnosis import Diagnosis
from .errors import JointbenchError, NoDaemon, Refused, RunNotCompleted
from .lab import Lab, connect
from .models import API_VERSION as __version__
from .models import Unit
from .queued import QueuedRun
from .run import Result, Run

__all__ = [
    "Bench",
    "Diagnosis",
    "JointbenchError",
    "Lab",
    "NoDaemon",
    "QueuedRun",
    "Refused",
    "Result",
    "Run",
    "RunNotCompleted",
    "Unit",
    "__version__",
    "connect",
]

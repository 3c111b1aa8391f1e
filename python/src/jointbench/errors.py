"""What can fail. Each message says what to do."""

from .models import Problem, RunSummary


class JointbenchError(Exception):
    """Base of all errors of this package."""


class NoDaemon(JointbenchError):
    """No daemon answers at the address, or its version does not match this package."""


class Refused(JointbenchError):
    """The daemon refused the request."""

    def __init__(self, problem: Problem, message: str | None = None) -> None:
        super().__init__(message or problem.detail)
        self.problem = problem

    @property
    def kind(self) -> str:
        """Kind of the refusal: `conflict` (the bench is busy), `not_found`, `invalid`, `unauthorized`, …"""
        return self.problem.type.removeprefix("urn:jointbench:")


class RunNotCompleted(JointbenchError):
    """The run ended before its last step: it failed, or it was stopped."""

    def __init__(self, run: RunSummary) -> None:
        reason = f": {run.reason}" if run.reason else ""
        super().__init__(f"run {run.id} {run.state} ({run.procedure} on {run.bench}){reason}")
        self.run = run

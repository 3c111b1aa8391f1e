"""A run that waits for its bench."""

from __future__ import annotations

from . import models
from ._connection import Connection
from ._waiting import poll
from .errors import JointbenchError
from .run import Run


class QueuedRun:
    """An entry of the queue of a bench. `info` is its latest known state."""

    def __init__(self, connection: Connection, info: models.QueueEntry) -> None:
        self._connection = connection
        self.info = info

    @property
    def id(self) -> int:
        return self.info.id

    def __repr__(self) -> str:
        return f"<QueuedRun {self.id}: {self.info.request.procedure} on {self.info.request.bench}, {self.info.state}>"

    def refresh(self) -> models.QueueEntry:
        """The present state, with the expected time until the start [s]."""
        self.info = self._connection.get(models.QueueEntry, f"/queue/{self.id}")
        return self.info

    def until_started(self, timeout: float | None = None) -> Run:
        """Waits until the run has started, and renews its lease meanwhile. After `timeout` [s]: `TimeoutError`."""

        def started() -> Run | None:
            entry = self.refresh()
            if entry.state == "started" and entry.run is not None:
                info = self._connection.get(models.Run, f"/runs/{entry.run}")
                return Run(self._connection, info, entry.request.lease_s)
            if entry.state in ("failed", "removed"):
                raise JointbenchError(f"queue entry {self.id} {entry.state}: {entry.reason}")
            return None

        return poll(started, self._renew, self.info.request.lease_s, timeout, f"queue entry {self.id}")

    def _renew(self) -> None:
        self._connection.post(models.Lease, f"/queue/{self.id}/lease")

    def remove(self) -> None:
        """Removes the waiting run from the queue."""
        self._connection.request("DELETE", f"/queue/{self.id}")

"""A bench, which runs procedures."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from . import models
from ._connection import Connection
from .queued import QueuedRun
from .run import Run


class Bench:
    """A test bench. `info` is its latest known state: instruments, limits, constants."""

    def __init__(self, connection: Connection, info: models.Bench) -> None:
        self._connection = connection
        self.info = info

    @property
    def name(self) -> str:
        return self.info.name

    def __repr__(self) -> str:
        return f"<Bench {self.name}, {self.info.state}>"

    def refresh(self) -> models.Bench:
        """The present state."""
        self.info = self._connection.get(models.Bench, f"/bench/{quote(self.name, safe='')}")
        return self.info

    def procedures(self) -> list[models.Procedure]:
        """The procedures with their settings: units, defaults and ranges."""
        return self._connection.get(list[models.Procedure], "/procedures", bench=self.name)

    def run(
        self,
        procedure: str,
        *,
        unit: str | models.Unit | None = None,
        operator: str | None = None,
        note: str | None = None,
        limits: str | os.PathLike[str] | None = None,
        lease: float | None = None,
        **settings: float,
    ) -> Run:
        """Starts a procedure: the bench moves.

        `settings` are those of `procedures()`, in SI units; omitted ones have their defaults. `unit` is the unit under
        test, or its serial number. `limits` is a file (TOML). With a `lease` [s] the run ends in order when this
        program no longer renews it; `wait` does.
        """
        new = self._new(procedure, settings, unit, limits, operator=operator, note=note, lease_s=lease)
        return Run(self._connection, self._connection.post(models.Run, "/runs", new), lease)

    def queue(
        self,
        procedure: str,
        *,
        unit: str | models.Unit | None = None,
        operator: str | None = None,
        note: str | None = None,
        limits: str | os.PathLike[str] | None = None,
        lease: float | None = None,
        priority: int = 0,
        key: str | None = None,
        **settings: float,
    ) -> QueuedRun:
        """Starts a procedure as `run` does, when the bench is free.

        The largest `priority` starts first. A repeated call with the same `key` (idempotency key) returns the first
        entry.
        """
        more = {"queue": True, "priority": priority}
        new = self._new(procedure, settings, unit, limits, operator=operator, note=note, lease_s=lease, **more)
        headers = {} if key is None else {"idempotency-key": key}
        return QueuedRun(self._connection, self._connection.post(models.QueueEntry, "/runs", new, **headers))

    def _new(
        self,
        procedure: str,
        settings: Mapping[str, float],
        unit: str | models.Unit | None,
        limits: str | os.PathLike[str] | None,
        **others: Any,
    ) -> models.NewRun:
        return models.NewRun(
            bench=self.name,
            procedure=procedure,
            parameters=dict(settings),
            unit=models.Unit(serial=unit) if isinstance(unit, str) else unit,
            limits=None if limits is None else Path(limits).read_text(encoding="utf-8"),
            **others,
        )

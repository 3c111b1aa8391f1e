"""A run of a bench, and its result."""

from __future__ import annotations

import sys
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import models, samples
from ._connection import Connection
from ._waiting import poll, show
from .diagnosis import Diagnosis
from .errors import JointbenchError, RunNotCompleted

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import polars as pl
    import pyarrow as pa

FINAL: tuple[models.RunState, ...] = ("completed", "stopped", "aborted", "failed", "interrupted")


class Result(models.Identification):
    """Result of a procedure: verdict, and quantities in SI units with 95 % intervals (`ci95`)."""

    def __getitem__(self, name: str) -> models.Quantity:
        """The quantity with this name, for example `result["tau_c"].value` in Nm."""
        for quantity in self.quantities:
            if quantity.name == name:
                return quantity
        names = ", ".join(quantity.name for quantity in self.quantities)
        raise KeyError(f"run {self.run} has no quantity {name}; available: {names}")


class Run:
    """A run, active or ended. `info` is its latest known state; `refresh` requests it again."""

    def __init__(self, connection: Connection, info: models.RunSummary, lease: float | None = None) -> None:
        self._connection = connection
        self._lease = lease
        self.info = info

    @property
    def id(self) -> int:
        return self.info.id

    def __repr__(self) -> str:
        return f"<Run {self.id}: {self.info.procedure} on {self.info.bench}, {self.info.state}>"

    def _get(self, kind: Any, part: str) -> Any:
        return self._connection.get(kind, f"/runs/{self.id}{part}")

    def refresh(self) -> models.Run:
        """The present state, with settings, progress and metadata."""
        info = self._connection.get(models.Run, f"/runs/{self.id}")
        self.info = info
        return info

    def wait(self, progress: bool = False, timeout: float | None = None) -> Run:
        """Waits until the run has ended, and renews its lease meanwhile.

        `progress` prints step and remaining time to standard error. After `timeout` [s] it raises `TimeoutError`; the
        run continues without a lease. A run that does not complete raises `RunNotCompleted`.
        """

        def ended() -> models.Run | None:
            info = self.refresh()
            # The safe state follows the end, and a completed run can be read as soon as it is stored.
            is_final = info.state in FINAL and (info.safe is not None or info.procedure == "import")
            if is_final and not (info.state == "completed" and info.not_stored):
                return info
            if progress and info.progress:
                show(info.progress)
            return None

        try:
            info = poll(ended, self._renew, self._lease, timeout, f"run {self.id}")
        finally:
            if progress:
                print(file=sys.stderr)
        if info.state != "completed":
            raise RunNotCompleted(info)
        return self

    def _renew(self) -> None:
        self._connection.post(models.Lease, f"/runs/{self.id}/lease")

    def stop(self) -> None:
        """Ends the run in an orderly way: the brake is unloaded, and measured samples are kept."""
        self.info = self._connection.post(models.Run, f"/runs/{self.id}/stop")

    @cached_property
    def result(self) -> Result:
        """Verdict and quantities of the ended run."""
        return self._connection.get(Result, f"/runs/{self.id}/identification")

    def junit(self) -> str:
        """The result and its limits as a JUnit report (XML)."""
        return self._connection.request("GET", f"/runs/{self.id}/junit").text

    def fit(self, effects: list[str] | None = None) -> models.Model:
        """Fits a model and stores it as a version of the run; without effects, with the baseline of the run."""
        effects = effects or self.refresh().meta.get("baseline")
        if not effects:
            raise JointbenchError(f"run {self.id} has no baseline: name the effects, such as ['coulomb', 'viscous']")
        return self._connection.post(models.Model, "/models", models.NewModel(run=self.id, effects=effects))

    def diagnose(self, effects: list[str] | None = None) -> Diagnosis:
        """Fits a model as `fit` does, and finds where it fails and which effect is missing."""
        model = self.fit(effects)
        found = self._connection.post(models.Diagnosis, "/diagnoses", models.NewDiagnosis(model=model.id))
        return Diagnosis(self._connection, found)

    def to_polars(self) -> pl.DataFrame:
        """The samples, a column for each channel with its unit in the name. Needs `jointbench[polars]`."""
        return samples.to_polars(self._stream())

    def to_pandas(self) -> pd.DataFrame:
        """The samples as `to_polars`. Needs `jointbench[pandas]`."""
        return samples.to_pandas(self._stream())

    def to_arrow(self) -> pa.Table:
        """The samples as `to_polars`. Needs `jointbench[arrow]`."""
        return samples.to_arrow(self._stream())

    def to_numpy(self) -> dict[str, np.ndarray[Any, Any]]:
        """The samples as one array for each channel. Needs `jointbench[arrow]`."""
        return samples.to_numpy(self._stream())

    def _stream(self) -> bytes:
        headers = {"accept": "application/vnd.apache.arrow.stream"}
        return self._connection.request("GET", f"/runs/{self.id}/samples", headers=headers).content

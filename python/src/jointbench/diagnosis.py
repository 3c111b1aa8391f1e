"""A diagnosis: where a model fails, and which effect is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import models
from ._connection import Connection
from .samples import need

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Diagnosis:
    """`found` holds the whole diagnosis: regions, rejected effects, detection limits."""

    def __init__(self, connection: Connection, found: models.Diagnosis) -> None:
        self._connection = connection
        self.found = found

    def __repr__(self) -> str:
        return f"<Diagnosis {self.found.id} of run {self.found.run}: {self.summary}>"

    @property
    def summary(self) -> str:
        """The verdict in one sentence."""
        return self.found.summary

    @property
    def verdict(self) -> models.Verdict:
        """`adequate`, `missing_effect` or `unexplained_structure`."""
        return self.found.verdict

    @property
    def effects(self) -> list[models.Suggestion]:
        """The missing effects with their evidence, best first; empty if no effect is missing."""
        return self.found.suggestions

    def residuals(self) -> models.ResidualSet:
        """Residual (measured − model) of each point, with its coordinates."""
        return self._connection.get(models.ResidualSet, f"/models/{self.found.model_id}/residuals")

    def plot(self, axis: str | None = None) -> Figure:
        """Residual over an axis, and validation error with each missing effect. Needs `jointbench[plot]`.

        Without `axis`: the axis of the region with the largest residual.
        """
        figure, (left, right) = need("matplotlib.pyplot", "plot").subplots(
            ncols=2, figsize=(11.0, 4.5), layout="constrained"
        )
        self._plot_residual(left, axis or (self.found.where[0].axis if self.found.where else None))
        self._plot_effects(right)
        result: Figure = figure
        result.suptitle(self.summary, wrap=True)
        return result

    def _plot_residual(self, plot: Axes, name: str | None) -> None:
        residuals = self.residuals()
        axes = {axis.name: axis for axis in residuals.axes}
        if name is not None and name not in axes:
            raise ValueError(f"no axis {name}; available: {', '.join(axes)}")
        axis = axes[name] if name is not None else residuals.axes[0]
        fitted = [i for i, held_out in enumerate(residuals.held_out) if not held_out]
        plot.plot([axis.values[i] for i in fitted], [residuals.error[i] for i in fitted], ".", markersize=2)
        plot.axhline(0.0, color="grey", linewidth=0.8)
        plot.set_xlabel(f"{axis.name} [{axis.unit}]")
        plot.set_ylabel(f"residual [{residuals.unit}]")

    def _plot_effects(self, plot: Axes) -> None:
        errors = {"model": self.found.fit.validation_rms}
        errors |= {f"+ {effect.effect}": effect.validation_rms for effect in self.effects}
        plot.barh(list(errors), list(errors.values()))
        plot.invert_yaxis()
        if self.found.noise_floor.rms is not None:
            plot.axvline(self.found.noise_floor.rms, color="grey", linestyle="--", label="noise floor")
            plot.legend()
        plot.set_xlabel(f"validation error, RMS [{self.found.fit.unit}]")

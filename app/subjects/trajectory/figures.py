"""The figures along a flight: their names on the page, units, and the shares that explain them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.document.numbers import show
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import from_si
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import FIGURES as DECLARED
from nav_model.design.figures import IN_FLIGHT

if TYPE_CHECKING:
    from nav_model.trajectory.result import TrajectoryResult


@dataclass(frozen=True)
class FlightFigure:
    """A figure that a requirement of the design may limit, by its name in a result. dimension: of `show`."""

    name: str
    label: str
    dimension: str
    spread: str

    def show(self, value: float, *, given: bool = False, like: float | None = None) -> str:
        """A value with its unit; `given` as a person gave it, ``like`` in the unit of this one."""
        return show(value, self.dimension, given=given, like=like)

    @property
    def in_sentence(self) -> str:
        """Its name within a sentence."""
        return in_sentence(self.label)

    @property
    def axis(self) -> str:
        """Label of an axis, which has room for its last word."""
        return f"{self.in_sentence.rpartition(' ')[2]}, {self.spread} [{DIMENSIONS[self.dimension].default_unit}]"

    @property
    def scale(self) -> float:
        """From SI to the axis's unit."""
        return from_si(1.0, DIMENSIONS[self.dimension].default_unit, self.dimension)


FIGURES = {
    name: FlightFigure(
        name, DECLARED[name].label, DECLARED[name].dimension, "1σ" if DECLARED[name].scaled else "90 %"
    )
    for name in IN_FLIGHT
}


def limit_of(result: TrajectoryResult, name: str) -> float:
    """The limit on one sigma of a figure that holds unless a line has its own; NaN where there is none."""
    return dict(result.spec.most).get(name, math.nan)


def limits_along(result: TrajectoryResult, name: str) -> tuple[tuple[float, float, float], ...]:
    """Start, stop [s] and level of every limit on one sigma of a figure: one, unless a line has its own."""
    everywhere = limit_of(result, name)
    limits = [(line.start_s, line.stop_s, line.limits[name]) for line in result.lines if name in line.limits]
    if all(level == everywhere for _, _, level in limits):
        limits = [(float(result.time_s[0]), float(result.time_s[-1]), everywhere)]
    return tuple(limit for limit in limits if not math.isnan(limit[2]))


def main_figure(result: TrajectoryResult) -> str:
    """The figure to show first: the one that is least within its limit on some line, or the detrended phase."""
    within = [(share, name) for line in result.lines for name, share in line.within.items()]
    return min(within, default=(1.0, "detrended_phase"), key=lambda pair: pair[0])[1]

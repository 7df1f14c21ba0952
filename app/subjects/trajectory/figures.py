"""The figures along a flight: their names on the page, units, and the shares that explain them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.document.numbers import show

if TYPE_CHECKING:
    from nav_model.trajectory.result import TrajectoryResult

_DEG = 180 / math.pi


@dataclass(frozen=True)
class Figure:
    """A figure by its name in a result. dimension: of `show`. shares: of which figure."""

    name: str
    label: str
    dimension: str
    shares: str
    spread: str = "1σ"

    def told(self, value: float, *, given: bool = False) -> str:
        """A value with its unit; `given` as a person gave it."""
        return show(value, self.dimension, given=given)

    @property
    def said(self) -> str:
        """Its name within a sentence."""
        return self.label if self.label.isupper() else self.label.lower()

    @property
    def axis(self) -> str:
        """Label of an axis, which has room for its last word."""
        unit = {"length": "m", "speed": "m/s", "angle": "°"}[self.dimension]
        return f"{self.said.rpartition(' ')[2]}, {self.spread} [{unit}]"

    @property
    def scale(self) -> float:
        """From SI to the axis's unit."""
        return _DEG if self.dimension == "angle" else 1.0


FIGURES = {
    figure.name: figure
    for figure in (
        Figure("detrended_phase", "Detrended phase", "angle", "detrended_phase"),
        Figure("quadratic_phase", "Quadratic phase", "angle", "quadratic_phase"),
        Figure("cubic_phase", "Cubic phase", "angle", "cubic_phase"),
        Figure("azimuth_shift", "Azimuth shift", "length", "azimuth_shift"),
        Figure("range_shift", "Range shift", "length", "range_shift"),
        Figure("ce90", "CE90", "length", "ce90", "90 %"),
        Figure("horizontal_position", "Horizontal position", "length", "position_horizontal"),
        Figure("vertical_position", "Vertical position", "length", "position_vertical"),
        Figure("horizontal_velocity", "Horizontal velocity", "speed", "velocity_horizontal"),
        Figure("vertical_velocity", "Vertical velocity", "speed", "velocity_vertical"),
        Figure("tilt", "Tilt", "angle", "tilt"),
    )
}


def limit_of(result: TrajectoryResult, name: str) -> float:
    """The limit on one sigma of a figure that holds unless a line has its own; NaN where there is none."""
    return dict(result.spec.limits.most).get(name, math.nan)


def limits_along(result: TrajectoryResult, name: str) -> tuple[tuple[float, float, float], ...]:
    """Start, stop [s] and level of every limit on one sigma of a figure: one, unless a line has its own."""
    everywhere = limit_of(result, name)
    own = [(line.start_s, line.stop_s, line.limits[name]) for line in result.lines if name in line.limits]
    if all(level == everywhere for _, _, level in own):
        own = [(float(result.time_s[0]), float(result.time_s[-1]), everywhere)]
    return tuple(limit for limit in own if not math.isnan(limit[2]))


def cause_at(result: TrajectoryResult, name: str, at: int) -> str:
    """The source with the largest share of a figure at an output."""
    shares: NDArray[np.float64] = result.chosen.shares[FIGURES[name].shares][:, at]
    return "" if np.isnan(shares).all() else result.sources[int(np.nanargmax(shares))]


def main_figure(result: TrajectoryResult) -> str:
    """The figure to show first: the one that is least within its limit on some line, or the detrended phase."""
    within = [(share, name) for line in result.lines for name, share in line.within.items()]
    return min(within, default=(1.0, "detrended_phase"), key=lambda pair: pair[0])[1]

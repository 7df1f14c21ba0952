"""Near and far range: between which slant ranges a flight closes, as high above the scene as the design.

The flight is followed again with the aperture of another range: its time, its grazing angle and its lever R/V.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import Radar
from nav_model.trajectory import line_length
from nav_model.trajectory.covariance import lines_along
from nav_model.trajectory.design_study import at_range
from nav_model.trajectory.line_length import Progress
from nav_model.trajectory.result import STATE_AXES, LineResult, Swath, TrajectoryResult

_FLATTEST, _STEEPEST = Radar.param["grazing_angle"].softbounds
_CLOSE = 0.01  # of the range: how near its end is to one that does not close
_USUAL_TRIALS = 12


class _Trial(NamedTuple):
    """A slant range [m], the worst figure over its limit there, and which, in words."""

    slant_range: float
    excess: float
    by: str

    @property
    def closes(self) -> bool:
        return self.excess <= 1.0


def with_swath(
    result: TrajectoryResult, design: Design, progress: Progress = lambda share, what: None
) -> TrajectoryResult:
    """The result with near and far range of its flight, to 1 %, searched at grazing angles from 20° to 70°.

    Without them where nothing is limited, where the design looks level, or where the flights are too many.
    """
    study, radar = result.spec.study, design.radar
    height = radar.slant_range * math.sin(radar.grazing_angle)
    limited = any(line.limits.keys() - STATE_AXES for line in result.lines)  # no range changes a state
    if not limited or not height or _USUAL_TRIALS * study.duration > line_length.MOST_FIXES * study.gnss.interval:
        return result
    trials = 0

    def flown(slant_range: float) -> _Trial:
        nonlocal trials
        progress(min(trials / _USUAL_TRIALS, 0.95), "Near and far range")
        trials += 1
        angle = math.asin(min(height / slant_range, 1.0))
        try:
            there = design.replace({"radar.slant_range": slant_range, "radar.grazing_angle": angle})
            spec = at_range(result.spec, there)
            return _worst(slant_range, lines_along(spec), _of_straight_leg(there))
        except InputError:  # no aperture, as it would take more than an hour
            return _Trial(slant_range, math.inf, "an aperture takes too long")

    here = _worst(radar.slant_range, result.lines, _of_straight_leg(design))
    near, far = (
        flown(height / math.sin(angle))
        for angle in (max(_STEEPEST, radar.grazing_angle), min(_FLATTEST, radar.grazing_angle))
    )
    # A design that does not close may do so from the nearest range on, or to the farthest.
    inside = next((trial for trial in (here, near, far) if trial.closes), None)
    if inside is None:
        return replace(result, swath=Swath(height))
    first, last = (
        _edge(inside, bound if inside is here or inside is bound else here, flown) for bound in (near, far)
    )
    return replace(result, swath=Swath(height, first.slant_range, last.slant_range, first.by, last.by))


def _of_straight_leg(design: Design) -> tuple[Check, ...]:
    """Checks of what no flight changes."""
    return tuple(check for check in analyse(design).verdict.checks if check.known)


def _worst(slant_range: float, lines: tuple[LineResult, ...], others: tuple[Check, ...]) -> _Trial:
    """The line, or the requirement that no flight changes, that is farthest beyond its limit at a slant range [m]."""
    trials = [_Trial(slant_range, 0.0, "")]
    for line in lines:
        name, excess = line.excess
        by = (
            f"{line.name} {line.reason}" if line.refused else f"{figure_in_sentence(name)} of {line.name} fails first"
        )
        trials.append(_Trial(slant_range, math.inf if line.refused else excess, by))
    for check in others:
        trials.append(_Trial(slant_range, check.value / check.limit, f"{figure_in_sentence(check.name)} fails first"))
    return max(trials, key=lambda trial: trial.excess)


def _edge(inside: _Trial, outside: _Trial, flown: Callable[[float], _Trial]) -> _Trial:
    """The last range that closes, from one that does towards one that does not, with what fails beyond it."""
    if outside.closes:  # as far as is searched
        return outside._replace(by="")
    trial = 0
    while abs(math.log(outside.slant_range / inside.slant_range)) > _CLOSE:
        share, trial = 0.5, trial + 1
        if trial % 3 and inside.excess > 0.0 and math.isfinite(outside.excess):  # nearly a power of the range
            share = min(max(-math.log(inside.excess) / math.log(outside.excess / inside.excess), 0.05), 0.95)
        middle = flown(inside.slant_range * (outside.slant_range / inside.slant_range) ** share)
        inside, outside = (middle, outside) if middle.closes else (inside, middle)
    return inside._replace(by=outside.by)


def swath_in_words(swath: Swath | None) -> str:
    """Near and far range in a sentence; empty where they are not solved."""
    if swath is None:
        return ""
    if swath.near_m is None or swath.far_m is None:
        return "No slant range from 20° to 70° of grazing angle meets the limits."

    def range_text(slant_range: float) -> str:
        return f"{slant_range / 1000:.3g} km ({math.degrees(math.asin(min(swath.height_m / slant_range, 1.0))):.0f}°)"

    limits = f"The limits are met from near range {range_text(swath.near_m)} to far range {range_text(swath.far_m)}"
    ends = (f" {where}, {by}." for where, by in (("Nearer", swath.near_by), ("Farther", swath.far_by)) if by)
    return f"{limits}, {swath.height_m / 1000:.3g} km above the scene.{''.join(ends)}"

"""Longest line that holds: its leg is made longer or shorter, and the plan is followed again by the same covariance.

All that follows the line moves along with its end, so that it is flown as before; outages stay at their times.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.processing import REAL_TIME
from nav_model.trajectory.covariance import lines_along
from nav_model.trajectory.design_study import planned
from nav_model.trajectory.lines import MOST_RESERVE
from nav_model.trajectory.result import STATE_AXES, LineResult, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec, FlightLine

_CLOSE = 0.01  # of its length: how near the solved line is to one that fails
_MOST_TRIALS = 24  # for a line
MOST_FIXES = 100_000
"""Of all flights of a solution together: a few minutes."""

Progress = Callable[[float, str], None]


def with_lengths(
    result: TrajectoryResult, design: Design, progress: Progress = lambda share, what: None
) -> TrajectoryResult:
    """The result of the design's plan, with the longest line that holds in place of each line, and its reserve.

    A line keeps None where it has no limit, cannot be flown longer or shorter, or where the flights are too many.
    """
    study, lines, solved = result.spec.study, result.lines, []
    if len(lines) * (study.duration + MOST_RESERVE) > MOST_FIXES * study.gnss.interval:
        return result
    for number, line in enumerate(lines):
        progress(number / len(lines), f"How long {line.name} may be, {number + 1} of {len(lines)}")
        try:
            solved.append(_solved(line, result, partial(line_longer, result.spec, design, number)))
        except InputError:  # the ground, the turns or the latitude leave no room for a line of another length
            solved.append(line)
    return replace(result, lines=tuple(solved))


def line_longer(spec: CovarianceSpec, design: Design, number: int, longer: float) -> LineResult:
    """A line of the plan flown longer than it is. In real time, what follows it changes nothing.

    Parameters
    ----------
    spec : CovarianceSpec
        The study.
    design : Design
        Its plan.
    number : int
        The line, counted from 0.
    longer : float
        By which it is longer, s.

    Raises
    ------
    InputError
        Where it cannot be flown.
    """
    flight = planned(design, number, longer)
    line = flight.lines[number] if flight.lines else FlightLine("flight", 0.0, flight.duration)
    if spec.lines:
        line = replace(line, most=spec.lines[number].most)
    soon = line.stop + 2.0 * spec.study.gnss.interval if spec.processing == REAL_TIME else math.inf
    study = replace(spec.study, trajectory=flight.trajectory, duration=min(flight.duration, soon))
    return lines_along(replace(spec, study=study, lines=(line,)))[0]


def _solved(line: LineResult, result: TrajectoryResult, flown: Callable[[float], LineResult]) -> LineResult:
    """The line with its longest that holds: bracketed from where a longer one first fails, then closed in."""
    if line.refused or not line.limits:
        return line
    aperture = float(result.spec.inputs.aperture)
    shortest = aperture + result.spec.study.every  # has a result with its aperture
    low: LineResult | None = None
    high = line
    if line.closes:
        low, high = line, flown(MOST_RESERVE)
        if high.closes:
            return replace(line, longest_s=high.duration, reserve_s=MOST_RESERVE)
    for trial in range(_MOST_TRIALS):
        least = low.duration * (1.0 + _CLOSE) if low else shortest
        if high.duration <= least * (1.0 + 1e-6):
            break
        if trial == 0:  # what is within the limits from the start on is, in real time, the answer
            image = high.fails_by not in STATE_AXES
            length = (high.fails_at_s or 0.0) + (aperture / 2 if image else 0.0)
        elif low is None:  # where the end fails at any length, so does the shortest
            length = least
        else:  # the excess grows nearly as a power of the length; halved now and then, whatever it does
            (x, y), (a, b) = (low.duration, high.duration), (low.excess[1], high.excess[1])
            share = min(max(-math.log(a) / math.log(b / a), 0.0), 1.0) if trial % 3 else 0.5
            length = x * (y / x) ** share
        other = flown(min(max(length, least), high.duration / (1.0 + _CLOSE)) - line.duration)
        low, high = (other, high) if other.closes else (low, other)
    longest = low.duration if low else 0.0
    return replace(line, longest_s=longest, reserve_s=max(longest - line.duration, 0.0))

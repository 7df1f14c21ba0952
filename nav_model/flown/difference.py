"""Figures of a flight from the difference of two solutions, line by line, beside those of the budget. [P-17], [P-18]

What a difference shows of a solution's error depends on the relation: a smoothed reference takes away what it has in
common with the solution, an independent one adds its own error. Mean squares are over time, at one sigma and of
navigation alone; to what is compared with a limit comes what the budget has beside navigation.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from nav_model.base.units import time_in_words
from nav_model.budget.verdict import confidence_of
from nav_model.flown.budgeted import LEAST_FREEDOM, Budgeted, Square, band
from nav_model.flown.images import FIGURES_FLOWN, Images
from nav_model.flown.result import ALL, CONSISTENT, FEW, LESS, MORE, FlownLine, FlownVerdict, Measured
from nav_model.flown.track import Stretch

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Flown:
    """A line as it was flown, middles of its apertures [s] with one sigma of each figure, and its mean squares."""

    line: FlownLine
    aperture_s: FloatArray
    apertures: Mapping[str, FloatArray]
    squares: Mapping[str, Square]


def line_of(stretch: Stretch, budgeted: Budgeted, images: Images, states: Mapping[str, Square]) -> Flown:
    """The figures of a line.

    Parameters
    ----------
    stretch : Stretch
    budgeted : Budgeted
    images : Images
    states : mapping
        Mean squares of the states.
    """
    squares = {**images.squares, **states}
    figures = _figures(squares, budgeted.limits_on(stretch), budgeted, stretch.stop - stretch.start)
    line = FlownLine(stretch.name, stretch.start, stretch.stop, figures, images.left_out)
    return Flown(line, images.aperture_s, images.apertures, squares)


def together(flown: Sequence[Flown], budgeted: Budgeted) -> FlownLine:
    """All lines as one: mean squares over their time, with the degrees of freedom of all."""
    lines = [each.line for each in flown]
    squares = {}
    for name in dict.fromkeys(name for each in flown for name in each.squares):
        known = [
            (each.line.stop_s - each.line.start_s, each.squares[name])
            for each in flown
            if name in each.squares and math.isfinite(each.squares[name].seen)
        ]
        if not known:
            continue
        time = sum(duration for duration, _ in known)
        squares[name] = Square(
            **{
                part: sum(duration * getattr(one, part) for duration, one in known) / time
                for part in ("seen", "beyond", "others", "budget")
            },
            freedom=sum(one.freedom for _, one in known),
            apertures=sum(one.apertures for _, one in known),
            refused=next((one.refused for _, one in known if one.refused), ""),
        )
    limits, time = dict(budgeted.track.spec.most), sum(line.stop_s - line.start_s for line in lines)
    figures = _figures(squares, limits, budgeted, time)
    left_out = sum(line.apertures_left_out for line in lines)
    return FlownLine(ALL, lines[0].start_s, lines[-1].stop_s, figures, left_out)


def _figures(
    squares: Mapping[str, Square], limits: Mapping[str, float], budgeted: Budgeted, duration: float
) -> dict[str, Measured]:
    return {
        name: _measured(name, squares[name], limits.get(name), budgeted, duration)
        for name in FIGURES_FLOWN
        if name in squares
    }


def _measured(name: str, square: Square, limit: float | None, budgeted: Budgeted, duration: float) -> Measured:
    """A figure at its confidence, with its verdict."""
    factor = confidence_of(budgeted.design, name)
    level = None if limit is None else factor * limit

    def whole(seen: float) -> float:
        return factor * math.sqrt(max(seen + square.beyond + square.others, 0.0))

    budget = factor * math.sqrt(square.budget + square.others)
    if not math.isfinite(square.seen):
        nothing = math.nan, math.nan, math.nan, 0.0, square.apertures
        verdict: FlownVerdict = "" if level is None else "cannot be told"
        return Measured(level, budget, *nothing, verdict, "", math.nan, square.refused)
    low, high = (square.seen * part for part in band(square.freedom))
    navigation = math.sqrt(max(square.seen + square.beyond, 0.0) / square.budget) if square.budget else math.nan
    against = ""
    if square.freedom >= LEAST_FREEDOM:
        sides = (low + square.beyond > square.budget, high + square.beyond < square.budget)
        against = MORE if sides[0] else LESS if sides[1] else CONSISTENT
    verdict, reason = _decided(level, square, (low, high), whole, duration)
    return Measured(
        level, budget, whole(square.seen), whole(low), whole(high), square.freedom, square.apertures,
        verdict, against, navigation, reason,
    )  # fmt: skip


def _decided(
    level: float | None, square: Square, ends: tuple[float, float], whole: Callable[[float], float], duration: float
) -> tuple[FlownVerdict, str]:
    """The verdict on a figure and its reason, of its limit, its band [of the mean square seen], and how a mean square
    becomes a value; `duration`: of the line [s]."""
    if level is None:
        return "", square.refused
    if square.refused:
        return "cannot be told", square.refused
    if square.freedom < LEAST_FREEDOM:
        few = f"{square.freedom:.1f} {FEW} {LEAST_FREEDOM:.0f}"
        return "cannot be told", few
    low, high = (whole(one) for one in ends)
    if high <= level:
        return "met", ""
    if low > level:
        return "not met", ""

    # Open: with more degrees of freedom the band is narrower, until an end of it passes the limit.
    end = 1 if whole(square.seen) <= level else 0

    def beyond(logarithm: float) -> float:
        return float(whole(square.seen * band(math.exp(logarithm))[end]) - level)

    first, last = math.log(square.freedom), math.log(1e7)
    if beyond(first) * beyond(last) > 0.0:
        return "open", "it lies at its limit"
    needed = math.exp(brentq(beyond, first, last))
    more = duration * (needed / square.freedom - 1.0)
    return "open", f"{time_in_words(more)} more of such flight would decide"

"""The figures along a flight: their values in words, their limits, and the one to show first."""

from __future__ import annotations

import math

from app.document.numbers import show
from app.work.flight import Followed
from nav_model.budget.verdict import decisive, lowest_limit
from nav_model.design import Design
from nav_model.design.figures import FIGURES as DECLARED
from nav_model.design.figures import IN_FLIGHT

FIGURES = {name: DECLARED[name] for name in IN_FLIGHT}
"""Figures that a requirement of the design may limit along a flight."""


def factor(design: Design, name: str) -> float:
    """The confidence at which a figure is told, along a flight as in the budget."""
    return decisive(design, name)[0]


def spread_of(design: Design) -> str:
    """The confidence of what is shown of a flight, for captions."""
    return f"at {design.requirements.confidence:g}σ"


def show_value(design: Design, name: str, sigma: float, *, given: bool = False, like: float | None = None) -> str:
    """One sigma of a figure [SI] at the confidence of its limit, with its unit.

    Parameters
    ----------
    design : Design
        Has the confidence.
    name : str
    sigma : float
    given : bool
        As a person gave it.
    like : float, optional
        In the unit of this one.
    """
    scale = factor(design, name)
    like = None if like is None else scale * like
    return show(scale * sigma, FIGURES[name].dimension, given=given, like=like)


def limits_along(followed: Followed, name: str) -> tuple[tuple[float, float, float], ...]:
    """Start, stop [s] and level of every limit on one sigma of a figure: one, unless a line has its own."""
    result, lowest = followed.result, lowest_limit(followed.design, name)
    everywhere = dict(result.spec.most).get(name, lowest.at_one_sigma if lowest else math.nan)
    limits = [(line.start_s, line.stop_s, line.limits[name]) for line in result.lines if name in line.limits]
    if all(level == everywhere for _, _, level in limits):
        limits = [(float(result.time_s[0]), float(result.time_s[-1]), everywhere)]
    return tuple(limit for limit in limits if not math.isnan(limit[2]))


def main_figure(followed: Followed) -> str:
    """The figure that decides: the one that is farthest over its limit on some line, or nearest to it. Where no line
    has a limit, that of the design's verdict; without one, the detrended phase."""
    _, name = max((line.excess[::-1] for line in followed.result.lines), default=(0.0, ""))
    if name:
        return name
    checks = (check for check in followed.budget.verdict.checks if check.known and check.on in FIGURES)
    tightest = min(checks, key=lambda check: check.margin, default=None)
    return tightest.on if tightest else "detrended_phase"

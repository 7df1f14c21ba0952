"""Accuracies that the file of a solution claims, beside the budget, and against the difference of two solutions."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from nav_model.base.arrays import interpolated
from nav_model.budget.verdict import confidence_of
from nav_model.flown.budgeted import LEAST_FREEDOM, Budgeted
from nav_model.flown.relation import Compared, Relation
from nav_model.flown.result import ALL, Claimed, FlownLine
from nav_model.flown.solution import Solution
from nav_model.trajectory.result import STATE_AXES

ClaimsByLine = Mapping[str, Mapping[str, Claimed]]
"""Claims by line and figure."""


def claims_of(solution: Solution, budgeted: Budgeted) -> ClaimsByLine:
    """Claimed and budgeted sigma of the states on each line, where the file claims any."""
    if solution.claims is None:
        return {}
    budget, sigma = budgeted.states(budgeted.processing), solution.claims.by_axis
    by_line = {}
    for stretch in budgeted.track.stretches:
        inside = (solution.time_s >= stretch.start) & (solution.time_s <= stretch.stop)
        on, limits = budgeted.on(stretch, image=False), budgeted.limits_on(stretch)
        by_line[stretch.name] = figures = dict[str, Claimed]()
        for name, axes in STATE_AXES.items():
            known = np.isfinite(sigma[inside, axes]).all(axis=1)
            if not known.any() or not on.any():
                continue
            factor = confidence_of(budgeted.design, name)
            figures[name] = Claimed(
                factor * math.sqrt(float(np.mean(sigma[inside, axes][known] ** 2, axis=0).max())),
                factor * math.sqrt(float(budget[on, axes].mean(axis=0).max())),
                None if name not in limits else factor * limits[name],
            )
    return by_line


def claimed(claims: ClaimsByLine) -> str:
    """The claims against the limits, in words."""
    answers = [one.claimed_to_be_met for figures in claims.values() for one in figures.values()]
    limited = [answer for answer in answers if answer is not None]
    if not answers:
        return "the file claims no accuracy, and there is no second solution"
    if not limited:
        return "there is no second solution, and no limit is on what the file claims"
    return f"claimed {'' if all(limited) else 'not '}to be met: a claim is no error"


def nees_of(
    relation: Relation, x: Solution, y: Solution, compared: Compared, lines: Sequence[FlownLine]
) -> Mapping[str, float]:
    """Mean normalised square of the position's difference by the claims over three, with its band; empty without
    claims of both.

    Parameters
    ----------
    relation : str
    x, y : Solution
        The solution and its reference, both on the solution's clock.
    compared : Compared
    lines : sequence of FlownLine
        Whose degrees of freedom count.
    """
    if x.claims is None or y.claims is None or relation == "reverse":
        return {}
    if x.claims.position is None or y.claims.position is None:
        return {}
    of_x = interpolated(compared.time_s, x.time_s, x.claims.position**2)
    of_y = interpolated(compared.time_s, y.time_s, y.claims.position**2)
    variance = of_x - of_y if relation == "smoothed" else of_x + of_y
    known = np.isfinite(variance).all(axis=1) & (variance > 0.0).all(axis=1)
    position = [line.figures.get("horizontal_position") for line in lines if line.name != ALL]
    degrees = 3.0 * sum(one.freedom for one in position if one is not None)
    if not known.any() or degrees < LEAST_FREEDOM:
        return {}
    mean = float(np.mean(compared.position[known] ** 2 / variance[known]))
    return {
        "mean": mean,
        "low_95": float(chi2.ppf(0.025, degrees) / degrees),
        "high_95": float(chi2.ppf(0.975, degrees) / degrees),
        "factor": math.sqrt(mean),
    }

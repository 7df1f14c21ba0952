"""Position, velocity and attitude of a flown line from the difference of two solutions. [P-17]"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.design.processing import REAL_TIME
from nav_model.flown.budgeted import Budgeted, Square, band
from nav_model.flown.noise_scale import Scale
from nav_model.flown.relation import Compared
from nav_model.flown.solution import Solution, nine_columns
from nav_model.flown.spread import Error, covariance_of, freedom, of_states, part_of_passes
from nav_model.flown.track import Stretch
from nav_model.trajectory.passes import DIFFERENCE
from nav_model.trajectory.result import STATE_AXES

FloatArray = NDArray[np.float64]
_MOST = 200  # results whose covariance gives the freedom of a line
AXES = 9


@dataclass(frozen=True, eq=False)
class Seen:
    """Mean squares (9,) of the difference on a line, of position, velocity and roll, pitch, yaw, nan where there is
    none; the results that count for it, their covariance over time, and the times of the difference [s]."""

    mean_square: FloatArray
    on: NDArray[np.int64]
    C: FloatArray
    time_s: FloatArray

    def freedom(self, axis: int) -> float:
        """Degrees of freedom of one axis."""
        return freedom(self.C, np.eye(AXES)[axis])


def seen_on(stretch: Stretch, budgeted: Budgeted, compared: Compared) -> Seen | None:
    """The difference on a line; None where nothing is."""
    on = np.flatnonzero(budgeted.on(stretch, image=False))
    inside = (compared.time_s >= stretch.start) & (compared.time_s <= stretch.stop)
    time = compared.time_s[inside]
    if not on.size or len(time) < 2:
        return None
    d = nine_columns(compared.position, compared.velocity, compared.attitude)[inside]
    # Which values stand for themselves: from some of the results, evenly.
    chosen = on[np.unique(np.linspace(0, len(on) - 1, min(len(on), _MOST)).astype(np.int64))]
    model, run = budgeted.followed.model, budgeted.followed.run
    error: Error = "output" if budgeted.relation == "reverse" else budgeted.error
    C = covariance_of(model, run, budgeted.adjoint, of_states(model, chosen), error)
    return Seen(np.asarray(np.trapezoid(d**2, time, axis=0) / np.ptp(time)), on, C, time)


def states_of(seen: Seen, budgeted: Budgeted, scale: Scale, reference: Solution) -> dict[str, Square]:
    """Mean squares of the states on a line.

    Parameters
    ----------
    seen : Seen
    budgeted : Budgeted
    scale : Scale
        Of the noise that the flight shows.
    reference : Solution
        Whose claims are its own error, on the solution's clock.
    """
    output = budgeted.states(budgeted.processing)[seen.on].mean(axis=0)
    factor, beyond, refused = _beyond(seen, budgeted, scale, reference)
    mean = seen.mean_square * factor
    return {
        name: _of_axes(mean, beyond, output, seen, [*range(AXES)[axes]], refused)
        for name, axes in STATE_AXES.items()
        if np.isfinite(mean[axes]).all()
    }


def claimed_by(reference: Solution, seen: Seen) -> FloatArray:
    """Mean squares of the error that a reference claims on a line, by axis (9,) in SI, 0 where it claims none."""
    if reference.claims is None:
        return np.zeros(AXES)
    near = np.clip(np.searchsorted(reference.time_s, seen.time_s), 0, len(reference.time_s) - 1)
    sigma = reference.claims.by_axis[near]
    return np.asarray(np.nansum(sigma**2, axis=0) / np.maximum(np.isfinite(sigma).sum(axis=0), 1))


def _of_axes(
    seen: FloatArray, beyond: FloatArray, output: FloatArray, of: Seen, axes: list[int], refused: Sequence[str]
) -> Square:
    """The mean square of one or two axes: that of the axis that the budget has larger, by what both show together.
    Where the two differ by more than their bands, it is that of the axis that is farther off than its budget.

    Parameters
    ----------
    seen, beyond, output : array (9,)
        Mean squares of the difference, what it does not show, and those of the solution by the budget.
    of : Seen
    axes : list of int
    refused : sequence of str
        Why an axis is, else empty.
    """
    ratios = {axis: seen[axis] / output[axis] for axis in axes}
    low, high = min(axes, key=lambda one: ratios[one]), max(axes, key=lambda one: ratios[one])
    degrees = {axis: of.freedom(axis) for axis in {low, high}}
    apart = ratios[high] * band(degrees[high])[0] > ratios[low] * band(degrees[low])[1]
    axis = high if apart else max(axes, key=lambda one: output[one])
    factors = np.zeros(AXES)
    factors[[axis] if apart else axes] = 1.0
    part = factors * float(output[axis]) / float(output @ factors)
    mean, lacking = (float(np.nan_to_num(values) @ part) for values in (seen, beyond))
    return Square(mean, lacking, 0.0, float(output[axis]), freedom(of.C, factors), refused=refused[axis])


def _beyond(
    seen: Seen, budgeted: Budgeted, scale: Scale, reference: Solution
) -> tuple[FloatArray, FloatArray, list[str]]:
    """Factor on the mean square of a difference that gives that of the solution's error, what is added to it, both by
    axis (9,), and why an axis is refused. [P-17]"""
    refused = [""] * AXES
    if budgeted.relation == "smoothed":
        # By source, an error of the solution is so much of the difference's, at the noise that the flight shows.
        whole, apart = (
            np.einsum("s,soq->q", scale.of_sources, budgeted.followed.states[name][:, seen.on]) / len(seen.on)
            for name in (REAL_TIME, DIFFERENCE)
        )
        empty = "the smoothed reference has the same error by the budget: is it post-processed?"
        refused = [empty if d <= 1e-6 * x else "" for d, x in zip(apart, whole, strict=True)]
        return np.where(apart > 0.0, whole / np.where(apart > 0.0, apart, 1.0), 1.0), np.zeros(AXES), refused
    if budgeted.relation == "reverse":
        model, run = budgeted.followed.model, budgeted.followed.run
        return part_of_passes(model, run, budgeted.adjoint, seen.on), np.zeros(AXES), refused
    claimed = claimed_by(reference, seen)
    for axis in np.flatnonzero(claimed > 0.5 * seen.mean_square):
        refused[axis] = "the reference's claim is more than half of the difference"
    return np.ones(AXES), -claimed, refused

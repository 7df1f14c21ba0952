"""The filter of one axis over the aperture and its smoothers, on the errors of many runs at once.

The filter works on errors, so its gains are the same for every run. The whole-leg smoother does not need the fixes
after the aperture one by one: they give information about the state at the next fix, whose error is drawn from its
covariance (`nav_model.sar.axis_model.information_after`). This is exact.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.sar.axis_model import (
    AxisModel,
    draw_state,
    filter_drift,
    fix_rows,
    inertial_drift,
    information_after,
    measure,
)
from nav_model.sar.smoother import rts_smooth, smoother_gain


class Filtered(NamedTuple):
    """Errors (k, runs, m) just before and just after each fix, and their covariances (k, m, m)."""

    prior: Array
    posterior: Array
    prior_covariance: Array
    covariance: Array


class Fixes(NamedTuple):
    """Fixes of the aperture: their noise (k, runs, kinds), and the innovation of the slow error at each (k, runs)."""

    noise: Array
    fresh: Array


def filtered(model: AxisModel, start: Array, covariance: Array, at_fixes: Array, fixes: Fixes) -> Filtered:
    """The filter's errors and covariances at every fix of the aperture.

    Parameters
    ----------
    model : AxisModel
        Noise and fixes of the axis.
    start : array (runs, m)
        Error just after the first fix.
    covariance : array (m, m)
        Of that error.
    at_fixes : array (3, runs, k)
        Noise path at the fixes.
    fixes : Fixes
        Noise of the fixes.
    """
    priors, posteriors, prior_covariances, covariances = [start], [start], [covariance], [covariance]
    phi, q = filter_drift(model, model.fix_interval)
    h, phi_inertial = fix_rows(model), inertial_drift(model, model.fix_interval)[0]
    for k in range(1, len(fixes.noise)):
        # The noise of this interval is the path at its end less what the path at its beginning has become by then.
        prior = posteriors[-1] @ phi.T
        prior[:, :3] += at_fixes[:, :, k].T - at_fixes[:, :, k - 1].T @ phi_inertial.T
        # The filter's fourth state is its estimate of the slow error less the truth, which has moved on.
        prior[:, 3:] -= fixes.fresh[k][:, None]
        prior_covariance = phi @ covariances[-1] @ phi.T + q
        gain, covariance = measure(prior_covariance, model)
        priors.append(prior)
        posteriors.append(prior - (prior @ h.T - fixes.noise[k]) @ gain.T)
        prior_covariances.append(prior_covariance)
        covariances.append(covariance)
    return Filtered(*(np.stack(part) for part in (priors, posteriors, prior_covariances, covariances)))


def filtered_in_leg(
    model: AxisModel,
    settled: tuple[Array, Array],
    path: tuple[Array, Array],
    fixes: Fixes,
    rest: float,
    random: np.random.Generator,
) -> Filtered:
    """The filter up to the first fix after the aperture, with the information of all later ones.

    Parameters
    ----------
    model : AxisModel
    settled : pair of array
        Error (runs, m) just after the first fix of the filter in steady state, and its covariance.
    path : pair of array
        Noise path at the fixes of the aperture (3, runs, k), and at its end (3, runs).
    fixes : Fixes
        Of the aperture.
    rest : float
        Seconds from the aperture's end to the next fix.
    random : Generator
    """
    # The filter up to the next fix, which is not taken: its noise path goes on from the aperture's end.
    runs = len(settled[0])
    phi, q = inertial_drift(model, rest)
    next_path = path[1].T @ phi.T + draw_state(q, runs, random)
    fresh = draw_fresh(model, runs, random, model.fix_interval)
    extended = Fixes(
        np.concatenate([fixes.noise, np.zeros_like(fixes.noise[:1])]), np.concatenate([fixes.fresh, fresh[None]])
    )
    result = filtered(model, *settled, np.concatenate([path[0], next_path.T[:, :, None]], axis=2), extended)
    # Information Y about the state there, of that fix and all later ones, makes of its error e the error
    # (1 + P Y)⁻¹ (e + P n), where n of covariance Y is what the noise of these fixes comes to.
    y, p = information_after(model, model.leg_after - rest), result.prior_covariance[-1]
    noise = random.standard_normal((runs, len(p))) @ _root(y).T
    posterior = np.linalg.solve(np.eye(len(p)) + p @ y, (result.prior[-1] + noise @ p).T).T
    return result._replace(posterior=np.concatenate([result.posterior[:-1], posterior[None]]))


def navigated(done: Filtered, at_fixes: Array, sampled: Array, time: Array, fix_time: Array) -> Array:
    """The filter's error (3, runs, n) between the fixes, from the noise path at the fixes and at the times.

    Parameters
    ----------
    done : Filtered
        Errors at the fixes.
    at_fixes, sampled : array (3, runs, k), array (3, runs, n)
        Noise path at the fixes, and at the times.
    time, fix_time : array (n,), array (k,)
        Seconds in the aperture.
    """
    error = sampled.copy()
    for k, span in _stretches(time, fix_time):
        error[:, :, span] += carried(done.posterior[k][:, :3] - at_fixes[:, :, k].T, time[span] - fix_time[k])
    return error


def smoothed(model: AxisModel, done: Filtered, position: Array, time: Array, fix_time: Array) -> Array:
    """Position error (runs, n) of the smoother that has all fixes of `done`, from the filter's between the fixes.

    Parameters
    ----------
    model : AxisModel
        Noise and fixes of the axis.
    done : Filtered
        Errors at the fixes.
    position : array (runs, n)
        The filter's error.
    time, fix_time : array (n,), array (k,)
        Seconds in the aperture.
    """
    phi = filter_drift(model, model.fix_interval)[0]
    transitions = np.broadcast_to(phi, (len(done.prior) - 1, *phi.shape))
    at_fixes = rts_smooth(done.posterior, done.covariance, done.prior, done.prior_covariance, transitions)
    error = position.copy()
    for k, span in _stretches(time, fix_time):
        if k + 1 < len(done.prior):
            # Between two fixes: what the smoother changes at the next one, times the gain from here to there.
            age = time[span] - fix_time[k]
            phi_here, q_here = filter_drift(model, age)
            predicted = phi_here @ done.covariance[k] @ phi_here.mT + q_here
            phi_next = filter_drift(model, model.fix_interval - age)[0]
            gain_row = smoother_gain(predicted, phi_next, done.prior_covariance[k + 1])[:, 0, :]
            error[:, span] += (at_fixes[k + 1] - done.prior[k + 1]) @ gain_row.T
    return error


def carried(state: Array, age: Array) -> Array:
    """A state (runs, 3) carried forward over ages (n,): (3, runs, n)."""
    p, v, a = state.T[:, :, None]
    return np.stack([p + v * age + a * (age**2 / 2), v + a * age, np.broadcast_to(a, (len(state), len(age)))])


def draw_fresh(model: AxisModel, runs: int, random: np.random.Generator, step: float) -> Array:
    """Innovation of the slow error of the fixes after a step, (runs,).

    Parameters
    ----------
    model : AxisModel
        Its slow error.
    runs : int
        Number of runs.
    random : numpy.random.Generator
        Of the draws.
    step : float
        Seconds.
    """
    if not model.slow_sigma:
        return np.zeros(runs)
    return model.slow_sigma * math.sqrt(-math.expm1(-2 * step / model.slow_time)) * random.standard_normal(runs)


def _stretches(time: Array, fix_time: Array) -> list[tuple[int, slice]]:
    """Slices of the times between each fix and the next."""
    edges = np.searchsorted(time, [*(fix_time - 1e-9), np.inf])
    return [(k, slice(a, b)) for k, (a, b) in enumerate(pairwise(edges))]


def _scale(matrix: Array) -> Array:
    """One over the roots of the diagonal: states differ by many orders of magnitude."""
    diagonal = np.diagonal(matrix)
    return np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 1.0)


def _root(matrix: Array) -> Array:
    """A matrix whose product with its own transpose is the one given."""
    by = _scale(matrix)
    values, vectors = np.linalg.eigh(matrix * by[:, None] * by)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) / by[:, None])

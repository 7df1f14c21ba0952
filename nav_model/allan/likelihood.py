"""Maximum likelihood of the five noise terms on a cosine spectrum, with profile-likelihood intervals.

The coefficients of the cosine transform are independent Gaussians whose variances are linear in Q², N², B², K²
and whose means are the ramp's (noise_terms.py). The likelihood uses all of them at once, so that the correlation
between overlapping Allan estimates, which makes least squares on an Allan plot overconfident, never arises.
Literature: P. Whittle 1953; J. Nikolic et al., IEEE Sensors J. 16(1), 2016 (maximum likelihood for inertial
sensors); W. Venzon and S. Moolgavkar 1988 (profile-likelihood intervals).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.noise_terms import FloatArray
from nav_model.allan.spectrum import CosineSpectrum

# 95 % point of chi-square with one degree of freedom: the fall of 2 ln L that bounds an interval.
CONFIDENCE_95 = 3.841458820694124

_ITERATIONS = 200
_CONVERGED = 1e-9
_SMOOTHING = 9


@dataclass(frozen=True)
class Estimate:
    """One coefficient squared (or the signed ramp) with its 95 % interval; `low` is 0 at the edge of the allowed range."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class _Problem:
    """A spectrum scaled to order one; `count` already holds any allowance for model error."""

    power: FloatArray
    count: FloatArray
    shapes: FloatArray
    amplitude: FloatArray
    ramp: FloatArray
    singles: int


@dataclass(frozen=True)
class _Solution:
    theta: FloatArray
    slope: float
    deviance: float


@dataclass(frozen=True)
class SpectrumFit:
    """Estimates of Q², N², B², K² (in that order) and of the signed ramp, SI, with the fitted bin variances."""

    squares: tuple[Estimate, Estimate, Estimate, Estimate]
    ramp: Estimate
    model: FloatArray
    residual_power: FloatArray


def fit_spectrum(spectrum: CosineSpectrum, used: NDArray[np.bool_], model_error: float) -> SpectrumFit:
    """Fit the bins marked in `used`; `model_error` is the relative standard deviation of a bin's power about the model.

    Zero when the five terms describe the log; otherwise it widens every interval as a random effect would.
    """
    keep = np.asarray(used, dtype=np.bool_)
    single = keep[: spectrum.singles]
    unit = float(np.median(spectrum.power[keep]))
    column = spectrum.shapes[:, keep]
    # Each column is scaled to touch the smoothed spectrum from below, so that theta is of order one or less.
    smooth = np.convolve(spectrum.power[keep], np.ones(_SMOOTHING), "same") / _SMOOTHING
    scale = np.max(column / smooth, axis=1)
    ramp_scale = float(np.max(np.abs(spectrum.ramp))) / np.sqrt(unit)
    count = spectrum.count[keep]
    problem = _Problem(
        power=spectrum.power[keep] / unit,
        count=1.0 / (1.0 / count + model_error**2 / 2.0),
        shapes=column / scale[:, None] / unit,
        amplitude=spectrum.amplitude[single] / np.sqrt(unit),
        ramp=spectrum.ramp[single] / ramp_scale / np.sqrt(unit),
        singles=int(np.count_nonzero(single)),
    )
    best = _best(problem)
    squares = tuple(_square_interval(problem, best, term, 1.0 / scale[term]) for term in range(4))
    ramp = _ramp_interval(problem, best, 1.0 / ramp_scale)
    theta = best.theta / scale
    residual = spectrum.power.copy()
    slope = best.slope / ramp_scale
    residual[: spectrum.singles] = (spectrum.amplitude - slope * spectrum.ramp) ** 2
    return SpectrumFit(
        squares=(squares[0], squares[1], squares[2], squares[3]),
        ramp=ramp,
        model=theta @ spectrum.shapes,
        residual_power=residual,
    )


def _deviance(problem: _Problem, theta: FloatArray, slope: float) -> tuple[float, FloatArray, FloatArray]:
    """-2 ln L up to a constant, with the model variances and the powers about the ramp."""
    model = theta @ problem.shapes
    power = problem.power.copy()
    power[: problem.singles] = (problem.amplitude - slope * problem.ramp) ** 2
    if np.any(model <= 0.0):
        return np.inf, model, power
    return float(problem.count @ (np.log(model) + power / model)), model, power


def _slope(problem: _Problem, model: FloatArray) -> float:
    weight = problem.count[: problem.singles] * problem.ramp / model[: problem.singles]
    return float(weight @ problem.amplitude / (weight @ problem.ramp))


def _solve(
    problem: _Problem, start: _Solution, fixed_term: int | None = None, fixed_value: float = 0.0, fixed_slope: float | None = None
) -> _Solution:
    """Fisher scoring with non-negative theta: each step is a weighted non-negative least squares, halved if it overshoots."""
    from scipy.optimize import nnls

    free = [term for term in range(4) if term != fixed_term]
    theta = start.theta.copy()
    if fixed_term is not None:
        theta[fixed_term] = fixed_value
    theta = np.maximum(theta, 0.0)
    if np.any(theta @ problem.shapes <= 0.0):
        theta[1 if fixed_term != 1 else 2] += 0.1
    slope = start.slope if fixed_slope is None else fixed_slope
    deviance, model, power = _deviance(problem, theta, slope)
    for _ in range(_ITERATIONS):
        weight = np.sqrt(problem.count) / model
        target = power if fixed_term is None else power - fixed_value * problem.shapes[fixed_term]
        step = theta.copy()
        step[free] = nnls((problem.shapes[free] * weight).T, target * weight)[0]
        fraction, previous = 1.0, deviance
        for _halving in range(30):
            trial = theta + fraction * (step - theta)
            trial_model = trial @ problem.shapes
            positive = bool(np.all(trial_model > 0.0))
            trial_slope = slope if fixed_slope is not None or not positive else _slope(problem, trial_model)
            trial_deviance, trial_model, trial_power = _deviance(problem, trial, trial_slope)
            if trial_deviance <= deviance:
                theta, slope, deviance, model, power = trial, trial_slope, trial_deviance, trial_model, trial_power
                break
            fraction /= 2.0
        if previous - deviance < _CONVERGED * max(1.0, abs(deviance) * 1e-6):
            break
    return _Solution(theta, slope, deviance)


def _best(problem: _Problem) -> _Solution:
    """Best of several starts: one term carrying everything, or all together."""
    starts = [np.full(4, 0.2), *(np.where(np.arange(4) == term, 1.0, 1e-3) for term in range(4))]
    found = [_solve(problem, _Solution(start, 0.0, np.inf)) for start in starts]
    return min(found, key=lambda solution: solution.deviance)


def _profile(problem: _Problem, best: _Solution, term: int, value: float) -> float:
    """Smallest deviance with one theta held; the walk, flicker and ramp trade places, so several starts are tried."""
    lifted = np.maximum(best.theta, 0.3)
    starts = (best.theta, lifted, np.where(np.arange(4) == 3, lifted, best.theta))
    return min(
        _solve(problem, _Solution(start, best.slope, np.inf), fixed_term=term, fixed_value=value).deviance
        for start in starts
    )


def _square_interval(problem: _Problem, best: _Solution, term: int, unit: float) -> Estimate:
    from scipy.optimize import brentq

    goal = best.deviance + CONFIDENCE_95
    value = float(best.theta[term])

    def excess(theta: float) -> float:
        return _profile(problem, best, term, theta) - goal

    low = 0.0
    if value > 0.0 and excess(0.0) > 0.0:
        inside, outside = value, value / 2.0
        while excess(outside) <= 0.0:
            inside, outside = outside, outside / 2.0
        low = float(brentq(excess, outside, inside, xtol=1e-5 * value))
    inside = value
    outside = value * 1.05 if value > 0.0 else 1e-9
    while excess(outside) <= 0.0:
        inside, outside = outside, outside * (1.5 if value > 0.0 else 4.0)
    high = float(brentq(excess, inside, outside, xtol=1e-5 * outside))
    return Estimate(value * unit, low * unit, high * unit)


def _ramp_interval(problem: _Problem, best: _Solution, unit: float) -> Estimate:
    from scipy.optimize import brentq

    goal = best.deviance + CONFIDENCE_95
    model = best.theta @ problem.shapes
    weight = problem.count[: problem.singles] * problem.ramp**2 / model[: problem.singles]
    sigma = float(1.0 / np.sqrt(weight.sum()))

    def excess(slope: float) -> float:
        return _solve(problem, best, fixed_slope=slope).deviance - goal

    ends = []
    for sign in (-1.0, 1.0):
        reach = 1.0
        while excess(best.slope + sign * reach * sigma) <= 0.0:
            reach *= 1.6
        ends.append(float(brentq(excess, best.slope, best.slope + sign * reach * sigma, xtol=1e-4 * sigma)))
    return Estimate(best.slope * unit, ends[0] * unit, ends[1] * unit)

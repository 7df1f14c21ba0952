"""Maximum likelihood of the five noise terms on a cosine spectrum, with profile-likelihood intervals.

The coefficients of the cosine transform are independent Gaussians whose variances are linear in Q², N², B²,
K² and whose means are the ramp's (noise_terms.py). The likelihood uses all of them at once, so that the
correlation between overlapping Allan estimates, which makes least squares on an Allan plot overconfident,
never arises. Literature: P. Whittle 1953; J. Nikolic et al., IEEE Sensors J. 16(1), 2016 (maximum likelihood
for inertial sensors); W. Venzon and S. Moolgavkar 1988 (profile-likelihood intervals).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.spectrum import CosineSpectrum
from nav_model.base.arrays import Array

# 95 % point of chi-square with one degree of freedom: the fall of 2 ln L that bounds an interval.
CONFIDENCE_95 = 3.841458820694124

_ITERATIONS = 200
_CONVERGED = 1e-9
_SMOOTHING = 9
_WALK_NODES = 25
_WALK_REACH = 1.5


@dataclass(frozen=True)
class Estimate:
    """One coefficient squared (or the signed ramp) with its 95 % interval; `low` 0 where absence fits."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class _Problem:
    """A spectrum scaled to order one; `count` already holds any allowance for model error."""

    power: Array
    count: Array
    shapes: Array
    amplitude: Array
    ramp: Array
    singles: int


@dataclass(frozen=True)
class _Solution:
    theta: Array
    slope: float
    deviance: float


@dataclass(frozen=True)
class SpectrumFit:
    """Estimates of Q², N², B², K² (in that order) and of the signed ramp, SI."""

    squares: tuple[Estimate, Estimate, Estimate, Estimate]
    ramp: Estimate


def fit_spectrum(spectrum: CosineSpectrum, used: NDArray[np.bool_], model_error: float) -> SpectrumFit:
    """Fit the bins marked in `used`; `model_error` is the relative standard deviation of a bin's power about
    the model.

    Zero when the five terms describe the log; otherwise it widens every interval as a random effect would.
    """
    problem, scale, ramp_scale = _scaled(spectrum, used, model_error)
    best = _best(problem)
    squares = tuple(_square_interval(problem, best, term, 1.0 / scale[term]) for term in range(4))
    walk_high = squares[3].high * scale[3]
    return SpectrumFit(
        squares=(squares[0], squares[1], squares[2], squares[3]),
        ramp=_ramp_interval(problem, best, walk_high, 1.0 / ramp_scale),
    )


def fitted_spectrum(spectrum: CosineSpectrum, used: NDArray[np.bool_], model_error: float) -> tuple[Array, Array]:
    """Model variance of every bin at the best fit to the `used` ones, and powers about the fitted ramp."""
    problem, scale, ramp_scale = _scaled(spectrum, used, model_error)
    best = _best(problem)
    residual = spectrum.power.copy()
    residual[: spectrum.singles] = (spectrum.amplitude - best.slope / ramp_scale * spectrum.ramp) ** 2
    return np.asarray((best.theta / scale) @ spectrum.shapes), residual


def _scaled(spectrum: CosineSpectrum, used: NDArray[np.bool_], model_error: float) -> tuple[_Problem, Array, float]:
    single = used[: spectrum.singles]
    unit = float(np.median(spectrum.power[used]))
    column = spectrum.shapes[:, used]
    # Each column is scaled to touch the smoothed spectrum from below, so that theta is of order one or less.
    smooth = np.convolve(spectrum.power[used], np.ones(_SMOOTHING), "same") / _SMOOTHING
    scale = np.max(column / smooth, axis=1)
    ramp_scale = float(np.max(np.abs(spectrum.ramp))) / np.sqrt(unit)
    problem = _Problem(
        power=spectrum.power[used] / unit,
        count=1.0 / (1.0 / spectrum.count[used] + model_error**2 / 2.0),
        shapes=column / scale[:, None] / unit,
        amplitude=spectrum.amplitude[single] / np.sqrt(unit),
        ramp=spectrum.ramp[single] / ramp_scale / np.sqrt(unit),
        singles=int(np.count_nonzero(single)),
    )
    return problem, scale, ramp_scale


def _deviance(problem: _Problem, theta: Array) -> tuple[float, Array, Array, float]:
    """-2 ln of the likelihood of `theta` up to a constant; model variances; powers that Fisher scoring aims
    at; slope.

    This is the restricted likelihood (the slope integrated out): plain likelihood would
    count the wander that the fitted ramp swallowed as absence of wander, and underrate the rate random walk.
    """
    model = theta @ problem.shapes
    power = problem.power.copy()
    if np.any(model <= 0.0):
        return np.inf, model, power, 0.0
    weight = problem.count[: problem.singles] * problem.ramp / model[: problem.singles]
    information = float(weight @ problem.ramp)
    slope = float(weight @ problem.amplitude) / information
    single = power[: problem.singles]
    single[:] = (problem.amplitude - slope * problem.ramp) ** 2
    deviance = float(problem.count @ (np.log(model) + power / model) + np.log(information))
    single += problem.ramp**2 / information
    return deviance, model, power, slope


def _solve(
    problem: _Problem,
    start: Array,
    fixed_term: int | None = None,
    fixed_value: float = 0.0,
) -> _Solution:
    """Fisher scoring with theta >= 0: each step a weighted non-negative least squares, halved if too long."""
    from scipy.optimize import nnls

    free = [term for term in range(4) if term != fixed_term]
    theta = start.copy()
    if fixed_term is not None:
        theta[fixed_term] = fixed_value
    if np.any(theta @ problem.shapes <= 0.0):
        theta[1 if fixed_term != 1 else 2] += 0.1
    deviance, model, power, slope = _deviance(problem, theta)
    for _ in range(_ITERATIONS):
        weight = np.sqrt(problem.count) / model
        target = power if fixed_term is None else power - fixed_value * problem.shapes[fixed_term]
        step = theta.copy()
        step[free] = nnls((problem.shapes[free] * weight).T, target * weight)[0]
        fraction, previous = 1.0, deviance
        for _halving in range(30):
            trial = theta + fraction * (step - theta)
            result = _deviance(problem, trial)
            if result[0] <= deviance:
                theta = trial
                deviance, model, power, slope = result
                break
            fraction /= 2.0
        if previous - deviance < _CONVERGED:
            break
    return _Solution(theta, slope, deviance)


def _best(problem: _Problem) -> _Solution:
    """Best of several starts: one term carrying everything, or all together."""
    starts = [np.full(4, 0.2), *(np.where(np.arange(4) == term, 1.0, 1e-3) for term in range(4))]
    solutions = [_solve(problem, start) for start in starts]
    return min(solutions, key=lambda solution: solution.deviance)


def _profile(problem: _Problem, best: _Solution, term: int, value: float) -> float:
    """Smallest deviance with one theta held; walk, flicker and ramp trade places, hence several starts."""
    lifted = np.maximum(best.theta, 0.3)
    starts = (best.theta, lifted, np.where(np.arange(4) == 3, lifted, best.theta))
    return min(_solve(problem, start, fixed_term=term, fixed_value=value).deviance for start in starts)


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


def _ramp_interval(problem: _Problem, best: _Solution, walk_high: float, unit: float) -> Estimate:
    """95 % interval of the slope, carrying the uncertainty of the rate random walk it is confounded with.

    The slope given the noise is Gaussian; its variance rests on a handful of coefficients, so it is averaged
    over the rate random walk with the restricted likelihood as weight, uniform in K (A. Gelman, Bayesian
    Analysis 1, 2006, for why uniform in the standard deviation). Treating the variance as known covers 85 %
    instead of 95 %.
    """
    from scipy.optimize import brentq
    from scipy.special import ndtr

    centre, sigma, weight = [], [], []
    lifted = np.maximum(best.theta, 0.3)
    for root in np.linspace(0.0, _WALK_REACH * np.sqrt(walk_high), _WALK_NODES):
        solutions = [_solve(problem, start, fixed_term=3, fixed_value=root**2) for start in (best.theta, lifted)]
        solution = min(solutions, key=lambda each: each.deviance)
        model = solution.theta @ problem.shapes
        information = problem.count[: problem.singles] @ (problem.ramp**2 / model[: problem.singles])
        centre.append(solution.slope)
        sigma.append(1.0 / np.sqrt(information))
        weight.append(np.exp((best.deviance - solution.deviance) / 2.0))
    centres, sigmas, weights = np.array(centre), np.array(sigma), np.array(weight) / np.sum(weight)

    def below(slope: float) -> float:
        return float(weights @ ndtr((slope - centres) / sigmas))

    lower, upper = float(np.min(centres - 8.0 * sigmas)), float(np.max(centres + 8.0 * sigmas))
    low, high = (float(brentq(lambda slope, p=p: below(slope) - p, lower, upper)) for p in (0.025, 0.975))
    return Estimate(best.slope * unit, low * unit, high * unit)

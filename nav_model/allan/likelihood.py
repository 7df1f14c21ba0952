"""Maximum likelihood of the five noise terms on a cosine spectrum, with profile-likelihood intervals.

The coefficients of the cosine transform are independent Gaussians whose variances are linear in Q², N², B²,
K² and whose means are the ramp's (noise_terms.py). The likelihood uses all of them at once, so that the
correlation between overlapping Allan estimates, which makes least squares on an Allan plot overconfident,
never arises. Literature: P. Whittle 1953; J. Nikolic et al., IEEE Sensors J. 16(1), 2016 (maximum likelihood
for inertial sensors); W. Venzon and S. Moolgavkar 1988 (profile-likelihood intervals).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.spectrum import CosineSpectrum
from nav_model.base.arrays import Array

# 95 % point of chi-square with one degree of freedom: the fall of 2 ln L that bounds an interval.
CONFIDENCE_95 = 3.841458820694124

# 95 % and 99.9 % points of chi-square with one, two and three degrees of freedom.
_RISES_95, _RISES_999 = (CONFIDENCE_95, 5.991, 7.815), (10.828, 13.816, 16.266)

_WHITE = 1  # place of N²
_LEFT_OUT = (0, 3, 2)  # places of Q², K², B², in the order in which they are left out
_ITERATIONS = 200
_CONVERGED = 1e-9
_SMOOTHING = 9
_WALK_NODES = 25
_WALK_REACH = 1.5


Held = Mapping[int, float]
"""Places of thetas that are held, and their values."""
_NOTHING: Held = MappingProxyType({})


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
    squares = [_square_interval(problem, best, term, 1.0 / scale[term]) for term in range(4)]
    walk_high = squares[3].high * scale[3]
    squares[_WHITE] = _white_interval(problem, best, squares[_WHITE], 1.0 / scale[_WHITE])
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


def _solve(problem: _Problem, start: Array, held: Held) -> _Solution:
    """Fisher scoring with theta >= 0: each step a weighted non-negative least squares, halved if too long."""
    from scipy.optimize import nnls

    free = [term for term in range(4) if term not in held]
    theta = start.copy()
    theta[[*held]] = [*held.values()]
    if free and np.any(theta @ problem.shapes <= 0.0):
        theta[1 if 1 in free else free[0]] += 0.1
    deviance, model, power, slope = _deviance(problem, theta)
    fixed = np.where(np.isin(np.arange(4), free), 0.0, theta) @ problem.shapes
    for _ in range(_ITERATIONS if free else 0):
        weight = np.sqrt(problem.count) / model
        target = power - fixed
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


def _best(problem: _Problem, held: Held = _NOTHING) -> _Solution:
    """Best of several starts: one term carrying everything, or all together."""
    starts = [np.full(4, 0.2), *(np.where(np.arange(4) == term, 1.0, 1e-3) for term in range(4))]
    solutions = [_solve(problem, start, held) for start in starts]
    return min(solutions, key=lambda solution: solution.deviance)


def _profile(problem: _Problem, best: _Solution, held: Held) -> float:
    """Smallest deviance with some thetas held; walk, flicker and ramp trade places, hence several starts."""
    lifted = np.maximum(best.theta, 0.3)
    starts = (best.theta, lifted, np.where(np.arange(4) == 3, lifted, best.theta))
    return min(_solve(problem, start, held).deviance for start in starts)


def _square_interval(problem: _Problem, best: _Solution, term: int, unit: float, absent: Held = _NOTHING) -> Estimate:
    """Profile interval of a term about the `best` fit, for which those of `absent` are held at zero."""
    from scipy.optimize import brentq

    goal = best.deviance + CONFIDENCE_95
    value = float(best.theta[term])

    def excess(theta: float) -> float:
        return _profile(problem, best, {**absent, term: theta}) - goal

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


def _white_interval(problem: _Problem, best: _Solution, whole: Estimate, unit: float) -> Estimate:
    """White noise: value and interval where the log does not show every other term; `whole` is of the fit with all.

    No term is less than nothing, so chance alone gives one or another of them something, which white noise then
    lacks: 0.24 % of N on average in logs of 36,000 samples of white noise. So the value is of the fit without the
    terms that the log does not show. In one log of forty chance even shows one, so the upper end is of the fit
    without the terms that are not shown beyond doubt. The lower end is of the fit with all: they may be there.
    """

    def alone(absent: Held) -> Estimate:
        return _square_interval(problem, _best(problem, absent), _WHITE, unit, absent)

    hidden, doubtful = (_absent(problem, best, rises) for rises in (_RISES_95, _RISES_999))
    if not doubtful:
        return whole
    fewest = alone(doubtful)
    estimate = fewest if hidden == doubtful else alone(hidden) if hidden else whole
    return Estimate(estimate.value, min(whole.low, estimate.low), max(whole.high, estimate.high, fewest.high))


def _absent(problem: _Problem, best: _Solution, rises: tuple[float, ...]) -> Held:
    """Terms that may be absent together: without the first of them the deviance rises by at most `rises[0]`, without
    two by `rises[1]`, and so on. Flicker and walk trade places, so that each may be absent alone, and not both."""
    absent: Held = _NOTHING
    for term in _LEFT_OUT:
        fewer = {**absent, term: 0.0}
        if _best(problem, fewer).deviance <= best.deviance + rises[len(absent)]:
            absent = fewer
    return absent


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
        solutions = [_solve(problem, start, {3: root**2}) for start in (best.theta, lifted)]
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

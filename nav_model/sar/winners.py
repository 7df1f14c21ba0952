"""The best strategy along the line of sight, of 2, 3, 5, 5w and 9.

Strategies are judged as requirements are (`nav_model.budget`): along the line of sight as it turns [S-8], also under
squint. A slow GNSS error enters the fits (`fit_noise`) and, through ``start``, the state at the last fix. The
whole-leg smoother's figures are the budget's (`Conditions.smoothed`). It counts only for post-processed designs, as
it needs fixes from after the aperture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.discrete import SlowError
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.analytic.turning import LEFT_OF_ORDER, Turn, free_bend, turn_of
from nav_model.aperture.autofocus import Residual
from nav_model.aperture.geometry import line_of_sight_weights
from nav_model.aperture.phase import phase_budget, total
from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.budget.contributors import Contributors
from nav_model.design.figures import DETRENDED, QUADRATIC
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.sar.fit_noise import SlowFit, slow_fit
from nav_model.sar.strategy_forms import (
    QUADRATIC_MEAN_SQUARE,
    fit_quadratic_sigma,
    fixes_in_aperture,
    ins_variances,
    shrunk_residual_variance,
)

IN_APERTURE: tuple[str, ...] = ("2", "3", "5", "5w")
"""Strategies whose closed forms need no fix after the aperture, simplest first."""

MAP_STRATEGIES: tuple[str, ...] = (*IN_APERTURE, "9")
"""Strategies that have a closed form, simplest first."""
WORTH = 0.05
"""A simpler strategy is chosen if its residual is within this fraction of the least."""

_AT_REST = Vertical(np.zeros(()), np.zeros(()), np.zeros(()))
_SECTIONS = 64  # parts a step of the search for the break-even aperture cuts its bracket into


@dataclass(frozen=True)
class Conditions:
    """Arguments of the closed forms: SI, numbers or arrays that broadcast together.

    ``start``, ``start_vertical``: covariance of a horizontal axis and of the vertical one at the last fix.
    ``fast``: variances along the line of sight that no strategy changes (vibration, unsensed motion, oscillator), of
    the quadratic and after autofocus [m²].
    ``vertical_gnss_sigma``: as the horizontal one unless given. ``turn_rate`` [rad/s]: V / R. ``fixes``: in the
    aperture, floor(T / dt) + 1 unless given. Only strategy 3 carries ``coast_time``. ``slow``: of the fixes, of one
    correlation time; ``start`` is then that of the filter that estimates it, and ``slow_with_tilt`` [m rad] the
    covariance of its tilt error with the slow error itself. ``smoothed``: of the whole-leg smoother [m²].
    ``post_processed``: whether the image is made after the flight. ``contributors``: the user's own, which enter the
    phases of every strategy; ``to_phase`` [rad/m] is what they need. ``residual``: of an autofocus in place of the
    polynomial, which adds ``estimation`` [m] and removes nothing where one sigma of the quadratic is beyond
    ``largest`` [m]; ``autofocus_order`` is then 1.
    """

    aperture_time: ArrayLike
    gnss_sigma: ArrayLike
    fix_interval: ArrayLike
    accelerometer_noise: ArrayLike
    gyro_noise: ArrayLike
    start: Horizontal
    coast_time: ArrayLike = 0.0
    gravity: ArrayLike = STANDARD_GRAVITY
    accelerometer_bias: ArrayLike = 0.0
    gyro_bias: ArrayLike = 0.0
    grazing_angle: ArrayLike = 0.0
    vertical_gnss_sigma: ArrayLike | None = None
    turn_rate: ArrayLike = 0.0
    autofocus_order: int = 1
    fixes: ArrayLike | None = None
    squint_angle: ArrayLike = 0.0
    start_vertical: Vertical = _AT_REST
    slow: SlowError | None = None
    slow_with_tilt: ArrayLike = 0.0
    smoothed: SmoothedVariances | None = None
    post_processed: bool = False
    fast: tuple[ArrayLike, ArrayLike] = (0.0, 0.0)
    contributors: Contributors = field(default_factory=Contributors)
    to_phase: ArrayLike = 1.0
    residual: Residual | None = None
    estimation: ArrayLike = 0.0
    largest: ArrayLike = np.inf


class SmoothedVariances(NamedTuple):
    """Variances [m²] of the whole-leg smoother, as in `StrategyVariances`."""

    quadratic: ArrayLike
    detrended: ArrayLike


class StrategyVariances(NamedTuple):
    """Variances [m²] along the line of sight as it turns, in the order of `MAP_STRATEGIES`; without ``smoothed``, of
    `IN_APERTURE`.

    ``quadratic``: of the coefficient of x^2 over the aperture. ``detrended``: mean over the aperture of what
    the autofocus leaves. Infinite for 5 where fewer than three fixes determine no quadratic.
    """

    quadratic: Array
    detrended: Array


def strategy_variances(c: Conditions) -> StrategyVariances:
    """The closed forms [T-15], [T-16], [S-5], [S-7] with the turn of the line of sight [S-8]."""
    horizontal, vertical = line_of_sight_weights(c.grazing_angle)
    t, dt = np.asarray(c.aperture_time, float), np.asarray(c.fix_interval, float)
    n = fixes_in_aperture(t, dt) if c.fixes is None else np.asarray(c.fixes, float)
    sensors = (c.start.p33, c.accelerometer_noise, c.gyro_noise, c.accelerometer_bias, c.gyro_bias, c.gravity)
    after = c.autofocus_order if c.residual is None else c.residual
    free = total(phase_budget(*sensors, t, 0.0, c.grazing_angle, c.autofocus_order))
    coasted = total(phase_budget(*sensors, t, c.coast_time, c.grazing_angle, c.autofocus_order))
    remains, coasted_remains = (
        total(phase_budget(*sensors, t, coast, c.grazing_angle, after)).detrended for coast in (0.0, c.coast_time)
    )
    weight = _of_the_quadratic(c)
    if c.residual is None:
        rest = total(phase_budget(*sensors, t, 0.0, c.grazing_angle, max(c.autofocus_order, 2))).detrended
    else:
        rest = remains - weight * free.quadratic

    slow, slow_horizontal, slow_vertical = _slow_fits(c, t, dt, n)
    across = fit_quadratic_sigma(c.gnss_sigma, dt, t, n) ** 2 + slow_horizontal * slow.quadratic
    vertical_sigma = c.gnss_sigma if c.vertical_gnss_sigma is None else c.vertical_gnss_sigma
    down = fit_quadratic_sigma(vertical_sigma, dt, t, n) ** 2 + slow_vertical * slow.quadratic
    held = ins_variances(
        t, c.accelerometer_noise, c.gyro_noise, c.start.p33, 0.0, c.gravity, c.accelerometer_bias, c.gyro_bias
    ).quadratic
    held_down = ins_variances(t, c.accelerometer_noise, 0.0, 0.0, 0.0, c.gravity, c.accelerometer_bias).quadratic
    # The tilt at the last fix bends the INS, and the slow error that caused part of it bends the fit.
    shared = np.asarray(c.slow_with_tilt) * c.gravity * t**2 / 8 * slow.quadratic_from_start
    shrunk = (
        horizontal * shrunk_residual_variance(held, across, 0.0, shared)
        + vertical * shrunk_residual_variance(held_down, down, 0.0)
    ) / QUADRATIC_MEAN_SQUARE

    with np.errstate(invalid="ignore"):  # no fit, on an axis of zero weight
        fitted = np.where(n > 2, horizontal * across + vertical * down, np.inf)
    if weight:
        corrected = [weight * part + rest for part in (fitted, shrunk)]
    else:
        corrected = [np.where(n > 2, rest, np.inf), rest]
    turn = turn_of(c.grazing_angle, c.squint_angle, c.turn_rate, t)
    ends = [free.quadratic, coasted.quadratic, fitted, shrunk]
    residuals = [remains, coasted_remains, *corrected]
    bent = _bent(c, "quadratic", t, dt, n, turn)
    for kind, factor in _of_the_turn(c):
        also = bent if kind == "quadratic" else _bent(c, kind, t, dt, n, turn)
        residuals = [np.add(part, factor * more) for part, more in zip(residuals, also, strict=True)]
    ends = [np.add(part + more, c.fast[0]) for part, more in zip(ends, bent, strict=True)]
    residuals = [np.add(part, c.fast[1]) for part in residuals]
    if c.residual is not None:  # beyond its limits, nothing is removed
        alone = replace(c, residual=None, smoothed=None, contributors=Contributors())
        residuals = [
            np.where(end > np.square(c.largest), before, part + np.square(c.estimation))
            for end, before, part in zip(ends, strategy_variances(alone).detrended, residuals, strict=True)
        ]
    if c.smoothed is not None:
        ends.append(np.asarray(c.smoothed.quadratic))
        residuals.append(np.asarray(c.smoothed.detrended))
    return StrategyVariances(_composed(c, QUADRATIC, ends), _composed(c, DETRENDED, residuals))


def _of_the_quadratic(c: Conditions) -> float:
    """Part of the quadratic's variance that an autofocus leaves in the detrended one."""
    if c.residual is not None:
        return float(c.residual.quadratic[2])
    return QUADRATIC_MEAN_SQUARE if c.autofocus_order == 1 else 0.0


def _of_the_turn(c: Conditions) -> list[tuple[str, float]]:
    """Likewise of the quadratic and the cubic that the turn makes."""
    if c.residual is not None:
        return [("quadratic", float(c.residual.quadratic[2])), ("cubic", float(c.residual.cubic[2]))]
    return [LEFT_OF_ORDER[c.autofocus_order]] if c.autofocus_order in LEFT_OF_ORDER else []


def _composed(c: Conditions, figure: str, variances: Sequence[ArrayLike]) -> Array:
    """Variances [m²] of the strategies with the contributors to a phase: those of real time, and of post-processing
    for the smoother."""
    stacked = np.stack(np.broadcast_arrays(*variances))
    for rows, processing in ((slice(len(IN_APERTURE)), REAL_TIME), (slice(len(IN_APERTURE), None), POST_PROCESSED)):
        whole = c.contributors.composed(figure, processing, np.sqrt(stacked[rows]) * c.to_phase)
        if whole.parts:
            stacked[rows] = np.square(whole.sigma / c.to_phase)
    return stacked


def _bent(c: Conditions, kind: str, t: Array, dt: Array, n: Array, turn: Turn) -> tuple[Array, ...]:
    """Part of the turn in the variance [m²] of the quadratic or the cubic, in the order of `IN_APERTURE`.

    For 5 and 5w the velocity is that of the fitted line, whose turn is a quadratic without a cubic, and the position
    error is negligible.
    """

    def free(coast: ArrayLike) -> Array:
        inside = c.gravity, coast, t
        horizontal = c.start, c.accelerometer_noise, c.gyro_noise, c.accelerometer_bias, c.gyro_bias
        vertical = c.start_vertical, c.accelerometer_noise, 0.0, c.accelerometer_bias, 0.0
        return turn.bent(free_bend(kind, *horizontal, *inside), free_bend(kind, *vertical, *inside))

    started = free(0.0)
    fitted = _bent_fit(c, t, dt, n, turn) if kind == "quadratic" else np.zeros(())
    return started, free(c.coast_time), fitted, np.where(n > 2, fitted, started)


def _slow_fits(c: Conditions, t: Array, dt: Array, n: Array) -> tuple[SlowFit, Array, Array]:
    """The fit of a slow error of 1 m, and the variances [m²] of the slow error, horizontal and vertical."""
    if c.slow is None:
        return slow_fit(None, dt, t, n), np.zeros(()), np.zeros(())
    fit = slow_fit(float(np.asarray(c.slow.correlation_time)), dt, t, n)
    return fit, np.square(c.slow.horizontal), np.square(c.slow.vertical)


def _bent_fit(c: Conditions, t: Array, dt: Array, n: Array, turn: Turn) -> Array:
    """Variance [m²] of the quadratic that the turn makes of the velocity of the fitted line."""
    slow, slow_horizontal, slow_vertical = _slow_fits(c, t, dt, n)
    white = np.where(n > 2, 12 / (n * (n**2 - 1) + (n <= 2)), 0.0) / dt**2
    noise = c.gnss_sigma if c.vertical_gnss_sigma is None else c.vertical_gnss_sigma
    horizontal = np.square(c.gnss_sigma) * white + slow_horizontal * slow.slope
    vertical = np.square(noise) * white + slow_vertical * slow.slope
    return np.asarray(t**2 / 4 * (turn.horizontal.turned * horizontal + turn.vertical.turned * vertical))


class WinnerMap(NamedTuple):
    """The strategy to use at each point: index into `strategies`, and sigma (strategies, ...) [m] of each."""

    strategies: tuple[str, ...]
    winner: NDArray[np.intp]
    sigma: Array
    best_sigma: Array


def map_of_winners(conditions: Conditions) -> WinnerMap:
    """The strategy that wins among those with a closed form, by the detrended sigma of the image: in real time among
    those that need no fix after the aperture.

    5w is never worse than 2 or 5 and would win everywhere by a hair, so the simplest strategy (in the order of
    `MAP_STRATEGIES`) within the fraction `WORTH` of the best is the one named.
    ``start`` goes with the fix noise and the sensors of each point, so give arrays of that shape.
    ``best_sigma`` is that of the strategy named.
    """
    sigma = np.sqrt(strategy_variances(conditions).detrended)
    able = sigma if conditions.post_processed else sigma[: len(IN_APERTURE)]
    winner = (able <= able.min(axis=0) * (1 + WORTH)).argmax(axis=0)
    named = np.take_along_axis(sigma, winner[None], axis=0)[0]
    return WinnerMap(MAP_STRATEGIES[: len(sigma)], winner, sigma, named)


def break_even_aperture(conditions: Conditions) -> Array:
    """Aperture time [s] above which the quadratic correction (5) beats the INS the filter starts (2).

    [T-15] equals [T-16] there but for the turn, with a fix at both ends: N = T / dt + 1. The noise of the fit falls
    and what the quadratic holds grows with T, so there is one crossing, searched over 2 to 1e6 fix intervals.
    The aperture time and the autofocus of the conditions do not enter.
    """
    dt = np.asarray(conditions.fix_interval, float)
    first = replace(conditions, autofocus_order=1, residual=None, aperture_time=2 * dt, fixes=3.0, smoothed=None)
    dt = np.broadcast_to(dt, strategy_variances(first).detrended.shape[1:])
    low, high = np.log(2.0 * dt), np.log(1e6 * dt)
    part = np.linspace(0, 1, _SECTIONS).reshape(-1, *[1] * dt.ndim)
    for _ in range(6):
        t = np.exp(low + (high - low) * part)
        free, _, corrected, _ = strategy_variances(replace(first, aperture_time=t, fixes=t / dt + 1)).detrended
        pays = free > corrected
        place = np.where(pays.any(axis=0), pays.argmax(axis=0), _SECTIONS - 1)[None]
        ends = (np.take_along_axis(t, np.maximum(place - k, 0), axis=0)[0] for k in (1, 0))
        low, high = (np.log(end) for end in ends)
    return np.asarray(np.exp((low + high) / 2))

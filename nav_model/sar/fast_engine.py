"""The fast engine: hundreds of runs of the per-axis error model, handed to the strategies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.discrete import SlowError
from nav_model.sar.axis_model import (
    AxisModel,
    draw_state,
    filter_noise,
    filter_transition,
    fix_row,
    measure,
    noise_path,
    process_noise,
    steady_covariance,
    transition,
)
from nav_model.sar.fit_noise import slow_fit
from nav_model.sar.smoother import rts_smooth, smoother_gain
from nav_model.sar.strategies import NavigationHistories, StrategyErrors, Tuning, apply_strategies
from nav_model.sar.strategy_forms import fit_quadratic_sigma, ins_variances, shrunk_weight

_FloatArray = NDArray[np.float64]


def simulate_axis(
    model: AxisModel,
    aperture_time: float,
    coast_time: float = 0.0,
    runs: int = 500,
    seed: int | np.random.SeedSequence = 0,
    rate: float = 100.0,
    tuning: Tuning | None = None,
) -> StrategyErrors:
    """Every strategy on `runs` realisations of one axis; arrays are (9, runs, n), n = T rate + 1.

    The filter is in its steady state, the aperture starts just after a fix; the INS of strategy 3 leaves the
    same filter ``coast_time`` [s] earlier. What the filter has not absorbed of the biases joins each INS when
    it starts.
    """
    histories = simulate_histories(model, aperture_time, coast_time, runs, seed, rate)
    return apply_strategies(histories, weight_of(model, aperture_time, len(histories.fix_time)), tuning)


def weight_of(model: AxisModel, aperture_time: float, fixes: int) -> float:
    """Weight of the fitted quadratic in 5w on one axis, from the closed forms [S-5], [S-7]."""
    inertial = ins_variances(
        aperture_time=aperture_time,
        accelerometer_noise=model.accelerometer_noise,
        gyro_noise=model.gyro_noise if model.horizontal else 0.0,
        tilt_variance=steady_covariance(model).posterior[2, 2] / model.gravity**2,
        gravity=model.gravity,
        accelerometer_bias=model.accelerometer_bias,
        gyro_bias=model.gyro_bias if model.horizontal else 0.0,
    ).quadratic
    white = fit_quadratic_sigma(model.gnss_sigma, model.fix_interval, aperture_time, fixes) ** 2
    slow = slow_fit(SlowError(model.slow_sigma, model.slow_time), model.fix_interval, aperture_time, fixes).quadratic
    return float(shrunk_weight(inertial, white + slow))


def simulate_histories(
    model: AxisModel,
    aperture_time: float,
    coast_time: float = 0.0,
    runs: int = 500,
    seed: int | np.random.SeedSequence = 0,
    rate: float = 100.0,
) -> NavigationHistories:
    """The fast engine: error histories (runs, n) of the INS, the filter and the smoother of one axis."""
    _check(aperture_time, coast_time, runs, rate, model)
    random = np.random.default_rng(seed)
    steady = steady_covariance(model)
    # Each source of randomness has its own stream, so a longer coast does not reshuffle the aperture.
    streams = random.spawn(5)
    unabsorbed = streams[0].standard_normal((2, runs)) * np.array(
        [[model.accelerometer_bias], [model.gravity * model.gyro_bias * model.horizontal]]
    )
    start, coasted, slow = _before_aperture(model, steady.posterior, coast_time, runs, streams[1], unabsorbed)

    samples = round(aperture_time * rate) + 1
    time: _FloatArray = np.linspace(0.0, aperture_time, samples)
    last_fix = int(np.floor(aperture_time / model.fix_interval + 1e-9))
    fix_time = np.arange(last_fix + 1, dtype=float) * model.fix_interval
    grid = _merged(time, fix_time[np.abs(time[_nearest(time, fix_time)] - fix_time) > 1e-9])
    path = noise_path(model, grid, runs, streams[2])
    path[2] += unabsorbed[1][:, None] * grid
    path[1] += unabsorbed[1][:, None] * grid**2 / 2
    path[0] += unabsorbed[1][:, None] * grid**3 / 6
    sampled = path[:, :, _nearest(grid, time)]
    at_fixes = path[:, :, _nearest(grid, fix_time)]
    gnss_error = streams[3].standard_normal((runs, len(fix_time))) * model.gnss_sigma

    ins = sampled + _carried(start[:, :3], time)
    coasted_position = (sampled[0] + _carried(coasted, time)[0]) if coast_time > 0 else ins[0].copy()

    priors, posteriors = [start], [start]
    prior_covariances, covariances = [steady.prior], [steady.posterior]
    phi, grown = filter_transition(model, model.fix_interval), filter_noise(model, model.fix_interval)
    row, inertial = fix_row(len(phi)), transition(model.fix_interval)
    gnss_error[:, 0] += slow
    for k in range(1, len(fix_time)):
        prior = posteriors[-1] @ phi.T
        prior[:, :3] += at_fixes[:, :, k].T - at_fixes[:, :, k - 1].T @ inertial.T
        prior_covariance = phi @ covariances[-1] @ phi.T + grown
        gain, covariance = measure(prior_covariance, model.gnss_sigma)
        slow = _moved(model, prior, slow, streams[4])
        priors.append(prior)
        posteriors.append(prior - np.outer(prior @ row - gnss_error[:, k], gain))
        gnss_error[:, k] += slow
        prior_covariances.append(prior_covariance)
        covariances.append(covariance)
    prior, posterior = np.stack(priors), np.stack(posteriors)
    smoothed_at_fixes = rts_smooth(
        posterior,
        np.stack(covariances),
        prior,
        np.stack(prior_covariances),
        np.broadcast_to(phi, (len(fix_time) - 1, *phi.shape)),
    )

    navigated = sampled.copy()
    smoothed = np.empty_like(sampled[0])
    interval = np.searchsorted(fix_time, time + 1e-9, side="right") - 1
    for k in range(len(fix_time)):
        inside = np.flatnonzero(interval == k)
        span = slice(inside[0], inside[-1] + 1) if len(inside) else slice(0, 0)
        age = time[span] - fix_time[k]
        navigated[:, :, span] += _carried(posterior[k][:, :3] - at_fixes[:, :, k].T, age)
        smoothed[:, span] = navigated[0][:, span]
        if k + 1 < len(fix_time):
            forward = filter_transition(model, age)
            predicted = forward @ covariances[k] @ np.swapaxes(forward, 1, 2) + filter_noise(model, age)
            onward = filter_transition(model, model.fix_interval - age)
            gain_row = smoother_gain(predicted, onward, prior_covariances[k + 1])[:, 0, :]
            smoothed[:, span] += (smoothed_at_fixes[k + 1] - prior[k + 1]) @ gain_row.T
    return NavigationHistories(
        time=time,
        fix_time=fix_time,
        ins_position=ins[0],
        ins_velocity=ins[1],
        coasted_position=coasted_position,
        filter_position=navigated[0],
        filter_velocity=navigated[1],
        filter_correction=(posterior - prior)[:, :, 0].T,
        gnss_error=gnss_error,
        smoothed_position=smoothed,
    )


def _check(aperture_time: float, coast_time: float, runs: int, rate: float, model: AxisModel) -> None:
    if not (np.isfinite(aperture_time) and aperture_time > 0):
        raise ValueError(f"aperture_time: {aperture_time} s; a positive, finite time is needed")
    if not (np.isfinite(coast_time) and coast_time >= 0):
        raise ValueError(f"coast_time: {coast_time} s; zero or a positive, finite time is needed")
    if runs < 1:
        raise ValueError(f"runs: {runs}; at least 1 is needed")
    if not (np.isfinite(rate) and rate * aperture_time >= 15):
        raise ValueError(f"rate: {rate} Hz; at least 16 samples over the aperture are needed")


def _before_aperture(
    model: AxisModel,
    posterior: _FloatArray,
    coast_time: float,
    runs: int,
    random: np.random.Generator,
    unabsorbed: _FloatArray,
) -> tuple[_FloatArray, _FloatArray, _FloatArray]:
    """States at the start of the aperture: of the filter (runs, m), and of the INS that left it earlier (runs, 3);
    and the slow error of the fixes there (runs,)."""
    filtered = draw_state(posterior, runs, random)
    coasted = filtered[:, :3].copy()
    coasted[:, 2] += unabsorbed[0]
    slow = np.zeros(runs)
    if model.slow_sigma:
        # The settled filter's estimate is independent of its error; the error is the estimate less the truth.
        estimated = np.sqrt(max(model.slow_sigma**2 - posterior[3, 3], 0.0))
        slow = estimated * random.standard_normal(runs) - filtered[:, 3]
    whole = int(np.floor(coast_time / model.fix_interval + 1e-9))
    rest = coast_time - whole * model.fix_interval
    covariance, drift = posterior, unabsorbed[1]
    for step in [rest] * (rest > 1e-9) + [model.fix_interval] * whole:
        phi = transition(step)
        noise = draw_state(process_noise(model, step), runs, random)
        ramp = np.outer(drift, [step**3 / 6, step**2 / 2, step])
        coasted = coasted @ phi.T + noise + ramp
        forward = filter_transition(model, step)
        filtered = filtered @ forward.T
        filtered[:, :3] += noise
        gain, covariance = measure(forward @ covariance @ forward.T + filter_noise(model, step), model.gnss_sigma)
        slow = _moved(model, filtered, slow, random, step)
        fix = random.standard_normal(runs) * model.gnss_sigma
        filtered = filtered - np.outer(filtered @ fix_row(filtered.shape[1]) - fix, gain)
    filtered[:, 2] += unabsorbed[0]
    return filtered, coasted, slow


def _moved(
    model: AxisModel, prior: _FloatArray, slow: _FloatArray, random: np.random.Generator, step: float | None = None
) -> _FloatArray:
    """The slow error (runs,) a step (by default a fix interval) later; what is new in it is taken off the filter's
    error in `prior`."""
    if not model.slow_sigma:
        return slow
    step = model.fix_interval if step is None else step
    fresh = model.slow_sigma * np.sqrt(-np.expm1(-2 * step / model.slow_time)) * random.standard_normal(len(slow))
    prior[:, 3] -= fresh
    return np.asarray(np.exp(-step / model.slow_time) * slow + fresh)


def _carried(state: _FloatArray, age: _FloatArray) -> _FloatArray:
    """A state (runs, 3) carried forward over ages (n,): (3, runs, n)."""
    p, v, a = state.T[:, :, None]
    return np.stack([p + v * age + a * (age**2 / 2), v + a * age, np.broadcast_to(a, (len(state), len(age)))])


def _merged(time: _FloatArray, more: _FloatArray) -> _FloatArray:
    both: _FloatArray = np.sort(np.concatenate([time, more]))
    return both


def _nearest(grid: _FloatArray, time: _FloatArray) -> NDArray[np.intp]:
    right = np.clip(np.searchsorted(grid, time), 1, len(grid) - 1)
    return (right - (np.abs(grid[right - 1] - time) <= np.abs(grid[right] - time))).astype(np.intp)

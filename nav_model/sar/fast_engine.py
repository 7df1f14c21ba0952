"""The fast engine: hundreds of runs of the per-axis error model, as input of the strategies."""

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.sar.axis_filter import Fixes, carried, draw_fresh, filtered, filtered_in_leg, navigated, smoothed
from nav_model.sar.axis_model import (
    AxisModel,
    draw_state,
    filter_drift,
    fix_rows,
    inertial_drift,
    measure,
    noise_path,
    steady_covariance,
)
from nav_model.sar.fit_noise import slow_fit
from nav_model.sar.strategies import NavigationHistories, StrategyErrors, Tuning, apply_strategies
from nav_model.sar.strategy_forms import fit_quadratic_sigma, ins_variances, shrunk_weight


def simulate_axis(
    model: AxisModel,
    aperture_time: float,
    coast_time: float = 0.0,
    runs: int = 500,
    seed: int | np.random.SeedSequence = 0,
    rate: float = 100.0,
    tuning: Tuning | None = None,
) -> StrategyErrors:
    """Every strategy on realisations of one axis; arrays are (10, runs, n), n = T rate + 1.

    The filter is in its steady state, the aperture starts just after a fix. Residual biases, which the filter has not
    absorbed, act on each INS from its start.

    Parameters
    ----------
    model : AxisModel
        Noise and fixes of the axis.
    aperture_time : float
        T, s.
    coast_time : float, optional
        By which the INS of strategy 3 leaves the same filter earlier, s.
    runs : int, optional
        Number of realisations.
    seed : int or SeedSequence, optional
        Of the noise.
    rate : float, optional
        Samples per second.
    tuning : Tuning, optional
        Gains of the strategies 6 and 7.
    """
    histories = simulate_histories(model, aperture_time, coast_time, runs, seed, rate)
    weight = weight_of(model, aperture_time, len(histories.fix_time))
    return apply_strategies(histories, weight, tuning or Tuning())


def weight_of(model: AxisModel, aperture_time: float, fixes: int) -> float:
    """Weight of the fitted quadratic in 5w on one axis, from the closed forms [S-5], [S-7]."""
    inertial = ins_variances(
        aperture_time=aperture_time,
        accelerometer_noise=model.accelerometer_noise,
        gyro_noise=model.gyro_noise if model.horizontal else 0.0,
        tilt_variance=steady_covariance(model)[2, 2] / model.gravity**2,
        gravity=model.gravity,
        accelerometer_bias=model.accelerometer_bias,
        gyro_bias=model.gyro_bias if model.horizontal else 0.0,
    ).quadratic
    white = fit_quadratic_sigma(model.gnss_sigma, model.fix_interval, aperture_time, fixes) ** 2
    slow = slow_fit(model.slow_time, model.fix_interval, aperture_time, fixes).quadratic
    return float(shrunk_weight(inertial, white + model.slow_sigma**2 * slow))


def simulate_histories(
    model: AxisModel,
    aperture_time: float,
    coast_time: float = 0.0,
    runs: int = 500,
    seed: int | np.random.SeedSequence = 0,
    rate: float = 100.0,
) -> NavigationHistories:
    """The fast engine: error histories (runs, n) of the INS, the filter and the smoother of one axis.

    Parameters
    ----------
    model, aperture_time, coast_time, runs, seed, rate
        As `simulate_axis`.
    """
    random = np.random.default_rng(seed)
    steady = steady_covariance(model)
    # Each source of randomness has its own stream, so a longer coast does not reshuffle the aperture.
    streams = random.spawn(7)
    unabsorbed = streams[0].standard_normal((2, runs)) * np.array(
        [[model.accelerometer_bias], [model.gravity * model.gyro_bias * model.horizontal]]
    )
    settled, coasted, slow = _before_aperture(model, steady, coast_time, runs, streams[1], unabsorbed)
    start = settled.copy()
    start[:, 2] += unabsorbed[0]

    # One noise path, exact at the outputs and at the fixes; a residual gyro bias is a jerk on top of it.
    samples = round(aperture_time * rate) + 1
    time: Array = np.linspace(0.0, aperture_time, samples)
    last_fix = int(np.floor(aperture_time / model.fix_interval + 1e-9))
    fix_time = np.arange(last_fix + 1, dtype=float) * model.fix_interval
    grid = _merged(time, fix_time[np.abs(time[_nearest(time, fix_time)] - fix_time) > 1e-9])
    noise = noise_path(model, grid, runs, streams[2])
    path = noise + unabsorbed[1][:, None] * np.stack([grid**3 / 6, grid**2 / 2, grid])[:, None]
    on_time, on_fixes = _nearest(grid, time), _nearest(grid, fix_time)
    sampled = path[:, :, on_time]
    # Errors of the fixes: white, slow, and of velocity where the receiver gives it.
    white = streams[3].standard_normal((runs, len(fix_time))) * model.gnss_sigma
    slow, fresh = _slow_path(model, slow, len(fix_time), streams[4])
    noises = [white] + [streams[6].standard_normal(white.shape) * model.velocity_sigma] * bool(model.velocity_sigma)
    fixes = Fixes(np.stack([noise.T for noise in noises], axis=-1), fresh)

    # Every way of navigating has this path; they differ in how the state at the start is carried along it.
    ins = sampled + carried(start[:, :3], time)
    coasted_position = (sampled[0] + carried(coasted, time)[0]) if coast_time > 0 else ins[0].copy()
    done = filtered(model, start, steady, path[:, :, on_fixes], fixes)
    output = navigated(done, path[:, :, on_fixes], sampled, time, fix_time)
    # A smoother over the whole leg has absorbed the constant part of the biases.
    rest = (last_fix + 1) * model.fix_interval - aperture_time
    unbiased = noise[:, :, on_fixes]
    in_leg = filtered_in_leg(model, (settled, steady), (unbiased, noise[:, :, -1]), fixes, rest, streams[5])
    leg_output = navigated(in_leg, unbiased, noise[:, :, on_time], time, fix_time)[0]
    return NavigationHistories(
        time=time,
        fix_time=fix_time,
        ins_position=ins[0],
        ins_velocity=ins[1],
        coasted_position=coasted_position,
        filter_position=output[0],
        filter_velocity=output[1],
        filter_correction=(done.posterior - done.prior)[:, :, 0].T,
        gnss_error=white + slow,
        smoothed_position=smoothed(model, done, output[0], time, fix_time),
        leg_position=smoothed(model, in_leg, leg_output, time, fix_time),
    )


def _before_aperture(
    model: AxisModel,
    posterior: Array,
    coast_time: float,
    runs: int,
    random: np.random.Generator,
    unabsorbed: Array,
) -> tuple[Array, Array, Array]:
    """States at the start of the aperture: of the filter (runs, m), without residual biases, and of the INS started
    earlier (runs, 3); and the slow error of the fixes there (runs,)."""
    state = draw_state(posterior, runs, random)
    coasted = state[:, :3].copy()
    coasted[:, 2] += unabsorbed[0]
    slow = np.zeros(runs)
    if model.slow_sigma:
        # The settled filter's estimate is independent of its error; the error is the estimate less the truth.
        estimated = np.sqrt(max(model.slow_sigma**2 - posterior[3, 3], 0.0))
        slow = estimated * random.standard_normal(runs) - state[:, 3]
    # The outage, from its first moment to the fix at the aperture's start: the same noise drives filter and INS.
    whole = int(np.floor(coast_time / model.fix_interval + 1e-9))
    rest = coast_time - whole * model.fix_interval
    covariance, drift = posterior, unabsorbed[1]
    for step in [rest] * (rest > 1e-9) + [model.fix_interval] * whole:
        phi, q = inertial_drift(model, step)
        noise = draw_state(q, runs, random)
        ramp = np.outer(drift, [step**3 / 6, step**2 / 2, step])
        coasted = coasted @ phi.T + noise + ramp
        phi, q = filter_drift(model, step)
        state = state @ phi.T
        state[:, :3] += noise
        gain, covariance = measure(phi @ covariance @ phi.T + q, model)
        fresh = draw_fresh(model, runs, random, step)
        slow = np.exp(-step / model.slow_time) * slow + fresh
        state[:, 3:] -= fresh[:, None]
        fix = random.standard_normal((runs, len(model.fix_sigmas))) * model.fix_sigmas
        state = state - (state @ fix_rows(model).T - fix) @ gain.T
    return state, coasted, slow


def _slow_path(model: AxisModel, start: Array, fixes: int, random: np.random.Generator) -> tuple[Array, Array]:
    """The slow error at each fix (runs, k), and its innovation there (k, runs)."""
    fresh, slow = [np.zeros_like(start)], [start]
    for _ in range(1, fixes):
        fresh.append(draw_fresh(model, len(start), random, model.fix_interval))
        slow.append(np.exp(-model.fix_interval / model.slow_time) * slow[-1] + fresh[-1])
    return np.stack(slow, axis=1), np.stack(fresh)


def _merged(time: Array, more: Array) -> Array:
    grid: Array = np.sort(np.concatenate([time, more]))
    return grid


def _nearest(grid: Array, time: Array) -> NDArray[np.intp]:
    right = np.clip(np.searchsorted(grid, time), 1, len(grid) - 1)
    return (right - (np.abs(grid[right - 1] - time) <= np.abs(grid[right] - time))).astype(np.intp)

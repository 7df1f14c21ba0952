"""The ways to navigate through an aperture (sar.md, "Navigation strategies"), on one noise realisation.

Two engines feed the same strategies: the per-axis error model here (`simulate_axis`), and full runs of the
simulator, which hand over their error histories as plain arrays (`NavigationHistories`). All histories are
navigation errors of one axis, [m] and [m/s], with the runs on any leading axes and time on the last.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.sar.axis_model import (
    AxisModel,
    draw_state,
    measure,
    noise_path,
    process_noise,
    steady_covariance,
    transition,
)
from nav_model.sar.smoother import rts_smooth, smoother_gain
from nav_model.sar.strategy_forms import fit_quadratic_sigma, ins_quadratic_variance, shrunk_weight

_FloatArray = NDArray[np.float64]


class Strategy(NamedTuple):
    """What a strategy is called and what may be said of it."""

    key: str
    name: str
    causal: bool
    reconstruction: bool
    source: str


STRATEGIES: tuple[Strategy, ...] = (
    Strategy("1", "Ideal", False, False, "reference, no error"),
    Strategy("2", "INS started by the filter", True, False, "[C]; closed form [T-15], [S-5]"),
    Strategy("3", "INS after a coast", True, False, "[C]; closed form [T-15], [S-5] with T_c"),
    Strategy("4", "Raw filter output", True, False, "[C]"),
    Strategy(
        "5", "INS minus a quadratic fitted to INS - GNSS", False, False, "[C]; closed form [T-16], [S-7]"
    ),
    Strategy("5w", "The same, quadratic shrunk", False, False, "[S-5], [S-7]; optimal linear weight"),
    Strategy("6", "Tracking filter after the INS", True, True, "after Kim, Fellerhoff and Kohler 2001"),
    Strategy("7", "Position-error damping loop", True, True, "after Song et al. 2015, 2017"),
    Strategy("8", "RTS smoother", False, False, "Rauch, Tung and Striebel 1965"),
)
STRATEGY_KEYS: tuple[str, ...] = tuple(strategy.key for strategy in STRATEGIES)


@dataclass(frozen=True)
class Tuning:
    """Gains of the two reconstructions; the literature names the schemes but not their numbers.

    Strategy 6: natural frequency [rad/s] and damping of the tracking filter. Strategy 7: proportional
    [1/s] and integral [1/s^2] gains by which a position correction is worked off.
    """

    natural_frequency: float = 0.3
    damping: float = 0.7071
    proportional_gain: float = 0.3
    integral_gain: float = 0.01

    def __post_init__(self) -> None:
        for name in ("natural_frequency", "damping", "proportional_gain"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise ValueError(f"{name}: {getattr(self, name)}; a positive, finite number is needed")
        if not (np.isfinite(self.integral_gain) and self.integral_gain >= 0):
            raise ValueError(f"integral_gain: {self.integral_gain}; zero or a positive number is needed")


@dataclass(frozen=True)
class NavigationHistories:
    """Errors of one axis over the aperture, from either engine; runs on the leading axes.

    ``time`` (n,) from 0 to T; ``fix_time`` (k,) the fixes in the aperture, the one at its start included.
    ``ins_position``, ``ins_velocity`` (..., n): free INS started by the filter at t = 0.
    ``coasted_position``: INS started earlier. ``filter_position``, ``filter_velocity``: the filter's output.
    ``filter_correction`` (..., k): what each fix adds to the filter's position error (zero for the fix at the
    start). ``gnss_error`` (..., k): error of each fix. ``smoothed_position`` (..., n): RTS.
    """

    time: _FloatArray
    fix_time: _FloatArray
    ins_position: _FloatArray
    ins_velocity: _FloatArray
    coasted_position: _FloatArray
    filter_position: _FloatArray
    filter_velocity: _FloatArray
    filter_correction: _FloatArray
    gnss_error: _FloatArray
    smoothed_position: _FloatArray

    def __post_init__(self) -> None:
        samples, fixes = len(self.time), len(self.fix_time)
        for name in self.__dataclass_fields__:
            if name in ("time", "fix_time"):
                continue
            expected = fixes if name in ("filter_correction", "gnss_error") else samples
            shape = np.shape(getattr(self, name))
            if not shape or shape[-1] != expected:
                raise ValueError(f"{name}: shape {shape}; {expected} values on the last axis are needed")


@dataclass(frozen=True)
class StrategyErrors:
    """Position error of every strategy, (9, ..., n) [m] in the order of STRATEGIES, and what made it."""

    time: _FloatArray
    error: _FloatArray
    jump_rms: _FloatArray
    fixes: int
    shrunk_weight: float
    tuning: Tuning
    strategies: tuple[Strategy, ...] = field(default=STRATEGIES)

    def of(self, key: str) -> _FloatArray:
        """Error histories (..., n) of one strategy, by its key ("2", "5w", ...)."""
        if key not in STRATEGY_KEYS:
            raise ValueError(f"strategy: {key!r}; one of {', '.join(STRATEGY_KEYS)} is needed")
        return np.asarray(self.error[STRATEGY_KEYS.index(key)])


def quadratic_correction(
    time: _FloatArray,
    ins_position: _FloatArray,
    fix_time: _FloatArray,
    gnss_error: _FloatArray,
    weight: float = 1.0,
) -> _FloatArray:
    """Strategies 5 and 5w: INS minus the quadratic fitted to INS - GNSS, its curvature times `weight`.

    The fit is least squares at the fixes, in the basis that is orthogonal over them, so the weight acts on
    the quadratic alone. Fewer than three fixes fix no quadratic: ValueError.
    """
    if len(fix_time) < 3:
        raise ValueError(f"fix_time: {len(fix_time)} fixes in the aperture; a quadratic fit needs at least 3")
    middle, half = (fix_time[0] + fix_time[-1]) / 2, (fix_time[-1] - fix_time[0]) / 2
    at_fixes = np.vander((fix_time - middle) / half, 3, increasing=True)
    basis, triangle = np.linalg.qr(at_fixes)
    over_time = np.vander((time - middle) / half, 3, increasing=True) @ np.linalg.inv(triangle)
    difference = _at(time, ins_position, fix_time) - gnss_error
    coefficients = difference @ basis
    return np.asarray(ins_position - (coefficients * np.array([1.0, 1.0, weight])) @ over_time.T)


def tracking_filter(
    time: _FloatArray,
    ins_velocity: _FloatArray,
    filter_position: _FloatArray,
    filter_velocity: _FloatArray,
    tuning: Tuning,
) -> _FloatArray:
    """Strategy 6 (reconstruction): p'' = a_INS + wn^2 (p_EKF - p) + 2 zeta wn (v_EKF - v), in errors.

    Starts from the filter; a_INS is taken as the velocity increments of the INS. Semi-implicit Euler at the
    sampling rate, which wants wn times the step well below one.
    """
    steps = np.diff(time)
    stiffness, drag = tuning.natural_frequency**2, 2 * tuning.damping * tuning.natural_frequency
    if drag * steps.max() > 0.5:
        raise ValueError(
            f"natural_frequency: {tuning.natural_frequency} rad/s is too fast "
            f"for steps of {steps.max():.3g} s"
        )
    # Time first: each step then works on contiguous runs.
    gained = np.ascontiguousarray(np.moveaxis(np.diff(ins_velocity, axis=-1), -1, 0))
    wanted = np.ascontiguousarray(np.moveaxis(stiffness * filter_position + drag * filter_velocity, -1, 0))
    position, velocity = filter_position[..., 0].copy(), filter_velocity[..., 0].copy()
    output = np.empty_like(wanted)
    output[0] = position
    for i, step in enumerate(steps):
        velocity += gained[i] + step * (wanted[i] - stiffness * position - drag * velocity)
        position += step * velocity
        output[i + 1] = position
    return np.moveaxis(output, 0, -1)


def damping_loop(
    time: _FloatArray,
    filter_position: _FloatArray,
    fix_time: _FloatArray,
    filter_correction: _FloatArray,
    tuning: Tuning,
) -> _FloatArray:
    """Strategy 7 (reconstruction): the filter's position correction is worked off by a PI law.

    Velocity and attitude are corrected at once, and what has been applied is fed back, so the output is the
    filter's error minus the part of its corrections still pending: r' = -kp r - ki integral(r). The loop is
    settled (nothing pending) at the start of the aperture.
    """
    age = time[None, :] - fix_time[:, None]
    pending = np.where(age >= -1e-9, _pi_decay(np.maximum(age, 0.0), tuning), 0.0)
    return np.asarray(filter_position - filter_correction @ pending)


def apply_strategies(
    histories: NavigationHistories, weight: float, tuning: Tuning | None = None
) -> StrategyErrors:
    """All nine strategies on the same histories; `weight` is that of 5w (`strategy_forms.shrunk_weight`).

    With fewer than three fixes in the aperture there is no quadratic to fit: 5 and 5w are then the same as 2
    (the result's ``fixes`` tells).
    """
    tuning = tuning or Tuning()
    h = histories

    def corrected(part: float) -> _FloatArray:
        if len(h.fix_time) < 3:
            return h.ins_position
        return quadratic_correction(h.time, h.ins_position, h.fix_time, h.gnss_error, part)

    error = np.stack(
        [
            np.zeros_like(h.ins_position),
            h.ins_position,
            h.coasted_position,
            h.filter_position,
            corrected(1.0),
            corrected(weight),
            tracking_filter(h.time, h.ins_velocity, h.filter_position, h.filter_velocity, tuning),
            damping_loop(h.time, h.filter_position, h.fix_time, h.filter_correction, tuning),
            h.smoothed_position,
        ]
    )
    jumps = h.filter_correction[..., 1:]
    jump_rms = np.sqrt(np.mean(jumps**2, axis=-1)) if jumps.shape[-1] else np.zeros(jumps.shape[:-1])
    return StrategyErrors(h.time, error, jump_rms, len(h.fix_time), weight, tuning)


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
    inertial = ins_quadratic_variance(
        aperture_time=aperture_time,
        accelerometer_noise=model.accelerometer_noise,
        gyro_noise=model.gyro_noise if model.horizontal else 0.0,
        tilt_variance=steady_covariance(model).posterior[2, 2] / model.gravity**2,
        gravity=model.gravity,
        accelerometer_bias=model.accelerometer_bias,
        gyro_bias=model.gyro_bias if model.horizontal else 0.0,
    )
    fit = fit_quadratic_sigma(model.gnss_sigma, model.fix_interval, aperture_time, len(histories.fix_time))
    return apply_strategies(histories, float(shrunk_weight(inertial, fit**2)), tuning)


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
    streams = random.spawn(4)
    unabsorbed = streams[0].standard_normal((2, runs)) * np.array(
        [[model.accelerometer_bias], [model.gravity * model.gyro_bias * model.horizontal]]
    )
    start, coasted = _before_aperture(model, steady.posterior, coast_time, runs, streams[1], unabsorbed)

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

    ins = sampled + _carried(start, time)
    coasted_position = (sampled[0] + _carried(coasted, time)[0]) if coast_time > 0 else ins[0].copy()

    priors, posteriors = [start], [start]
    prior_covariances, covariances = [steady.prior], [steady.posterior]
    phi = transition(model.fix_interval)
    for k in range(1, len(fix_time)):
        gathered = at_fixes[:, :, k].T - at_fixes[:, :, k - 1].T @ phi.T
        prior = posteriors[-1] @ phi.T + gathered
        prior_covariance = phi @ covariances[-1] @ phi.T + process_noise(model, model.fix_interval)
        gain, covariance = measure(prior_covariance, model.gnss_sigma)
        priors.append(prior)
        posteriors.append(prior - np.outer(prior[:, 0] - gnss_error[:, k], gain))
        prior_covariances.append(prior_covariance)
        covariances.append(covariance)
    prior, posterior = np.stack(priors), np.stack(posteriors)
    smoothed_at_fixes = rts_smooth(
        posterior,
        np.stack(covariances),
        prior,
        np.stack(prior_covariances),
        np.broadcast_to(phi, (len(fix_time) - 1, 3, 3)),
    )

    navigated = sampled.copy()
    smoothed = np.empty_like(sampled[0])
    interval = np.searchsorted(fix_time, time + 1e-9, side="right") - 1
    for k in range(len(fix_time)):
        inside = np.flatnonzero(interval == k)
        span = slice(inside[0], inside[-1] + 1) if len(inside) else slice(0, 0)
        age = time[span] - fix_time[k]
        navigated[:, :, span] += _carried(posterior[k] - at_fixes[:, :, k].T, age)
        smoothed[:, span] = navigated[0][:, span]
        if k + 1 < len(fix_time):
            forward = transition(age)
            predicted = forward @ covariances[k] @ np.swapaxes(forward, 1, 2) + process_noise(model, age)
            onward = transition(model.fix_interval - age)
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
) -> tuple[_FloatArray, _FloatArray]:
    """States (runs, 3) at the start of the aperture: of the filter, and of the INS that left it earlier."""
    filtered = draw_state(posterior, runs, random)
    coasted = filtered.copy()
    coasted[:, 2] += unabsorbed[0]
    whole = int(np.floor(coast_time / model.fix_interval + 1e-9))
    rest = coast_time - whole * model.fix_interval
    covariance, drift = posterior, unabsorbed[1]
    for step in [rest] * (rest > 1e-9) + [model.fix_interval] * whole:
        phi = transition(step)
        noise = draw_state(process_noise(model, step), runs, random)
        ramp = np.outer(drift, [step**3 / 6, step**2 / 2, step])
        coasted = coasted @ phi.T + noise + ramp
        filtered = filtered @ phi.T + noise
        gain, covariance = measure(phi @ covariance @ phi.T + process_noise(model, step), model.gnss_sigma)
        fix = random.standard_normal(runs) * model.gnss_sigma
        filtered = filtered - np.outer(filtered[:, 0] - fix, gain)
    filtered[:, 2] += unabsorbed[0]
    return filtered, coasted


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


def _at(time: _FloatArray, values: _FloatArray, moments: _FloatArray) -> _FloatArray:
    """Linear interpolation of (..., n) at moments (k,)."""
    place = np.interp(moments, time, np.arange(len(time)))
    before = np.minimum(place.astype(int), len(time) - 2)
    part = place - before
    return np.asarray(values[..., before] * (1 - part) + values[..., before + 1] * part)


def _pi_decay(age: _FloatArray, tuning: Tuning) -> _FloatArray:
    """Response r(t) to r(0) = 1 of r'' + kp r' + ki r = 0 with r'(0) = -kp."""
    kp, ki = tuning.proportional_gain, tuning.integral_gain
    root = np.sqrt(complex(kp**2 / 4 - ki))
    if abs(root) < 1e-6 * kp:
        return np.asarray(np.exp(-kp * age / 2) * (1 - kp * age / 2))
    fast, slow = -kp / 2 - root, -kp / 2 + root
    return np.asarray(((fast * np.exp(fast * age) - slow * np.exp(slow * age)) / (fast - slow)).real)

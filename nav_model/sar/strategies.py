"""The strategies for navigating through an aperture (sar.md, "Navigation strategies"), on the same noise.

Two engines feed the same strategies: the per-axis error model (`fast_engine.simulate_axis`), and full runs of
the simulator, which hand over their error histories as plain arrays (`NavigationHistories`). All are
navigation errors of one axis, [m] and [m/s], with the runs on any leading axes and time on the last.

Only the last, the whole-leg smoother, uses fixes from after the aperture: it is what post-processing reaches
(`nav_model.processing`). The RTS smoother stops at the aperture's end and bounds causal and in-aperture methods only.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.design.processing import POST_PROCESSED

IN_FLIGHT, AFTER_APERTURE = "in flight", "after the aperture"


class Strategy(NamedTuple):
    """Name and properties of a strategy.

    ``timing``: when its output is available: in flight, after the last fix of the aperture, or post-processed. A
    design that is processed in real time can use the first two.
    """

    key: str
    name: str
    timing: str
    reconstruction: bool
    source: str

    @property
    def causal(self) -> bool:
        """True if its output is available in flight."""
        return self.timing == IN_FLIGHT


STRATEGIES: tuple[Strategy, ...] = (
    Strategy("1", "Ideal", AFTER_APERTURE, False, "reference without error"),
    Strategy("2", "INS from filter", IN_FLIGHT, False, "formula [T-15], [S-5]"),
    Strategy("3", "INS after outage", IN_FLIGHT, False, "formula [T-15], [S-5] with T_c"),
    Strategy("4", "Filter output", IN_FLIGHT, False, "runs only"),
    Strategy("5", "Quadratic fit", AFTER_APERTURE, False, "INS less a quadratic fitted to INS - GNSS [T-16], [S-7]"),
    Strategy("5w", "Quadratic fit, noise-weighted", AFTER_APERTURE, False, "optimal linear weight [S-5], [S-7]"),
    Strategy("6", "Tracking filter", IN_FLIGHT, True, "after Kim, Fellerhoff and Kohler 2001"),
    Strategy("7", "Damping loop", IN_FLIGHT, True, "after Song et al. 2015, 2017"),
    Strategy("8", "RTS smoother of the aperture", AFTER_APERTURE, False, "Rauch, Tung and Striebel 1965"),
    Strategy("9", "Whole-leg smoother", POST_PROCESSED, False, "formula [P-3], [P-5]: fixes before, in and after"),
)
STRATEGY_KEYS: tuple[str, ...] = tuple(strategy.key for strategy in STRATEGIES)
NAMES: dict[str, str] = {strategy.key: strategy.name for strategy in STRATEGIES}
"""Name of each strategy, wherever a person reads of it."""


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


@dataclass(frozen=True)
class NavigationHistories:
    """Errors of one axis over the aperture, from either engine; runs on the leading axes.

    ``time`` (n,) from 0 to T; ``fix_time`` (k,) the fixes in the aperture, the one at its start included.
    ``ins_position``, ``ins_velocity`` (..., n): free INS started by the filter at t = 0.
    ``coasted_position``: INS started earlier. ``filter_position``, ``filter_velocity``: the filter's output.
    ``filter_correction`` (..., k): what each fix adds to the filter's position error (zero for the fix at the
    start). ``gnss_error`` (..., k): error of each fix. ``smoothed_position`` (..., n): RTS up to the aperture's
    end, ``leg_position`` (..., n): with the fixes of the whole leg.
    """

    time: Array
    fix_time: Array
    ins_position: Array
    ins_velocity: Array
    coasted_position: Array
    filter_position: Array
    filter_velocity: Array
    filter_correction: Array
    gnss_error: Array
    smoothed_position: Array
    leg_position: Array


@dataclass(frozen=True)
class StrategyErrors:
    """Position error of every strategy, (10, ..., n) [m] in the order of STRATEGIES."""

    time: Array
    error: Array
    jump_rms: Array
    fixes: int

    def of(self, key: str) -> Array:
        """Error histories (..., n) of one strategy, by its key ("2", "5w", ...)."""
        return np.asarray(self.error[STRATEGY_KEYS.index(key)])


def quadratic_correction(
    time: Array, ins_position: Array, fix_time: Array, gnss_error: Array, weight: float = 1.0
) -> Array:
    """Strategies 5 and 5w: INS minus the quadratic fitted to INS - GNSS, its curvature times `weight`.

    The fit is least squares at the fixes, in the basis that is orthogonal over them, so the weight acts on
    the quadratic alone.

    Parameters
    ----------
    time, fix_time : array (n,), array (k,)
        Seconds in the aperture.
    ins_position : array (..., n)
        Error of the INS, m.
    gnss_error : array (..., k)
        Error of each fix, m.
    weight : float, optional
        1 for strategy 5.

    Raises
    ------
    ValueError
        For fewer than three fixes, which determine no quadratic.
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
    time: Array,
    ins_velocity: Array,
    filter_position: Array,
    filter_velocity: Array,
    tuning: Tuning,
) -> Array:
    """Strategy 6 (reconstruction): p'' = a_INS + wn^2 (p_EKF - p) + 2 zeta wn (v_EKF - v), in errors.

    Starts from the filter; a_INS is taken as the velocity increments of the INS. Semi-implicit Euler at the
    sampling rate, which needs wn times the step well below one.

    Parameters
    ----------
    time : array (n,)
        Seconds.
    ins_velocity, filter_position, filter_velocity : array (..., n)
        Errors, m/s and m.
    tuning : Tuning
        wn and zeta.

    Raises
    ------
    ValueError
        For a natural frequency that is too fast for the steps.
    """
    steps = np.diff(time)
    stiffness, drag = tuning.natural_frequency**2, 2 * tuning.damping * tuning.natural_frequency
    if drag * steps.max() > 0.5:
        raise ValueError(
            f"natural_frequency: {tuning.natural_frequency} rad/s is too fast for steps of {steps.max():.3g} s"
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
    time: Array,
    filter_position: Array,
    fix_time: Array,
    filter_correction: Array,
    tuning: Tuning,
) -> Array:
    """Strategy 7 (reconstruction): the filter's position correction is worked off by a PI law.

    Velocity and attitude are corrected at once, and applied corrections are fed back, so the output is the filter's
    error minus the pending part of its corrections: r' = -kp r - ki integral(r). The loop is settled (nothing
    pending) at the start of the aperture.

    Parameters
    ----------
    time, fix_time : array (n,), array (k,)
        Seconds in the aperture.
    filter_position : array (..., n)
        Error of the filter, m.
    filter_correction : array (..., k)
        Change of its position at each fix, m.
    tuning : Tuning
        kp and ki.
    """
    age = time[None, :] - fix_time[:, None]
    pending = np.where(age >= -1e-9, _pi_decay(np.maximum(age, 0.0), tuning), 0.0)
    return np.asarray(filter_position - filter_correction @ pending)


def apply_strategies(h: NavigationHistories, weight: float, tuning: Tuning) -> StrategyErrors:
    """Every strategy on the same histories; `weight` is that of 5w (`strategy_forms.shrunk_weight`).

    With fewer than three fixes in the aperture there is no quadratic to fit: 5 and 5w are then the same as 2
    (see the result's ``fixes``).
    """

    def corrected(part: float) -> Array:
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
            h.leg_position,
        ]
    )
    jumps = h.filter_correction[..., 1:]
    jump_rms = np.sqrt(np.mean(jumps**2, axis=-1)) if jumps.shape[-1] else np.zeros(jumps.shape[:-1])
    return StrategyErrors(h.time, error, jump_rms, len(h.fix_time))


def _at(time: Array, values: Array, moments: Array) -> Array:
    """Linear interpolation of (..., n) at moments (k,)."""
    place = np.interp(moments, time, np.arange(len(time)))
    before = np.minimum(place.astype(int), len(time) - 2)
    part = place - before
    return np.asarray(values[..., before] * (1 - part) + values[..., before + 1] * part)


def _pi_decay(age: Array, tuning: Tuning) -> Array:
    """Response r(t) to r(0) = 1 of r'' + kp r' + ki r = 0 with r'(0) = -kp."""
    kp, ki = tuning.proportional_gain, tuning.integral_gain
    root = np.sqrt(complex(kp**2 / 4 - ki))
    if abs(root) < 1e-6 * kp:
        return np.asarray(np.exp(-kp * age / 2) * (1 - kp * age / 2))
    fast, slow = -kp / 2 - root, -kp / 2 + root
    return np.asarray(((fast * np.exp(fast * age) - slow * np.exp(slow * age)) / (fast - slow)).real)

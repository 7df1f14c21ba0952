"""The decoupled height and horizontal channels [B-5]: closed forms [B-6] and where they stop holding.

    x'' + w^2 x = a_x horizontally,   z'' - 2 w^2 z = a_z vertically,   w^2 = GM / r^3
They explain the Schuler oscillation and the unstable height, and hold only for a local frame that does not
rotate. On a long arc they are wrong: displayed numbers come from the integrated INS.
"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.compiled import kernel
from nav_model.base.constants import GRAVITATIONAL_PARAMETER, SPHERE_RADIUS
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.errors import ErrorSet
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.layout import (
    ACCELEROMETERS,
    ATTITUDE,
    BIAS,
    COUNT,
    GYROS,
    MATRIX,
    POSITION,
    SENSORS,
    SLOW_BIAS,
    SLOW_MATRIX,
    VELOCITY,
)
from nav_model.suborbital.mechanisation import oscillations
from nav_model.suborbital.sensitivity import unit_errors


def schuler_rate(height_m: ArrayLike) -> Array:
    """w = sqrt(GM / r^3), rad/s, at a height above the sphere, m [B-5]."""
    return np.asarray(
        np.sqrt(GRAVITATIONAL_PARAMETER / (SPHERE_RADIUS + np.asarray(height_m, dtype=np.float64)) ** 3)
    )


def height_e_folding_time(height_m: ArrayLike) -> Array:
    """Time 1/k = 1/(sqrt(2) w) in which the height error grows by e, s [B-6]."""
    return np.asarray(1.0 / (np.sqrt(2.0) * schuler_rate(height_m)))


def channel_error(
    rate: ArrayLike,
    time_s: ArrayLike,
    *,
    bias: ArrayLike = 0.0,
    tilt_rate: ArrayLike = 0.0,
    position: ArrayLike = 0.0,
    velocity: ArrayLike = 0.0,
    amplitude: ArrayLike = 0.0,
    frequency: ArrayLike = 1e-3,
) -> Array:
    """Position error in one channel, m [B-6]; broadcasts over every argument.

    Parameters
    ----------
    rate : array_like
        w of `schuler_rate` horizontally; i k = i sqrt(2) w for the height, whose sines are hyperbolic ones.
    time_s : array_like
        Since the start.
    bias : array_like, optional
        Of the accelerometer, m/s².
    tilt_rate : array_like, optional
        f e, specific force times gyro bias, m/s³.
    position, velocity : array_like, optional
        At t = 0, m and m/s.
    amplitude, frequency : array_like, optional
        Of a forcing A sin(O t), m/s² and rad/s, resonance included.
    """
    t, w, o = (np.asarray(value) for value in (time_s, rate, frequency))
    c, s = np.cos(w * t), np.sin(w * t) / w
    resonant = np.abs(o - w) < 1e-7 * np.abs(w)
    gap = np.where(resonant, 1.0, w * w - o * o)
    forced = np.where(resonant, (s - t * c) / (2.0 * w), (np.sin(o * t) - o * s) / gap)
    return np.real(
        np.asarray(bias) / w**2 * (1.0 - c)
        + np.asarray(tilt_rate) / w**2 * (t - s)
        + np.asarray(position) * c
        + np.asarray(velocity) * s
        + np.asarray(amplitude) * forced
    )


def height_growth(flight: TrueFlight) -> Array:
    """exp of the integral of k along a flight, (n+1,): the factor by which the unstable height grows a start
    error, whose slope on a log plot is 1/(e-folding time) at the height of the moment [B-6]."""
    k = 1.0 / height_e_folding_time(flight.height_m)
    steps = 0.5 * flight.step_s * (k[1:] + k[:-1])
    return np.asarray(np.exp(np.concatenate([[0.0], np.cumsum(steps)])))


@kernel
def _channels(x: Array, v: Array, force: Array, w2: Array, h: float, every: int, out: Array) -> None:
    """Exact step of each channel under the mean forcing of the step; x, v (c, 3), force (n, c, 3)."""
    n, cases = force.shape[0], x.shape[0]
    for i in range(n + 1):
        if i % every == 0:
            out[:, i // every] = x
        if i == n:
            break
        w, k = np.sqrt(w2[i]), np.sqrt(2.0 * w2[i])
        s, c = np.sin(w * h) / w, np.cos(w * h)
        sv, cv = np.sinh(k * h) / k, np.cosh(k * h)
        for a in range(cases):
            for b in range(3):
                x0, v0, f = x[a, b], v[a, b], force[i, a, b]
                if b < 2:
                    x[a, b] = x0 * c + v0 * s + f * (1.0 - c) / w2[i]
                    v[a, b] = v0 * c - x0 * w2[i] * s + f * s
                else:
                    x[a, b] = x0 * cv + v0 * sv + f * (cv - 1.0) / (2.0 * w2[i])
                    v[a, b] = v0 * cv + x0 * 2.0 * w2[i] * sv + f * sv


@kernel
def _force_channels(
    attitude: Array,
    force: Array,
    rate: Array,
    sines: Array,
    axes: Array,
    tilt: Array,
    h: float,
    out: Array,
) -> None:
    """Forcing C df + psi x f of a unit of each parameter, resolved in `axes`; tilt (3, P) is psi at lift-off."""
    n, columns = out.shape[0], out.shape[1]
    acc, turn = np.zeros((3, columns)), np.zeros((3, columns))
    f, felt, step = np.empty(3), np.empty(3), np.empty(3)
    for i in range(n):
        c = attitude[i]
        unit_errors(c, force[i], rate[i], sines[i], acc, turn)
        for a in range(3):
            f[a] = c[a, 0] * force[i, 0] + c[a, 1] * force[i, 1] + c[a, 2] * force[i, 2]
        for p in range(columns):
            for a in range(3):
                step[a] = tilt[a, p] + 0.5 * h * turn[a, p]
                tilt[a, p] += h * turn[a, p]
            for a in range(3):
                b, d = (a + 1) % 3, (a + 2) % 3
                felt[a] = acc[a, p] + step[b] * f[d] - step[d] * f[b]
            for b in range(3):
                out[i, p, b] = felt[0] * axes[i, 0, b] + felt[1] * axes[i, 1, b] + felt[2] * axes[i, 2, b]


def _forcing(flight: TrueFlight, sines: Array) -> tuple[Array, Array]:
    """Forcing of the channels by a unit of each parameter in the middle of every step, north, east, up (n, 61, 3),
    m/s²; the path there (n, 3)."""
    launch, tilt = local_axes(flight.position_i[0]), np.zeros((3, COUNT))
    tilt[:, ATTITUDE] = launch
    middle = 0.5 * (flight.position_i[1:] + flight.position_i[:-1])
    out = np.empty((flight.steps, COUNT, 3))
    _force_channels(
        np.ascontiguousarray(flight.half_attitude_bi[1::2]),
        np.ascontiguousarray(flight.specific_force_b[:, 1]),
        np.ascontiguousarray(flight.angular_rate_b[:, 1]),
        np.ascontiguousarray(sines),
        local_axes(middle) * _UP,
        tilt,
        flight.step_s,
        out,
    )
    return out, middle


def decoupled_response(flight: TrueFlight, errors: ErrorSet, every: int = 10) -> Array:
    """[B-5] driven along a real flight by a unit of each parameter (61, m, 3), m: north, east, up.

    The forcing C df + psi x f is that of [B-4], resolved in the moving local axes; Coriolis and transport
    terms are dropped, as in [B]. errors supplies the oscillation periods only.
    """
    n, h = flight.steps, flight.step_s
    flight.require_spacing(every)
    forcing, middle = _forcing(flight, oscillations(flight, errors)[1::2])
    unit = np.eye(COUNT)
    out = np.empty((COUNT, n // every + 1, 3))
    w2 = GRAVITATIONAL_PARAMETER / np.linalg.norm(middle, axis=1) ** 3
    _channels(unit[:, POSITION] * _UP, unit[:, VELOCITY] * _UP, forcing, w2, h, every, out)
    return out


def closed_form_errors(flight: TrueFlight, parameters: Array, errors: ErrorSet, every: int = 10) -> Array:
    """The closed forms [B-6] for a flight that they were not made for: north, east, up (c, m, 3), m.

    They assume one height and forcing that does not turn: the height is the flight's mean; bias b and amplitude A
    are the means of the accelerometers' local errors while the motor burns, f e the slope (least squares
    through zero) of the acceleration that attitude errors cause then (X). An initial attitude error acts as a
    bias of f psi. They hold while these stay constant.

    Parameters
    ----------
    flight : TrueFlight
        Of n steps.
    parameters : array (c, 61)
        Errors of each case, in the order of `layout`.
    errors : ErrorSet
        Periods of the oscillating terms.
    every : int, optional
        Steps between outputs.
    """
    p = np.atleast_2d(parameters)
    flight.require_spacing(every)
    felt = np.linalg.norm(flight.specific_force_b[:, 1], axis=-1)
    burning = felt > _BURNING if np.any(felt > _BURNING) else np.ones(flight.steps, dtype=np.bool_)
    time = flight.time_s[:-1][burning] + 0.5 * flight.step_s
    sines = oscillations(flight, errors)[1::2]
    sines[:, :2] = 1.0  # the accelerometers' amplitude
    forcing = _forcing(flight, sines)[0][burning]
    mean, slope = np.mean(forcing, axis=0), np.einsum("t,tpi->pi", time, forcing) / np.sum(time**2)
    slow = np.r_[SLOW_BIAS:MATRIX, SLOW_MATRIX:GYROS] + ACCELEROMETERS
    steady = np.r_[BIAS:SLOW_BIAS, MATRIX:SLOW_MATRIX, ATTITUDE]
    gyros = slice(GYROS, SENSORS.stop)
    constants = {
        "bias": p[:, steady] @ mean[steady],
        "tilt_rate": p[:, gyros] @ slope[gyros],
        "amplitude": p[:, slow] @ mean[slow],
        "position": p[:, POSITION] * _UP,
        "velocity": p[:, VELOCITY] * _UP,
    }
    w = schuler_rate(np.mean(flight.height_m))
    t = flight.time_s[::every]
    channels = [
        channel_error(
            rate, t, frequency=2.0 * np.pi / errors.accelerometers.bias_period_s,
            **{name: value[:, None, axis] for name, value in constants.items()},
        )
        for axis, rate in enumerate((w, w, 1j * np.sqrt(2.0) * w))
    ]  # fmt: skip
    return np.stack(channels, axis=-1)


_UP = np.array([1.0, 1.0, -1.0])
_BURNING = 0.1
"""Specific force, m/s², above which the motor burns."""

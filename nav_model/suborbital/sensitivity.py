"""Linear error model [B-4]: one batch run gives every slider its curve, and white noise its standard
deviation.

    psi' = C domega ;   dr'' = C df + psi x f + w^2 (3 u u^T - I) dr
With psi the error rotation on inertial axes (C_est = (I + [psi x]) C), u the unit radius, w^2 = GM/r^3. The
errors of [B-1] are linear in their 61 numbers, so the error history is S p. With a star tracker psi starts
anew at each frame from the camera's own error: body-fixed misalignment C m and latency -C omega tau.
"""

from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.compiled import kernel, part
from nav_model.base.constants import GRAVITATIONAL_PARAMETER
from nav_model.earth.rotation import skew
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.errors import ErrorSet
from nav_model.suborbital.flight import TrueFlight, step_nodes
from nav_model.suborbital.layout import (
    ATTITUDE,
    BIAS,
    CAMERA,
    COUNT,
    GYROS,
    LATENCY,
    MATRIX,
    POSITION,
    SLOW_BIAS,
    SLOW_MATRIX,
    VELOCITY,
)
from nav_model.suborbital.mechanisation import oscillations
from nav_model.suborbital.runge_kutta import after_step, node_of, state_at


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivity of the error history to the parameter vector.

    position (m, 3, 61): north, east, up in metres per unit of each parameter, at time_s (m,); velocity
    (m, 3, 61): north, east, up of the inertial velocity error; attitude (m, 3, 61): psi on inertial axes.
    """

    time_s: Array
    position: Array = field(repr=False)
    velocity: Array = field(repr=False)
    attitude: Array = field(repr=False)

    def position_m(self, parameters: Array) -> Array:
        """Position errors (cases, m, 3), m, of parameter vectors (cases, 61) or (61,): the product S p."""
        p = np.atleast_2d(parameters)
        flat = self.position.reshape(-1, COUNT) @ p.T
        return np.ascontiguousarray(flat.T).reshape(len(p), len(self.time_s), 3)


@dataclass(frozen=True)
class NoiseSpread:
    """Standard deviation of the error that white sensor noise (and, aided, star noise) leaves.

    time_s (m,); position_sigma_m (m, 3): north, east, up; covariance (m, 9, 9) of psi, velocity and position on
    inertial axes.
    """

    time_s: Array
    position_sigma_m: Array
    covariance: Array = field(repr=False)


@part
def unit_errors(c: Array, f: Array, w: Array, s: Array, acc: Array, turn: Array) -> None:
    """Columns of C df and C domega for a unit of each sensor parameter.

    Parameters
    ----------
    c : array (3, 3)
        Body to inertial axes.
    f, w : array (3,)
        Specific force [m/s²] and angular rate [rad/s] in body axes.
    s : array (4,)
        Sines of the oscillating terms: bias and matrix of the accelerometers, then of the gyros.
    acc, turn : array (3, 61)
        Take the columns.
    """
    for a in range(3):
        for b in range(3):
            acc[a, BIAS + b] = c[a, b]
            acc[a, SLOW_BIAS + b] = c[a, b] * s[0]
            turn[a, GYROS + BIAS + b] = c[a, b]
            turn[a, GYROS + SLOW_BIAS + b] = c[a, b] * s[2]
            for d in range(3):
                k = 3 * b + d
                acc[a, MATRIX + k] = c[a, b] * f[d]
                acc[a, SLOW_MATRIX + k] = c[a, b] * f[d] * s[1]
                turn[a, GYROS + MATRIX + k] = c[a, b] * w[d]
                turn[a, GYROS + SLOW_MATRIX + k] = c[a, b] * w[d] * s[3]


@part
def _restart(state: Array, c: Array, w: Array) -> None:
    """Start psi anew at a frame, from the camera's own errors."""
    state[:3] = 0.0
    for a in range(3):
        for b in range(3):
            state[a, CAMERA + b] = c[a, b]
            state[a, LATENCY] -= c[a, b] * w[b]


@kernel
def _propagate(
    state: Array,
    dynamics: Array,
    attitude: Array,
    force: Array,
    rate: Array,
    sines: Array,
    used: NDArray[np.bool_],
    h: float,
    every: int,
    out: Array,
) -> None:
    """RK4 of [B-4] for all columns at once; state (9, P) holds psi, velocity and position errors."""
    n, driven, k = len(dynamics), np.zeros((3, *state.shape)), np.empty((4, *state.shape))
    for i in range(n + 1):
        if used[i]:
            _restart(state, attitude[2 * i], rate[i, 0] if i < n else rate[i - 1, 2])
        if i % every == 0:
            out[i // every] = state
        if i == n:
            break
        for node in range(3):
            at = 2 * i + node
            unit_errors(attitude[at], force[i, node], rate[i, node], sines[at], driven[node, 3:6], driven[node, :3])
        for slope in range(4):
            node = node_of(slope)
            k[slope] = dynamics[i, node] @ state_at(state, k, slope, h) + driven[node]
        state = after_step(state, k, h)


def _half_path(flight: TrueFlight) -> Array:
    """True position at every half step, (2n+1, 3): Hermite midpoint of position and velocity."""
    r, v = flight.position_i, flight.velocity_i
    path = np.empty((2 * flight.steps + 1, 3))
    path[::2] = r
    path[1::2] = 0.5 * (r[:-1] + r[1:]) + flight.step_s / 8.0 * (v[:-1] - v[1:])
    return path


def sensitivity(flight: TrueFlight, errors: ErrorSet, used: np.ndarray | None = None, every: int = 10) -> Sensitivity:
    """Sensitivity matrix of a flight [B-4]. The gravity gradient is the spherical one.

    Parameters
    ----------
    flight : TrueFlight
        Of n steps.
    errors : ErrorSet
        Periods of the oscillating terms.
    used : array (n+1,) of bool, optional
        Steps with a star frame; a pure INS by default.
    every : int, optional
        Steps between outputs, a divisor of n.
    """
    n = flight.steps
    flight.require_spacing(every)
    taken = np.zeros(n + 1, dtype=np.bool_) if used is None else np.ascontiguousarray(used, dtype=np.bool_)
    launch = local_axes(flight.position_i[0])
    state = np.zeros((9, COUNT))
    state[6:, POSITION] = launch
    state[3:6, VELOCITY] = launch
    state[:3, ATTITUDE] = launch
    out = np.empty((n // every + 1, 9, COUNT))
    _propagate(
        state,
        _dynamics(
            np.einsum("tnij,tnj->tni", step_nodes(flight.half_attitude_bi), flight.specific_force_b),
            step_nodes(_half_path(flight)),
        ),
        flight.half_attitude_bi,
        flight.specific_force_b,
        flight.angular_rate_b,
        oscillations(flight, errors),
        taken,
        flight.step_s,
        every,
        out,
    )
    to_local = np.swapaxes(local_axes(flight.position_i[::every]), -1, -2).copy()
    to_local[:, 2] *= -1.0
    return Sensitivity(
        time_s=flight.time_s[::every],
        position=to_local @ out[:, 6:],
        velocity=to_local @ out[:, 3:6],
        attitude=out[:, :3].copy(),
    )


def _dynamics(force: Array, position: Array) -> Array:
    """[B-4] as a matrix (..., 9, 9) on psi, velocity and position errors; force and position (..., 3), inertial."""
    radius = np.linalg.norm(position, axis=-1)[..., None, None]
    outer = position[..., :, None] * position[..., None, :] / radius**2
    matrix = np.zeros((*force.shape[:-1], 9, 9))
    matrix[..., 3:6, :3] = -skew(force)
    matrix[..., 3:6, 6:] = GRAVITATIONAL_PARAMETER / radius**3 * (3.0 * outer - np.eye(3))
    matrix[..., 6:, 3:6] = np.eye(3)
    return matrix


def white_noise_spread(
    flight: TrueFlight,
    accelerometer: float,
    gyro: float,
    used: np.ndarray | None = None,
    frame_covariance: Array | None = None,
    every: int = 10,
) -> NoiseSpread:
    """Standard deviation from white noise alone, against time [B-4].

    Each step is one transition, to second order, with the noise added at its end, which is exact to the step over the
    flight time.

    Parameters
    ----------
    flight : TrueFlight
        Of n steps.
    accelerometer, gyro : float
        Root spectral densities, as `SensorErrors.white_noise`.
    used : array (n+1,) of bool, optional
        Steps with a star frame; a pure INS by default.
    frame_covariance : array (n+1, 3, 3) or (3, 3), optional
        Covariance of the camera's attitude error, body axes, rad²; a perfect camera by default.
    every : int, optional
        Steps between outputs.
    """
    n, h = flight.steps, flight.step_s
    flight.require_spacing(every)
    force = np.einsum("tij,tj->ti", flight.half_attitude_bi[1::2], flight.specific_force_b[:, 1])
    change = h * _dynamics(force, _half_path(flight)[1::2])
    transition = np.eye(9) + change + 0.5 * change @ change
    a, g = accelerometer**2, gyro**2
    grown = np.asarray(
        np.kron([[g * h, 0.0, 0.0], [0.0, a * h, a * h**2 / 2], [0.0, a * h**2 / 2, a * h**3 / 3]], np.eye(3))
    )
    taken = np.zeros(n + 1, dtype=np.bool_) if used is None else np.asarray(used, dtype=np.bool_)
    star = np.zeros((n + 1, 3, 3))
    if frame_covariance is not None:
        c = flight.attitude_bi
        star = c @ np.broadcast_to(frame_covariance, (n + 1, 3, 3)) @ np.swapaxes(c, -1, -2)
    out = np.empty((n // every + 1, 9, 9))
    _covariance(transition, taken, star, grown, every, out)
    turn = np.swapaxes(local_axes(flight.position_i[::every]), -1, -2)
    place = turn @ out[:, 6:, 6:] @ np.swapaxes(turn, -1, -2)
    return NoiseSpread(
        time_s=flight.time_s[::every],
        position_sigma_m=np.sqrt(np.diagonal(place, axis1=1, axis2=2)),
        covariance=out,
    )


@dataclass(frozen=True)
class NoiseParts:
    """Spread of unit white noise: its variance is linear in the squared densities, so it need not be run again.

    accelerometer and gyro: for a density of one in SI; star: of the camera's own noise alone (None without).
    """

    accelerometer: NoiseSpread
    gyro: NoiseSpread
    star: NoiseSpread | None

    def spread(self, errors: ErrorSet) -> NoiseSpread:
        """The spread at the densities of `errors`."""
        parts = [(errors.accelerometers.white_noise, self.accelerometer), (errors.gyros.white_noise, self.gyro)]
        if self.star is not None:
            parts.append((1.0, self.star))
        return NoiseSpread(
            time_s=self.accelerometer.time_s,
            position_sigma_m=np.sqrt(sum((a * a * part.position_sigma_m**2 for a, part in parts), np.zeros(1))),
            covariance=sum((a * a * part.covariance for a, part in parts), np.zeros(1)),
        )


def noise_parts(
    flight: TrueFlight, used: np.ndarray | None, frame_covariance: Array | None, every: int
) -> NoiseParts:
    """White noise in parts.

    Parameters
    ----------
    flight, used, frame_covariance, every
        As `white_noise_spread`.
    """
    unit = partial(white_noise_spread, flight, used=used, every=every)
    star = None if frame_covariance is None else unit(0.0, 0.0, frame_covariance=frame_covariance)
    return NoiseParts(unit(1.0, 0.0), unit(0.0, 1.0), star)


def along_track_sigma(spread: NoiseSpread, flight: TrueFlight, every: int = 10) -> Array:
    """Standard deviation of the position error down-range and cross-range, (m, 2), m; every as in the spread."""
    north, east = np.swapaxes(local_axes(flight.position_i[::every]), -1, -2)[:, :2].swapaxes(0, 1)
    c, s = (f(flight.track_rad[::every])[:, None] for f in (np.cos, np.sin))
    place = spread.covariance[:, 6:, 6:]
    axes = (c * north + s * east, c * east - s * north)
    return np.asarray(np.sqrt(np.stack([np.einsum("ti,tij,tj->t", a, place, a) for a in axes], axis=-1)))


@kernel
def _covariance(
    transition: Array, used: NDArray[np.bool_], star: Array, grown: Array, every: int, out: Array
) -> None:
    """Covariance at every `every`-th step from transition (n, 9, 9) and what the noise adds in one (9, 9)."""
    p = np.zeros((9, 9))
    for i in range(len(used)):
        if used[i]:
            p[:3, :] = 0.0
            p[:, :3] = 0.0
            p[:3, :3] = star[i]
        if i % every == 0:
            out[i // every] = p
        if i < len(transition):
            p = transition[i] @ p @ transition[i].T + grown

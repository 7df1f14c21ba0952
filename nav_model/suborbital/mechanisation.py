"""Strapdown INS in inertial axes [B-3], many cases in one call.

Conventions that reproduce star_tracker.md's printed final errors to 0.01 m: RK4 with the flight's step on the
nine direction cosines, velocity and position together; sensor errors evaluated at the RK4 nodes; initial
position and velocity errors are those of the inertial vectors, resolved in the launch site's north, east,
down; the initial attitude error is the rotation exp([psi x]). The aided INS takes the star camera's
attitude at the start of a step and carries it through that step with its gyros.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.compiled import kernel, part
from nav_model.earth.gravity import field_kernel, zonals
from nav_model.earth.rotation import matrix_from_vector
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.errors import ErrorSet, require_parameters
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.layout import (
    ACCELEROMETERS,
    ATTITUDE,
    BIAS,
    GYROS,
    MATRIX,
    POSITION,
    SLOW_BIAS,
    SLOW_MATRIX,
    VELOCITY,
)
from nav_model.suborbital.runge_kutta import after_step, node_of, state_at

_TOGETHER = 64  # cases in a call of the kernel: between two, progress is told


@dataclass(frozen=True)
class AttitudeFrames:
    """Star-camera attitude for the INS to take: used (n+1,) bool, attitude_bi (n+1, 3, 3) body to inertial,
    and where the camera is noisy the covariance of its error on body axes (n+1, 3, 3), rad²."""

    used: np.ndarray
    attitude_bi: Array = field(repr=False)
    covariance: Array | None = field(default=None, repr=False)


@dataclass(frozen=True)
class InsRun:
    """INS output of c cases at m instants: time_s (m,), position_i and velocity_i (c, m, 3), attitude_bi
    (c, m, 3, 3), all in inertial axes, SI; `index` are the flight's steps at those instants."""

    time_s: Array
    index: np.ndarray
    position_i: Array = field(repr=False)
    velocity_i: Array = field(repr=False)
    attitude_bi: Array = field(repr=False)
    source: str

    def cases(self, which: list[int]) -> InsRun:
        """The run of the cases at these places alone."""
        picked = {name: getattr(self, name)[which] for name in ("position_i", "velocity_i", "attitude_bi")}
        return replace(self, **picked)


@part
def _measured(
    p: Array,
    first: int,
    true: Array,
    noise: Array,
    bias_sine: float,
    matrix_sine: float,
    out: Array,
) -> None:
    """Measure with the cases' faulty accelerometers (``first`` = ACCELEROMETERS) or gyros (GYROS) [B-1], into out
    (3, c)."""
    for a in range(3):
        for case in range(out.shape[1]):
            value = true[a] + noise[a, case] + p[first + BIAS + a, case] + p[first + SLOW_BIAS + a, case] * bias_sine
            for b in range(3):
                k = first + 3 * a + b
                value += (p[MATRIX + k, case] + p[SLOW_MATRIX + k, case] * matrix_sine) * true[b]
            out[a, case] = value


@part
def _inertial_rates(y: Array, f: Array, w: Array, j: Array, dy: Array) -> None:
    """[B-3]; state: direction cosines C_bi by rows (9), inertial velocity (3), inertial position (3)."""
    for case in range(y.shape[1]):
        x, yy, z = y[12, case], y[13, case], y[14, case]
        radius = np.sqrt(x * x + yy * yy + z * z)
        sine = z / radius
        radial, axial = field_kernel(radius, sine, (j[0, case], j[1, case], j[2, case]))
        toward = (radial - axial * sine) / radius
        f0, f1, f2 = f[0, case], f[1, case], f[2, case]
        w0, w1, w2 = w[0, case], w[1, case], w[2, case]
        for a in range(3):
            c0, c1, c2 = y[3 * a, case], y[3 * a + 1, case], y[3 * a + 2, case]
            dy[3 * a, case] = c1 * w2 - c2 * w1
            dy[3 * a + 1, case] = c2 * w0 - c0 * w2
            dy[3 * a + 2, case] = c0 * w1 - c1 * w0
            pull = c0 * f0 + c1 * f1 + c2 * f2 + toward * y[12 + a, case]
            dy[9 + a, case] = pull + axial if a == 2 else pull
            dy[12 + a, case] = y[9 + a, case]


@kernel
def _run(
    start: Array,
    p: Array,
    force: Array,
    rate: Array,
    sines: Array,
    noise: Array,
    noisy: bool,
    used: NDArray[np.bool_],
    frames: Array,
    seen: NDArray[np.int64],
    j: Array,
    h: float,
    every: int,
    out: Array,
) -> None:
    """All cases over the whole flight; `out` (m, 15, c) takes the states at every `every`-th step.

    Cases come last in every array, start (15, c), p (61, c), j (3, c): the processor takes several at once. Those
    with a star tracker have their camera's row of used (k, n+1) and frames (k, n+1, 3, 3) in seen (c,), others -1.
    """
    n, cases = force.shape[0], start.shape[1]
    y, k = start.copy(), np.empty((4, 15, cases))
    f, w = np.empty((3, 3, cases)), np.empty((3, 3, cases))
    felt = np.zeros((6, cases))
    for i in range(n + 1):
        for case in range(cases):
            if seen[case] >= 0 and used[seen[case], i]:
                for a in range(3):
                    for b in range(3):
                        y[3 * a + b, case] = frames[seen[case], i, a, b]
        if i % every == 0:
            out[i // every] = y
        if i == n:
            break
        if noisy:
            for case in range(cases):
                for a in range(6):
                    felt[a, case] = noise[case, i, a]
        for node in range(3):
            s = sines[2 * i + node]
            _measured(p, ACCELEROMETERS, force[i, node], felt[:3], s[0], s[1], f[node])
            _measured(p, GYROS, rate[i, node], felt[3:], s[2], s[3], w[node])
        for slope in range(4):
            node = node_of(slope)
            _inertial_rates(state_at(y, k, slope, h), f[node], w[node], j, k[slope])
        y = after_step(y, k, h)


def oscillations(flight: TrueFlight, errors: ErrorSet) -> Array:
    """sin(2 pi t / T) at every half step, (2n+1, 4): accelerometer bias, matrix, gyro bias, matrix [B-1]."""
    periods = np.array(
        [
            errors.accelerometers.bias_period_s,
            errors.accelerometers.matrix_period_s,
            errors.gyros.bias_period_s,
            errors.gyros.matrix_period_s,
        ]
    )
    half_time = 0.5 * flight.step_s * np.arange(2 * flight.steps + 1)
    return np.asarray(np.sin(2.0 * np.pi * half_time[:, None] / periods))


def _initial_states(flight: TrueFlight, parameters: Array) -> Array:
    launch = local_axes(flight.position_i[0])
    position = flight.position_i[0] + parameters[:, POSITION] @ launch.T
    velocity = flight.velocity_i[0] + parameters[:, VELOCITY] @ launch.T
    attitude = matrix_from_vector(parameters[:, ATTITUDE] @ launch.T) @ flight.attitude_bi[0]
    return np.concatenate([attitude.reshape(-1, 9), velocity, position], axis=1)


def _cameras(
    frames: Sequence[AttitudeFrames | None],
) -> tuple[NDArray[np.bool_], Array, NDArray[np.int64]]:
    """The frames that cases take, each once: used (k, n+1), attitudes (k, n+1, 3, 3) and
    each case's row of them (c,), -1 without."""
    cameras = {id(each): each for each in frames if each is not None}
    place = {name: row for row, name in enumerate(cameras)}
    seen = np.array([-1 if each is None else place[id(each)] for each in frames])
    if not cameras:
        return np.zeros((1, 1), dtype=np.bool_), np.zeros((1, 1, 3, 3)), seen
    return (
        np.stack([each.used for each in cameras.values()]),
        np.stack([each.attitude_bi for each in cameras.values()]),
        seen,
    )


def mechanise(
    flight: TrueFlight,
    parameters: Array,
    errors: ErrorSet,
    *,
    frames: Sequence[AttitudeFrames | None] | None = None,
    noise: Array | None = None,
    gravity: str | Sequence[str] = "spherical",
    every: int = 10,
    progress: Callable[[float], None] | None = None,
) -> InsRun:
    """Run the INS over a flight for c cases.

    Parameters
    ----------
    flight : TrueFlight
        Of n steps.
    parameters : array (c, 61)
        Errors of each case, in the order of `layout` (star tracker entries are not read: they are in the frames).
    errors : ErrorSet
        Periods of the oscillating terms.
    frames : sequence, optional
        One entry per case, None for a pure INS.
    noise : array (c, n, 6), optional
        Added specific force and angular rate [m/s², rad/s], held over each step.
    gravity : str or sequence of str, optional
        The model the INS believes in, of all cases or one each.
    every : int, optional
        Steps between outputs, a divisor of n.
    progress : callable, optional
        Takes the share done.

    Raises
    ------
    InputError
        Where `every` does not divide the flight.
    """
    parameters = np.ascontiguousarray(np.atleast_2d(parameters), dtype=np.float64)
    count, n = len(parameters), flight.steps
    models = (gravity,) * count if isinstance(gravity, str) else tuple(gravity)
    frames = (None,) * count if frames is None else frames
    require_parameters(parameters)
    flight.require_spacing(every)
    j, sines = np.array([zonals(model) for model in models]).T, oscillations(flight, errors)
    starts = _initial_states(flight, parameters)
    used, attitudes, seen = _cameras(frames)
    out = np.empty((count, n // every + 1, 15))
    for first in range(0, count, _TOGETHER):
        some = slice(first, min(first + _TOGETHER, count))
        states = np.empty((n // every + 1, 15, some.stop - first))
        _run(
            np.ascontiguousarray(starts[some].T),
            np.ascontiguousarray(parameters[some].T),
            flight.specific_force_b,
            flight.angular_rate_b,
            sines,
            np.zeros((1, 1, 6)) if noise is None else noise[some],
            noise is not None,
            used,
            attitudes,
            seen[some],
            np.ascontiguousarray(j[:, some]),
            flight.step_s,
            every,
            states,
        )
        out[some] = np.moveaxis(states, -1, 0)
        if progress is not None:
            progress(some.stop / count)
    index = np.arange(0, n + 1, every)
    believed = " and ".join(dict.fromkeys(models))
    return InsRun(
        time_s=flight.time_s[index],
        index=index,
        position_i=out[..., 12:],
        velocity_i=out[..., 9:12],
        attitude_bi=out[..., :9].reshape(*out.shape[:2], 3, 3),
        source=f"INS in inertial axes [B-3], sensor errors [B-1], {believed} gravity; {flight.source}",
    )

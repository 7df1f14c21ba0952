"""Sensor errors [B-1] and initial errors of the suborbital INS, as inputs and as one parameter vector.

    df = B_a + (S_a + N_a) f + w_a,   domega = B_g + (S_g + N_g) omega + w_g
    each parameter = constant + oscillation X_o sin(2 pi t / T)

The deterministic part is linear in its numbers, which `parameter_vector` lists in one order. An error source
is a group of entries of that vector (`SOURCES`), a class of the study a union of groups (`CLASSES`), so one
case differs from another only by a mask, and a slider is a factor on some entries.
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.base.units import to_si
from nav_model.suborbital.layout import (
    ACCELEROMETERS,
    ATTITUDE,
    BIAS,
    CAMERA,
    COUNT,
    GYROS,
    LATENCY,
    MATRIX,
    POSITION,
    SENSORS,
    SLOW_BIAS,
    SLOW_MATRIX,
    VELOCITY,
)

Triple = tuple[float, float, float]
Matrix = tuple[Triple, Triple, Triple]

MISALIGNMENT_PATTERN: Matrix = ((0.0, 1.0, -1.0), (-1.0, 0.0, 1.0), (1.0, -1.0, 0.0))
"""The antisymmetric pattern "mis" of the set GP-1."""


def scale_and_misalignment(size: float) -> Matrix:
    """S + N of the set GP-1, dimensionless: scale factors and misalignments of one size."""
    m = size * (np.eye(3) + np.array(MISALIGNMENT_PATTERN))
    rows = [(float(row[0]), float(row[1]), float(row[2])) for row in m]
    return rows[0], rows[1], rows[2]


def scale_matrix(scale: tuple[float, ...], misalignment: tuple[float, ...]) -> Matrix:
    """S + N from scale factors (x, y, z) and misalignments by rows (xy, xz, yx, yz, zx, zy)."""
    (x, y, z), (xy, xz, yx, yz, zx, zy) = scale, misalignment
    return (x, xy, xz), (yx, y, yz), (zx, zy, z)


def diagonal(matrix: Matrix) -> tuple[float, ...]:
    """The scale factors (x, y, z) of S + N."""
    return tuple(matrix[k][k] for k in range(3))


def off_diagonal(matrix: Matrix) -> tuple[float, ...]:
    """The misalignments of S + N by rows (xy, xz, yx, yz, zx, zy)."""
    return tuple(matrix[i][j] for i in range(3) for j in range(3) if i != j)


@dataclass(frozen=True)
class SensorErrors:
    """Errors of one triad [B-1], SI (m/s² or rad/s for biases, dimensionless matrices acting on the input).

    white_noise is the one-sided root spectral density: m/s²/√Hz = m/s/√s, or rad/√s.
    """

    constant_bias: Triple = (0.0, 0.0, 0.0)
    oscillating_bias: Triple = (0.0, 0.0, 0.0)
    bias_period_s: float = 1500.0
    constant_matrix: Matrix = ((0.0, 0.0, 0.0),) * 3
    oscillating_matrix: Matrix = ((0.0, 0.0, 0.0),) * 3
    matrix_period_s: float = 1500.0
    white_noise: float = 0.0


@dataclass(frozen=True)
class InitialErrors:
    """Errors at lift-off, estimate minus truth, components in the launch site's north, east, down axes.

    Position and velocity are errors of the inertial position and velocity vectors; attitude is the rotation
    vector psi of C_est = exp([psi x]) C.
    """

    position_m: Triple = (0.0, 0.0, 0.0)
    velocity_m_s: Triple = (0.0, 0.0, 0.0)
    attitude_rad: Triple = (0.0, 0.0, 0.0)


def _triple(values: tuple[float, float, float], unit: str, dimension: str) -> Triple:
    """Converted with one rounding, so that a value written in its unit gives the same number."""
    x, y, z = (to_si(Fraction(repr(value)), unit, dimension) for value in values)
    return x, y, z


GP1_ACCELEROMETERS = SensorErrors(
    constant_bias=_triple((1.0, 0.9, -1.1), "mg", "acceleration"),
    oscillating_bias=_triple((-0.8, 0.4, 0.8), "mg", "acceleration"),
    bias_period_s=1500.0,
    constant_matrix=scale_and_misalignment(1e-4),
    oscillating_matrix=scale_and_misalignment(3e-5),
    matrix_period_s=1500.0,
    white_noise=1e-3,
)
GP1_GYROS = SensorErrors(
    constant_bias=_triple((3.0, 4.0, 2.0), "°/h", "angular rate"),
    oscillating_bias=_triple((0.3, 0.3, 0.3), "°/h", "angular rate"),
    bias_period_s=600.0,
    constant_matrix=scale_and_misalignment(1e-4),
    oscillating_matrix=scale_and_misalignment(3e-5),
    matrix_period_s=600.0,
    white_noise=to_si(Fraction("0.02"), "°/√h", "angle random walk"),
)
GP1_INITIAL = InitialErrors(
    position_m=(20.0, -20.0, -50.0),
    velocity_m_s=(0.1, 0.1, -0.1),
    attitude_rad=_triple((60.0, 60.0, 60.0), "arcsec", "angle"),
)


@dataclass(frozen=True)
class ErrorSet:
    """All errors of the INS. The default is the set GP-1 (X) of star_tracker.md."""

    accelerometers: SensorErrors = GP1_ACCELEROMETERS
    gyros: SensorErrors = GP1_GYROS
    initial: InitialErrors = GP1_INITIAL


def parameter_vector(errors: ErrorSet, misalignment_rad: Triple = (0.0, 0.0, 0.0), latency_s: float = 0.0) -> Array:
    """The deterministic errors as one vector, (61,), in the order of `layout`; star tracker entries last."""
    parts: list[Array] = []
    for sensor in (errors.accelerometers, errors.gyros):
        parts += [
            np.array(sensor.constant_bias),
            np.array(sensor.oscillating_bias),
            np.array(sensor.constant_matrix).ravel(),
            np.array(sensor.oscillating_matrix).ravel(),
        ]
    initial = errors.initial
    parts += [np.array(initial.position_m), np.array(initial.velocity_m_s), np.array(initial.attitude_rad)]
    return np.concatenate([*parts, np.array(misalignment_rad), [latency_s]])


def require_parameters(parameters: Array) -> None:
    """InputError unless parameter vectors are (cases, 61)."""
    if parameters.shape[1] != COUNT:
        raise InputError("parameters", f"has shape {parameters.shape}; it must be (cases, {COUNT})")


def _of(sensor: int, kind: int) -> slice:
    return slice(sensor + kind, sensor + kind + (3 if kind in (BIAS, SLOW_BIAS) else 9))


SOURCES: dict[str, tuple[slice, ...]] = {
    **{
        f"{name} {part}": (_of(first, kind),)
        for name, first in (("accelerometer", ACCELEROMETERS), ("gyro", GYROS))
        for part, kind in (
            ("constant bias", BIAS),
            ("constant scale factor and misalignment", MATRIX),
            ("oscillating bias", SLOW_BIAS),
            ("oscillating scale factor and misalignment", SLOW_MATRIX),
        )
    },
    "initial position": (POSITION,),
    "initial velocity": (VELOCITY,),
    "star tracker misalignment": (slice(CAMERA, LATENCY),),
    "star tracker latency": (slice(LATENCY, COUNT),),
}
"""Error sources one at a time (initial attitude is a class of its own)."""

CLASSES: dict[str, tuple[slice, ...]] = {
    "accelerometer bias": (_of(ACCELEROMETERS, BIAS), _of(ACCELEROMETERS, MATRIX)),
    "accelerometer instability": (_of(ACCELEROMETERS, SLOW_BIAS), _of(ACCELEROMETERS, SLOW_MATRIX)),
    "accelerometer total": (slice(ACCELEROMETERS, GYROS),),
    "gyro bias": (_of(GYROS, BIAS), _of(GYROS, MATRIX)),
    "gyro instability": (_of(GYROS, SLOW_BIAS), _of(GYROS, SLOW_MATRIX)),
    "gyro total": (slice(GYROS, SENSORS.stop),),
    "initial position and velocity": (POSITION, VELOCITY),
    "initial attitude": (ATTITUDE,),
    "all": (slice(0, COUNT),),
}
"""Classes of the study: "bias" is every constant term, "instability" every time-dependent one (the white
noise, which is random, is reported beside it as a standard deviation)."""


def mask(group: tuple[slice, ...]) -> Array:
    """Ones at the entries of a group, zeros elsewhere, (61,)."""
    out = np.zeros(COUNT)
    for part in group:
        out[part] = 1.0
    return out

"""A GNSS fix: what the receiver reports, the filter's update with it, and the correction of the INS."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel, part
from nav_model.base.constants import EARTH_RATE
from nav_model.earth.rotation import normalise, rotate
from nav_model.earth.wgs84 import curvature_radii_kernel
from nav_model.simulation.kalman import update
from nav_model.simulation.layout import (
    ATTITUDE,
    BIASES,
    GYRO,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    POSITION,
    QUATERNION,
    TRIADS,
    VELOCITY,
)

FloatArray = NDArray[np.float64]


class Truth(NamedTuple):
    """True states at some epochs, as the kernel reads them; see `TruthStates`."""

    position: FloatArray
    velocity: FloatArray
    matrix: FloatArray
    body_rate: FloatArray


class Receiver(NamedTuple):
    """The receiver's noise: white sigmas (fixes, 3), Gauss-Markov sigmas (3) and time, velocity sigmas (3, or none),
    lever arm."""

    white: FloatArray
    markov: FloatArray
    markov_time: float
    velocity: FloatArray
    lever_arm: FloatArray


class Tuning(NamedTuple):
    """What the filter assumes.

    White densities; variance of one sample's rate [rad^2/s^2], which acts on the lever arm; bias decay [1/s]
    and drive (12); sigmas of a fix: position (fixes, 3), velocity (3, or none).
    """

    accelerometer_density: float
    gyro_density: float
    rate_variance: float
    decay_rate: FloatArray
    bias_drive: FloatArray
    position_sigma: FloatArray
    velocity_sigma: FloatArray


@part
def take_fix(
    state: FloatArray,
    truth: Truth,
    fix: int,
    receiver: Receiver,
    markov: FloatArray,
    rate: FloatArray,
    matrix: FloatArray,
    covariance: FloatArray,
    tuning: Tuning,
    generator: np.random.Generator,
    estimate: FloatArray,
    work: FloatArray,
    error: FloatArray,
) -> float:
    """Simulate one fix, update the filter with it; leaves the error estimate in `estimate` and the position error
    of the fix (3) in `error`, returns the NIS.

    rate: the INS's bias-corrected inertial rate, body axes [rad/s]. Residuals are predicted minus measured.
    """
    n = covariance.shape[0]
    # Rows of `work` beyond those of `update`.
    row, lever, swing, cross = work[3, 0], work[3, 1], work[3, 2], work[3, 3]
    sin_lat, cos_lat = math.sin(state[LATITUDE]), math.cos(state[LATITUDE])
    meridian, prime = curvature_radii_kernel(sin_lat)
    arm = receiver.lever_arm
    for i in range(3):
        lever[i] = matrix[i, 0] * arm[0] + matrix[i, 1] * arm[1] + matrix[i, 2] * arm[2]
    for i in range(n):
        estimate[i] = 0.0
    nis = 0.0
    for i in range(3):
        if i == 0:
            residual = (state[LATITUDE] - truth.position[fix, 0]) * (meridian + state[HEIGHT])
        elif i == 1:
            residual = (state[LONGITUDE] - truth.position[fix, 1]) * (prime + state[HEIGHT]) * cos_lat
        else:
            residual = truth.position[fix, 2] - state[HEIGHT]
        true_lever = 0.0
        for j in range(3):
            true_lever += truth.matrix[fix, i, j] * arm[j]
        _observe(row, n, POSITION + i, i, lever)
        noise = receiver.white[fix, i] * generator.standard_normal() + markov[i]
        error[i] = noise
        residual += lever[i] - true_lever
        nis += update(covariance, row, residual - noise, tuning.position_sigma[fix, i] ** 2, estimate, work)
    if len(receiver.velocity) > 0:
        for i in range(3):
            # The rate against the Earth, body axes, turned by the arm.
            j, k = (i + 1) % 3, (i + 2) % 3
            earth_j = EARTH_RATE * (cos_lat * matrix[0, j] - sin_lat * matrix[2, j])
            earth_k = EARTH_RATE * (cos_lat * matrix[0, k] - sin_lat * matrix[2, k])
            cross[i] = (rate[j] - earth_j) * arm[k] - (rate[k] - earth_k) * arm[j]
        for i in range(3):
            swing[i] = matrix[i, 0] * cross[0] + matrix[i, 1] * cross[1] + matrix[i, 2] * cross[2]
        for i in range(3):
            true_swing = 0.0
            for axis in range(3):
                j, k = (axis + 1) % 3, (axis + 2) % 3
                turn = truth.body_rate[fix, j] * arm[k] - truth.body_rate[fix, k] * arm[j]
                true_swing += truth.matrix[fix, i, axis] * turn
            _observe(row, n, VELOCITY + i, i, swing)
            # A rate error, bias or noise, acts on the lever arm: C (-dw x l) = C [l x] dw, row i.
            x = matrix[i, 1] * arm[2] - matrix[i, 2] * arm[1]
            y = matrix[i, 2] * arm[0] - matrix[i, 0] * arm[2]
            z = matrix[i, 0] * arm[1] - matrix[i, 1] * arm[0]
            for gyro in range(BIASES + GYRO, n, TRIADS):
                row[gyro], row[gyro + 1], row[gyro + 2] = x, y, z
            variance = tuning.velocity_sigma[i] ** 2 + tuning.rate_variance * (x * x + y * y + z * z)
            difference = state[VELOCITY + i] + swing[i] - truth.velocity[fix, i] - true_swing
            noise = receiver.velocity[i] * generator.standard_normal()
            nis += update(covariance, row, difference - noise, variance, estimate, work)
    return nis


@part
def _observe(row: FloatArray, n: int, state: int, axis: int, arm: FloatArray) -> None:
    """H (n) of one component: 1 at its own state, and the row `axis` of [arm x] at the attitude's."""
    for i in range(n):
        row[i] = 0.0
    row[state] = 1.0
    j, k = (axis + 1) % 3, (axis + 2) % 3
    row[ATTITUDE + j], row[ATTITUDE + k] = -arm[k], arm[j]


@kernel
def correct(state: FloatArray, bias: FloatArray, estimate: FloatArray) -> None:
    """Take the estimated error out of the navigation state and the bias estimates (12)."""
    meridian, prime = curvature_radii_kernel(math.sin(state[LATITUDE]))
    state[LONGITUDE] -= estimate[POSITION + 1] / ((prime + state[HEIGHT]) * math.cos(state[LATITUDE]))
    state[LATITUDE] -= estimate[POSITION] / (meridian + state[HEIGHT])
    state[HEIGHT] += estimate[POSITION + 2]
    for i in range(3):
        state[VELOCITY + i] -= estimate[VELOCITY + i]
    quaternion = state[QUATERNION : QUATERNION + 4]
    rotate(quaternion, 0.0, 0.0, 0.0, estimate[ATTITUDE], estimate[ATTITUDE + 1], estimate[ATTITUDE + 2])
    normalise(quaternion)
    for i in range(len(estimate) - BIASES):
        bias[i] -= estimate[BIASES + i]

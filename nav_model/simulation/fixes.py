"""A GNSS fix: what the receiver reports, the filter's update with it, and the correction of the INS."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.compiled import kernel
from nav_model.constants import EARTH_RATE
from nav_model.earth.rotation import normalise, rotate
from nav_model.earth.wgs84 import curvature_radii_kernel
from nav_model.simulation.kalman import update

FloatArray = NDArray[np.float64]


class Truth(NamedTuple):
    """True states at some epochs, as the kernel reads them; see `TruthStates`."""

    position: FloatArray
    velocity: FloatArray
    matrix: FloatArray
    body_rate: FloatArray


class Receiver(NamedTuple):
    """The receiver's noise: white sigmas (3), Gauss-Markov sigmas (3) and time, velocity sigma (0: none),
    lever arm."""

    white: FloatArray
    markov: FloatArray
    markov_time: float
    velocity: float
    lever_arm: FloatArray


class Tuning(NamedTuple):
    """What the filter believes.

    White densities; variance of one sample's rate [rad^2/s^2], which swings the lever arm; bias decay [1/s]
    and drive (12); sigmas of a fix: position (3), velocity.
    """

    accelerometer_density: float
    gyro_density: float
    rate_variance: float
    decay_rate: FloatArray
    bias_drive: FloatArray
    position_sigma: FloatArray
    velocity_sigma: float


@kernel
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
    row = np.zeros(n)
    meridian, prime = curvature_radii_kernel(np.sin(state[0]))
    cos_lat = np.cos(state[0])
    true_position, true_matrix = truth.position[fix], truth.matrix[fix]
    residual = np.empty(3)
    residual[0] = (state[0] - true_position[0]) * (meridian + state[2])
    residual[1] = (state[1] - true_position[1]) * (prime + state[2]) * cos_lat
    residual[2] = true_position[2] - state[2]
    arm = receiver.lever_arm
    lever = matrix @ arm
    residual += lever - true_matrix @ arm
    estimate[:] = 0.0
    nis = 0.0
    for i in range(3):
        row[:] = 0.0
        row[i] = 1.0
        j, k = (i + 1) % 3, (i + 2) % 3
        row[6 + j], row[6 + k] = -lever[k], lever[j]
        noise = receiver.white[i] * generator.standard_normal() + markov[i]
        error[i] = noise
        nis += update(covariance, row, residual[i] - noise, tuning.position_sigma[i] ** 2, estimate, work)
    if receiver.velocity > 0.0:
        earth = np.array([EARTH_RATE * cos_lat, 0.0, -EARTH_RATE * np.sin(state[0])])
        swing = matrix @ np.cross(rate - matrix.T @ earth, arm)
        true_swing = true_matrix @ np.cross(truth.body_rate[fix], arm)
        for i in range(3):
            row[:] = 0.0
            row[3 + i] = 1.0
            j, k = (i + 1) % 3, (i + 2) % 3
            row[6 + j], row[6 + k] = -swing[k], swing[j]
            # A rate error, bias or noise, swings the arm: C (-dw x l) = C [l x] dw, row i.
            x = matrix[i, 1] * arm[2] - matrix[i, 2] * arm[1]
            y = matrix[i, 2] * arm[0] - matrix[i, 0] * arm[2]
            z = matrix[i, 0] * arm[1] - matrix[i, 1] * arm[0]
            for gyro in range(12, n, 6):
                row[gyro], row[gyro + 1], row[gyro + 2] = x, y, z
            variance = tuning.velocity_sigma**2 + tuning.rate_variance * (x * x + y * y + z * z)
            difference = state[3 + i] + swing[i] - truth.velocity[fix, i] - true_swing[i]
            noise = receiver.velocity * generator.standard_normal()
            nis += update(covariance, row, difference - noise, variance, estimate, work)
    return nis


@kernel
def correct(state: FloatArray, bias: FloatArray, estimate: FloatArray) -> None:
    """Take the estimated error out of the navigation state and the bias estimates (12)."""
    meridian, prime = curvature_radii_kernel(np.sin(state[0]))
    state[1] -= estimate[1] / ((prime + state[2]) * np.cos(state[0]))
    state[0] -= estimate[0] / (meridian + state[2])
    state[2] += estimate[2]
    for i in range(3):
        state[3 + i] -= estimate[3 + i]
    rotate(state[6:10], 0.0, 0.0, 0.0, estimate[6], estimate[7], estimate[8])
    normalise(state[6:10])
    for i in range(len(estimate) - 9):
        bias[i] -= estimate[9 + i]

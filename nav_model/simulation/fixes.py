"""A fix: what the sensors report, what it measures, the filter's update with it, and the correction of the INS."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel, part
from nav_model.base.constants import EARTH_RATE
from nav_model.earth.rotation import normalise, rotate
from nav_model.earth.wgs84 import curvature_radii_kernel, metres_per_radian
from nav_model.simulation.kalman import update
from nav_model.simulation.layout import (
    ATTITUDE,
    BAROMETER,
    BIASES,
    GYRO,
    HEADING,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    MEASURED,
    POSITION,
    QUATERNION,
    TRIADS,
    VELOCITY,
)
from nav_model.simulation.truth import TruthStates

FloatArray = NDArray[np.float64]


class FilterTuning(NamedTuple):
    """Assumptions of the filter: white densities of the IMU; variance of one sample's rate [rad^2/s^2], which acts on
    the lever arm; decay [1/s] and drive of its states beyond the first nine; sigma of the slow error of the fixes (3)
    [m], which has states where the filter knows it; and of the residual biases [m/s²], [rad/s], which act while no
    fix comes."""

    accelerometer_density: float
    gyro_density: float
    rate_variance: float
    decay_rate: FloatArray
    drive: FloatArray
    slow_sigma: FloatArray
    residual_accelerometer: float
    residual_gyro: float


def reported(truth: TruthStates, noise: FloatArray, arm: FloatArray) -> FloatArray:
    """Reports of the sensors at the fixes (n, MEASURED): latitude, longitude [rad], height and velocity of an
    antenna that is `arm` from the IMU, heading, and the barometer's height.

    truth: at the times that the receiver takes for those of the fixes. noise: (n, MEASURED), NED.
    """
    arm_n = truth.matrix @ arm
    swing = np.einsum("kij,kj->ki", truth.matrix, np.cross(truth.body_rate, arm))
    latitude, _, height = truth.position.T
    scale = np.column_stack([*metres_per_radian(latitude, height), np.full(len(height), -1.0)])
    position = truth.position + (arm_n + noise[:, POSITION : POSITION + 3]) / scale
    velocity = truth.velocity + swing + noise[:, VELOCITY : VELOCITY + 3]
    both = truth.euler[:, 2] + noise[:, HEADING], height - noise[:, BAROMETER]
    return np.column_stack([position, velocity, *both])


@kernel
def first_order(factors: FloatArray, values: FloatArray) -> None:
    """First-order Gauss-Markov processes (n, axes), in place of what each step adds, with the `factors` (n) of the
    value before."""
    for k in range(1, len(values)):
        for i in range(values.shape[1]):
            values[k, i] += factors[k] * values[k - 1, i]


@kernel
def observe(
    matrix: FloatArray, arm: FloatArray, body_rate: FloatArray, lever: FloatArray, swing: FloatArray, rows: FloatArray
) -> None:
    """Write what a fix measures of the filter's error states.

    Parameters
    ----------
    matrix : array (3, 3)
        Body to north, east, down.
    arm : array (3,)
        Antenna from the IMU, body axes, m.
    body_rate : array (3,)
        Against the Earth, body axes, rad/s.
    lever, swing : array (3,)
        Take the arm and its velocity, north, east, down.
    rows : array (MEASURED or more, n)
        The first MEASURED take the rows of H, n states each.
    """
    n = rows.shape[1]
    for i in range(MEASURED):
        for j in range(n):
            rows[i, j] = 0.0
    for i in range(3):
        lever[i] = matrix[i, 0] * arm[0] + matrix[i, 1] * arm[1] + matrix[i, 2] * arm[2]
        swing[i] = 0.0
        for axis in range(3):
            j, k = (axis + 1) % 3, (axis + 2) % 3
            swing[i] += matrix[i, axis] * (body_rate[j] * arm[k] - body_rate[k] * arm[j])
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[POSITION + i, POSITION + i], rows[VELOCITY + i, VELOCITY + i] = 1.0, 1.0
        # Row i of [lever x] and [swing x].
        rows[POSITION + i, ATTITUDE + j], rows[POSITION + i, ATTITUDE + k] = -lever[k], lever[j]
        rows[VELOCITY + i, ATTITUDE + j], rows[VELOCITY + i, ATTITUDE + k] = -swing[k], swing[j]
        # A rate error, bias or noise, acts on the lever arm: C (-dw x l) = C [l x] dw.
        for first in range(BIASES + GYRO, n, TRIADS):
            for axis in range(3):
                j, k = (axis + 1) % 3, (axis + 2) % 3
                rows[VELOCITY + i, first + axis] = matrix[i, j] * arm[k] - matrix[i, k] * arm[j]
    # Heading: the last row of `euler_error_map`.
    level = matrix[0, 0] ** 2 + matrix[1, 0] ** 2
    rows[HEADING, ATTITUDE] = matrix[2, 0] * matrix[0, 0] / level
    rows[HEADING, ATTITUDE + 1] = matrix[2, 0] * matrix[1, 0] / level
    rows[HEADING, ATTITUDE + 2] = -1.0
    rows[BAROMETER, POSITION + 2] = 1.0


@part
def take_fix(
    state: FloatArray,
    report: FloatArray,
    variance: FloatArray,
    arm: FloatArray,
    rate: FloatArray,
    matrix: FloatArray,
    covariance: FloatArray,
    tuning: FilterTuning,
    slow: FloatArray,
    estimate: FloatArray,
    work: FloatArray,
) -> float:
    """Update the filter with what was reported at a fix; returns the NIS. Residuals are predicted minus measured.

    Parameters
    ----------
    state : array
        Navigation state.
    report, variance : array (MEASURED,)
        As `reported` gives them and the filter assumes, infinite for what did not come.
    arm : array (3,)
        Antenna from the IMU, body axes, m.
    rate : array (3,)
        The INS's bias-corrected inertial rate, body axes, rad/s.
    matrix : array (3, 3)
        Body to north, east, down.
    covariance : array (n, n)
        The filter's, updated in place.
    tuning : FilterTuning
        Assumptions of the filter.
    slow : array (3,) or (0,)
        The filter's estimate of the slow error over its sigma, north, east, down; empty where it does not know it.
    estimate : array (n,)
        Takes the error estimate.
    work : array (4, n, n)
        Working space.
    """
    # Parts of `work` that `update` does not use.
    rows, lever, swing, body_rate, residual = work[3], work[2, 0], work[2, 1], work[2, 2], work[2, 3]
    sin_lat, cos_lat = math.sin(state[LATITUDE]), math.cos(state[LATITUDE])
    for i in range(3):
        body_rate[i] = rate[i] - EARTH_RATE * (cos_lat * matrix[0, i] - sin_lat * matrix[2, i])
    observe(matrix, arm, body_rate, lever, swing, rows)
    meridian, prime = curvature_radii_kernel(sin_lat)
    residual[0] = (state[LATITUDE] - report[0]) * (meridian + state[HEIGHT]) + lever[0]
    residual[1] = (state[LONGITUDE] - report[1]) * (prime + state[HEIGHT]) * cos_lat + lever[1]
    residual[2] = report[2] - state[HEIGHT] + lever[2]
    for i in range(3):
        if len(slow) > 0:
            rows[POSITION + i, len(estimate) - len(slow) + i] = tuning.slow_sigma[i]
            residual[POSITION + i] += tuning.slow_sigma[i] * slow[i]
        residual[VELOCITY + i] = state[VELOCITY + i] + swing[i] - report[VELOCITY + i]
    change = math.atan2(matrix[1, 0], matrix[0, 0]) - report[HEADING]
    residual[HEADING] = change - 2.0 * math.pi * math.floor(change / (2.0 * math.pi) + 0.5)
    residual[BAROMETER] = report[BAROMETER] - state[HEIGHT]
    squared = arm[0] ** 2 + arm[1] ** 2 + arm[2] ** 2
    for i in range(len(estimate)):
        estimate[i] = 0.0
    nis = 0.0
    for i in range(MEASURED):
        if variance[i] < np.inf:
            of_rate = tuning.rate_variance * (squared - lever[i - VELOCITY] ** 2) if VELOCITY <= i < HEADING else 0.0
            nis += update(covariance, rows[i], residual[i], variance[i] + of_rate, estimate, work)
    return nis


@kernel
def correct(state: FloatArray, bias: FloatArray, slow: FloatArray, estimate: FloatArray) -> None:
    """Take the estimated error out of the navigation state and the filter's further estimates.

    Parameters
    ----------
    state : array
        Navigation state.
    bias : array (12,)
        Estimates of biases.
    slow : array (3,) or (0,)
        Estimate of the slow error.
    estimate : array (n,)
        Error estimate of `take_fix`.
    """
    meridian, prime = curvature_radii_kernel(math.sin(state[LATITUDE]))
    state[LONGITUDE] -= estimate[POSITION + 1] / ((prime + state[HEIGHT]) * math.cos(state[LATITUDE]))
    state[LATITUDE] -= estimate[POSITION] / (meridian + state[HEIGHT])
    state[HEIGHT] += estimate[POSITION + 2]
    for i in range(3):
        state[VELOCITY + i] -= estimate[VELOCITY + i]
    quaternion = state[QUATERNION : QUATERNION + 4]
    rotate(quaternion, 0.0, 0.0, 0.0, estimate[ATTITUDE], estimate[ATTITUDE + 1], estimate[ATTITUDE + 2])
    normalise(quaternion)
    inertial = len(estimate) - len(slow)
    for i in range(inertial - BIASES):
        bias[i] -= estimate[BIASES + i]
    for i in range(len(slow)):
        slow[i] -= estimate[inertial + i]

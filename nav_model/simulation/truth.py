"""Outputs of perfect instruments on a trajectory, and the true states that an error-free INS reproduces.

Specific force and angular rate follow from the spline's derivatives and the Earth of `earth`; their
integrals over each IMU sample use two Gauss-Legendre points (fourth order, error about 1e-12 per sample).
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel
from nav_model.base.constants import EARTH_RATE
from nav_model.earth.rotation import matrix_from_euler
from nav_model.earth.wgs84 import ECCENTRICITY_SQUARED, curvature_radii_kernel, normal_gravity_kernel
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import QuinticPath, plan_trajectory

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TruthStates:
    """True states at some epochs, n of them: geodetic position (n, 3), NED velocity (n, 3), body-to-NED (n,
    3, 3).

    `position` holds latitude [rad], longitude [rad], height [m]; `euler` roll, pitch, yaw [rad, unwrapped];
    `body_rate` the body's rate against the Earth, body axes [rad/s].
    """

    time_s: FloatArray
    position: FloatArray
    velocity: FloatArray
    matrix: FloatArray
    euler: FloatArray
    body_rate: FloatArray

    def at(self, epochs: NDArray[np.int64]) -> "TruthStates":
        """The states at some of the epochs, by their indices."""
        return TruthStates(*(values[epochs] for values in vars(self).values()))


@kernel
def _force_and_rate_at(
    origin: FloatArray,
    breaks: FloatArray,
    coefficients: FloatArray,
    times: FloatArray,
    weight: float,
    work: FloatArray,
    out: FloatArray,
) -> None:
    """Sum over each row of increasing `times` (rows, points) of specific force (out[:, 0:3], m/s^2) and inertial rate
    (out[:, 3:6], rad/s), body axes, times `weight`.

    origin, breaks, coefficients: as in `QuinticPath`; work: (3, 6) of working space. One kernel that calls only the
    Earth's, to keep the compile time short.
    """
    value, first, second = work[0], work[1], work[2]
    piece = 0
    for k in range(times.shape[0]):
        for i in range(6):
            out[k, i] = 0.0
        for point in range(times.shape[1]):
            while piece < len(breaks) - 2 and times[k, point] >= breaks[piece + 1]:
                piece += 1
            u = times[k, point] - breaks[piece]
            for i in range(6):
                p, d, dd = coefficients[piece, 0, i], 0.0, 0.0
                for power in range(1, 6):
                    dd = dd * u + 2.0 * d
                    d = d * u + p
                    p = p * u + coefficients[piece, power, i]
                value[i], first[i], second[i] = origin[i] + p, d, dd
            sin_lat, cos_lat = math.sin(value[0]), math.cos(value[0])
            height = value[2]
            meridian, prime = curvature_radii_kernel(sin_lat)
            lat_rate, lon_rate, climb = first[0], first[1], first[2]
            # Derivatives of the two radii with latitude.
            shared = ECCENTRICITY_SQUARED * sin_lat * cos_lat / (1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat)
            meridian_rate, prime_rate = 3.0 * meridian * shared * lat_rate, prime * shared * lat_rate
            north = lat_rate * (meridian + height)
            east_radius = (prime + height) * cos_lat
            east = lon_rate * east_radius
            north_acc = second[0] * (meridian + height) + lat_rate * (meridian_rate + climb)
            east_acc = second[1] * east_radius + lon_rate * (
                (prime_rate + climb) * cos_lat - (prime + height) * sin_lat * lat_rate
            )
            down_acc = -second[2]
            # Rates of the NED frame: Earth's, and Earth's plus transport's.
            earth_n, earth_d = EARTH_RATE * cos_lat, -EARTH_RATE * sin_lat
            frame_n, frame_e, frame_d = earth_n + lon_rate * cos_lat, -lat_rate, earth_d - lon_rate * sin_lat
            a, b, c = earth_n + frame_n, frame_e, earth_d + frame_d
            down = -climb
            force_n = north_acc + b * down - c * east
            force_e = east_acc + c * north - a * down
            force_d = down_acc + a * east - b * north - normal_gravity_kernel(sin_lat, height)
            sr, cr = math.sin(value[3]), math.cos(value[3])
            sp, cp = math.sin(value[4]), math.cos(value[4])
            sy, cy = math.sin(value[5]), math.cos(value[5])
            m00, m01, m02 = cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy
            m10, m11, m12 = cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy
            m20, m21, m22 = -sp, sr * cp, cr * cp
            out[k, 0] += m00 * force_n + m10 * force_e + m20 * force_d
            out[k, 1] += m01 * force_n + m11 * force_e + m21 * force_d
            out[k, 2] += m02 * force_n + m12 * force_e + m22 * force_d
            roll_rate, pitch_rate, yaw_rate = first[3], first[4], first[5]
            out[k, 3] += roll_rate - yaw_rate * sp + m00 * frame_n + m10 * frame_e + m20 * frame_d
            out[k, 4] += pitch_rate * cr + yaw_rate * sr * cp + m01 * frame_n + m11 * frame_e + m21 * frame_d
            out[k, 5] += -pitch_rate * sr + yaw_rate * cr * cp + m02 * frame_n + m12 * frame_e + m22 * frame_d
        for i in range(6):
            out[k, i] *= weight


def specific_force_and_rate(trajectory: QuinticPath, time_s: FloatArray) -> FloatArray:
    """Specific force [m/s^2] and inertial angular rate [rad/s] in body axes at increasing times, shape (n, 6)."""
    return _summed(trajectory, np.array(time_s, dtype=np.float64)[:, None], 1.0)


def _summed(trajectory: QuinticPath, times: FloatArray, weight: float) -> FloatArray:
    """`_force_and_rate_at` for a trajectory, shape (rows, 6)."""
    out = np.empty((len(times), 6))
    path = trajectory.origin, trajectory.breaks, trajectory.coefficients
    _force_and_rate_at(*path, np.ascontiguousarray(times), weight, np.empty((3, 6)), out)
    return out


def true_states(trajectory: QuinticPath, time_s: FloatArray) -> TruthStates:
    """The true state at times of shape (n,)."""
    coordinates = trajectory.evaluate(time_s)
    position, euler = coordinates[:, :3], coordinates[:, 3:]
    matrix = matrix_from_euler(euler[:, 0], euler[:, 1], euler[:, 2])
    inertial = specific_force_and_rate(trajectory, time_s)[:, 3:]
    zero = np.zeros(len(time_s))
    earth = EARTH_RATE * np.column_stack([np.cos(position[:, 0]), zero, -np.sin(position[:, 0])])
    body_rate = inertial - np.einsum("nij,ni->nj", matrix, earth)
    return TruthStates(time_s, position, trajectory.velocity(time_s), matrix, euler, body_rate)


@lru_cache(maxsize=2)
def perfect_increments(spec: TrajectorySpec, duration: float, rate: float) -> FloatArray:
    """Velocity [m/s] and angle [rad] increments of perfect instruments, shape (samples + 2, 6), read-only.

    The first two rows end at time 0: the mechanisation's coning and sculling terms look two samples back.
    """
    trajectory = plan_trajectory(spec, duration)
    step = 1.0 / rate
    middle = (np.arange(-2, round(duration * rate)) + 0.5) * step
    gauss = 0.5 / math.sqrt(3.0) * step
    out = _summed(trajectory, np.stack([middle - gauss, middle + gauss], axis=1), 0.5 * step)
    out.flags.writeable = False
    return out

"""Rotations: direction cosine matrices, quaternions, rotation vectors, Euler angles.

A matrix C or quaternion (w, x, y, z) turns body components into those of the axes the attitude is counted in:
north-east-down in the simulator, inertial axes in the suborbital study. Euler angles are yaw about down, then
pitch, then roll (aerospace order). Angles in rad. The plain functions broadcast over NumPy arrays; the kernels
at the end work in place, inside the simulator's loops.

Source: Shuster, A survey of attitude representations, Journal of the Astronautical Sciences 41, 1993.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.compiled import part


def matrix_of(*elements: ArrayLike) -> Array:
    """Matrices (..., 3, 3) of nine elements, row by row, that broadcast to a common shape."""
    stacked = np.stack(np.broadcast_arrays(*elements), axis=-1)
    return stacked.reshape(*stacked.shape[:-1], 3, 3)


def matrix_from_euler(roll: ArrayLike, pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Matrices Rz(yaw) Ry(pitch) Rx(roll).

    Parameters
    ----------
    roll, pitch, yaw : array_like
        rad, of any shapes that broadcast.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    Examples
    --------
    >>> matrix_from_euler(0.0, 0.0, np.pi / 2).round(12)[:2, 0]  # the nose of an aircraft that heads east
    array([0., 1.])
    """
    sr, cr = np.sin(roll), np.cos(roll)
    sp, cp = np.sin(pitch), np.cos(pitch)
    sy, cy = np.sin(yaw), np.cos(yaw)
    return matrix_of(
        cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy,
        cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy,
        -sp, sr * cp, cr * cp,
    )  # fmt: skip


def euler_error_map(pitch: Array, yaw: Array) -> Array:
    """Matrices (..., 3, 3) taking the filter's attitude error to errors (estimate minus truth) of roll, pitch, yaw.

    The filter's error is psi in C_estimate = (I - [psi x]) C, so the small rotation of the estimate is
    -psi in NED. Singular at a pitch of 90°.
    """
    cy, sy = np.cos(yaw), np.sin(yaw)
    secant, tangent = 1.0 / np.cos(pitch), np.tan(pitch)
    return -matrix_of(cy * secant, sy * secant, 0.0, -sy, cy, 0.0, cy * tangent, sy * tangent, 1.0)


def quaternion_from_matrix(matrix: ArrayLike) -> Array:
    """Unit quaternions (..., 4) of matrices (..., 3, 3), of either sign."""
    return np.asarray(_rotations().from_matrix(matrix, assume_valid=True).as_quat(scalar_first=True))


def matrix_from_vector(vector: ArrayLike) -> Array:
    """exp([v x]), (..., 3, 3), of rotation vectors (..., 3)."""
    return np.asarray(_rotations().from_rotvec(vector).as_matrix())


def vector_from_matrix(matrix: ArrayLike) -> Array:
    """Rotation vectors (..., 3) of matrices (..., 3, 3), no longer than pi: the inverse of `matrix_from_vector`."""
    return np.asarray(_rotations().from_matrix(matrix, assume_valid=True).as_rotvec())


def _rotations() -> Any:
    from scipy.spatial.transform import Rotation  # late: a budget starts without it

    return Rotation


def skew(vector: ArrayLike) -> Array:
    """Matrices [v x] (..., 3, 3) of the cross product with vectors (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=np.float64), -1, 0)
    return matrix_of(0.0, -z, y, z, 0.0, -x, -y, x, 0.0)


@part
def write_matrix(q: Array, out: Array) -> None:
    """Write the 3 x 3 matrix of the unit quaternion `q` into `out`."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0, 0], out[0, 1], out[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    out[1, 0], out[1, 1], out[1, 2] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    out[2, 0], out[2, 1], out[2, 2] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)


@part
def _half_angle(x: float, y: float, z: float) -> tuple[float, float]:
    """cos(a/2) - 1 and sin(a/2)/a of a rotation vector of length a, without loss of digits for small ones."""
    square = x * x + y * y + z * z
    if square < 1e-4:
        return (
            -square / 8.0 * (1.0 - square / 48.0 * (1.0 - square / 120.0)),
            0.5 - square / 48.0 * (1.0 - square / 80.0 * (1.0 - square / 168.0)),
        )
    angle = math.sqrt(square)
    quarter = math.sin(0.25 * angle)
    return -2.0 * quarter * quarter, math.sin(0.5 * angle) / angle


@part
def rotate(q: Array, bx: float, by: float, bz: float, nx: float, ny: float, nz: float) -> None:
    """q <- exp(n) q exp(b): two rotation vectors applied in place.

    The two changes are summed before they meet `q`: where they cancel (a resting INS under the Earth's
    rate) `q` then stays as it is, instead of collecting the same rounding error at every step.

    Parameters
    ----------
    q : array (4,)
        Unit quaternion, body to navigation axes.
    bx, by, bz : float
        Rotation vector in body axes [rad].
    nx, ny, nz : float
        Rotation vector in navigation axes [rad].
    """
    q0, q1, q2, q3 = q[0], q[1], q[2], q[3]
    c, s = _half_angle(bx, by, bz)
    x, y, z = s * bx, s * by, s * bz
    d0 = q0 * c - q1 * x - q2 * y - q3 * z
    d1 = q1 * c + q0 * x + q2 * z - q3 * y
    d2 = q2 * c + q0 * y - q1 * z + q3 * x
    d3 = q3 * c + q0 * z + q1 * y - q2 * x
    c, s = _half_angle(nx, ny, nz)
    x, y, z = s * nx, s * ny, s * nz
    p0, p1, p2, p3 = q0 + d0, q1 + d1, q2 + d2, q3 + d3
    d0 += c * p0 - x * p1 - y * p2 - z * p3
    d1 += c * p1 + x * p0 + y * p3 - z * p2
    d2 += c * p2 + y * p0 + z * p1 - x * p3
    d3 += c * p3 + z * p0 + x * p2 - y * p1
    q[0], q[1], q[2], q[3] = q0 + d0, q1 + d1, q2 + d2, q3 + d3


@part
def normalise(q: Array) -> None:
    """Scale `q` back to unit length: one Newton step, enough where rounding is all there is to remove."""
    excess = 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0)
    for i in range(4):
        q[i] -= excess * q[i]

"""Rotations: quaternions, direction cosine matrices, Euler angles.

A quaternion (w, x, y, z) or matrix `C` here turns body components into navigation (NED) components.
Euler angles are yaw about down, then pitch, then roll (aerospace order), in rad.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.compiled import part

FloatArray = NDArray[np.float64]


def matrix_from_euler(roll: Any, pitch: Any, yaw: Any) -> FloatArray:
    """Body-to-NED matrix, shape (..., 3, 3), from Euler angles of any common shape."""
    sr, cr = np.sin(roll), np.cos(roll)
    sp, cp = np.sin(pitch), np.cos(pitch)
    sy, cy = np.sin(yaw), np.cos(yaw)
    rows = [
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp * np.ones_like(cy), sr * cp, cr * cp],
    ]
    stacked: FloatArray = np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows], axis=-2)
    return stacked


def euler_from_matrix(matrix: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Roll, pitch, yaw of matrices of shape (..., 3, 3)."""
    return (
        np.arctan2(matrix[..., 2, 1], matrix[..., 2, 2]),
        np.arcsin(np.clip(-matrix[..., 2, 0], -1.0, 1.0)),
        np.arctan2(matrix[..., 1, 0], matrix[..., 0, 0]),
    )


def euler_error_map(pitch: FloatArray, yaw: FloatArray) -> FloatArray:
    """Matrix taking the filter's attitude error to errors (estimate minus truth) of roll, pitch, yaw.

    The filter's error is psi in C_estimate = (I - [psi x]) C, so the small rotation of the estimate is
    -psi in NED; shape (..., 3, 3). Singular at a pitch of 90 deg.
    """
    cy, sy = np.cos(yaw), np.sin(yaw)
    secant, tangent = 1.0 / np.cos(pitch), np.tan(pitch)
    zero, one = np.zeros_like(cy), np.ones_like(cy)
    rows = [[cy * secant, sy * secant, zero], [-sy, cy, zero], [cy * tangent, sy * tangent, one]]
    result: FloatArray = -np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    return np.ascontiguousarray(result)


def quaternion_from_matrix(matrix: FloatArray) -> FloatArray:
    """Unit quaternion of one 3 x 3 matrix (Shepperd's method: divides by the largest component)."""
    m = matrix
    squares = np.array(
        [
            1.0 + m[0, 0] + m[1, 1] + m[2, 2],
            1.0 + m[0, 0] - m[1, 1] - m[2, 2],
            1.0 - m[0, 0] + m[1, 1] - m[2, 2],
            1.0 - m[0, 0] - m[1, 1] + m[2, 2],
        ]
    )
    largest = int(np.argmax(squares))
    r = np.sqrt(squares[largest])
    a, b, c = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    d, e, f = m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2]
    parts = [[r * r, a, b, c], [a, r * r, d, e], [b, d, r * r, f], [c, e, f, r * r]][largest]
    quaternion: FloatArray = np.array(parts) / (2.0 * r)
    return quaternion


@part
def matrix_from_quaternion(q: FloatArray, out: FloatArray) -> None:
    """Write the 3 x 3 matrix of the unit quaternion `q` into `out`."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[0, 1] = 2.0 * (x * y - w * z)
    out[0, 2] = 2.0 * (x * z + w * y)
    out[1, 0] = 2.0 * (x * y + w * z)
    out[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    out[1, 2] = 2.0 * (y * z - w * x)
    out[2, 0] = 2.0 * (x * z - w * y)
    out[2, 1] = 2.0 * (y * z + w * x)
    out[2, 2] = 1.0 - 2.0 * (x * x + y * y)


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
def rotate(q: FloatArray, bx: float, by: float, bz: float, nx: float, ny: float, nz: float) -> None:
    """q <- exp(n) q exp(b): a rotation vector `b` in body axes and `n` in navigation axes, in place.

    The two changes are summed before they meet `q`: where they cancel (a resting INS under the Earth's
    rate) `q` then stays as it is, instead of collecting the same rounding error at every step.
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
def normalise(q: FloatArray) -> None:
    """Scale `q` back to unit length: one Newton step, enough where rounding is all there is to remove."""
    excess = 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0)
    for i in range(4):
        q[i] -= excess * q[i]

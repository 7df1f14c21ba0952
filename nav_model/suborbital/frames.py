"""Inertial, local and body axes over a spherical Earth, and small rotations.

Inertial axes have z along the Earth's spin and x through the Greenwich meridian at lift-off. Local axes are
north, east, down on the sphere of radius R. C_bi carries body components into inertial ones; everything here
is star_tracker.md's own choice (X) for its reconstruction.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

KM = 3.986004418e14
"""Earth's gravitational constant, m³/s²."""
EARTH_RADIUS = 6371000.0
"""Radius of the spherical Earth, m."""
EARTH_RATE = 7.2921150e-5
"""Earth's rate of rotation, rad/s."""
STANDARD_GRAVITY = 9.80665
"""What "1 g" on a data sheet means, m/s²."""
ARCSEC = np.pi / 648000.0
"""One second of arc, rad."""


def ned_to_inertial(latitude: ArrayLike, inertial_longitude: ArrayLike) -> Array:
    """Rotation from north-east-down to inertial axes; longitude is lon + w_e t. Broadcasts to (..., 3, 3)."""
    lat, lon = np.broadcast_arrays(
        np.asarray(latitude, dtype=np.float64), np.asarray(inertial_longitude, dtype=np.float64)
    )
    sl, cl, so, co = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    zero = np.zeros_like(sl)
    return np.stack(
        [
            np.stack([-sl * co, -so, -cl * co], axis=-1),
            np.stack([-sl * so, co, -cl * so], axis=-1),
            np.stack([cl, zero, -sl], axis=-1),
        ],
        axis=-2,
    )


def spherical_position(position_i: Array) -> tuple[Array, Array, Array]:
    """Latitude, inertial longitude (rad) and height (m) of inertial positions (..., 3)."""
    radius = np.linalg.norm(position_i, axis=-1)
    latitude = np.arcsin(position_i[..., 2] / radius)
    longitude = np.arctan2(position_i[..., 1], position_i[..., 0])
    return latitude, longitude, radius - EARTH_RADIUS


def local_axes(position_i: Array) -> Array:
    """Rotation from north-east-down at inertial positions (..., 3) to inertial axes, (..., 3, 3)."""
    latitude, longitude, _ = spherical_position(position_i)
    return ned_to_inertial(latitude, longitude)


def earth_velocity(position_i: Array) -> Array:
    """Velocity w_ie x r of a point at rest on the turning Earth, inertial axes, (..., 3), m/s."""
    return np.stack(
        [
            -EARTH_RATE * position_i[..., 1],
            EARTH_RATE * position_i[..., 0],
            np.zeros_like(position_i[..., 0]),
        ],
        axis=-1,
    )


def skew(vector: ArrayLike) -> Array:
    """Matrix [v x] of vectors (..., 3)."""
    v = np.asarray(vector, dtype=np.float64)
    zero = np.zeros_like(v[..., 0])
    return np.stack(
        [
            np.stack([zero, -v[..., 2], v[..., 1]], axis=-1),
            np.stack([v[..., 2], zero, -v[..., 0]], axis=-1),
            np.stack([-v[..., 1], v[..., 0], zero], axis=-1),
        ],
        axis=-2,
    )


def rotation_from_vector(vector: ArrayLike) -> Array:
    """exp([v x]) of rotation vectors (..., 3), rad (Rodrigues' formula)."""
    v = np.asarray(vector, dtype=np.float64)
    angle = np.linalg.norm(v, axis=-1)[..., None, None]
    cross = skew(v)
    # np.sinc is sin(pi x)/(pi x): both coefficients stay exact down to a zero angle.
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    return np.asarray(np.eye(3) + first * cross + second * (cross @ cross))


def vector_from_rotation(rotation: Array) -> Array:
    """Rotation vector (..., 3), rad, of rotations (..., 3, 3): the inverse of `rotation_from_vector`."""
    w, x, y, z = np.moveaxis(quaternion_from_rotation(rotation), -1, 0)
    axis = np.stack([x, y, z], axis=-1) * np.where(w < 0.0, -1.0, 1.0)[..., None]
    length = np.linalg.norm(axis, axis=-1)
    half = np.arctan2(length, np.abs(w))
    scale = np.where(length > 1e-12, 2.0 * half / np.where(length > 1e-12, length, 1.0), 2.0)
    return np.asarray(axis * scale[..., None])


def quaternion_from_rotation(rotation: Array) -> Array:
    """Quaternion (w, x, y, z) of rotations (..., 3, 3), from the largest of its four squares (Shepperd)."""
    r = np.asarray(rotation, dtype=np.float64)
    trace = r[..., 0, 0] + r[..., 1, 1] + r[..., 2, 2]
    squares = np.stack([trace, r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]], axis=-1)
    best = np.argmax(squares, axis=-1)
    a = r[..., 2, 1] - r[..., 1, 2]
    b = r[..., 0, 2] - r[..., 2, 0]
    c = r[..., 1, 0] - r[..., 0, 1]
    xy = r[..., 0, 1] + r[..., 1, 0]
    xz = r[..., 0, 2] + r[..., 2, 0]
    yz = r[..., 1, 2] + r[..., 2, 1]
    diagonal = 1.0 - trace[..., None] + 2.0 * np.stack([r[..., k, k] for k in range(3)], axis=-1)
    candidates = np.stack(
        [
            np.stack([1.0 + trace, a, b, c], axis=-1),
            np.stack([a, diagonal[..., 0], xy, xz], axis=-1),
            np.stack([b, xy, diagonal[..., 1], yz], axis=-1),
            np.stack([c, xz, yz, diagonal[..., 2]], axis=-1),
        ],
        axis=-2,
    )
    q = np.take_along_axis(candidates, best[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True))


def rotation_from_quaternion(quaternion: Array) -> Array:
    """Rotations (..., 3, 3) of unit quaternions (w, x, y, z), (..., 4)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, dtype=np.float64), -1, 0)
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=-1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=-1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1),
        ],
        axis=-2,
    )


def rotation_from_euler(roll: ArrayLike, pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll) from body to the axes the angles are counted in, (..., 3, 3)."""
    cr, sr = np.cos(roll), np.sin(roll)
    cp, sp = np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    return np.stack(
        [
            np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=-1),
            np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=-1),
            np.stack([-sp + 0.0 * cr * cy, cp * sr + 0.0 * cy, cp * cr + 0.0 * cy], axis=-1),
        ],
        axis=-2,
    )


def require(condition: bool, message: str) -> None:
    """Raise ValueError with `message` unless the condition holds."""
    if not condition:
        raise ValueError(message)


def require_finite(name: str, value: Any) -> None:
    """Raise ValueError naming the field unless every number in `value` is finite."""
    require(bool(np.all(np.isfinite(value))), f"{name} = {value!r}: every value must be a finite number")

"""The spherical Earth of the suborbital study: inertial and local axes over it.

Inertial axes have z along the Earth's spin and x through the Greenwich meridian at lift-off. Local axes are
north, east, down on the sphere of radius `nav_model.base.constants.SPHERE_RADIUS`. Everything here is
star_tracker.md's own choice (X) for its reconstruction.
"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.constants import EARTH_RATE, SPHERE_RADIUS
from nav_model.earth.rotation import matrix_of


def ned_to_inertial(latitude: ArrayLike, inertial_longitude: ArrayLike) -> Array:
    """Matrices from north-east-down to inertial axes [B-2].

    Parameters
    ----------
    latitude, inertial_longitude : array_like
        rad, of any shapes that broadcast; the inertial longitude is longitude + Earth's rate * time.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Its columns are north, east and down in inertial axes.
    """
    sl, cl = np.sin(latitude), np.cos(latitude)
    so, co = np.sin(inertial_longitude), np.cos(inertial_longitude)
    return matrix_of(-sl * co, -so, -cl * co, -sl * so, co, -cl * so, cl, 0.0, -sl)


def spherical_position(position_i: Array) -> tuple[Array, Array, Array]:
    """Latitude [rad], inertial longitude [rad] and height above the sphere [m], (...), of inertial positions (..., 3)
    [m]."""
    radius = np.linalg.norm(position_i, axis=-1)
    latitude = np.arcsin(position_i[..., 2] / radius)
    longitude = np.arctan2(position_i[..., 1], position_i[..., 0])
    return latitude, longitude, radius - SPHERE_RADIUS


def local_axes(position_i: Array) -> Array:
    """Matrices (..., 3, 3) from north-east-down at inertial positions (..., 3) [m] to inertial axes."""
    latitude, longitude, _ = spherical_position(position_i)
    return ned_to_inertial(latitude, longitude)


def earth_velocity(position_i: Array) -> Array:
    """Velocity w_ie x r (..., 3) [m/s] of points at rest on the turning Earth, at inertial positions (..., 3) [m]."""
    return np.stack(
        [
            -EARTH_RATE * position_i[..., 1],
            EARTH_RATE * position_i[..., 0],
            np.zeros_like(position_i[..., 0]),
        ],
        axis=-1,
    )

"""WGS 84: shape, rotation and normal gravity of the Earth.

The plain functions broadcast over NumPy arrays; the `*_kernel` twins are the same functions compiled,
for use inside the simulator's loops. Angles in rad, lengths in m, accelerations in m/s^2.

Source: NIMA TR8350.2, *Department of Defense World Geodetic System 1984*, 3rd edition, chapters 3 and 4.
"""

from typing import Any, Final

import numpy as np

from nav_model.base.compiled import part
from nav_model.base.constants import EARTH_RATE, FLATTENING, GRAVITATIONAL_PARAMETER, SEMI_MAJOR_AXIS

ECCENTRICITY_SQUARED: Final = FLATTENING * (2.0 - FLATTENING)
EQUATOR_GRAVITY: Final = 9.7803253359
SOMIGLIANA: Final = 1.931852652458e-3
# Ratio of centrifugal to gravitational acceleration at the equator, TR8350.2's m.
CENTRIFUGAL_RATIO: Final = EARTH_RATE**2 * SEMI_MAJOR_AXIS**3 * (1.0 - FLATTENING) / GRAVITATIONAL_PARAMETER


def curvature_radii(sin_latitude: Any) -> Any:
    """Radii of curvature [m], meridian M and prime vertical N, at the sine of geodetic latitude.

    Any shape; both are returned in it. Source: the geometry of the ellipse.
    """
    root = np.sqrt(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude)
    prime_vertical = SEMI_MAJOR_AXIS / root
    return prime_vertical * (1.0 - ECCENTRICITY_SQUARED) / (root * root), prime_vertical


def metres_per_radian(latitude: Any, height: Any) -> Any:
    """Metres north of a radian of latitude, and east of one of longitude, at a latitude [rad] and height [m]."""
    meridian, prime = curvature_radii(np.sin(latitude))
    return meridian + height, (prime + height) * np.cos(latitude)


def normal_gravity(sin_latitude: Any, height: Any) -> Any:
    """Normal gravity [m/s^2], taken along the ellipsoid's normal, at a height [m] (TR8350.2 4-1, 4-3).

    Somigliana's formula on the ellipsoid, second order in height above it. The horizontal component that
    appears with height (8e-9 h sin 2 latitude, 24 micro-m/s^2 at 3 km) is left out of truth and of the INS
    alike.
    """
    s2 = sin_latitude * sin_latitude
    surface = EQUATOR_GRAVITY * (1.0 + SOMIGLIANA * s2) / np.sqrt(1.0 - ECCENTRICITY_SQUARED * s2)
    ratio = height / SEMI_MAJOR_AXIS
    first = 2.0 * (1.0 + FLATTENING + CENTRIFUGAL_RATIO - 2.0 * FLATTENING * s2)
    return surface * (1.0 - first * ratio + 3.0 * ratio * ratio)


curvature_radii_kernel = part(curvature_radii)
normal_gravity_kernel = part(normal_gravity)


def geodetic(place: Any) -> Any:
    """Latitude, longitude [rad] and height [m] of places (n, 3) in metres from the Earth's centre (ECEF).

    Fixed point of the latitude with the radius of curvature: 1e-12 rad within 100 km of the ground after six steps.
    """
    x, y, z = np.asarray(place, dtype=np.float64).T
    from_axis = np.hypot(x, y)
    latitude = np.arctan2(z, from_axis * (1.0 - ECCENTRICITY_SQUARED))
    for _ in range(6):
        sine = np.sin(latitude)
        radius = curvature_radii(sine)[1]
        latitude = np.arctan2(z + ECCENTRICITY_SQUARED * radius * sine, from_axis)
    sine = np.sin(latitude)
    radius = curvature_radii(sine)[1]
    height = from_axis * np.cos(latitude) + z * sine - radius * (1.0 - ECCENTRICITY_SQUARED * sine**2)
    return np.column_stack([latitude, np.arctan2(y, x), height])


def central(place: Any) -> Any:
    """Metres from the Earth's centre (ECEF) of places (n, 3), latitude, longitude [rad], height [m]: the inverse of
    `geodetic`."""
    latitude, longitude, height = np.asarray(place, dtype=np.float64).T
    sine, cosine = np.sin(latitude), np.cos(latitude)
    radius = curvature_radii(sine)[1]
    from_axis = (radius + height) * cosine
    up = (radius * (1.0 - ECCENTRICITY_SQUARED) + height) * sine
    return np.column_stack([from_axis * np.cos(longitude), from_axis * np.sin(longitude), up])

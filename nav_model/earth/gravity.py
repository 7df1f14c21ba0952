"""Gravitation of the Earth: spherical, with J2, and of the WGS-84 ellipsoid, and their differences.

The ellipsoidal field is the normal field of WGS 84 to its sixth zonal: within 5e-9 m/s² of the closed form
(Heiskanen and Moritz, Physical Geodesy, sections 2-7 and 6-2) from the ground to 1000 km.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.compiled import part
from nav_model.base.constants import (
    EARTH_RATE,
    GRAVITATIONAL_PARAMETER,
    J2,
    J4,
    J6,
    SEMI_MAJOR_AXIS,
    SPHERE_RADIUS,
)
from nav_model.base.errors import InputError, not_a_choice

ZONALS: dict[str, tuple[float, float, float]] = {
    "spherical": (0.0, 0.0, 0.0),
    "j2": (J2, 0.0, 0.0),
    "ellipsoidal": (J2, J4, J6),
}
"""J2, J4, J6 of each model."""


def zonals(model: str) -> Array:
    """J2, J4, J6 of a model named in `ZONALS`; InputError for another name."""
    if model not in ZONALS:
        raise InputError("gravity", not_a_choice(model, ZONALS), model)
    return np.array(ZONALS[model])


def _field(radius: Any, s: Any, j: Sequence[float] | Array) -> tuple[Any, Any]:
    """Radial part (along r) and the factor of the direction (k - s u), k the spin axis, u the unit radius."""
    q = (SEMI_MAJOR_AXIS / radius) ** 2
    s2 = s * s
    j2, j4, j6 = j[0] * q, j[1] * q * q, j[2] * q * q * q
    radial = (
        -1.0
        + j2 * 1.5 * (3.0 * s2 - 1.0)
        + j4 * 0.625 * ((35.0 * s2 - 30.0) * s2 + 3.0)
        + j6 * 0.4375 * (((231.0 * s2 - 315.0) * s2 + 105.0) * s2 - 5.0)
    )
    axial = -s * (3.0 * j2 + j4 * (17.5 * s2 - 7.5) + j6 * ((86.625 * s2 - 78.75) * s2 + 13.125))
    k = GRAVITATIONAL_PARAMETER / (radius * radius)
    return k * radial, k * axial


field_kernel = part(_field)
"""`_field` compiled: (radius m, sine of latitude, J2..J6) -> (radial, axial), m/s²."""


def gravitation(position_i: Array, model: str) -> Array:
    """Gravitation, without the centrifugal part [B-3].

    Parameters
    ----------
    position_i : ndarray, shape (..., 3)
        Inertial positions [m], z along the Earth's spin.
    model : str
        A name in `ZONALS`.

    Returns
    -------
    ndarray, shape (..., 3)
        In inertial axes [m/s²].

    Raises
    ------
    InputError
        For another model.

    Source: the gradient of the potential in zonal harmonics to J6.
    """
    radius = np.linalg.norm(position_i, axis=-1)
    u = position_i / radius[..., None]
    s = u[..., 2]
    radial, axial = _field(radius, s, zonals(model))
    axis = -s[..., None] * u
    axis[..., 2] += 1.0
    return np.asarray(radial[..., None] * u + axial[..., None] * axis)


@dataclass(frozen=True)
class GravityComparison:
    """Gravity (with centrifugal part) of three models along one vertical.

    height_m (n,); spherical, j2 and ellipsoidal magnitudes (n,), m/s²; horizontal_* is the component that
    each oblate field has across the sphere's vertical at the same point, positive towards north, m/s².
    """

    height_m: Array
    latitude_rad: float
    spherical_m_s2: Array
    j2_m_s2: Array
    ellipsoidal_m_s2: Array
    horizontal_j2_m_s2: Array
    horizontal_ellipsoidal_m_s2: Array
    source: str = "gravitation of [B-3] with zonals J2, J4, J6 of WGS-84, plus centrifugal acceleration"


def compare_gravity(latitude_rad: float, height_m: ArrayLike) -> GravityComparison:
    """The three models at geocentric radius R + height and one geocentric latitude, 0 to 1000 km and
    beyond."""
    height = np.atleast_1d(np.asarray(height_m, dtype=np.float64))
    radius = SPHERE_RADIUS + height
    cl, sl = np.cos(latitude_rad), np.sin(latitude_rad)
    position = np.stack([radius * cl, np.zeros_like(radius), radius * sl], axis=-1)
    centrifugal = EARTH_RATE**2 * position * np.array([1.0, 1.0, 0.0])
    north = np.array([-sl, 0.0, cl])
    g = {model: gravitation(position, model) + centrifugal for model in ZONALS}
    horizontal = {model: (g[model] - g["spherical"]) @ north for model in ZONALS}
    return GravityComparison(
        height_m=height,
        latitude_rad=latitude_rad,
        spherical_m_s2=np.linalg.norm(g["spherical"], axis=-1),
        j2_m_s2=np.linalg.norm(g["j2"], axis=-1),
        ellipsoidal_m_s2=np.linalg.norm(g["ellipsoidal"], axis=-1),
        horizontal_j2_m_s2=horizontal["j2"],
        horizontal_ellipsoidal_m_s2=horizontal["ellipsoidal"],
    )

"""Gravitation of the Earth: spherical, with J2, and of the WGS-84 ellipsoid, and what separates them.

The ellipsoidal field is the normal field of WGS-84 to its sixth zonal; `normal_gravity` is the closed form
(Heiskanen and Moritz, Physical Geodesy, section 2-7 and 6-2) against which it is checked.
"""

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import ArrayLike

from nav_model.suborbital.frames import EARTH_RADIUS, EARTH_RATE, KM, Array, require

EQUATORIAL_RADIUS = 6378137.0
"""Semi-major axis of WGS-84, m."""
FLATTENING = 1.0 / 298.257223563
"""Flattening of WGS-84."""
ZONALS: dict[str, tuple[float, float, float]] = {
    "spherical": (0.0, 0.0, 0.0),
    "j2": (1.08262982e-3, 0.0, 0.0),
    "ellipsoidal": (1.08262982e-3, -2.37091126e-6, 6.08346498e-9),
}
"""J2, J4, J6 of each model. Normal zonals of WGS-84: NIMA TR8350.2, 3rd edition, table 3.5 and its
recursion."""


def zonals(model: str) -> Array:
    """J2, J4, J6 of a model named in `ZONALS`; ValueError for another name."""
    require(model in ZONALS, f"gravity = {model!r}: must be one of {', '.join(ZONALS)}")
    return np.array(ZONALS[model])


def _field(radius: Any, s: Any, j: Array) -> tuple[Any, Any]:
    """Radial part (along r) and the factor of the direction (k - s u), k the spin axis, u the unit radius."""
    q = (EQUATORIAL_RADIUS / radius) ** 2
    s2 = s * s
    j2, j4, j6 = j[0] * q, j[1] * q * q, j[2] * q * q * q
    radial = (
        -1.0
        + j2 * 1.5 * (3.0 * s2 - 1.0)
        + j4 * 0.625 * ((35.0 * s2 - 30.0) * s2 + 3.0)
        + j6 * 0.4375 * (((231.0 * s2 - 315.0) * s2 + 105.0) * s2 - 5.0)
    )
    axial = -s * (3.0 * j2 + j4 * (17.5 * s2 - 7.5) + j6 * ((86.625 * s2 - 78.75) * s2 + 13.125))
    k = KM / (radius * radius)
    return k * radial, k * axial


field_kernel = numba.njit(cache=True, inline="always")(_field)
"""`_field` compiled: (radius m, sine of latitude, J2..J6) -> (radial, axial), m/s²."""


def gravitation(position_i: Array, model: str) -> Array:
    """Gravitation (without centrifugal part) at inertial positions (..., 3) m, in inertial axes, m/s²
    [B-3]."""
    radius = np.linalg.norm(position_i, axis=-1)
    u = position_i / radius[..., None]
    s = u[..., 2]
    radial, axial = _field(radius, s, zonals(model))
    axis = -s[..., None] * u
    axis[..., 2] += 1.0
    return np.asarray(radial[..., None] * u + axial[..., None] * axis)


def normal_gravity(latitude: ArrayLike, height: ArrayLike) -> tuple[Array, Array]:
    """Normal gravity of WGS-84 with its centrifugal part, closed form.

    latitude: geodetic, rad; height above the ellipsoid, m. Returns the components along the axis of rotation
    and away from it, m/s² (Heiskanen and Moritz 2-120 to 2-126 in ellipsoidal coordinates u, beta).
    """
    lat, h = np.asarray(latitude, dtype=np.float64), np.asarray(height, dtype=np.float64)
    a = EQUATORIAL_RADIUS
    b = a * (1.0 - FLATTENING)
    e = np.sqrt(a * a - b * b)
    x, z = _meridian(lat, h)
    d = x * x + z * z - e * e
    u = np.sqrt(0.5 * d * (1.0 + np.sqrt(1.0 + 4.0 * e * e * z * z / (d * d))))
    root = np.sqrt(u * u + e * e)
    beta = np.arctan2(z * root, u * x)
    sb, cb = np.sin(beta), np.cos(beta)
    w = np.sqrt((u * u + e * e * sb * sb) / (u * u + e * e))

    def q_of(v: Array) -> Array:
        return np.asarray(0.5 * ((1.0 + 3.0 * v * v / (e * e)) * np.arctan(e / v) - 3.0 * v / e))

    q0 = q_of(np.asarray(b))
    qp = 3.0 * (1.0 + u * u / (e * e)) * (1.0 - u / e * np.arctan(e / u)) - 1.0
    w2 = EARTH_RATE**2
    gu = (
        -(
            KM / (u * u + e * e)
            + w2 * a * a * e / (u * u + e * e) * qp / q0 * (0.5 * sb * sb - 1.0 / 6.0)
            - w2 * u * cb * cb
        )
        / w
    )
    gb = (w2 * a * a / root * q_of(u) / q0 - w2 * root) * sb * cb / w
    # Unit vectors of the ellipsoidal coordinates turned into the meridian plane.
    axial = gu * sb / w + gb * u / root * cb / w
    outward = gu * u / root * cb / w - gb * sb / w
    return np.asarray(axial), np.asarray(outward)


def _meridian(lat: Array, h: Array) -> tuple[Array, Array]:
    e2 = FLATTENING * (2.0 - FLATTENING)
    n = EQUATORIAL_RADIUS / np.sqrt(1.0 - e2 * np.sin(lat) ** 2)
    return (n + h) * np.cos(lat), (n * (1.0 - e2) + h) * np.sin(lat)


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
    radius = EARTH_RADIUS + height
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

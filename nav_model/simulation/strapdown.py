"""The mechanisation: NED axes, quaternion attitude, coning and sculling from the two previous samples.

A navigation state is one array of 15: latitude, longitude [rad], height [m], velocity north, east, down
[m/s], quaternion body-to-NED (w, x, y, z), the last sample's velocity change (3) that carries the Earth's
and transport's terms to the middle of the step, and what rounding has so far withheld from latitude and
longitude (2): at 100 Hz a step slower than 0.4 um/s is less than half a unit in the last place of either.

The weights of the three products (121, -31, 1)/720 follow from asking that the non-commutative part
(1/2) int alpha x omega dt be exact for a quadratic rate; the sculling part is the same form, polarised.

Sources: Savage, "Strapdown inertial navigation integration algorithm design", J. Guidance, Control, and
Dynamics 21(1-2), 1998; Titterton and Weston, *Strapdown Inertial Navigation Technology*, 2nd ed., ch. 11.
"""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel, part
from nav_model.base.constants import EARTH_RATE
from nav_model.earth.rotation import normalise, quaternion_from_matrix, rotate
from nav_model.earth.wgs84 import curvature_radii_kernel, normal_gravity_kernel
from nav_model.simulation.layout import (
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    QUATERNION,
    STATE_LENGTH,
    VELOCITY,
    VELOCITY_CHANGE,
    WITHHELD,
)

FloatArray = NDArray[np.float64]


@part
def _product(weight: float, early: FloatArray, late: FloatArray, correction: FloatArray) -> None:
    """Add `weight` times one pair's coning (angle x angle) and sculling (both mixed products) to `correction`."""
    ux, uy, uz, bx, by, bz = early[0], early[1], early[2], early[3], early[4], early[5]
    vx, vy, vz, ax, ay, az = late[0], late[1], late[2], late[3], late[4], late[5]
    correction[0] += weight * (by * vz - bz * vy + uy * az - uz * ay)
    correction[1] += weight * (bz * vx - bx * vz + uz * ax - ux * az)
    correction[2] += weight * (bx * vy - by * vx + ux * ay - uy * ax)
    correction[3] += weight * (by * az - bz * ay)
    correction[4] += weight * (bz * ax - bx * az)
    correction[5] += weight * (bx * ay - by * ax)


@part
def advance(
    state: FloatArray,
    now: FloatArray,
    before: FloatArray,
    earlier: FloatArray,
    dt: float,
    force: FloatArray,
    scratch: FloatArray,
) -> None:
    """Advance the navigation state by one IMU sample, in place.

    Parameters
    ----------
    state : array
        Navigation state.
    now, before, earlier : array (6,)
        Velocity and angle increments of this sample and the two before it, body axes.
    dt : float
        Seconds.
    force : array (3,)
        The velocity change from specific force alone is added to it, north, east, down; the filter's transition needs
        its mean.
    scratch : array (6,)
        Working space.
    """
    # Coning and sculling, exact for a rate and a force that are quadratic in time over the three samples.
    for i in range(6):
        scratch[i] = 0.0
    _product(121.0 / 720.0, before, now, scratch)
    _product(-31.0 / 720.0, earlier, now, scratch)
    _product(1.0 / 720.0, earlier, before, scratch)
    cone_x, cone_y, cone_z = scratch[3], scratch[4], scratch[5]
    vx, vy, vz, ax, ay, az = now[0], now[1], now[2], now[3], now[4], now[5]
    # Velocity rotation, exact for constant rate and force.
    square = ax * ax + ay * ay + az * az
    first, second = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    rx, ry, rz = ay * vz - az * vy, az * vx - ax * vz, ax * vy - ay * vx
    fx = vx + first * rx + second * (ay * rz - az * ry) + scratch[0]
    fy = vy + first * ry + second * (az * rx - ax * rz) + scratch[1]
    fz = vz + first * rz + second * (ax * ry - ay * rx) + scratch[2]

    # Position and velocity carried to the middle of the step for the Earth's terms.
    vn, ve, vd = state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2]
    mn = vn + 0.5 * state[VELOCITY_CHANGE]
    me = ve + 0.5 * state[VELOCITY_CHANGE + 1]
    md = vd + 0.5 * state[VELOCITY_CHANGE + 2]
    sin_lat, cos_lat = math.sin(state[LATITUDE]), math.cos(state[LATITUDE])
    meridian, prime = curvature_radii_kernel(sin_lat)
    half = 0.5 * dt
    shift = half * vn / (meridian + state[HEIGHT])
    height = state[HEIGHT] - half * vd
    sin_lat, cos_lat = sin_lat + cos_lat * shift, cos_lat - sin_lat * shift
    meridian, prime = curvature_radii_kernel(sin_lat)
    north_radius, east_radius = meridian + height, prime + height
    earth_n, earth_d = EARTH_RATE * cos_lat, -EARTH_RATE * sin_lat
    transport_n = me / east_radius
    transport_e = -mn / north_radius
    transport_d = -transport_n * sin_lat / cos_lat
    zx, zy, zz = (earth_n + transport_n) * dt, transport_e * dt, (earth_d + transport_d) * dt

    # Body to NED with the attitude at the start, NED turned half a step on.
    quaternion = state[QUATERNION : QUATERNION + 4]
    q0, q1, q2, q3 = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    tx, ty, tz = 2.0 * (q2 * fz - q3 * fy), 2.0 * (q3 * fx - q1 * fz), 2.0 * (q1 * fy - q2 * fx)
    nx = fx + q0 * tx + q2 * tz - q3 * ty
    ny = fy + q0 * ty + q3 * tx - q1 * tz
    nz = fz + q0 * tz + q1 * ty - q2 * tx
    sx = nx - 0.5 * (zy * nz - zz * ny)
    sy = ny - 0.5 * (zz * nx - zx * nz)
    sz = nz - 0.5 * (zx * ny - zy * nx)
    force[0] += sx
    force[1] += sy
    force[2] += sz
    wx, wy, wz = 2.0 * earth_n + transport_n, transport_e, 2.0 * earth_d + transport_d
    dn = sx - (wy * md - wz * me) * dt
    de = sy - (wz * mn - wx * md) * dt
    dd = sz - (wx * me - wy * mn) * dt + normal_gravity_kernel(sin_lat, height) * dt

    # Trapezoid in velocity for the position; mid-step radii.
    latitude_step = dt * (vn + 0.5 * dn) / north_radius + state[WITHHELD]
    longitude_step = dt * (ve + 0.5 * de) / (east_radius * cos_lat) + state[WITHHELD + 1]
    latitude, longitude = state[LATITUDE] + latitude_step, state[LONGITUDE] + longitude_step
    state[WITHHELD] = latitude_step - (latitude - state[LATITUDE])
    state[WITHHELD + 1] = longitude_step - (longitude - state[LONGITUDE])
    state[LATITUDE], state[LONGITUDE] = latitude, longitude
    state[HEIGHT] -= dt * (vd + 0.5 * dd)
    state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2] = vn + dn, ve + de, vd + dd
    state[VELOCITY_CHANGE], state[VELOCITY_CHANGE + 1], state[VELOCITY_CHANGE + 2] = dn, de, dd
    rotate(quaternion, ax + cone_x, ay + cone_y, az + cone_z, -zx, -zy, -zz)
    normalise(quaternion)


@kernel
def _navigate(state: FloatArray, increments: FloatArray, dt: float, every: int, out: FloatArray) -> None:
    force = np.zeros(3)
    scratch = np.empty(6)
    for k in range(len(increments) - 1):
        if k > 0:
            advance(state, increments[k + 1], increments[k], increments[k - 1], dt, force, scratch)
        if k % every == 0:
            for i in range(VELOCITY_CHANGE):
                out[k // every, i] = state[i]


def initial_state(position: FloatArray, velocity: FloatArray, matrix: FloatArray) -> FloatArray:
    """Navigation state from geodetic position, NED velocity and body-to-NED matrix."""
    state = np.zeros(STATE_LENGTH)
    state[:VELOCITY], state[VELOCITY:QUATERNION] = position, velocity
    state[QUATERNION:VELOCITY_CHANGE] = quaternion_from_matrix(matrix)
    return state


def navigate(state: FloatArray, increments: FloatArray, rate: float, every: int = 1) -> FloatArray:
    """Run a free-inertial INS over increments.

    Parameters
    ----------
    state : array
        Navigation state at time 0; left as it is.
    increments : array (samples + 2, 6)
        Of velocity and angle; the first two rows precede time 0.
    rate : float
        Samples per second.
    every : int, optional
        Samples between outputs.

    Returns
    -------
    array (samples // every + 1, 10)
        Latitude, longitude, height, velocity (3), quaternion (4), at time 0 and at each output.
    """
    out = np.empty(((len(increments) - 2) // every + 1, 10))
    _navigate(state.copy(), increments, 1.0 / rate, every, out)
    return out

"""The outage with the Schuler, gravity-gradient and Coriolis terms that the polynomials omit. [T-17]

Beside [T-1], the horizontal channels feel the Schuler term -g/R, the vertical channel gravity's gradient
+2g/R and the horizontal velocity error through Coriolis and the centrifugal term:
``d(dv_down)/dt += 2 Omega cos(lat) dv_east + (2V/R) dv_along``. Left out, the vertical curve is optimistic
after about 45 s.

With omega² = g/R and mu² = 2 omega², the transition of this linear system is made of sin, cos, sinh and cosh.
The variance is the propagated covariance of the last fix plus the integrals of the squared impulse responses, which
are smooth and positive and are integrated by Gauss and Legendre's rule to rounding. Everything broadcasts, so the
same function draws a curve and fills a map.
"""

from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.constants import EARTH_RATE, MEAN_RADIUS

# Schuler angle -> points of the rule that integrate the squared responses up to it to rounding.
_RULES = ((0.8, 8), (3.0, 14), (20.0, 40))
_MOST_REMEMBERED = 1000  # points of the longest curve that is remembered


class RefinedGrowth(NamedTuple):
    """Position variances [m²] against time. The two horizontal channels start and grow alike."""

    horizontal: Array
    vertical: Array


def refined_growth(
    start: Horizontal,
    start_vertical: Vertical,
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    time: ArrayLike,
    *,
    speed: ArrayLike,
    latitude: ArrayLike,
    altitude: ArrayLike = 0.0,
    heading: ArrayLike = 0.0,
    rule: tuple[Array, Array] | None = None,
) -> RefinedGrowth:
    """Variances `time` seconds after the last fix, from the posterior covariance of the filter. [T-17]

    Parameters
    ----------
    start, start_vertical
        Covariances just after the last fix, of one horizontal channel and the vertical one. The two
        horizontal channels start alike and independent.
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    time : array_like
        Seconds since the last fix.
    speed, latitude, altitude, heading : array_like
        m/s, rad, m, rad.
    rule : pair of array, optional
        Nodes on [0, 1] and weights to integrate with, instead of those chosen by the Schuler angle.

    Raises
    ------
    ArithmeticError
        If the Schuler angle sqrt(g/R) time exceeds 20 rad (4.5 hours on Earth).
    """
    qa, qw = as_numbers(sigma_a) ** 2, as_numbers(sigma_w) ** 2
    g, t = as_numbers(g), as_numbers(time)
    radius = MEAN_RADIUS + as_numbers(altitude)
    omega = np.sqrt(g / radius)
    p, v0 = start, start_vertical
    free, noise = _transition(omega, t) if rule is None else (_responses(omega, t), _integrals(omega, t, *rule))
    sine, tilt, coupled, twice, cosine = free.sine, free.tilt, free.coupled, free.twice, free.cosine
    horizontal = (
        p.p11 * cosine**2
        + p.p22 * sine**2
        + p.p33 * (g * tilt) ** 2
        + 2 * cosine * (p.p12 * sine + g * p.p13 * tilt)
        + 2 * g * p.p23 * sine * tilt
        + qa * noise.sine
        + g**2 * qw * noise.tilt
    )
    # Effect of one horizontal channel's velocity error on the vertical channel, for a coupling of one.
    schuler = omega**2
    by_coupling = (
        p.p22 * coupled**2
        + twice**2 * (p.p11 * schuler**2 + g**2 * p.p33 - 2 * schuler * g * p.p13)
        + 2 * twice * coupled * (g * p.p23 - schuler * p.p12)
        + qa * noise.coupled
        + g**2 * qw * noise.twice
    )
    vertical = (
        v0.v11 * free.rising**2
        + 2 * v0.v12 * free.rising * free.falling
        + v0.v22 * free.falling**2
        + qa * noise.falling
        + coupling(speed, latitude, altitude, heading) * by_coupling
    )
    return RefinedGrowth(horizontal, vertical)


def coupling(speed: ArrayLike, latitude: ArrayLike, altitude: ArrayLike, heading: ArrayLike) -> Array:
    """Square of the vertical acceleration that a horizontal velocity error of one makes, of both axes together, 1/s²,
    by Coriolis and the centrifugal term. [T-17]

    Parameters
    ----------
    speed, latitude, altitude, heading : array_like
        m/s, rad, m, rad.
    """
    v, latitude, heading = (as_numbers(x) for x in (speed, latitude, heading))
    coriolis = 2 * EARTH_RATE * np.cos(latitude)
    # east = along sin(heading) + cross cos(heading)
    along = coriolis * np.sin(heading) + 2 * v / (MEAN_RADIUS + as_numbers(altitude))
    cross = coriolis * np.cos(heading)
    square: Array = along**2 + cross**2
    return square


class _Responses(NamedTuple):
    """Position after a time, of a unit start.

    Horizontal, of position (``cosine``), of velocity (``sine`` [s]), of acceleration (``tilt`` [s²]); vertical, of
    its own position (``rising``) and velocity (``falling`` [s]), and, for a coupling of 1/s, of horizontal
    velocity (``coupled`` [s²]) and of horizontal acceleration (``twice`` [s³]).
    """

    cosine: Array
    sine: Array
    tilt: Array
    rising: Array
    falling: Array
    coupled: Array
    twice: Array


def _transition(omega: Array, t: Array) -> tuple[_Responses, _Responses]:
    """Responses and the integrals of their squares; those of a curve are kept while only the sensors change."""
    if omega.ndim == 0 and t.ndim == 1 and omega.dtype == t.dtype == float and len(t) <= _MOST_REMEMBERED:
        return _of_curve(float(omega), t.tobytes())
    return _responses(omega, t), _squared_integrals(omega, t)


@lru_cache(maxsize=32)
def _of_curve(omega: float, times: bytes) -> tuple[_Responses, _Responses]:
    rate, t = np.array(omega), np.frombuffer(times)
    curve = _responses(rate, t), _squared_integrals(rate, t)
    for responses in curve:
        for response in responses:
            response.flags.writeable = False
    return curve


def _responses(omega: Array, t: Array) -> _Responses:
    mu = np.sqrt(2) * omega
    sine, falling = np.sin(omega * t) / omega, np.sinh(mu * t) / mu
    # 1 - cos and cosh - 1, without cancellation
    fallen = 2 * (np.sin(omega * t / 2) / omega) ** 2
    risen = 2 * (np.sinh(mu * t / 2) / omega) ** 2
    return _Responses(
        cosine=1 - omega**2 * fallen,
        sine=sine,
        tilt=fallen,
        rising=1 + omega**2 * risen,
        falling=falling,
        coupled=(risen + fallen) / 3,
        twice=(falling - sine) / (3 * omega**2),
    )


def _squared_integrals(omega: Array, t: Array) -> _Responses:
    """Integrals of the squared responses from zero to `t`, under the same names."""
    angle = float(np.max(np.abs(omega * t), initial=0.0))
    points = next((points for limit, points in _RULES if angle <= limit), None)
    if points is None:
        raise ArithmeticError(
            f"an outage of {angle:.3g} rad of Schuler angle is beyond the {_RULES[-1][0]:g} integrated to rounding"
        )
    return _integrals(omega, t, *_rule(points))


def _integrals(omega: Array, t: Array, nodes: Array, weights: Array) -> _Responses:
    at = _responses(np.expand_dims(omega, -1), np.expand_dims(t, -1) * nodes)
    return _Responses(*((response**2 @ weights) * t for response in at))


def longest_rule() -> tuple[Array, Array]:
    """Nodes and weights that integrate every outage that is not refused."""
    return _rule(_RULES[-1][1])


@cache
def _rule(points: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss and Legendre on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return (nodes + 1) / 2, weights / 2

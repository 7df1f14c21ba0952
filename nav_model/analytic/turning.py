"""Quadratic and cubic phase along the turning line of sight: all three axes of the error in one image. [S-2], [S-8]

Over the aperture, x from -1 to 1, the line of sight is to second order

    u(x) = u0 + kappa (s u0 - e) x + kappa² ((3 s² - 1)/2 u0 - s e) x²,     kappa = V T / (2 R),  s = sin(squint)

with u0 that of mid-aperture and e along the track. The quadratic of u . dp is then, axis by axis, a weighted sum
of three functionals of the axis's error p: the quadratics of p, of x p (its velocity) and of x² p (its position);
the cubic likewise of the three cubics. A free INS's are Gaussian with the covariance written here: from the state it
starts in, and from its noise (found symbolically). Higher orders of the turn are omitted.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.coast import carried
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

# Covariances of the three functionals under white accelerometer noise (times S_a T³) and gyro noise (g² S_g T⁵), for
# quadratics and for cubics.
_ACCELEROMETER = {
    "quadratic": (
        (5 / 224, 1 / 32, 215 / 7392),
        (1 / 32, 213 / 2464, 9 / 112),
        (215 / 7392, 9 / 112, 21547 / 288288),
    ),
    "cubic": (
        (35 / 3168, 0.0, -1085 / 123552),
        (0.0, 805 / 41184, 1 / 32),
        (-1085 / 123552, 1 / 32, 30127 / 370656),
    ),
}
_GYRO = {
    "quadratic": (
        (181 / 29568, 15 / 1792, 4475 / 576576),
        (15 / 1792, 1739 / 144144, 421 / 37632),
        (4475 / 576576, 421 / 37632, 46523 / 4484480),
    ),
    "cubic": (
        (175 / 247104, 1 / 768, 175 / 114048),
        (1 / 768, 8713 / 1482624, 59 / 6912),
        (175 / 114048, 59 / 6912, 997 / 77792),
    ),
}

LEFT_OF_ORDER = {1: ("quadratic", 4 / 45), 2: ("cubic", 4 / 175)}
"""Autofocus order -> the first order that it leaves, and the mean square of what it leaves of that one's x² or x³.
The turn adds nothing to what an autofocus of order 3 leaves. [S-8]"""


class Bend(NamedTuple):
    """Variances and covariances of the three functionals of an axis but for the first one's variance, or the weights
    of these."""

    turned: Array
    curved: Array
    with_turned: Array
    with_curved: Array
    turned_curved: Array


class Turn(NamedTuple):
    """Weights of the functionals' covariances of both horizontal axes together, and of the vertical."""

    horizontal: Bend
    vertical: Bend

    def bent(self, horizontal: Bend, vertical: Bend) -> Array:
        """Part of the turn in the variance [m²] of the quadratic or the cubic, from the covariances of a horizontal
        axis and of the vertical. It may be negative: the turn can work against them."""
        return _sum(self.horizontal, horizontal) + _sum(self.vertical, vertical)


def _sum(weights: Bend, covariances: Bend) -> Array:
    parts = [weight * covariance for weight, covariance in zip(weights, covariances, strict=True)]
    return parts[0] + parts[1] + 2 * (parts[2] + parts[3] + parts[4])


def turn_of(grazing: ArrayLike, squint: ArrayLike, turn_rate: ArrayLike, aperture: ArrayLike) -> Turn:
    """Weights by which the functionals of the axes add up along the turning line of sight.

    Parameters
    ----------
    grazing, squint : array_like
        Angles of the line of sight of mid-aperture, rad.
    turn_rate : array_like
        Speed over slant range V/R, rad/s.
    aperture : array_like
        s.

    Returns
    -------
    Turn
        The errors of both horizontal axes are taken for equal and independent.
    """
    s, d = np.sin(as_numbers(squint)), np.sin(as_numbers(grazing))
    kappa = as_numbers(turn_rate) * as_numbers(aperture) / 2
    # u0 = (s, across, d); across² is below zero by rounding alone: `analyse` refuses the rest.
    across = 1 - s**2 - d**2
    across = np.where(across.real > 0, across, 0.0)
    # Coefficients of x and x² along u0; the track takes kappa and kappa² s off its own.
    first, second = kappa * s, kappa**2 * (3 * s**2 - 1) / 2
    track = s * first - kappa, s * second - kappa**2 * s

    def on(square: Array) -> Bend:
        return Bend(*(square * part for part in (first**2, second**2, first, second, first * second)))

    along = Bend(track[0] ** 2, track[1] ** 2, s * track[0], s * track[1], track[0] * track[1])
    return Turn(Bend(*(one + other for one, other in zip(along, on(across), strict=True))), on(d**2))


def free_bend(
    kind: str,
    start: Horizontal | Vertical,
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    bias_a: ArrayLike,
    bias_w: ArrayLike,
    g: ArrayLike,
    coast: ArrayLike,
    aperture: ArrayLike,
) -> Bend:
    """Covariances [m²] of an axis's functionals under a free INS, which starts `coast` seconds before the aperture.

    Parameters
    ----------
    kind : str
        "quadratic" or "cubic".
    start : Horizontal or Vertical
        Covariance at the last fix.
    sigma_a, sigma_w : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], the latter zero for the vertical.
    bias_a, bias_w : array_like
        Residual biases, m/s² and rad/s, the latter zero for the vertical.
    g, coast, aperture : array_like
        m/s², s, s. All broadcast together; complex numbers pass through.
    """
    sigma_a, sigma_w, b, d, g, c, t = (as_numbers(x) for x in (sigma_a, sigma_w, bias_a, bias_w, g, coast, aperture))
    if isinstance(start, Vertical):
        zero = 0 * start.v11
        start = Horizontal(start.v11, start.v12, zero, start.v22, zero, zero)
    p = carried(start, sigma_a, sigma_w, g, c)
    p13, p23, p33 = g * p.p13, g * p.p23, g**2 * p.p33
    state = (p.p11, p.p12, p13), (p.p12, p.p22, p23), (p13, p23, p33)
    # Functionals of the error that a unit of position, velocity and acceleration at the aperture's start makes, that
    # of a bias and that of a jerk (g times a gyro bias) since the last fix; all are polynomials of x.
    h, age = t / 2, c + t / 2
    unit: tuple[Sequence[Any], ...]
    if kind == "quadratic":
        bend = h**2 / 2
        unit = (None, None, bend), (None, h, 2 * bend), (1.0, h, 13 / 7 * bend)
        by_bias: tuple[Any, ...] = bend, age * h, age**2 / 2 + 3 / 7 * h**2
        by_jerk = age * bend, age**2 * h / 2 + h**3 / 7, age**3 / 6 + 3 / 7 * age * h**2
    else:
        bend = h**2 / 2
        unit = (None, None, None), (None, None, bend), (None, h, 2 * bend)
        by_bias = 0.0, bend, age * h
        by_jerk = h**3 / 6, age * bend, age**2 * h / 2 + 5 / 27 * h**3
    s_a, s_g, bias, jerk = sigma_a**2 * t**3, (g * sigma_w) ** 2 * t**5, b**2, (g * d) ** 2

    def covariance(i: int, j: int) -> Array:
        of_state = sum(
            one * other * state[k][n]
            for k, one in enumerate(unit[i])
            for n, other in enumerate(unit[j])
            if one is not None and other is not None
        )
        of_noise = _ACCELEROMETER[kind][i][j] * s_a + _GYRO[kind][i][j] * s_g
        whole: Array = of_state + of_noise + by_bias[i] * by_bias[j] * bias + by_jerk[i] * by_jerk[j] * jerk
        return whole

    return Bend(covariance(1, 1), covariance(2, 2), covariance(0, 1), covariance(0, 2), covariance(1, 2))

"""Image location errors: range and azimuth shift, their covariance on the ground, CE90 and LE90. [P-7]

The antenna's position error along the line of sight shifts the image in range; its error along the track shifts it in
azimuth, and so does R/V times the slope of the line-of-sight error over the aperture, which focusing takes for a
Doppler shift. Everything broadcasts over arrays and takes complex steps.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from nav_model.analytic.coast import carried
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

_ANGLES = 96  # of a quarter turn: the integrand is smooth for every ratio of the axes
_STEPS = 12
_DEGREE = 28
_LEAST_SIDE = 1e-12
NINETY = 1.6448536269514722
"""Sigmas that hold 90 % of a normal error on both sides."""


class AxisError(NamedTuple):
    """Error of one axis over the aperture: variance of its mean [m²], of its slope [m²/s²], and their covariance
    [m²/s]."""

    mean: Array
    slope: Array
    covariance: Array


class Shifts(NamedTuple):
    """Variances of the image's shift in range and in azimuth, their covariance, and that of the height, m²."""

    range: Array
    azimuth: Array
    covariance: Array
    height: Array


def free_line(
    start: Horizontal | Vertical,
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    bias_a: ArrayLike,
    bias_w: ArrayLike,
    g: ArrayLike,
    coast: ArrayLike,
    aperture: ArrayLike,
) -> AxisError:
    """The line in the error of a free INS over an aperture that begins `coast` seconds after the last fix.

    Parameters
    ----------
    start : Horizontal or Vertical
        Covariance at the last fix.
    sigma_a, sigma_w : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], the latter zero for the vertical.
    bias_a, bias_w : array_like
        Residual biases, m/s² and rad/s, the latter zero for the vertical.
    g, coast, aperture : array_like
        m/s², s, s.
    """
    sigma_a, sigma_w, b, d, g, c, t = (as_numbers(x) for x in (sigma_a, sigma_w, bias_a, bias_w, g, coast, aperture))
    if isinstance(start, Vertical):
        zero = 0 * start.v11
        start = Horizontal(start.v11, start.v12, zero, start.v22, zero, zero)
    p = carried(start, sigma_a, sigma_w, g, c)
    a, w = sigma_a**2, (g * sigma_w) ** 2
    p13, p23, p33 = g * p.p13, g * p.p23, g**2 * p.p33
    # mean = p + v T/2 + a T²/6, slope = v + a T/2, and what the noises add inside the aperture
    mean = (
        p.p11 + p.p22 * t**2 / 4 + p33 * t**4 / 36 + p.p12 * t + p13 * t**2 / 3 + p23 * t**3 / 6
        + a * t**3 / 20 + w * t**5 / 252
    )  # fmt: skip
    slope = p.p22 + p23 * t + p33 * t**2 / 4 + 13 / 35 * a * t + 23 / 504 * w * t**3
    covariance = (
        p.p12 + p13 * t / 2 + p.p22 * t / 2 + p23 * t**2 * (1 / 4 + 1 / 6) + p33 * t**3 / 12
        + 2 / 15 * a * t**2 + 3 / 224 * w * t**4
    )  # fmt: skip
    by_a = b * (c**2 / 2 + c * t / 2 + t**2 / 6), b * (c + t / 2)
    jerk = g * d
    by_w = jerk * (c**3 / 6 + c**2 * t / 4 + c * t**2 / 6 + t**3 / 24), jerk * (c**2 / 2 + c * t / 2 + 3 / 20 * t**2)
    return AxisError(
        mean + by_a[0] ** 2 + by_w[0] ** 2,
        slope + by_a[1] ** 2 + by_w[1] ** 2,
        covariance + by_a[0] * by_a[1] + by_w[0] * by_w[1],
    )


def shifts(
    horizontal: AxisError,
    vertical: AxisError,
    grazing: ArrayLike,
    slant_range: ArrayLike,
    speed: ArrayLike,
    squint: ArrayLike = 0.0,
) -> Shifts:
    """Shift of the image from the lines in the errors of a horizontal axis and of the vertical. [P-7]

    Range is along the line of sight, azimuth across it in the slant plane: along the track where there is no squint.
    The errors of the two horizontal axes are equal and independent. A growing error away from the radar shifts the
    image back along the track: hence the sign of the covariance.

    Parameters
    ----------
    horizontal, vertical : AxisError
        Means and slopes of the error over the aperture.
    grazing, squint : array_like
        rad.
    slant_range : array_like
        m.
    speed : array_like
        m/s.
    """
    psi, r, v, squint = (as_numbers(x) for x in (grazing, slant_range, speed, squint))
    w_h, w_v = np.cos(psi) ** 2, np.sin(psi) ** 2
    along_sight = AxisError(*(w_h * h + w_v * z for h, z in zip(horizontal, vertical, strict=True)))
    lever = r / (v * np.cos(squint))
    up = np.tan(squint) * np.sin(psi)  # of the azimuth's direction, the line of sight going down by the grazing angle
    between = AxisError(*(-up * np.sin(psi) * (z - h) for h, z in zip(horizontal, vertical, strict=True)))
    azimuth = (
        horizontal.mean * (1 - up**2)
        + vertical.mean * up**2
        - 2 * lever * between.covariance
        + lever**2 * along_sight.slope
    )
    return Shifts(along_sight.mean, azimuth, between.mean - lever * along_sight.covariance, vertical.mean)


def ground_covariance(
    moved: Shifts, grazing: ArrayLike, height_error: ArrayLike, squint: ArrayLike = 0.0
) -> tuple[Array, Array, Array]:
    """Variances along the track and across it on the ground, and their covariance, m². [P-7]

    Broadside, range becomes ground range by the cosine of the grazing angle, and an error of the scene's height moves
    the image by its tangent. Under squint both directions of the slant plane have a part in both on the ground.

    Parameters
    ----------
    moved : Shifts
        Variances in the slant plane, m².
    grazing, squint : array_like
        rad.
    height_error : array_like
        Sigma of the scene's height, m.
    """
    psi, height, squint = as_numbers(grazing), as_numbers(height_error), as_numbers(squint)
    s, k = np.sin(squint), np.cos(squint)
    side = np.cos(psi) ** 2 - s**2  # squared part of the line of sight across the track
    side = np.where(side.real > _LEAST_SIDE, side, _LEAST_SIDE)
    along = s**2 * moved.range + k**2 * moved.azimuth + 2 * s * k * moved.covariance
    across = k**4 * moved.range + (s * k) ** 2 * moved.azimuth - 2 * s * k**3 * moved.covariance
    across = (across + (np.sin(psi) * height) ** 2) / side
    covariance = (k**2 * s * (moved.range - moved.azimuth) + k * (k**2 - s**2) * moved.covariance) / np.sqrt(side)
    return along, across, covariance + 0.0  # a zero has no sign


def circular_error(variance_x: ArrayLike, variance_y: ArrayLike, covariance: ArrayLike, share: float = 0.9) -> Array:
    """Radius about the truth that contains this share of a normal error in the plane: CE90, or CEP at one half.

    Parameters
    ----------
    variance_x, variance_y, covariance : array_like
        Variances of the two axes and their covariance, m².
    share : float

    Notes
    -----
    The radius over the larger axis alone depends on the ratio of the axes' variances, smoothly: a polynomial has it
    to 1e-8 at 90 % and to 1e-5 at a half.

    Examples
    --------
    >>> f"{float(circular_error(1.0, 1.0, 0.0)):.4f} {float(circular_error(1.0, 0.0, 0.0)):.4f}"
    '2.1460 1.6449'
    """
    a, b, ab = (as_numbers(x) for x in (variance_x, variance_y, covariance))
    middle, spread = (a + b) / 2, np.sqrt((a - b) ** 2 / 4 + ab**2)
    large = middle + spread
    small = np.where(spread == 0, middle, (a * b - ab**2) / large)
    return np.asarray(np.sqrt(large * chebyshev.chebval(2 * small / large - 1, _square_radius(share))))


@cache
def _square_radius(share: float) -> Array:
    """Coefficients of the squared radius that contains this share, over the larger variance, by the ratio of the two.

    With the variances a, b along the principal axes the squared radius q obeys
    1 - share = mean over the angle of exp(-q/(2 (a cos² + b sin²))): convex in q, so Newton's method from below,
    the value for the larger axis alone, converges without overshooting.
    """
    angle = (np.arange(_ANGLES) + 0.5) * (np.pi / 2 / _ANGLES)

    def root(x: Array) -> Array:
        scale = np.cos(angle) ** 2 + ((x + 1) / 2)[:, None] * np.sin(angle) ** 2
        square = -2 * math.log(1 - share) * np.ones_like(x) / 4
        for _ in range(_STEPS):
            outside = np.exp(-square[:, None] / (2 * scale))
            square = square + (np.mean(outside, axis=-1) - (1 - share)) / np.mean(outside / (2 * scale), axis=-1)
        return square

    nodes = chebyshev.chebpts1(_DEGREE + 1)
    return np.asarray(chebyshev.chebfit(nodes, root(nodes), _DEGREE), float)

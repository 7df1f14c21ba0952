"""The INS/GNSS filter in steady state on a straight path at constant velocity, in closed form.

Symbols of theory.md: ``sigma_a`` velocity random walk [m/s/√s], ``sigma_w`` angle random walk [rad/√s],
``s`` density of the fixes [m·√s], ``g`` gravity [m/s²]. Every function broadcasts over arrays.
Source: Makarem and Cheraghi Mahmudabadi, Journal of Radar 7(2), 2019, equations 14 to 19.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array, as_numbers


class Horizontal(NamedTuple):
    """Covariance of one horizontal channel: position, velocity, tilt.

    ``p11`` [m²], ``p12`` [m²/s], ``p13`` [m·rad], ``p22`` [m²/s²], ``p23`` [m/s·rad], ``p33`` [rad²]. The
    signs are those of a channel in which positive tilt accelerates forward (y with roll); the x channel
    has p13 and p23 negative.
    """

    p11: Array
    p12: Array
    p13: Array
    p22: Array
    p23: Array
    p33: Array

    def matrix(self) -> Array:
        """As an array of shape (..., 3, 3)."""
        rows = (
            (self.p11, self.p12, self.p13),
            (self.p12, self.p22, self.p23),
            (self.p13, self.p23, self.p33),
        )
        return np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows], axis=-2)

    @classmethod
    def of(cls, matrix: Array) -> Horizontal:
        """From an array of shape (..., 3, 3), of which the upper triangle is read."""
        return cls(*(matrix[..., i, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))))


class Vertical(NamedTuple):
    """Covariance of the vertical channel: ``v11`` [m²], ``v12`` [m²/s], ``v22`` [m²/s²]."""

    v11: Array
    v12: Array
    v22: Array


def fix_density(sigma_gnss: ArrayLike, interval: ArrayLike) -> Array:
    """Density of white noise equivalent to a fix of `sigma_gnss` [m] every `interval` [s], in m·√s. [T-2]"""
    density: Array = as_numbers(sigma_gnss) * np.sqrt(as_numbers(interval))
    return density


def gyro_dominance(sigma_a: ArrayLike, sigma_w: ArrayLike, s: ArrayLike, g: ArrayLike) -> Array:
    """Gyro dominance kappa: large when the gyro limits the horizontal channel, small when the accelerometer does.
    [T-6]

    Parameters
    ----------
    sigma_a, sigma_w : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s].
    s : array_like
        Density of the fixes, `fix_density` [m·√s].
    g : array_like
        m/s².
    """
    sigma_a, sigma_w, s, g = (as_numbers(x) for x in (sigma_a, sigma_w, s, g))
    kappa: Array = 2 * np.sqrt(2) * g * sigma_w * np.sqrt(s) / sigma_a**1.5
    return kappa


def position_ratio(kappa: ArrayLike) -> Array:
    """The root u >= 1 of u⁴ = 1 + kappa·u: horizontal over vertical position variance. [T-6]

    Newton's method from a start good to 3 %: five steps reach the last bit for every kappa >= 0.
    """
    kappa = as_numbers(kappa)
    u: Array = np.sqrt(np.sqrt(1 + np.cbrt(kappa.real) ** 4))
    for _ in range(5):
        cube = u * u * u
        u = (3 * cube * u + 1) / (4 * cube - kappa)
    return u


def vertical(sigma_a: ArrayLike, s: ArrayLike, s_v: ArrayLike | None = None, gradient: ArrayLike = 0.0) -> Vertical:
    """Steady-state covariance of the vertical channel. [T-4]; with velocity fixes [P-6]

    The settled filter has x² + c1 x + c0, the stable factor of x⁴ - 2 gamma x² + gamma² + sigma_a² (1/s² - x²/s_v²).

    Parameters
    ----------
    sigma_a, s : array_like
        See the module.
    s_v : array_like, optional
        Density of the velocity fixes, m/s·√s.
    gradient : array_like, optional
        Decrease of gravity with height, gamma, 1/s²; none in [T-4] as the literature has it.
    """
    sigma_a, s, gradient = as_numbers(sigma_a), as_numbers(s), as_numbers(gradient)
    c0 = np.sqrt(gradient**2 + (sigma_a / s) ** 2)
    known, first = 1 / s**2, 2 * (c0 + gradient)
    if s_v is not None:
        s_v = as_numbers(s_v)
        known, first = known + c0 / s_v**2, first + (sigma_a / s_v) ** 2
    v11 = np.sqrt(first) / known
    return Vertical(v11, (c0 + gradient) / known, c0 * v11)


def horizontal(
    sigma_a: ArrayLike, sigma_w: ArrayLike, s: ArrayLike, g: ArrayLike, s_v: ArrayLike | None = None
) -> Horizontal:
    """Steady-state covariance of a horizontal channel. [T-3]; with velocity fixes [P-6]

    Parameters
    ----------
    sigma_a, sigma_w, s, g : array_like
        Positive; see the module. They broadcast together.
    s_v : array_like, optional
        Density of the velocity fixes, m/s·√s.
    """
    sigma_a, sigma_w, s, g = (as_numbers(x) for x in (sigma_a, sigma_w, s, g))
    if s_v is not None:
        p = _with_velocity(sigma_a, g * sigma_w, s, as_numbers(s_v))
        return Horizontal(p.p11, p.p12, p.p13 / g, p.p22, p.p23 / g, p.p33 / g**2)
    return horizontal_from_position(
        position_ratio(gyro_dominance(sigma_a, sigma_w, s, g)) * vertical(sigma_a, s).v11, sigma_w, s, g
    )


def _with_velocity(a: Array, w: Array, s: Array, s_v: Array) -> Horizontal:
    """Covariance of position, velocity and acceleration by tilt when position and velocity are both measured. [P-6]

    The characteristic polynomial x³ + c2 x² + c1 x + c0 of the settled filter is the stable factor of
    [P-6]: c0 = w/s, c1² = a²/s² + (s c0/s_v)² + 2 c0 c2, c2² = (a/s_v)² + 2 c1. Every step adds positive numbers.
    """
    c0, rho = w / s, (s / s_v) ** 2
    first, free = (a / s_v) ** 2, (a / s) ** 2 + rho * c0**2
    c2: Array = np.sqrt(first + 2 * np.sqrt(free) + 4 * np.cbrt(c0.real) ** 2)
    # Newton's method: the right-hand side is concave, with a slope of at most a quarter at the root. From a start
    # good to 16 % three steps reach the last bit, and a fourth that of a complex step.
    for _ in range(4):
        c1 = np.sqrt(free + 2 * c0 * c2)
        right = np.sqrt(first + 2 * c1)
        c2 = c2 - (c2 - right) / (1 - c0 / (c1 * right))
    b = c2 + rho * c0
    u = 1 / np.sqrt(1 + rho * b**2)
    x = b * u
    p12 = (s * x) ** 2 / (1 + u)
    p13, p23 = u * s * w, x * s * w
    p22 = s**2 * (x**3 / (u * (1 + u)) - c0)
    return Horizontal(s**2 * x, p12, p13, p22, p23, p12 * p13 / s**2 + p22 * p23 / s_v**2)


def horizontal_from_position(p11: Array, sigma_w: Array, s: Array, g: Array) -> Horizontal:
    """The other elements of [T-3], given the variance of position.

    Parameters
    ----------
    p11 : array
        Variance of position, m².
    sigma_w, s, g : array
        As `gyro_dominance`.
    """
    ratio = p11 / s  # [m/√s]; powers of s itself would leave the range of floats sooner
    return Horizontal(
        p11=p11,
        p12=ratio * ratio / 2,
        p13=sigma_w * s,
        p22=ratio**3 / (2 * s) - g * sigma_w * s,
        p23=ratio * sigma_w,
        p33=ratio * ratio * sigma_w / (2 * g * s),
    )


def gyro_dominated(sigma_w: ArrayLike, s: ArrayLike, g: ArrayLike) -> tuple[Array, Array, Array]:
    """Asymptotes of p11, p22, p33 for kappa >> 1; relative error of p11 about kappa^(-4/3)/3. [T-7]"""
    sigma_w, s, g = (as_numbers(x) for x in (sigma_w, s, g))
    p11 = 2 * np.cbrt(s**5 * g * sigma_w)
    return p11, 3 * g * sigma_w * s, 2 * np.cbrt(s * sigma_w**5 / g)


def yaw_variance(sigma_w: ArrayLike, time: ArrayLike) -> Array:
    """Growth of the yaw variance [rad²] over `time` [s]: unobservable on this path. [T-5]"""
    variance: Array = as_numbers(sigma_w) ** 2 * as_numbers(time)
    return variance


def lambda_dt(p11: ArrayLike, s: ArrayLike, interval: ArrayLike) -> Array:
    """Filter bandwidth times fix interval; above 0.5 the sawtooth of a discrete filter is wide. [T-8]"""
    product: Array = as_numbers(p11) * as_numbers(interval) / as_numbers(s) ** 2
    return product

"""Growth of the errors after the fixes stop, as polynomials of time.

`time` [s] counts from the last fix. Every function broadcasts: the covariance's elements against `time`.
Source: Makarem and Cheraghi Mahmudabadi 2019, equations 21 to 27.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers


class HorizontalGrowth(NamedTuple):
    """Variances of one horizontal channel against time: [m²], [m²/s²], [rad²]."""

    position: Array
    velocity: Array
    tilt: Array


class VerticalGrowth(NamedTuple):
    """Variances of the vertical channel against time: [m²], [m²/s²]."""

    position: Array
    velocity: Array


def horizontal_growth(
    start: Horizontal, sigma_a: ArrayLike, sigma_w: ArrayLike, g: ArrayLike, time: ArrayLike
) -> HorizontalGrowth:
    """Variances of a horizontal channel `time` seconds after the last fix. [T-9]

    Parameters
    ----------
    start : Horizontal
        Covariance at the last fix.
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    time : array_like
        Seconds since the last fix.
    """
    sigma_a, sigma_w, g, t = (as_numbers(x) for x in (sigma_a, sigma_w, g, time))
    p = start
    position = p.p11 + t * (
        2 * p.p12
        + t
        * (p.p22 + g * p.p13 + t * (sigma_a**2 / 3 + g * p.p23 + t * (g**2 * p.p33 / 4 + t * g**2 * sigma_w**2 / 20)))
    )
    velocity = p.p22 + t * (sigma_a**2 + 2 * g * p.p23 + t * (g**2 * p.p33 + t * g**2 * sigma_w**2 / 3))
    return HorizontalGrowth(position, velocity, p.p33 + sigma_w**2 * t)


def carried(start: Horizontal, sigma_a: ArrayLike, sigma_w: ArrayLike, g: ArrayLike, time: ArrayLike) -> Horizontal:
    """Covariance of a horizontal channel `time` seconds after the last fix, every element.

    Parameters
    ----------
    start, sigma_a, sigma_w, g, time
        As `horizontal_growth`.
    """
    sigma_a, sigma_w, g, t = (as_numbers(x) for x in (sigma_a, sigma_w, g, time))
    p, a, w = start, sigma_a**2, sigma_w**2
    grown = horizontal_growth(start, sigma_a, sigma_w, g, t)
    p12 = (
        p.p12
        + (p.p22 + g * p.p13) * t
        + 1.5 * g * p.p23 * t**2
        + g**2 * p.p33 * t**3 / 2
        + a * t**2 / 2
        + g**2 * w * t**4 / 8
    )
    p13 = p.p13 + p.p23 * t + g * p.p33 * t**2 / 2 + g * w * t**3 / 6
    p23 = p.p23 + g * p.p33 * t + g * w * t**2 / 2
    return Horizontal(grown.position, p12, p13, grown.velocity, p23, grown.tilt)


def vertical_growth(start: Vertical, sigma_a: ArrayLike, time: ArrayLike) -> VerticalGrowth:
    """Variances of the vertical channel `time` seconds after the last fix. [T-10]"""
    sigma_a, t = as_numbers(sigma_a), as_numbers(time)
    position = start.v11 + t * (2 * start.v12 + t * (start.v22 + t * sigma_a**2 / 3))
    return VerticalGrowth(position, start.v22 + sigma_a**2 * t)


def perfect_start(sigma_a: ArrayLike, sigma_w: ArrayLike, g: ArrayLike, time: ArrayLike) -> tuple[Array, Array]:
    """Position variances [m²], horizontal and vertical, of an INS without initial error. [T-11]

    Parameters
    ----------
    sigma_a, sigma_w, g, time
        As `horizontal_growth`.
    """
    sigma_a, sigma_w, g, t = (as_numbers(x) for x in (sigma_a, sigma_w, g, time))
    vertical = sigma_a**2 * t**3 / 3
    return vertical + g**2 * sigma_w**2 * t**5 / 20, vertical


def initial_tilt(p33: ArrayLike, g: ArrayLike, time: ArrayLike) -> Array:
    """Horizontal position variance [m²] from the tilt at the last fix alone. [T-12]"""
    p33, g, t = (as_numbers(x) for x in (p33, g, time))
    variance: Array = g**2 * p33 * t**4 / 4
    return variance


def bias_position(
    accelerometer_bias: ArrayLike, gyro_bias: ArrayLike, g: ArrayLike, time: ArrayLike
) -> tuple[Array, Array]:
    """Position errors [m], 1σ, from residual biases: b t²/2 and g d t³/6 (the second horizontal only).

    Parameters
    ----------
    accelerometer_bias, gyro_bias : array_like
        1σ at the last fix, m/s² and rad/s.
    """
    b, d, g, t = (as_numbers(x) for x in (accelerometer_bias, gyro_bias, g, time))
    return b * t**2 / 2, g * d * t**3 / 6


def bias_velocity(
    accelerometer_bias: ArrayLike, gyro_bias: ArrayLike, g: ArrayLike, time: ArrayLike
) -> tuple[Array, Array]:
    """Velocity errors [m/s], 1σ, from residual biases: b t and g d t²/2 (the second horizontal only).

    Parameters
    ----------
    accelerometer_bias : array_like
        b, m/s².
    gyro_bias : array_like
        d, rad/s.
    g : array_like
        m/s².
    time : array_like
        Seconds since the last fix.
    """
    b, d, g, t = (as_numbers(x) for x in (accelerometer_bias, gyro_bias, g, time))
    return b * t, g * d * t**2 / 2


def varying_heading(instability: ArrayLike, correlation_time: ArrayLike, walk: ArrayLike, time: ArrayLike) -> Array:
    """Variance of the heading [rad²] that the vertical gyro's varying bias makes over a time. [T-22]

    Parameters
    ----------
    instability, correlation_time : array_like
        Of a Gauss-Markov process, 1σ [rad/s], [s].
    walk : array_like
        Rate random walk, rad/s/√s.
    time : array_like
        Seconds.
    """
    sigma, tau, walk, t = (as_numbers(x) for x in (instability, correlation_time, walk, time))
    age = t / tau
    variance: Array = 2 * (sigma * tau) ** 2 * (age + np.expm1(-age)) + walk**2 * t**3 / 3
    return variance

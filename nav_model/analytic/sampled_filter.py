"""Steady state of the filter with sampled fixes, in closed form, by spectral factorisation. [T-8]

With the fix interval as unit of time and the fix noise as unit of length, the spectrum of the innovations of a
channel that integrates white noise twice (alpha, accelerometer) and three times (beta, gyro times gravity) is
rational in u = (1 - z)(1 - 1/z):

    u³ S(u) = u³ + alpha² u (1 - u/6) + beta² (1 - u/4 + u²/120)

with the exactly sampled noises. One factor of the cubic, u + rho with rho > 0, is found by Newton's method,
which converges from above monotonically; the other is a quadratic known in closed form. The roots inside the
unit circle give the characteristic polynomial of the settled filter, hence its gain, hence its covariance.
Written in delta = z - 1, every step adds numbers of one sign or nearly so: the result is good to rounding
from MEMS to navigation grade, at the cost of some eighty array operations, so that it serves one design or a
map.

Source: spectral factorisation, Anderson and Moore, *Optimal Filtering*, 1979, section 9.3; the sampled spectra
are those of the Euler-Frobenius polynomials.
"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.rise import gravity_gradient, rise
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

_NEWTON_STEPS = 10  # the start is at most about three times the root; six steps reach the last bit


def horizontal_cycle(
    sigma_a: ArrayLike, sigma_w: ArrayLike, g: ArrayLike, interval: ArrayLike, sigma_fix: ArrayLike
) -> tuple[Horizontal, Horizontal]:
    """Covariance of a horizontal channel just before a fix and just after it. [T-8]

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²]; positive.
    interval, sigma_fix : array_like
        Between fixes [s]; one fix, 1σ [m]; positive. All broadcast together.
    """
    sigma_a, sigma_w, g, h, r = (as_numbers(x) for x in (sigma_a, sigma_w, g, interval, sigma_fix))
    root = np.sqrt(h)
    qa = (sigma_a * h * root / r) ** 2
    qw = (g * sigma_w * h * h * root / r) ** 2
    rho, b, c = cubic_factors(qa, qw)
    z1, e = delta_root(rho)
    product, d0, d1 = quadratic_factor(b, c)
    product = product * z1  # of the three roots: fix noise over innovation variance
    f2, f1, f0 = e + d1, d0 + e * d1, e * d0
    innovation = 1 / product
    k1, k2, k3 = f2 - f1 + f0, f1 - 1.5 * f0, f0
    p11, p12, p13 = k1 * innovation, k2 * innovation, k3 * innovation
    # Posterior X = P - K K' times innovation, and P = Phi X Phi' + Q, read from the last row upwards.
    x33 = k2 * p13 - qw / 2
    x23 = k1 * p13 - x33 / 2 - qw / 6
    x13 = p13 * product
    x22 = k1 * p12 - x13 - 1.5 * x23 - x33 / 2 - (qa / 2 + qw / 8)
    prior = (p11, p12, p13, x22 + k2 * p12, x23 + k2 * p13, x33 + qw)
    posterior = (k1, p12 * product, x13, x22, x23, x33)
    v, a = r / h, r / (h * h * g)  # units of velocity and tilt
    units = (r * r, r * v, r * a, v * v, v * a, a * a)
    before, after = (
        Horizontal(*(x * unit for x, unit in zip(elements, units, strict=True))) for elements in (prior, posterior)
    )
    return before, after


def vertical_cycle(
    sigma_a: ArrayLike, g: ArrayLike, interval: ArrayLike, sigma_fix: ArrayLike
) -> tuple[Vertical, Vertical]:
    """Covariance of the vertical channel just before a fix and just after it. [T-8]

    Gravity decreases with height: the poles at z = 1 part to either side, and u² of the spectrum becomes
    (u + risen)², by `nav_model.analytic.rise` over an interval.

    Parameters
    ----------
    sigma_a, g, interval, sigma_fix
        As `horizontal_cycle`.
    """
    sigma_a, h, r = (as_numbers(x) for x in (sigma_a, interval, sigma_fix))
    gradient = gravity_gradient(g)
    qa, free = sigma_a**2 * h**3 / r**2, rise(gradient, h)
    risen, sine, cosine = free.risen, free.sine, free.cosine
    q11, q12, q22 = (qa * noise for noise in free.noise)
    # The spectrum of what the noise makes of the position, and the stable factor of that of the innovations.
    level = q11 * (risen / 2) ** 2 - q12 * sine * risen + q22 * sine**2
    product, d0, d1 = quadratic_factor(2 * risen + q11 * cosine - q12 * sine, risen**2 + level)
    k1 = d1 - d0
    k2 = (d0 + risen - k1 * risen / 2) / sine
    p11, p12 = k1 / product, k2 / product
    # Posterior X, and P = Phi X Phi' + Q, read from its covariance of position and velocity.
    driven = gradient * h**2 * sine
    x22 = (k1 * p12 - 2 * driven * sine * k2 - driven * cosine * k1 - q12) / (sine * cosine)
    p22 = driven**2 * k1 + 2 * driven * cosine * k2 + cosine**2 * x22 + q22
    v = r / h
    return (
        Vertical(p11 * r * r, p12 * r * v, p22 * v * v),
        Vertical(k1 * r * r, k2 * r * v, x22 * v * v),
    )


def cubic_factors(qa: Array, qw: Array) -> tuple[Array, Array, Array]:
    """rho, b, c of u³ + qa u (1 - u/6) + qw (1 - u/4 + u²/120) = (u + rho)(u² + b u + c); rho, -b and c positive."""
    rho = _positive_root(qa, qw)
    share = 1 + rho * (0.25 + rho / 120)
    b = -(qa * (1 / 6 + rho / 30) + rho * (1 + rho / 4)) / share
    return rho, b, (qa * (1 + rho / 6) + rho * rho) / share


def delta_root(rho: Array) -> tuple[Array, Array]:
    """The root z inside the unit circle behind u = -rho, and 1 - z."""
    width = np.sqrt(rho * (rho + 4))
    return 2 / (2 + rho + width), 2 * rho / (rho + width)


def _positive_root(qa: Array, qw: Array) -> Array:
    """The root rho > 0 of rho³ + qa rho (1 + rho/6) = qw (1 + rho/4 + rho²/120).

    The difference of the two sides has one positive root and is convex to its right, so Newton's method
    started above it comes down to it without overshooting.
    """
    # Two bounds from above, each near the root where it is the smaller: one keeps the cubic, one leaves it out.
    # They depend on real parts alone: Newton's method brings the small imaginary part of a complex step along.
    a, w = qa.real, qw.real
    cubic = np.cbrt(w) + np.sqrt(np.maximum(w / 4 - a, 0)) + np.maximum(w / 120 - a / 6, 0)
    k = np.minimum(w / a, 19.99)
    rest, lead = 1 - k / 4, 1 / 6 - k / 120
    root = np.sqrt(rest**2 + 4 * k * lead)
    quadratic = np.where(rest > 0, 2 * k / (np.abs(rest) + root), (root - rest) / (2 * lead))
    rho = np.where(w < 19.99 * a, np.minimum(cubic, quadratic), cubic)
    for _ in range(_NEWTON_STEPS):
        difference = ((rho + qa / 6 - qw / 120) * rho + (qa - qw / 4)) * rho - qw
        slope = (3 * rho + qa / 3 - qw / 60) * rho + (qa - qw / 4)
        rho = rho - difference / slope
    result: Array = rho
    return result


def quadratic_factor(b: Array, c: Array) -> tuple[Array, Array, Array]:
    """Stable factor delta² + d1 delta + d0 behind u² + b u + c; first the product of its two roots z."""
    root_c = np.sqrt(c)
    y = (root_c + np.sqrt(c + 16 + 4 * b)) / 2
    x = np.sqrt(root_c * y + b)
    m = 2 / (y + x)
    return m * m, m * root_c, m * (x + root_c)

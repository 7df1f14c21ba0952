"""Steady state of the sampled filter that also estimates a slow GNSS error, in closed form. [T-8]

The fixes carry white noise and a first-order Gauss-Markov error that the filter models as one more state. As in
`nav_model.analytic.sampled_filter`, the fix interval is the unit of time, the white fix noise the unit of length,
u = (1 - z)(1 - 1/z), and C(u) is that module's cubic (the vertical channel's square). With phi the error's decay
over an interval, epsilon = 1 - phi and gamma its innovation variance, the spectrum of the innovations has the
numerator

    C(u) (epsilon² + phi u) + gamma u^n,     n = 3 horizontally, 2 vertically

Horizontally it is negative at u = -epsilon²/phi and at the real root of C, positive at zero and far below: one
real root lies between these and zero and one beyond them. Vertically one lies beyond -epsilon²/phi. Each is
bracketed and found by Newton's method in logarithms; what remains is a quadratic.
The roots z give the settled gain, the gain the covariance. Terms are arranged so that nearly every sum adds
numbers of one sign, so the result holds for every allowed design. It costs some three hundred array operations, for
one design or a map of 40,000.

Source: spectral factorisation, Anderson and Moore, *Optimal Filtering*, 1979, section 9.3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.sampled_filter import cubic_factors, delta_root, quadratic_factor
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

_MOST_STEPS = 200  # ten are usual
_NEAR = 1e-6  # of the root: two more steps of Newton's method reach the last bit
_FAR = 1e-4  # the longest step down: further, the logarithms are not yet straight
_LEAST_DECAY = 1e-30  # an error forgotten to thirty digits between fixes is white; zero would divide

_Balance = tuple[Array, Array]
"""Ratio of two sides, and its logarithmic derivative."""


class _Error(NamedTuple):
    """The slow error at the fixes: decay over an interval, one minus it, innovation variance over the white noise."""

    phi: Array
    epsilon: Array
    gamma: Array

    @property
    def pole(self) -> Array:
        """-u at z = phi."""
        return self.epsilon**2 / self.phi

    def distance(self, gap: Array, z: Array, e: Array) -> Array:
        """How far, in epsilon, a root z = 1 - e lies from phi, from the gap between both in u, however small."""
        return gap * self.phi * z / (self.epsilon * (self.epsilon + e * self.phi))


def _error(interval: Array, fix: Array, sigma: Array, correlation_time: Array) -> _Error:
    rate = interval / correlation_time
    phi = np.exp(-rate)
    phi = np.where(phi.real < _LEAST_DECAY, _LEAST_DECAY, phi)
    return _Error(phi, -np.expm1(-rate), -np.expm1(-2 * rate) * (sigma / fix) ** 2)


def horizontal_cycle_slow(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_slow: ArrayLike,
    correlation_time: ArrayLike,
) -> tuple[Horizontal, Horizontal, Array]:
    """Covariance of a horizontal channel just before a fix and just after it, slow error estimated. [T-8]

    Third comes the covariance [m rad], just after the fix, of the tilt error with the slow error itself: the
    estimate of the slow error is independent of the filter's errors, the error of that estimate is not.

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²]; positive.
    interval, sigma_fix : array_like
        Between fixes [s]; white noise of one fix, 1σ [m]; positive.
    sigma_slow, correlation_time : array_like
        Slow error of the fixes: 1σ [m], time to fall to 1/e [s]; positive. All broadcast together.
    """
    sigma_a, sigma_w, g, h, r, slow, tau = (
        as_numbers(x) for x in (sigma_a, sigma_w, g, interval, sigma_fix, sigma_slow, correlation_time)
    )
    root = np.sqrt(h)
    qa = (sigma_a * h * root / r) ** 2
    qw = (g * sigma_w * h * h * root / r) ** 2
    error = _error(h, r, slow, tau)
    phi, epsilon, gamma = error
    near, far, short, long = _real_roots(qa, qw, error)
    b, c = _middle(qa, qw, error, near, far)
    (z1, e1), (z2, e2) = delta_root(near), delta_root(far)
    product, d0, d1 = quadratic_factor(b, c)
    s = phi / (z1 * z2 * product)  # innovation variance
    # Characteristic polynomial of the settled filter against the open one, (delta + epsilon) delta³.
    below, above = error.distance(short, z1, e1), error.distance(long, z2, e2)
    cross = e1 + e2 * below
    l3 = e1 * e2 * d0 / epsilon
    m = (e1 * e2 * d1 + d0 * cross) / epsilon
    l1 = (e1 * e2 + d1 * cross - d0 * below * above) / epsilon
    k4 = gamma * epsilon**3 / (s * (epsilon + phi * e1) * (epsilon + phi * e2)
                               * (epsilon**2 + d1 * epsilon * phi + d0 * phi**2))  # fmt: skip
    k1, k2, k3 = l1 - m + l3, m - 1.5 * l3, l3
    # Minus the covariance of the slow error with tilt, velocity and position, from the last row upwards.
    pull = phi * s * k4
    w3 = pull * l3 / epsilon
    w2 = (phi * w3 + pull * (m - l3 / 2)) / epsilon
    w1 = (phi * (w2 + w3 / 2) + pull * l1) / epsilon
    more = 1 + s * k4
    x11, x12, x13 = k1 * more + w1, k2 * more + w2, k3 * more + w3
    x33 = s * k2 * k3 - qw / 2
    x23 = s * k1 * k3 - x33 / 2 - qw / 6
    x22 = s * k1 * k2 - x13 - 1.5 * x23 - x33 / 2 - (qa / 2 + qw / 8)
    posterior = (x11, x12, x13, x22, x23, x33)
    prior = (s * k1 + w1, s * k2 + w2, s * k3 + w3, x22 + s * k2 * k2, x23 + s * k2 * k3, x33 + qw)
    v, a = r / h, r / (h * h * g)  # units of velocity and tilt
    units = (r * r, r * v, r * a, v * v, v * a, a * a)
    before, after = (
        Horizontal(*(x * unit for x, unit in zip(elements, units, strict=True))) for elements in (prior, posterior)
    )
    return before, after, (w3 + s * k3 * k4) * r * a


def vertical_cycle_slow(
    sigma_a: ArrayLike, interval: ArrayLike, sigma_fix: ArrayLike, sigma_slow: ArrayLike, correlation_time: ArrayLike
) -> tuple[Vertical, Vertical]:
    """Covariance of the vertical channel just before a fix and just after it; as `horizontal_cycle_slow`. [T-8]"""
    sigma_a, h, r, slow, tau = (as_numbers(x) for x in (sigma_a, interval, sigma_fix, sigma_slow, correlation_time))
    qa = sigma_a**2 * h**3 / r**2
    error = _error(h, r, slow, tau)
    phi, epsilon, gamma = error
    pole, ratio = error.pole, gamma / phi
    k = 2 * np.sqrt(qa.real) + qa.real / 6  # (t² + qa t/6 + qa)/t is never less
    with np.errstate(divide="ignore"):
        most = np.minimum(pole.real + ratio.real, np.where(k > ratio.real, pole.real / (1 - ratio.real / k), np.inf))

    def balance(t: Array, above: Array) -> _Balance:
        up, up_slope = _square(t, qa, qa / 6, 1)
        return above * up / (ratio * t * t), 1 / above + up_slope / up - 2 / t

    beyond = _root(balance, pole, most)
    far = pole + beyond
    c = pole * qa / far
    b = np.where(c.real <= far.real**2, (qa - pole * qa / 6 - c) / far, pole + ratio - qa / 6 - far)
    z, e = delta_root(far)
    product, d0, d1 = quadratic_factor(b, c)
    s = phi / (z * product)
    l2 = e * d0 / epsilon
    l1 = (e * d1 - d0 * error.distance(beyond, z, e)) / epsilon
    k3 = gamma * epsilon**2 / (s * (epsilon + phi * e) * (epsilon**2 + d1 * epsilon * phi + d0 * phi**2))
    k1, k2 = l1 - l2, l2
    pull = phi * s * k3
    w2 = pull * l2 / epsilon
    w1 = (phi * w2 + pull * l1) / epsilon
    more = 1 + s * k3
    x22 = s * k1 * k2 - qa / 2
    v = r / h
    return (
        Vertical((s * k1 + w1) * r * r, (s * k2 + w2) * r * v, (x22 + qa) * v * v),
        Vertical((k1 * more + w1) * r * r, (k2 * more + w2) * r * v, x22 * v * v),
    )


def _real_roots(qa: Array, qw: Array, error: _Error) -> tuple[Array, Array, Array, Array]:
    """-u of the two real roots of the horizontal numerator, the smaller first, and how far each is from the pole."""
    rho, b, c = cubic_factors(qa, qw)
    lift = -b  # C(-t) = (rho - t)(t² + lift t + c): both factors of the quadratic are positive
    pole, ratio = error.pole, error.gamma / error.phi
    # Without the quadratic's lower terms the roots obey t² - (rho + pole + ratio) t + rho pole = 0.
    middle, both = (rho + pole + ratio).real, (rho * pole).real
    larger = (middle + np.sqrt(np.maximum(middle**2 - 4 * both, 0))) / 2
    # (t² + lift t + c)/t is never less than k, which bounds the roots where ratio is small beside it.
    k = (lift + 2 * np.sqrt(c)).real
    rest = 1 - ratio.real / k
    half = (rho + pole).real
    wide = half + np.sqrt(np.maximum(half**2 - 4 * np.maximum(rest, 0) * both, 0))
    with np.errstate(divide="ignore"):
        far_start = np.minimum(larger, np.where(rest > 0, wide / (2 * rest), np.inf))
    first = rho.real > pole.real
    large, small = np.where(first, rho, pole), np.where(first, pole, rho)

    def beyond(t: Array, above: Array) -> _Balance:
        up, up_slope = _square(t, c, lift, 1)
        rest = above + (large - small)
        return above * rest * up / (ratio * t**3), 1 / above + 1 / rest + up_slope / up - 3 / t

    past = _root(beyond, large, far_start)

    # The smaller root by its inverse x: (rho x - 1)(pole x - 1)(1 + lift x + c x²) = ratio x.
    def before(x: Array, above: Array) -> _Balance:
        up, up_slope = _square(x, 1, lift, c)
        rest = above + (1 / small - 1 / large)
        return large * small * above * rest * up / (ratio * x), 1 / above + 1 / rest + up_slope / up - 1 / x

    with np.errstate(divide="ignore"):
        inverse_start = np.minimum(larger / both, np.where(rest > 0, wide / (2 * both), np.inf))
    inverse = _root(before, 1 / small, inverse_start)
    near = small / (1 + small * inverse)
    return near, large + past, near * pole * (inverse + (1 / small - 1 / pole)), past + (large - pole)


def _square(t: Array, c: Array | float, b: Array | float, a: Array | float) -> tuple[Array, Array]:
    """a t² + b t + c and its slope."""
    return (a * t + b) * t + c, 2 * a * t + b


def _root(balance: Callable[[Array, Array], _Balance], edge: Array, most: Array) -> Array:
    """How far the root that is above `edge` and not above `most` lies above it.

    `balance` takes t and t - edge and gives the ratio of two sides that are equal at the root, zero at the edge
    and at least one at `most`, with its logarithmic derivative. Newton's method in the logarithms of both, where
    the sides are nearly straight, kept inside what is known to hold the root.
    """
    shape = np.broadcast_shapes(edge.shape, most.shape)
    inside = edge.real
    high = np.broadcast_to(np.maximum(most - inside, 0) + 1e-14 * inside, shape)
    low, above = np.zeros(shape), high
    for _ in range(_MOST_STEPS):
        sides, slope = (x.real for x in balance(inside + above, above))
        low, high = np.where(sides < 1, above, low), np.where(sides < 1, high, above)
        with np.errstate(divide="ignore", over="ignore"):
            new = above * np.exp(-np.log(sides) / (above * slope))
        # Rounding near the root must not count as having left what holds it.
        least = np.maximum(low, above * _FAR)
        kept = (new >= least * (1 - _NEAR)) & (new <= high * (1 + _NEAR))
        new = np.where(kept, new, np.maximum(np.sqrt(low * high), above * _FAR))
        done, above = np.all(np.abs(new / above - 1) <= _NEAR), new
        if done:
            break
    else:
        raise ArithmeticError("the spectral factor of the slow error did not settle")
    for _ in range(2):  # whole numbers now, so that a complex step's derivative follows
        sides, slope = balance(edge + above, above)
        above = above - np.log(sides) / slope
    return above


def _middle(qa: Array, qw: Array, error: _Error, near: Array, far: Array) -> tuple[Array, Array]:
    """The quadratic u² + b u + c that is left of the horizontal numerator."""
    pole, ratio = error.pole, error.gamma / error.phi
    c2, c1 = qw / 120 - qa / 6, qa - qw / 4
    c = qw * pole / (near * far)
    size = np.sqrt(c.real)
    # One of three coefficients gives b without losing it in larger numbers, by where the quadratic's roots lie.
    b = np.where(
        size < near.real,
        (qw + pole * c1 - c * (near + far)) / (near * far),
        np.where(size > far.real, pole + ratio + c2 - near - far, (c1 + pole * c2 - c - near * far) / (near + far)),
    )
    return b, c

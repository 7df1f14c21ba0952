"""Shares by error source and exact logarithmic derivatives of the steady state.

The filter's gain is optimal, so the share of a source in a variance IS the logarithmic derivative of that
variance with respect to the source's own variance ([T-18]). Differentiating [T-3] implicitly gives them in
closed form. Every function broadcasts over arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Horizontal, Vertical, horizontal, vertical
from nav_model.base.arrays import Array


class LogDerivatives(NamedTuple):
    """d ln(element) / d ln(input) of every element of a `Horizontal`, one per input."""

    sigma_a: Horizontal
    sigma_w: Horizontal
    s: Horizontal
    g: Horizontal


def log_derivatives(sigma_a: ArrayLike, sigma_w: ArrayLike, s: ArrayLike, g: ArrayLike) -> LogDerivatives:
    """Exact logarithmic derivatives of [T-3] by implicit differentiation.

    With P = p11⁴/4 and B = 2 g sigma_w s⁵ p11, [T-3] reads P = B + s⁶ sigma_a², and
    d ln p11 / d ln x = (x dF/dx) / (4P - B) for the right-hand side F.
    """
    sigma_a, sigma_w, s, g = (np.asarray(x, float) for x in (sigma_a, sigma_w, s, g))
    return _slopes(horizontal(sigma_a, sigma_w, s, g), sigma_a, sigma_w, s, g)


def _slopes(p: Horizontal, sigma_a: Array, sigma_w: Array, s: Array, g: Array) -> LogDerivatives:
    gyro = 2 * g * sigma_w * s**5 * p.p11
    accelerometer = s**6 * sigma_a**2
    slope = 3 * gyro + 4 * accelerometer
    d_a = 2 * accelerometer / slope
    d_w = gyro / slope
    d_s = (5 * gyro + 6 * accelerometer) / slope
    # p22 = A - C with A = p11³/(2 s⁴), C = g sigma_w s
    head = (p.p22 + g * sigma_w * s) / p.p22
    tail = g * sigma_w * s / p.p22
    zero, one = np.zeros_like(d_a), np.ones_like(d_a)
    return LogDerivatives(
        sigma_a=Horizontal(d_a, 2 * d_a, zero, 3 * d_a * head, d_a, 2 * d_a),
        sigma_w=Horizontal(d_w, 2 * d_w, one, 3 * d_w * head - tail, d_w + 1, 2 * d_w + 1),
        s=Horizontal(d_s, 2 * d_s - 2, one, (3 * d_s - 4) * head - tail, d_s - 1, 2 * d_s - 3),
        g=Horizontal(d_w, 2 * d_w, zero, 3 * d_w * head - tail, d_w, 2 * d_w - 1),
    )


class Parts(NamedTuple):
    """A horizontal covariance split into what each source contributes; the three add up to it exactly."""

    accelerometer: Horizontal
    gyro: Horizontal
    gnss: Horizontal


def horizontal_parts(sigma_a: ArrayLike, sigma_w: ArrayLike, s: ArrayLike, g: ArrayLike) -> Parts:
    """Contribution of each source to every element of the steady-state covariance. [T-18]

    The covariance is homogeneous of degree one in (sigma_a², sigma_w², s²), so half its three logarithmic derivatives
    with respect to these add up to one.
    """
    sigma_a, sigma_w, s, g = (np.asarray(x, float) for x in (sigma_a, sigma_w, s, g))
    p = horizontal(sigma_a, sigma_w, s, g)
    d = _slopes(p, sigma_a, sigma_w, s, g)
    return Parts(
        *(
            Horizontal(*(element * slope / 2 for element, slope in zip(p, slopes, strict=True)))
            for slopes in (d.sigma_a, d.sigma_w, d.s)
        )
    )


def vertical_parts(sigma_a: ArrayLike, s: ArrayLike) -> tuple[Vertical, Vertical]:
    """Contributions of accelerometer and GNSS to the vertical covariance, from the powers of [T-4]."""
    v = vertical(sigma_a, s)
    weights = (0.25, 0.5, 0.75)  # v11 ~ sigma_a^(1/2), v12 ~ sigma_a, v22 ~ sigma_a^(3/2)
    accelerometer = Vertical(*(weight * element for weight, element in zip(weights, v, strict=True)))
    gnss = Vertical(*((1 - weight) * element for weight, element in zip(weights, v, strict=True)))
    return accelerometer, gnss

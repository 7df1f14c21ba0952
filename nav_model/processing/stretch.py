"""A stretch of flight: a segment, and what becomes of the position error along it.

The position error p(t) along a stretch follows from the stretch's first state x0 and from noise, given the fixes in
it. A stretch has the coefficients c of its first six Legendre polynomials,

    c = L x0 + n,   n of covariance S,   C = cov(n, w) with the noise w of the last state, x1 = Phi x0 + w

and of the remainder r(t) = R(t) x0 + noise, D(t) = cov(r(t), w), two means over the stretch: `gram` is that of
[R D]ᵀ [R D], `rest` that of var r. Information Y about the last state changes them as in every Gaussian update, with
K = (1 + Q Y)⁻¹ and T = Y K:

    L - C T Phi,   C Kᵀ,   S - C T Cᵀ

Two stretches in a row are one, so an aperture of n fixes takes as many steps as n has binary digits. The doubling is
that of `nav_model.analytic.doubling`; the coefficients along the way are our own addition.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from nav_model.analytic import doubling
from nav_model.analytic.doubling import Segment, drift
from nav_model.base.arrays import Array

ORDERS = 6
"""Legendre orders of the position error that figures use: 0 to 5."""

_MODES = 12  # of white noise: orders above add nothing to the first six of its second to sixth integral


class Stretch(NamedTuple):
    """One stretch of every design, rows first.

    `info`, `transition` and `noise` of the segment are (rows, n, n), its length ``span`` (rows); ``lines`` = [L C],
    (rows, 6, 2 n); ``spread`` = S, (rows, 6, 6); ``gram``, (rows, 2 n, 2 n); ``rest`` (rows). Coefficients are of
    polynomials that are orthonormal over the stretch.
    """

    info: Array
    transition: Array
    noise: Array
    span: Array
    lines: Array
    spread: Array
    gram: Array
    rest: Array

    @property
    def segment(self) -> Segment:
        """Its information, transition and noise alone, as a filter doubles them."""
        return Segment(*self[:3])


def free(
    span: Array, accelerometer: Array, gyro: Array, slow: tuple[ArrayLike, ArrayLike] | None, gradient: Array
) -> Stretch:
    """A stretch without fixes.

    Along it gravity that decreases with height counts to the second power of the gradient, which leaves out 10⁻⁹
    where fixes are a minute apart.

    Parameters
    ----------
    span : array (rows,)
        Seconds.
    accelerometer, gyro, slow, gradient
        As `nav_model.analytic.doubling.drift`, of (rows,).
    """
    segment = drift(span, accelerometer, gyro, slow, gradient)
    n, unit = segment.noise.shape[-1], _drift_of_one()
    a, w = accelerometer * span**3, gyro * span**5
    rising = (gradient * span**2)[:, None] ** np.arange(3)
    # L: position, velocity and acceleration at the start move the position as 1, t and t²/2; with the gradient, the
    # first two as the powers of cosh and sinh.
    lines = np.zeros((len(span), ORDERS, 2 * n), segment.noise.dtype)
    by_state = np.einsum("nk,kij->nij", rising, unit.state)
    lines[:, :, :3] = by_state * np.stack([0 * span + 1, span, span**2], axis=-1)[:, None, :]
    if n == 4:  # position is the first state less the slow error
        lines[:, :, 3] = -lines[:, :, 0]
    # C: position, velocity and acceleration at the end have powers of the span less than position along it.
    powers = span[:, None] ** np.arange(5, 0, -1)
    by_a, by_w = accelerometer[:, None] * powers[:, 2:], gyro[:, None] * powers[:, :3]
    with_end, spread_a = (np.einsum("nk,kij->nij", rising, part) for part in (unit.with_end, unit.spread))
    lines[:, :, n : n + 3] = with_end * by_a[:, None, :] + unit.gyro_with_end * by_w[:, None, :]
    spread = spread_a * a[:, None, None] + unit.gyro_spread * w[:, None, None]
    # The remainder depends neither on the first state nor on the last: these are polynomials in time.
    gram = np.zeros((len(span), 2 * n, 2 * n), segment.noise.dtype)
    return Stretch(*segment, span, lines, spread, gram, rising @ unit.rest * a + unit.gyro_rest * w)


def measured(stretch: Stretch, info: Array) -> Stretch:
    """The stretch with information about its last state, (rows, n, n)."""
    n = info.shape[-1]
    k = doubling.update_factor(stretch.segment, info)
    t = info @ k
    # [L C] and [R D] change by the same matrix: [L C] M = [L - C T Phi, C Kᵀ].
    m: Array = np.zeros((len(t), 2 * n, 2 * n), t.dtype)
    m[:, range(n), range(n)] = 1
    m[:, n:, :n] = -t @ stretch.transition
    m[:, n:, n:] = k.mT
    c = stretch.lines[..., n:]
    return Stretch(
        *doubling.measured(stretch.segment, info, k),
        stretch.span,
        stretch.lines @ m,
        stretch.spread - c @ t @ c.mT,
        m.mT @ stretch.gram @ m,
        stretch.rest - _trace(t, stretch.gram[:, n:, n:]),  # the mean of D T Dᵀ
    )


def joined(first: Stretch, second: Stretch) -> Stretch:
    """One stretch after the other.

    Examples
    --------
    >>> noise = np.array([1e-6]), np.array([1e-8]), None, np.array([0.0])
    >>> one, two = free(np.array([1.0]), *noise), free(np.array([2.0]), *noise)
    >>> bool(np.allclose(joined(one, one).spread, two.spread, rtol=1e-12))
    True
    """
    # The first stretch learns what the second's fixes say about x1, the state between the two.
    first = measured(first, second.info)
    n, q1, phi2 = first.noise.shape[-1], first.noise, second.transition
    l1, c1 = first.lines[..., :n], first.lines[..., n:]
    l2, c2 = second.lines[..., :n], second.lines[..., n:]
    span = first.span + second.span
    share = np.stack([first.span, second.span], axis=-1) / np.where(span == 0, 1.0, span)[:, None]
    # Polynomials are orthonormal over their own span, so a part's coefficients count the root of its share of both.
    root1, root2 = np.moveaxis(np.sqrt(share)[..., None, None], 1, 0)
    # [L C] of both parts, by x0 and w = Phi2 w1 + w2: x1 = Phi1 x0 + w1 enters the second part, and w1 enters w.
    lines1 = np.concatenate([l1, c1 @ phi2.mT], axis=-1)
    lines2 = np.concatenate([l2 @ first.transition, c2 + l2 @ q1 @ phi2.mT], axis=-1)
    lines = np.concatenate([lines1 * root1, lines2 * root2], axis=1)
    # S of both: the noise of the second part is n2 + L2 w1, whose covariance with that of the first, n1, is C1 L2ᵀ.
    spread: Array = np.zeros((len(span), 2 * ORDERS, 2 * ORDERS), lines.dtype)
    spread[:, :ORDERS, :ORDERS] = first.spread * root1**2
    spread[:, :ORDERS, ORDERS:] = c1 @ l2.mT * root1 * root2
    spread[:, ORDERS:, :ORDERS] = spread[:, :ORDERS, ORDERS:].mT
    spread[:, ORDERS:, ORDERS:] = (second.spread + l2 @ q1 @ l2.mT) * root2**2
    # From twelve coefficients to six of the whole; the other six directions join the remainder.
    merge = _merge(share)
    lines_merged, spread_merged = merge @ lines, merge @ spread @ merge.mT
    rejected = lines - merge.mT @ lines_merged
    return Stretch(
        *doubling.continued(first.segment, second.segment),
        span,
        lines_merged,
        spread_merged,
        _gram(first, second, share) + rejected.mT @ rejected,
        first.rest * share[:, 0]
        + (second.rest + _trace(q1, second.gram[:, :n, :n])) * share[:, 1]
        + spread.trace(axis1=-1, axis2=-2)
        - spread_merged.trace(axis1=-1, axis2=-2),
    )


def _gram(first: Stretch, second: Stretch, share: Array) -> Array:
    """Mean of [R D]ᵀ [R D] over both, by x0 and w of the whole; `first` knows what the second's fixes say."""
    n, phi2 = first.noise.shape[-1], second.transition
    # As for [L C]: [R1, D1 Phi2ᵀ] = [R1 D1] M1 and [R2 Phi1, D2 + R2 Q1 Phi2ᵀ] = [R2 D2] M2.
    m1, m2 = np.zeros((2, len(phi2), 2 * n, 2 * n), np.result_type(first.noise, phi2))
    m1[:, range(n), range(n)] = 1
    m1[:, n:, n:] = phi2.mT
    m2[:, :n, :n] = first.transition
    m2[:, :n, n:] = first.noise @ phi2.mT
    m2[:, range(n, 2 * n), range(n, 2 * n)] = 1
    gram1, gram2 = m1.mT @ first.gram @ m1, m2.mT @ second.gram @ m2
    return np.asarray(gram1 * share[:, 0, None, None] + gram2 * share[:, 1, None, None])


def _trace(a: Array, b: Array) -> Array:
    """Trace of each row's product of two symmetric matrices, (rows)."""
    return np.asarray(np.einsum("nij,nij->n", a, b))


class _Drift(NamedTuple):
    """Position error along a time of one without fixes, in orthonormal polynomials of orders 0 to 5.

    By powers 0, 1 and 2 of the gradient of gravity: ``state`` is that by the state at the start, (3, 6, 3); for the
    accelerometer's noise ``spread`` is the covariance, (3, 6, 6), ``with_end`` that with the state at the end,
    (3, 6, 3), and ``rest`` the mean square of what these orders leave, (3). The gyro's are without gradient.
    """

    state: Array
    spread: Array
    with_end: Array
    rest: Array
    gyro_spread: Array
    gyro_with_end: Array
    gyro_rest: float


@cache
def _drift_of_one() -> _Drift:
    # White noise in orthonormal polynomials, a column each; its integrals, from the first to the sixth, in Legendre
    # ones. Every Legendre polynomial is one at the end.
    noise = np.eye(_MODES + 3)[:, :_MODES] * np.sqrt(2 * np.arange(_MODES) + 1)
    norm = np.sqrt(2 * np.arange(ORDERS) + 1)[:, None]  # to orthonormal polynomials
    integrals = [legendre.legint(noise, m, lbnd=-1, scl=0.5) for m in range(1, 7)]
    lines, ends = [part[:ORDERS] / norm for part in integrals], [part.sum(axis=0) for part in integrals]
    # Height is the second, fourth and sixth integral of the noise by powers of the gradient, velocity the one before
    # each; a product of two is of the sum of their powers.
    height = lines[1::2]
    at_end = [np.stack([ends[m + 1], ends[m], np.zeros(_MODES)]) for m in (0, 2, 4)]
    spread, with_end = np.zeros((3, ORDERS, ORDERS)), np.zeros((3, ORDERS, 3))
    for i in range(3):
        for j in range(3 - i):
            spread[i + j] += height[i] @ height[j].T
            with_end[i + j] += height[i] @ at_end[j].T
    # The start moves the height by the powers of time over their factorials: 1, t, t²/2; with the gradient t²/2,
    # t³/6, t⁴/24; with its square t⁴/24, t⁵/120.
    _, back, _ = _powers()
    by_power = back / np.array([math.factorial(power) for power in range(ORDERS)])[:, None]
    state = np.zeros((3, ORDERS, 3))
    state[0] = by_power[:3].T
    state[1], state[2, :, :2] = by_power[2:5].T, by_power[4:6].T
    # The mean squares over a unit of time less what the six orders have; the gyro's is the third integral.
    thrice = np.stack([ends[2], ends[1], ends[0]])
    gyro_spread = lines[2] @ lines[2].T
    rest = np.array([1 / 12, 1 / 90, 1 / 1260]) - spread.trace(axis1=1, axis2=2)
    return _Drift(
        state, spread, with_end, rest, gyro_spread, lines[2] @ thrice.T, float(1 / 120 - gyro_spread.trace())
    )


@cache
def _powers() -> tuple[Array, Array, Array]:
    """The orthonormal polynomials on (0, 1) by powers, the powers by these polynomials, and how signs change when a
    span is read from its end."""
    powers = np.zeros((ORDERS, ORDERS))
    for k in range(ORDERS):
        for m in range(k + 1):
            powers[k, m] = (-1) ** (k + m) * math.comb(k, m) * math.comb(k + m, m) * math.sqrt(2 * k + 1)
    moments = 1 / (np.arange(ORDERS)[:, None] + np.arange(ORDERS) + 1)
    order = np.arange(ORDERS)
    return powers, moments @ powers.T, np.where((order[:, None] + order) % 2, -1.0, 1.0)


def _merge(share: Array) -> Array:
    """From coefficients of two parts, each times the root of its share of the span, to those of both: (rows, 6, 12).

    Rows are orthonormal; what they leave is orthogonal to polynomials of order 5 along both parts.
    """
    powers, back, sign = _powers()
    # A power of the whole span is, on a part that begins with it, the part's power times its share to that power.
    # The second part ends with the span: read backwards it begins with it, and odd orders change sign.
    first, second = (powers * part[:, None, None] ** np.arange(ORDERS) @ back for part in share.T)
    root = np.sqrt(share)[..., None, None]
    return np.concatenate([root[:, 0] * first, root[:, 1] * sign * second], axis=-1)

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

from nav_model.analytic import doubling
from nav_model.analytic.channel import Noise, system
from nav_model.analytic.doubling import Segment
from nav_model.analytic.taylor import ORDERS, TERMS, System, halvings, integrals, noise_at_end, segment, series
from nav_model.base.arrays import Array


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


def free(span: Array, noise: Noise) -> Stretch:
    """A stretch [s] without fixes, (rows,)."""
    return along(system(noise), span, noise.position)


def along(system: System, span: Array, position: Array) -> Stretch:
    """A stretch of a linear system, whose ``position``, (n,), is a row of its states.

    Parameters
    ----------
    system : System
        Of (rows,).
    span : array (rows,)
        Seconds.
    position : array (n,)
    """
    count, table = halvings(system, span), integrals()
    part = span / 2**count
    terms = series(system, part)
    n = terms.transition.shape[-1]
    # L and C: the position by powers of time, and by the repeated integrals of each noise; so is the end's state.
    by_state, by_noise = position @ terms.transition, position @ terms.noise
    modes = np.moveaxis(np.tensordot(by_noise, table.lines, (1, 0)), 1, 2)  # (rows, orders, noises, modes)
    ends = noise_at_end(terms)
    with_end = _flat(modes[..., :TERMS]) @ _flat(ends).mT  # higher modes do not reach the end
    lines = np.concatenate([np.tensordot(by_state, table.powers, (1, 0)).mT, with_end], axis=-1)
    # The remainder of a short part depends neither on the first state nor on the last: both are polynomials of time.
    rest = np.einsum("nkm,nkm->n", by_noise, table.rest @ by_noise)
    gram = np.zeros((len(span), 2 * n, 2 * n), lines.dtype)
    spread = _flat(modes) @ _flat(modes).mT
    stretch = Stretch(*segment(terms), part, lines, spread, gram, rest)
    for _ in range(count):
        stretch = joined(stretch, stretch)
    return stretch


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
    >>> noise = Noise(np.array([1e-6]), np.array([1e-8]), np.array([0.0]))
    >>> one, two = free(np.array([1.0]), noise), free(np.array([2.0]), noise)
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


def _flat(modes: Array) -> Array:
    """The last two axes in one."""
    return modes.reshape(*modes.shape[:-2], -1)


def _trace(a: Array, b: Array) -> Array:
    """Trace of each row's product of two symmetric matrices, (rows)."""
    return np.asarray(np.einsum("nij,nij->n", a, b))


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

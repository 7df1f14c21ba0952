"""A stretch of flight: a segment, and what becomes of the position error along it.

The position error p(t) along a stretch follows from the stretch's first state x0 and from noise, given the fixes in
it. Of it are kept the coefficients c of the first six Legendre polynomials, and the mean square of what these leave:

    c = L x0 + noise of covariance S,   C = cov(c, w) with the noise w of the last state

and the same of what is left, r(t) = R(t) x0 + noise with D(t) = cov(r(t), w), as means over the stretch: `gram` is
that of [R D]ᵀ [R D], `rest` that of var r. Information Y about the last state changes them as in every Gaussian
update, with T = Y (1 + Q Y)⁻¹:

    L - C T Phi,   C (1 + Y Q)⁻¹,   S - C T Cᵀ

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
from nav_model.analytic.doubling import Segment, drift, turned
from nav_model.base.arrays import Array

ORDERS = 6
"""Legendre orders of the position error that figures use: 0 to 5."""

_MODES = 9  # of white noise: orders above add nothing to the first six of its second and third integral


class Stretch(NamedTuple):
    """One stretch of every design, rows first.

    `info`, `through` and `noise` of the segment are (rows, n, n), its length ``span`` (rows); ``lines`` = [L C],
    (rows, 6, 2 n); ``spread`` = S, (rows, 6, 6); ``gram``, (rows, 2 n, 2 n); ``rest`` (rows). Coefficients are of
    polynomials that are orthonormal over the stretch.
    """

    info: Array
    through: Array
    noise: Array
    span: Array
    lines: Array
    spread: Array
    gram: Array
    rest: Array

    @property
    def segment(self) -> Segment:
        """What a filter needs of it."""
        return Segment(*self[:3])


def free(span: Array, accelerometer: Array, gyro: Array, slow: tuple[ArrayLike, ArrayLike] | None) -> Stretch:
    """A stretch without fixes; arguments as `nav_model.analytic.doubling.drift`, of (rows)."""
    segment = drift(span, accelerometer, gyro, slow)
    size, one = segment.noise.shape[-1], _drift_of_one()
    a, w = accelerometer * span**3, gyro * span**5
    lines = np.zeros((len(span), ORDERS, 2 * size), segment.noise.dtype)
    lines[:, :, :3] = one.state * np.stack([0 * span + 1, span, span**2], axis=-1)[:, None, :]
    if size == 4:  # position is the first state less the slow error
        lines[:, :, 3] = -lines[:, :, 0]
    # Position, velocity and acceleration at the end have powers of the span less than position along it.
    powers = span[:, None] ** np.arange(5, 0, -1)
    by_a, by_w = accelerometer[:, None] * powers[:, 2:], gyro[:, None] * powers[:, :3]
    lines[:, :, size : size + 3] = one.with_end[0] * by_a[:, None, :] + one.with_end[1] * by_w[:, None, :]
    spread = one.spread[0] * a[:, None, None] + one.spread[1] * w[:, None, None]
    # What the coefficients leave depends neither on the first state nor on the last: these are polynomials in time.
    gram = np.zeros((len(span), 2 * size, 2 * size), segment.noise.dtype)
    return Stretch(*segment, span, lines, spread, gram, one.rest[0] * a + one.rest[1] * w)


def measured(one: Stretch, info: Array) -> Stretch:
    """The stretch with information about its last state, (rows, n, n)."""
    size = info.shape[-1]
    keep = doubling.kept(one.segment, info)
    taken = info @ keep
    into: Array = np.zeros((len(taken), 2 * size, 2 * size), taken.dtype)  # what [L C] is multiplied by
    into[:, range(size), range(size)] = 1
    into[:, size:, :size] = -taken @ one.through
    into[:, size:, size:] = turned(keep)
    covered = one.lines[..., size:]
    return Stretch(
        *doubling.measured(one.segment, info, keep),
        one.span,
        one.lines @ into,
        one.spread - covered @ taken @ turned(covered),
        turned(into) @ one.gram @ into,
        one.rest - _trace(taken, one.gram[:, size:, size:]),
    )


def joined(first: Stretch, second: Stretch) -> Stretch:
    """One stretch after the other.

    Examples
    --------
    >>> noise = np.array([1e-6]), np.array([1e-8]), None
    >>> one, two = free(np.array([1.0]), *noise), free(np.array([2.0]), *noise)
    >>> bool(np.allclose(joined(one, one).spread, two.spread, rtol=1e-12))
    True
    """
    met = measured(first, second.info)  # the first, with what the second's fixes say about where they meet
    size, phi, along = met.noise.shape[-1], second.through, second.lines[..., : met.noise.shape[-1]]
    span = met.span + second.span
    share = np.stack([met.span, second.span], axis=-1) / np.where(span == 0, 1.0, span)[:, None]
    root = np.sqrt(share)[..., None, None]
    # Both parts' coefficients by the first state of all, and by the noise of the last: x1 = Phi x0 + w is where they
    # meet, and what is after it adds to both.
    onward = np.concatenate([met.lines[..., :size], met.lines[..., size:] @ turned(phi)], axis=-1)
    out = np.concatenate([along @ met.through, second.lines[..., size:] + along @ met.noise @ turned(phi)], axis=-1)
    lines = np.concatenate([onward * root[:, 0], out * root[:, 1]], axis=1)
    across = met.lines[..., size:] @ turned(along)  # covariance of both parts' coefficients
    spread: Array = np.zeros((len(span), 2 * ORDERS, 2 * ORDERS), across.dtype)
    spread[:, :ORDERS, :ORDERS] = met.spread * root[:, 0] ** 2
    spread[:, :ORDERS, ORDERS:] = across * root[:, 0] * root[:, 1]
    spread[:, ORDERS:, :ORDERS] = turned(spread[:, :ORDERS, ORDERS:])
    spread[:, ORDERS:, ORDERS:] = (second.spread + along @ met.noise @ turned(along)) * root[:, 1] ** 2
    merge = _merge(share)
    merged, both = merge @ lines, merge @ spread @ turned(merge)
    lost = lines - turned(merge) @ merged  # of the parts' coefficients, what those of the whole leave
    return Stretch(
        *doubling.continued(met.segment, second.segment),
        span,
        merged,
        both,
        _gram(met, second, share) + turned(lost) @ lost,
        met.rest * share[:, 0]
        + (second.rest + _trace(met.noise, second.gram[:, :size, :size])) * share[:, 1]
        + spread.trace(axis1=-1, axis2=-2)
        - both.trace(axis1=-1, axis2=-2),
    )


def _gram(met: Stretch, second: Stretch, share: Array) -> Array:
    """Mean of [R D]ᵀ [R D] over both, by the first state of all and the noise of the last."""
    size, phi = met.noise.shape[-1], second.through
    into, out = np.zeros((2, len(phi), 2 * size, 2 * size), np.result_type(met.noise, phi))
    into[:, range(size), range(size)] = 1
    into[:, size:, size:] = turned(phi)
    out[:, :size, :size] = met.through
    out[:, :size, size:] = met.noise @ turned(phi)
    out[:, range(size, 2 * size), range(size, 2 * size)] = 1
    one, other = turned(into) @ met.gram @ into, turned(out) @ second.gram @ out
    return np.asarray(one * share[:, 0, None, None] + other * share[:, 1, None, None])


def _trace(one: Array, other: Array) -> Array:
    """That of each row's product of two symmetric matrices."""
    return np.asarray(np.einsum("nij,nij->n", one, other))


class _Drift(NamedTuple):
    """Position error along a time of one without fixes, in orthonormal polynomials of orders 0 to 5.

    ``state`` is that by the state at the start, (6, 3). For the noise of the accelerometer and then of the gyro,
    ``spread`` is the covariance, (2, 6, 6), ``with_end`` that with the state at the end, (2, 6, 3), and ``rest`` the
    mean square of what these orders leave, (2).
    """

    state: Array
    spread: Array
    with_end: Array
    rest: Array


@cache
def _drift_of_one() -> _Drift:
    noise = np.eye(_MODES + 3)[:, :_MODES] * np.sqrt(2 * np.arange(_MODES) + 1)
    once, twice, thrice = (legendre.legint(noise, m, lbnd=-1, scl=0.5) for m in (1, 2, 3))
    unit = np.sqrt(2 * np.arange(ORDERS) + 1)[:, None]  # to orthonormal polynomials
    lines = [integral[:ORDERS] / unit for integral in (twice, thrice)]
    # Every Legendre polynomial is one at the end.
    ends = [
        np.stack([twice.sum(axis=0), once.sum(axis=0), np.zeros(_MODES)]),
        np.stack([thrice.sum(axis=0), twice.sum(axis=0), once.sum(axis=0)]),
    ]
    state = np.zeros((ORDERS, 3))
    state[:3] = [[1, 1 / 2, 1 / 6], [0, 1 / 2, 1 / 4], [0, 0, 1 / 12]]  # 1, t, t²/2
    spread = np.stack([part @ part.T for part in lines])
    with_end = np.stack([part @ end.T for part, end in zip(lines, ends, strict=True)])
    return _Drift(state / unit, spread, with_end, np.array([1 / 12, 1 / 120]) - spread.trace(axis1=1, axis2=2))


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
    one, other = (powers * part[:, None, None] ** np.arange(ORDERS) @ back for part in share.T)
    root = np.sqrt(share)[..., None, None]
    return np.concatenate([root[:, 0] * one, root[:, 1] * sign * other], axis=-1)

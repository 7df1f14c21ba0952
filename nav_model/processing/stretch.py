"""A stretch of flight with fixes, and the position error along it, for many designs at once.

A stretch is what its fixes say about its first state, and what follows from that state: the last one, the first six
Legendre coefficients of the position error along it, and what those leave of its mean square. Two stretches in a row
are one, so an aperture of n fixes takes about as many steps as n has binary digits, whatever the noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.doubling import drift
from nav_model.base.arrays import Array
from nav_model.processing.modes import ORDERS, drifts

Counts = NDArray[np.int64]


class Noise(NamedTuple):
    """Densities of accelerometer and gyro [m²/s³, m²/s⁵], variance [m²] and time [s] of the slow error; (rows)."""

    accelerometer: Array
    gyro: Array
    slow: tuple[Array, Array] | None

    def of(self, rows: Counts) -> Noise:
        """These rows."""
        slow = None if self.slow is None else (self.slow[0][rows], self.slow[1][rows])
        return Noise(self.accelerometer[rows], self.gyro[rows], slow)


class Stretch(NamedTuple):
    """A stretch of flight with fixes, given its first state; rows come first, n is the number of states.

    ``known`` is the information of its fixes about the first state, ``through`` and ``noise`` give the last one,
    (rows, n, n). ``lines`` are the coefficients of the position error by the first state, and beside these their
    covariances with the noise of the last, (rows, 6, 2 n), ``spread`` is their covariance, and of what they leave
    ``gram`` is the mean product of the same two, (rows, 2 n, 2 n), and ``rest`` its mean square. ``span`` is in s.
    """

    span: Array
    known: Array
    through: Array
    noise: Array
    lines: Array
    spread: Array
    gram: Array
    rest: Array

    def of(self, rows: Counts) -> Stretch:
        """These rows."""
        return Stretch(*(part[rows] for part in self))

    def put(self, rows: Counts, new: Stretch) -> Stretch:
        """This, but for these rows, which are the new ones."""
        if len(rows) == len(self.span):
            return new
        found = Stretch(*(part.astype(np.result_type(part, values)) for part, values in zip(self, new, strict=True)))
        for part, values in zip(found, new, strict=True):
            part[rows] = values
        return found


def turned(matrix: Array) -> Array:
    """Transposes of each row's matrices."""
    return matrix.swapaxes(-1, -2)


def trace(one: Array, other: Array) -> Array:
    """That of each row's product of two symmetric matrices."""
    found: Array = np.einsum("nij,nij->n", one, other)
    return found


def free(noise: Noise, span: Array) -> Stretch:
    """A stretch without fixes, of `span` seconds, (rows)."""
    drifted = drift(span, noise.accelerometer, noise.gyro, noise.slow)
    through, added = (np.moveaxis(part, -1, 0) for part in drifted)
    size, made = through.shape[-1], drifts()
    a, w = noise.accelerometer * span**3, noise.gyro * span**5
    zero = 0 * (a + w)
    lines = np.zeros((len(span), ORDERS, 2 * size), added.dtype)
    lines[:, :, :3] = made.state * np.stack([zero + 1, span, span**2], axis=-1)[:, None, :]
    # position, velocity and acceleration at the end have powers of the span less than position along it
    lower = np.stack([a, noise.accelerometer * span**2, noise.accelerometer * span], axis=-1)
    slower = np.stack([w, noise.gyro * span**4, noise.gyro * span**3], axis=-1)
    lines[:, :, size : size + 3] = made.with_end[0] * lower[:, None, :] + made.with_end[1] * slower[:, None, :]
    spread = made.spread[0] * a[:, None, None] + made.spread[1] * w[:, None, None]
    # what the coefficients leave has nothing to do with the last state: that is a polynomial of order 5 at most
    gram = np.zeros((len(span), 2 * size, 2 * size), added.dtype)
    return Stretch(span, 0 * through, through, added, lines, spread, gram, made.rest[0] * a + made.rest[1] * w)


def inverse(matrix: Array) -> Array:
    """Of each row; not a number where double precision leaves none."""
    try:
        return np.asarray(np.linalg.inv(matrix), matrix.dtype)
    except np.linalg.LinAlgError:
        found = np.full_like(matrix, np.nan)
        some = np.linalg.det(matrix) != 0
        found[some] = np.linalg.inv(matrix[some])
        return found


class _Gain(NamedTuple):
    """What information about a stretch's last state says of its first and of what lies between.

    ``through`` and ``noise`` are those of the stretch with it. Times a state, ``back`` is by how much the expected
    noise of the last state falls, in units of ``noise`` before; ``kept`` is the part of a covariance with that noise
    which remains, and ``taken`` what the square of one loses.
    """

    through: Array
    noise: Array
    taken: Array
    back: Array
    kept: Array


def _gain(one: Stretch, known: Array) -> _Gain:
    size = known.shape[-1]
    kept = inverse(np.eye(size) + one.noise @ known)
    after = kept @ np.concatenate([one.through, one.noise], axis=-1)
    taken = known @ kept
    return _Gain(after[..., :size], after[..., size:], taken, -taken @ one.through, turned(kept))


def measured(one: Stretch, known: Array) -> Stretch:
    """The stretch with information about its last state, (rows, n, n)."""
    gain, size = _gain(one, known), known.shape[-1]
    covered = one.lines[..., size:]
    into = _blocks(np.eye(size), None, gain.back, gain.kept)
    return Stretch(
        one.span,
        one.known - turned(one.through) @ gain.back,
        gain.through,
        gain.noise,
        one.lines @ into,
        one.spread - covered @ gain.taken @ turned(covered),
        turned(into) @ one.gram @ into,
        one.rest - trace(gain.taken, one.gram[:, size:, size:]),
    )


def joined(first: Stretch, second: Stretch) -> Stretch:
    """One stretch after the other.

    Examples
    --------
    >>> noise = Noise(np.array([1e-6]), np.array([1e-8]), None)
    >>> one, two = free(noise, np.array([1.0])), free(noise, np.array([2.0]))
    >>> bool(np.allclose(joined(one, one).spread, two.spread, rtol=1e-12))
    True
    """
    gain, size = _gain(first, second.known), first.through.shape[-1]
    ahead = second.through @ np.concatenate([gain.through, gain.noise], axis=-1)
    onward, covered, along = ahead[..., size:], first.lines[..., size:], second.lines[..., :size]
    into = _blocks(np.eye(size), None, gain.back, gain.kept @ turned(second.through))
    out = _blocks(gain.through, turned(onward), None, np.eye(size))
    span = first.span + second.span
    one = np.divide(first.span, span, out=0 * span, where=span != 0)
    share = np.stack([one, 1 - one], axis=-1)
    root = np.sqrt(share)[..., None, None]
    lines = np.concatenate([first.lines @ into * root[:, 0], second.lines @ out * root[:, 1]], axis=1)
    across = covered @ gain.kept @ turned(along) * (root[:, 0] * root[:, 1])
    spread = _blocks(
        (first.spread - covered @ gain.taken @ turned(covered)) * root[:, 0] ** 2,
        across,
        turned(across),
        (second.spread + along @ gain.noise @ turned(along)) * root[:, 1] ** 2,
    )
    merge = _merge(share)
    merged, both = merge @ lines, merge @ spread @ turned(merge)
    left = lines - turned(merge) @ merged
    grams = turned(into) @ first.gram @ into * root[:, 0] ** 2 + turned(out) @ second.gram @ out * root[:, 1] ** 2
    rests = np.stack([
        first.rest - trace(gain.taken, first.gram[:, size:, size:]),
        second.rest + trace(gain.noise, second.gram[:, :size, :size]),
    ], axis=-1)  # fmt: skip
    lost = spread.trace(axis1=-1, axis2=-2) - both.trace(axis1=-1, axis2=-2)
    return Stretch(
        span,
        first.known - turned(first.through) @ gain.back,
        ahead[..., :size],
        second.noise + onward @ turned(second.through),
        merged,
        both,
        grams + turned(left) @ left,
        (rests * share).sum(axis=-1) + lost,
    )


def _blocks(one: Array, beside: Array | None, under: Array | None, last: Array) -> Array:
    """A matrix of four equal ones, each row; None for zero."""
    some = [part for part in (one, beside, under, last) if part is not None]
    rows, size = max(len(part) for part in some if part.ndim > 2), last.shape[-1]
    found: Array = np.zeros((rows, 2 * size, 2 * size), np.result_type(*some))
    places = [(slice(None), slice(i, i + size), slice(j, j + size)) for i in (0, size) for j in (0, size)]
    for place, part in zip(places, (one, beside, under, last), strict=True):
        if part is not None:
            found[place] = part
    return found


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


class Doubles:
    """A stretch, two of it in a row, four and so on, each worked out once, when it is needed."""

    def __init__(self, one: Callable[[], Stretch]) -> None:
        self._one = one
        self._found: list[Stretch] = []

    def after(self, row: Stretch, counts: Counts, alike: Counts) -> Stretch:
        """`counts` of them after each row; `alike` is which of them."""
        for power in range(int(counts.max(initial=0)).bit_length()):
            if power == len(self._found):
                self._found.append(joined(self._found[-1], self._found[-1]) if power else self._one())
            odd = np.flatnonzero((counts >> power) % 2)
            row = row.put(odd, joined(row.of(odd), self._found[power].of(alike[odd])))
        return row

"""Settled filters and legs of any length, made by doubling a segment of flight with fixes.

States are position, velocity, acceleration by tilt, and the slow error of the fixes where there is one. A segment of
flight with fixes is what they measure of its first state, and how the last state follows from the first and from
noise. Two equal segments in a row are one of twice the length: a leg of n fixes takes as many steps as n has binary
digits, and a filter settles in about fifteen.

Source: Chu, Fan, Lin and Wang, Int. J. Control 77(8), 2004.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.stacks import even, plus_one, solved, times, turned
from nav_model.base.arrays import Array, as_numbers

_MOST_STEPS = 60
_FEW = 400  # elements; with fewer, NumPy's own functions are faster than our stacks
_SETTLED = 1e-14


class Segment(NamedTuple):
    """Information about the first state, transition from the first to the last, covariance of the noise added: (n, n,
    ...)."""

    info: Array
    through: Array
    noise: Array


def drift(
    step: Array, accelerometer: ArrayLike, gyro: ArrayLike, slow: tuple[ArrayLike, ArrayLike] | None = None
) -> tuple[Array, Array]:
    """Transition and covariance of the noise of the states over a step without fixes, exact: (n, n, ...), n 3 or 4.

    Parameters
    ----------
    step : array
        Seconds.
    accelerometer, gyro : array_like
        Densities of the white noises, m²/s³ and m²/s⁵.
    slow : pair of array_like, optional
        Variance of the slow error [m²], its correlation time [s].
    """
    values = step, accelerometer, gyro, *(slow or ())
    shape, kind = np.broadcast_shapes(*(np.shape(x) for x in values)), np.result_type(*values)
    size = 3 if slow is None else 4
    phi, noise = np.zeros((size, size, *shape), kind), np.zeros((size, size, *shape), kind)
    phi[range(size), range(size)] = 1
    phi[0, 1] = phi[1, 2] = step
    phi[0, 2] = step * step / 2
    a, w = as_numbers(accelerometer) * step, as_numbers(gyro) * step
    noise[0, 0] = a * step**2 / 3 + w * step**4 / 20
    noise[0, 1] = noise[1, 0] = a * step / 2 + w * step**3 / 8
    noise[0, 2] = noise[2, 0] = w * step**2 / 6
    noise[1, 1] = a + w * step**2 / 3
    noise[1, 2] = noise[2, 1] = w * step / 2
    noise[2, 2] = w
    if slow is not None:
        phi[3, 3] = np.exp(-step / as_numbers(slow[1]))
        noise[3, 3] = -as_numbers(slow[0]) * np.expm1(-2 * step / as_numbers(slow[1]))
    return phi, noise


def before(info: Array, through: Array, noise: Array) -> Array:
    """Information about the state before a drift, from the information about the state after it."""
    if info.size > _FEW:
        return times(turned(through), even(solved(plus_one(times(info, noise)), info)), through)
    # Transposed they are stacks as NumPy has them, matrices last. All but `through` are symmetric.
    known, back = info.T, through.T
    found = back @ np.linalg.solve(known @ noise.T + _one(len(info)), known @ back.swapaxes(-1, -2))
    return np.asarray(found + found.swapaxes(-1, -2)).T / 2


def joined(first: Segment, second: Segment) -> Segment:
    """One segment after the other."""
    if first.info.size > _FEW:
        both = np.concatenate([first.through, times(first.noise, turned(second.through))], axis=1)
        onward = solved(plus_one(times(first.noise, second.info)), both)
        ahead, size = times(second.through, onward), len(both)
        return Segment(
            first.info + even(times(turned(first.through), second.info, onward[:, :size])),
            ahead[:, :size],
            second.noise + even(ahead[:, size:]),
        )
    # The same for the library's stacks, transposed: a segment is then read from its end, and what is known of its
    # first state and what is added change places.
    size, back = len(first.info), first.through.swapaxes(0, 1).T
    both = np.concatenate([second.through.T, second.info.T @ back], axis=-1)
    onward = np.linalg.solve(second.info.T @ first.noise.T + _one(size), both)
    ahead = first.through.T @ onward
    noise = second.noise.T + second.through.T.swapaxes(-1, -2) @ (first.noise.T @ onward[..., :size])
    return Segment(first.info + ahead[..., size:].T, ahead[..., :size].T, noise.T)


def twice(one: Segment) -> Segment:
    """Two equal segments in a row."""
    return joined(one, one)


@cache
def _one(size: int) -> Array:
    return np.eye(size)


class Doubles:
    """A segment, two of it in a row, four and so on, each worked out once."""

    def __init__(self, one: Segment) -> None:
        self._found = [one]

    def __getitem__(self, power: int) -> Segment:
        while len(self._found) <= power:
            self._found.append(twice(self._found[-1]))
        return self._found[power]


def repeated(units: Doubles, counts: NDArray[np.int64]) -> Segment:
    """`counts` (rows) equal segments in a row; segments have the shape (n, n, rows)."""
    one = units[0]
    row = Segment(0 * one.info, 0 * one.through + _one(len(one.info))[:, :, None], 0 * one.noise)
    for power in range(int(counts.max()).bit_length()):
        odd = (counts >> power) % 2 == 1
        if odd.any():
            longer = joined(row, units[power])
            row = longer if odd.all() else Segment(*(np.where(odd, *both) for both in zip(longer, row, strict=True)))
    return row


def information(units: Doubles, counts: NDArray[np.int64], beyond: Array | None = None) -> Array:
    """Information that a row of equal segments gives about the first state.

    Parameters
    ----------
    units : Doubles
        Of shape (n, n, rows).
    counts : array of int, (kinds, rows)
        How many of them.
    beyond : array, (n, n, kinds, rows), optional
        Information about the last state.
    """
    one, fresh = units[0], beyond is None
    known = np.zeros((*one.info.shape[:2], *counts.shape), np.result_type(*one)) if beyond is None else beyond
    for power in range(int(counts.max()).bit_length()):
        odd = (counts >> power) % 2 == 1
        if odd.all() and not fresh:
            info, through, noise = (part[:, :, None] for part in units[power])
            known = info + before(known, through, noise)
        elif odd.any():  # the others' rows may have gone on so far that there is no number for them
            unit, row = units[power], np.nonzero(odd)[1]
            last = 0.0 if fresh else before(known[:, :, odd], unit.through[..., row], unit.noise[..., row])
            known = known.copy()
            known[:, :, odd] = unit.info[..., row] + last
            fresh = False
    return known


def settled(unit: Segment) -> Array:
    """Covariance just before a fix of the filter in steady state, after many such segments.

    Raises
    ------
    ArithmeticError
        If the equation does not settle in double precision.
    """
    less = np.diagonal(unit.noise)
    for _ in range(_MOST_STEPS):
        unit = twice(unit)
        more = np.diagonal(unit.noise)
        if (np.abs(more - less) <= _SETTLED * more.real).all():
            return unit.noise
        less = more
    raise ArithmeticError("the filter with velocity fixes did not settle")

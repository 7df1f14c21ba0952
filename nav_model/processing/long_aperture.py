"""The smoothed error over an aperture of many time constants, by doubling a stretch of flight.

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
from nav_model.analytic.steady_state import Array
from nav_model.processing.leg_fixes import Pace, uneven
from nav_model.processing.modes import ORDERS, drifts, variances

Counts = NDArray[np.int64]

_AT_ONCE = 512  # rows, so that their matrices stay in the cache
_SINGLY = 64  # fixes in an aperture, to take them one by one where there is no such number


class Noise(NamedTuple):
    """Densities of accelerometer and gyro [m²/s³, m²/s⁵], variance [m²] and time [s] of the slow error; (rows)."""

    accelerometer: Array
    gyro: Array
    slow: tuple[Array, Array] | None

    def of(self, rows: Counts) -> Noise:
        """These rows."""
        slow = None if self.slow is None else (self.slow[0][rows], self.slow[1][rows])
        return Noise(self.accelerometer[rows], self.gyro[rows], slow)


class _Grid(NamedTuple):
    """Fixes every ``step``, and others at every ``parts``-th of these; rows come first."""

    step: Array
    parts: Counts
    dense: Array
    sparse: Array

    def of(self, rows: Counts) -> _Grid:
        return _Grid(self.step[rows], self.parts[rows], self.dense[rows], self.sparse[rows])


class _Stretch(NamedTuple):
    """A stretch of flight with fixes, given its first state; rows come first.

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

    def of(self, rows: Counts) -> _Stretch:
        return _Stretch(*(part[rows] for part in self))

    def put(self, rows: Counts, new: _Stretch) -> _Stretch:
        """With these rows in place of its own."""
        if len(rows) == len(self.span):
            return new
        found = _Stretch(*(part.copy() for part in self))
        for part, values in zip(found, new, strict=True):
            part[rows] = values
        return found


def _turned(matrix: Array) -> Array:
    return matrix.swapaxes(-1, -2)


def _trace(one: Array, other: Array) -> Array:
    """Of the product of symmetric matrices."""
    found: Array = np.einsum("nij,nij->n", one, other)
    return found


def _free(noise: Noise, span: Array) -> _Stretch:
    """A stretch without fixes."""
    slow = None if noise.slow is None else noise.slow
    through, added = (np.moveaxis(part, -1, 0) for part in drift(span, noise.accelerometer, noise.gyro, slow))
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
    return _Stretch(span, 0 * through, through, added, lines, spread, gram, made.rest[0] * a + made.rest[1] * w)


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


def _gain(one: _Stretch, known: Array) -> _Gain:
    size = known.shape[-1]
    inner = np.eye(size) + one.noise @ known
    kept = np.asarray(np.linalg.inv(inner), inner.dtype)
    after = kept @ np.concatenate([one.through, one.noise], axis=-1)
    taken = known @ kept
    return _Gain(after[..., :size], after[..., size:], taken, -taken @ one.through, _turned(kept))


def _measured(one: _Stretch, known: Array) -> _Stretch:
    """With information about its last state."""
    gain, size = _gain(one, known), known.shape[-1]
    covered = one.lines[..., size:]
    into = _blocks(np.eye(size), None, gain.back, gain.kept)
    return _Stretch(
        one.span,
        one.known - _turned(one.through) @ gain.back,
        gain.through,
        gain.noise,
        one.lines @ into,
        one.spread - covered @ gain.taken @ _turned(covered),
        _turned(into) @ one.gram @ into,
        one.rest - _trace(gain.taken, one.gram[:, size:, size:]),
    )


def _joined(first: _Stretch, second: _Stretch) -> _Stretch:
    """One stretch after the other."""
    gain, size = _gain(first, second.known), first.through.shape[-1]
    ahead = second.through @ np.concatenate([gain.through, gain.noise], axis=-1)
    onward, covered, along = ahead[..., size:], first.lines[..., size:], second.lines[..., :size]
    into = _blocks(np.eye(size), None, gain.back, gain.kept @ _turned(second.through))
    out = _blocks(gain.through, _turned(onward), None, np.eye(size))
    span = first.span + second.span
    one = np.divide(first.span, span, out=0 * span, where=span != 0)
    share = np.stack([one, 1 - one], axis=-1)
    root = np.sqrt(share)[..., None, None]
    lines = np.concatenate([first.lines @ into * root[:, 0], second.lines @ out * root[:, 1]], axis=1)
    across = covered @ gain.kept @ _turned(along) * (root[:, 0] * root[:, 1])
    spread = _blocks(
        (first.spread - covered @ gain.taken @ _turned(covered)) * root[:, 0] ** 2,
        across,
        _turned(across),
        (second.spread + along @ gain.noise @ _turned(along)) * root[:, 1] ** 2,
    )
    merge = _merge(share)
    merged, both = merge @ lines, merge @ spread @ _turned(merge)
    left = lines - _turned(merge) @ merged
    grams = _turned(into) @ first.gram @ into * root[:, 0] ** 2 + _turned(out) @ second.gram @ out * root[:, 1] ** 2
    rests = np.stack([
        first.rest - _trace(gain.taken, first.gram[:, size:, size:]),
        second.rest + _trace(gain.noise, second.gram[:, :size, :size]),
    ], axis=-1)  # fmt: skip
    lost = spread.trace(axis1=-1, axis2=-2) - both.trace(axis1=-1, axis2=-2)
    return _Stretch(
        span,
        first.known - _turned(first.through) @ gain.back,
        ahead[..., :size],
        second.noise + onward @ _turned(second.through),
        merged,
        both,
        grams + _turned(left) @ left,
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


class _Doubles:
    """A stretch, two of it in a row, four and so on, each worked out once."""

    def __init__(self, one: _Stretch) -> None:
        self._found = [one]

    def after(self, row: _Stretch, counts: Counts, alike: Counts) -> _Stretch:
        """`counts` of them after each row; `alike` is which of them."""
        for power in range(int(counts.max(initial=0)).bit_length()):
            if power == len(self._found):
                self._found.append(_joined(self._found[-1], self._found[-1]))
            odd = np.flatnonzero((counts >> power) % 2)
            row = row.put(odd, _joined(row.of(odd), self._found[power].of(alike[odd])))
        return row


def smoothed_by_doubling(
    noise: Noise, pace: Pace, aperture: Array, start: Array, end: Array, first: Counts, alike: Counts
) -> dict[str, Array]:
    """Variances over the aperture, as `nav_model.processing.modes.smoothed_modes`.

    Parameters
    ----------
    noise : Noise
    pace : Pace
        Both kinds have a fix at the aperture's start.
    aperture : array (rows)
        Seconds.
    start, end : array (n, n, rows)
        Information of the legs about the states at both ends; a fix at either belongs to these.
    first, alike : array of int
        Rows whose noise and fixes differ, and for each row which of these it is like.

    Returns
    -------
    dict
        Those of `nav_model.processing.leg.COLUMNS`.
    """
    grid, apart = _grid(pace, aperture)
    known, later = (np.moveaxis(part, -1, 0) for part in (start, end))
    found: list[tuple[Counts, dict[str, Array]]] = []

    def solve(rows: Counts, halves: Callable[[Counts], _Stretch]) -> None:
        for batch in np.array_split(rows, -(-len(rows) // _AT_ONCE)) if len(rows) else ():
            found.append((batch, _figures(halves(batch), aperture[batch], known[batch], later[batch])))

    if not np.all(apart):
        units, dense = _units(noise.of(first), grid.of(first))
        solve(
            np.flatnonzero(~apart),
            lambda rows: _halves(noise.of(rows), grid.of(rows), aperture[rows], units, dense, alike[rows]),
        )
    solve(
        np.flatnonzero(apart),
        lambda rows: _one_by_one(noise.of(rows), Pace(*(part[..., rows] for part in pace)), aperture[rows]),
    )
    order = np.argsort(np.concatenate([rows for rows, _ in found]))
    return {name: np.concatenate([values[name] for _, values in found])[order] for name in found[0][1]}


def _grid(pace: Pace, aperture: Array) -> tuple[_Grid, NDArray[np.bool_]]:
    """The fixes with a whole number of the ones in each interval of the others, and where they are to be taken one
    by one instead, as there is not."""
    ratio = pace.seldom / pace.often
    parts = np.asarray(np.rint(ratio.real), np.int64)
    apart = uneven(pace) & ((aperture / pace.often).real < _SINGLY)
    dense = np.moveaxis(pace.dense * (ratio / parts), -1, 0)
    return _Grid(pace.seldom / parts, parts, dense, np.moveaxis(pace.sparse, -1, 0)), apart


def _figures(halves: _Stretch, aperture: Array, known: Array, later: Array) -> dict[str, Array]:
    """From both halves of each aperture, and the information about the states at its ends."""
    one, other = (halves.of(np.arange(len(aperture)) + n * len(aperture)) for n in (0, 1))
    whole = _measured(_joined(one, other), later)
    known = known + whole.known
    at_start = np.asarray(np.linalg.inv(known), known.dtype)
    size = at_start.shape[-1]
    along = whole.lines[..., :size]
    spread = whole.spread + along @ at_start @ _turned(along)
    rest = whole.rest + _trace(at_start, whole.gram[:, :size, :size])
    # the state in the middle: of the first half, what the second and the leg after it say of its end
    to_middle = _measured(one, _measured(other, later).known)
    middle = to_middle.noise + to_middle.through @ at_start @ _turned(to_middle.through)
    root = np.sqrt(2 * np.arange(ORDERS) + 1)
    left = spread[:, 4, 4] + spread[:, 5, 5] + rest
    return variances(spread * (root[:, None] * root), left, np.einsum("nii->ni", middle)[:, :3], aperture)


def _units(noise: Noise, grid: _Grid) -> tuple[_Doubles, _Doubles | None]:
    """From one of the sparse fixes to the next, and from one of the dense ones where that is less."""
    step = _measured(_free(noise, grid.step), grid.dense)
    if not np.any(grid.parts > 1):
        return _Doubles(_measured(step, grid.sparse) if np.any(grid.sparse) else step), None
    dense = _Doubles(step)
    unit = dense.after(step, grid.parts - 1, np.arange(len(grid.step)))
    return _Doubles(_measured(unit, grid.sparse)), dense


def _halves(
    noise: Noise, grid: _Grid, aperture: Array, units: _Doubles, dense: _Doubles | None, alike: Counts
) -> _Stretch:
    """Both halves of each aperture, all first ones before the second ones."""
    both = _twice(len(aperture))
    half, zero = aperture / 2, 0 * aperture
    middle, last = (np.asarray(np.ceil((span / grid.step).real - 1e-9), np.int64) - 1 for span in (half, aperture))
    first = np.concatenate([0 * middle + 1, middle + 1])
    last = np.concatenate([middle, last])
    noise, grid, span, here = noise.of(both), grid.of(both), half[both], alike[both]
    some = last >= first
    lead = _not_negative(np.where(some, first * grid.step - np.concatenate([zero, half]), span))
    row = _measured(_free(noise, lead), grid.dense * some[:, None, None])
    shared = -(-first // grid.parts) * grid.parts  # the first of the sparse kind
    has = shared <= last
    beyond = np.where(has, last - shared, 0)
    between = np.maximum(last - first, 0)
    if dense is not None:
        row = dense.after(row, np.where(has, shared - first, between), here)
    if np.any(grid.sparse):
        row = _measured(row, grid.sparse * has[:, None, None])
    row = units.after(row, beyond // grid.parts, here)
    if dense is not None:
        row = dense.after(row, beyond % grid.parts, here)
    return _joined(row, _free(noise, _not_negative(np.where(some, span - lead - between * grid.step, 0.0))))


def _one_by_one(noise: Noise, pace: Pace, aperture: Array) -> _Stretch:
    """Both halves of each aperture, fix after fix."""
    both, half = _twice(len(aperture)), aperture / 2
    noise, span, zero = noise.of(both), half[both], 0 * aperture
    begin = np.concatenate([zero, half])[:, None]
    times, infos = [], []
    for step, info in ((pace.often, pace.dense), (pace.seldom, pace.sparse)):
        k = np.arange(1, int(np.max((aperture / step).real)) + 2)
        times.append(k * step[both, None] - begin)
        infos.append(np.broadcast_to(np.moveaxis(info, -1, 0)[both, None], (*times[-1].shape, *info.shape[:2])))
    time, info = np.hstack(times), np.concatenate(infos, axis=1)
    edge = 1e-9 * np.minimum(pace.often, pace.seldom).real[both, None]
    second = (np.arange(len(both)) >= len(aperture))[:, None]
    inside = (time.real >= np.where(second, -edge, edge)) & (time.real < span.real[:, None] - edge)
    order = np.argsort(np.where(inside, time.real, np.inf), axis=1)[:, : int(np.max(inside.sum(axis=1)))]
    row, now = _free(noise, 0 * span), 0 * span
    for column in order.T:
        rows = np.flatnonzero(inside[np.arange(len(both)), column])
        then = _not_negative(time[rows, column[rows]])
        new = _joined(row.of(rows), _free(noise.of(rows), then - now[rows]))
        row = row.put(rows, _measured(new, info[rows, column[rows]]))
        now[rows] = then
    return _joined(row, _free(noise, span - now))


def _twice(rows: int) -> Counts:
    return np.concatenate([np.arange(rows), np.arange(rows)])


def _not_negative(time: Array) -> Array:
    """But for rounding it is not."""
    return np.where(time.real < 0, 0.0, time)

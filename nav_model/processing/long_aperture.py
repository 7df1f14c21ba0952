"""The smoothed error over an aperture of many time constants, by doubling a stretch of flight.

An aperture of n fixes takes about as many steps as n has binary digits, whatever the noise; where neither of two
intervals holds a whole number of the other, as many as it has fixes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.processing.leg_fixes import Pace, uneven
from nav_model.processing.modes import ORDERS, variances
from nav_model.processing.stretch import (
    Counts,
    Doubles,
    Noise,
    Stretch,
    free,
    inverse,
    joined,
    measured,
    trace,
    turned,
)

_AT_ONCE = 512  # rows, so that their matrices stay in the cache
_SINGLY = 64  # fixes in an aperture, to take them one by one where there is no such number


class _Grid(NamedTuple):
    """Fixes every ``step``, and others at every ``parts``-th of these; rows come first."""

    step: Array
    parts: Counts
    dense: Array
    sparse: Array

    def of(self, rows: Counts) -> _Grid:
        return _Grid(self.step[rows], self.parts[rows], self.dense[rows], self.sparse[rows])


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
        Those of `nav_model.processing.leg.COLUMNS`, (rows); not a number where double precision holds none.

    Notes
    -----
    The figures are those of [P-5]. As in `nav_model.analytic.doubling`, two equal stretches in a row are one; the
    Legendre coefficients of the error along it, and what these leave, are our own addition.
    """
    grid, apart = _grid(pace, aperture)
    known, later = (np.moveaxis(part, -1, 0) for part in (start, end))
    found: list[tuple[Counts, dict[str, Array]]] = []

    def solve(rows: Counts, halves: Callable[[Counts], Stretch]) -> None:
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


def _figures(halves: Stretch, aperture: Array, known: Array, later: Array) -> dict[str, Array]:
    """From both halves of each aperture, and the information about the states at its ends."""
    one, other = (halves.of(np.arange(len(aperture)) + n * len(aperture)) for n in (0, 1))
    whole = measured(joined(one, other), later)
    at_start = inverse(known + whole.known)
    size = at_start.shape[-1]
    along = whole.lines[..., :size]
    spread = whole.spread + along @ at_start @ turned(along)
    rest = whole.rest + trace(at_start, whole.gram[:, :size, :size])
    # the state in the middle: of the first half, what the second and the leg after it say of its end
    to_middle = measured(one, measured(other, later).known)
    middle = to_middle.noise + to_middle.through @ at_start @ turned(to_middle.through)
    root = np.sqrt(2 * np.arange(ORDERS) + 1)
    left = spread[:, 4, 4] + spread[:, 5, 5] + rest
    return variances(spread * (root[:, None] * root), left, np.einsum("nii->ni", middle)[:, :3], aperture)


def _units(noise: Noise, grid: _Grid) -> tuple[Doubles, Doubles | None]:
    """From one of the sparse fixes to the next, and from one of the dense ones where that is less."""

    def step() -> Stretch:
        return measured(free(noise, grid.step), grid.dense)

    if not np.any(grid.parts > 1):
        return Doubles(lambda: measured(step(), grid.sparse) if np.any(grid.sparse) else step()), None
    dense = Doubles(step)

    def unit() -> Stretch:
        return measured(dense.after(step(), grid.parts - 1, np.arange(len(grid.step))), grid.sparse)

    return Doubles(unit), dense


def _halves(
    noise: Noise, grid: _Grid, aperture: Array, units: Doubles, dense: Doubles | None, alike: Counts
) -> Stretch:
    """Both halves of each aperture, all first ones before the second ones."""
    both = np.tile(np.arange(len(aperture)), 2)
    half, zero = aperture / 2, 0 * aperture
    middle, last = (np.asarray(np.ceil((span / grid.step).real - 1e-9), np.int64) - 1 for span in (half, aperture))
    first = np.concatenate([0 * middle + 1, middle + 1])
    last = np.concatenate([middle, last])
    noise, grid, span, here = noise.of(both), grid.of(both), half[both], alike[both]
    some = last >= first
    lead = _not_negative(np.where(some, first * grid.step - np.concatenate([zero, half]), span))
    row = measured(free(noise, lead), grid.dense * some[:, None, None])
    shared = -(-first // grid.parts) * grid.parts  # the first of the sparse kind
    has = shared <= last
    beyond = np.where(has, last - shared, 0)
    between = np.maximum(last - first, 0)
    if dense is not None:
        row = dense.after(row, np.where(has, shared - first, between), here)
    if np.any(grid.sparse):
        row = measured(row, grid.sparse * has[:, None, None])
    row = units.after(row, beyond // grid.parts, here)
    if dense is not None:
        row = dense.after(row, beyond % grid.parts, here)
    return joined(row, free(noise, _not_negative(np.where(some, span - lead - between * grid.step, 0.0))))


def _one_by_one(noise: Noise, pace: Pace, aperture: Array) -> Stretch:
    """Both halves of each aperture, fix after fix."""
    both, half = np.tile(np.arange(len(aperture)), 2), aperture / 2
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
    row, now = free(noise, 0 * span), 0 * span
    for column in order.T:
        rows = np.flatnonzero(inside[np.arange(len(both)), column])
        then = _not_negative(time[rows, column[rows]])
        new = joined(row.of(rows), free(noise.of(rows), then - now[rows]))
        row = row.put(rows, measured(new, info[rows, column[rows]]))
        now[rows] = then
    return joined(row, free(noise, span - now))


def _not_negative(time: Array) -> Array:
    """But for rounding it is not."""
    return np.where(time.real < 0, 0.0, time)

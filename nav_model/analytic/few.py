"""Values over a map of designs, computed at a few designs and interpolated by polynomials, with a check.

A map is cut into boxes. In each, the values at a dozen rows and columns close to Chebyshev's points give a polynomial
of the place, and that is compared with values computed at other places between them. Where it is beyond `BOUND`
along an axis, the box is halved there, until every row or column of it is taken. Along an axis that changes how many
fixes there are, values jump: there every row or column is compared. Other discontinuities, such as where one method
takes over from another, must be separate maps of the caller. All boxes of a round are computed in one call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array

BOUND = 1e-4
"""Largest difference, at the places compared, of a polynomial from what is computed there."""

_POINTS = 13  # along a side of a box
_CHECKED = 4  # rows or columns between the points that are compared, at as many of the points along the other axis

Places = NDArray[np.int64]


@dataclass
class _Box:
    """Part of a map: its rows and columns, and the axes along which every row or column is computed."""

    of: int
    ends: tuple[tuple[int, int], tuple[int, int]]
    whole: tuple[bool, bool] = (False, False)


@dataclass
class _Map:
    wanted: NDArray[np.bool_]
    jumps: tuple[bool, bool]
    at: tuple[Array, Array]  # where rows and columns are
    values: Array  # (k, rows, columns)
    known: NDArray[np.bool_]

    def ask(self, rows: Places, columns: Places) -> None:
        """Request these points in this round."""
        self.asked[np.ix_(rows, columns)] = True

    def __post_init__(self) -> None:
        self.asked = np.zeros_like(self.known)


def from_few(
    wanted: Sequence[NDArray[np.bool_]],
    jumps: Sequence[tuple[bool, bool]],
    size: int,
    exact: Callable[[Places, Places, Places], Array],
    at: tuple[Array, Array] | None = None,
) -> list[Array]:
    """Values of several maps, within `BOUND` where they are interpolated.

    Parameters
    ----------
    wanted : sequence of array of bool, (rows, columns)
        Where each map is asked for; its function must be known elsewhere in the box around that too.
    jumps : sequence of pairs of bool
        Of each map, whether values may jump from row to row, at any column alike, and from column to column.
    size : int
        Values of a design.
    exact : callable
        Number of the map, row and column, each an array (n,), to values (size, n). They should vary little: the
        logarithms of variances, say.
    at : pair of array, optional
        Where the rows and the columns of all maps are, rising, if not evenly spaced: values are smooth in these.

    Returns
    -------
    list of array, (size, rows, columns)
        Anything outside what is wanted.
    """
    rows, columns = wanted[0].shape
    even = np.arange(rows, dtype=float), np.arange(columns, dtype=float)
    maps = [
        _Map(where, jumping, at or even, np.zeros((size, *where.shape)), np.zeros_like(where))
        for where, jumping in zip(wanted, jumps, strict=True)
    ]
    boxes = [_Box(n, ((0, where.shape[0]), (0, where.shape[1]))) for n, where in enumerate(wanted)]
    while boxes:
        plans = [(box, plan) for box in boxes if (plan := _plan(box, maps[box.of])) is not None]
        _work_out(maps, exact)
        boxes = [part for box, plan in plans for part in _settle(box, plan, maps[box.of])]
    return [one.values for one in maps]


@dataclass
class _Plan:
    """Points of a box along each axis, and the points between them for comparison."""

    points: tuple[Places, Places]
    between: tuple[Places, Places]


def _plan(box: _Box, of: _Map) -> _Plan | None:
    """Request the points that a box needs; None if every point of it is requested."""
    (top, bottom), (left, right) = box.ends
    inside = of.wanted[top:bottom, left:right]
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if not len(rows):
        return None
    box.ends = (top + rows[0], top + rows[-1] + 1), (left + columns[0], left + columns[-1] + 1)
    points = _points(*box.ends[0], box.whole[0], of.at[0]), _points(*box.ends[1], box.whole[1], of.at[1])
    if all(of.jumps) or np.count_nonzero(inside) <= 1.5 * len(points[0]) * len(points[1]):
        of.asked[top:bottom, left:right] |= inside
        return None
    between = _between(points[0], of.jumps[0]), _between(points[1], of.jumps[1])
    of.ask(*points)
    of.ask(between[0], _some(points[1]))
    of.ask(_some(points[0]), between[1])
    return _Plan(points, between)


def _points(first: int, end: int, whole: bool, at: Array) -> Places:
    if whole or end - first <= _POINTS:
        return np.arange(first, end)
    x = (1 - np.cos(np.pi * np.arange(_POINTS) / (_POINTS - 1))) / 2
    middle = (at[first + 1 : end] + at[first : end - 1]) / 2
    return np.unique(first + np.searchsorted(middle, at[first] + (at[end - 1] - at[first]) * x))


def _between(points: Places, everywhere: bool) -> Places:
    if everywhere:
        return np.setdiff1d(np.arange(points[0], points[-1]), points)
    middle = (points[:-1] + points[1:]) // 2
    return _some(middle[middle != points[:-1]])


def _some(places: Places) -> Places:
    taken = np.unique(np.linspace(0, len(places) - 1, min(_CHECKED, len(places))).round().astype(int))
    return np.asarray(places[taken])


def _work_out(maps: Sequence[_Map], exact: Callable[[Places, Places, Places], Array]) -> None:
    fresh = [np.nonzero(one.asked & ~one.known) for one in maps]
    counts = [len(rows) for rows, _ in fresh]
    if not sum(counts):
        return
    rows, columns = (np.concatenate([pair[axis] for pair in fresh]) for axis in (0, 1))
    values = exact(np.repeat(np.arange(len(maps)), counts), rows, columns)
    for one, pair, found in zip(maps, fresh, np.split(values, np.cumsum(counts)[:-1], axis=1), strict=True):
        one.values[:, pair[0], pair[1]] = found
        one.known[pair] = True


def _settle(box: _Box, plan: _Plan, of: _Map) -> list[_Box]:
    """Fill a box from its points, or return the parts that it is split into."""
    weights = [_weights(*box.ends[axis], plan.points[axis], of.at[axis]) for axis in (0, 1)]
    off = _off(of.values, plan, weights[0], box.ends[0][0], 0), _off(of.values, plan, weights[1], box.ends[1][0], 1)
    if max(off) <= BOUND:
        rows, columns = plan.points
        made = weights[0] @ of.values[:, rows[:, None], columns] @ weights[1].T
        across, down = (slice(*ends) for ends in box.ends)
        left = ~of.known[across, down]
        of.values[:, across, down][:, left] = made[:, left]
        return []
    whole, parts = list(box.whole), [[ends] for ends in box.ends]
    for axis, (first, end) in enumerate(box.ends):
        if off[axis] <= BOUND:
            continue
        if end - first <= 2 * _POINTS:
            whole[axis] = True
        else:
            middle = (first + end) // 2
            parts[axis] = [(first, middle), (middle, end)]
    return [_Box(box.of, (rows, columns), (whole[0], whole[1])) for rows in parts[0] for columns in parts[1]]


def _off(values: Array, plan: _Plan, weights: Array, first: int, axis: int) -> float:
    """Largest difference at the comparison points along an axis."""
    between, points, other = plan.between[axis], plan.points[axis], _some(plan.points[1 - axis])
    if not len(between):
        return 0.0
    turned = values if axis == 0 else values.swapaxes(1, 2)
    made = weights[between - first] @ turned[:, points[:, None], other]
    difference = float(np.max(np.abs(made - turned[:, between[:, None], other])))
    return difference if difference == difference else np.inf


def _weights(first: int, end: int, points: Places, at: Array) -> Array:
    """Of the values at the points, for every place of an axis: the polynomial through them."""
    places, nodes = at[first:end], at[points]
    if len(nodes) == len(places):
        return np.eye(len(places))
    span = places[-1] - places[0]
    apart = (nodes[:, None] - nodes) * (4 / span)  # near one on the whole, so that products stay in range
    np.fill_diagonal(apart, 1)
    distance = places[:, None] - nodes
    hit = distance == 0
    distance[hit] = 1
    weights = 1 / np.prod(apart, axis=1) / distance
    weights /= weights.sum(axis=1, keepdims=True)
    on = hit.any(axis=1)
    weights[on] = hit[on]
    return np.asarray(weights)

"""Places on a map, the same on screen and on paper: the contour of a level, and the names of regions."""

import numpy as np
from contourpy import contour_generator

from app.charts.kinds import Array, MapChart

_SLIVER = 0.004  # of the map: too little to carry a name
_LETTER, _LINE, _AROUND = 6.8 / 288, 17 / 232, (6 / 288, 5 / 232)  # of a map in a window of 390 pixels


def contour(across: Array, up: Array, values: Array, level: float) -> Array:
    """Where values (m, n) over across (n,) and up (m,) are at a level: points (k, 2), pieces apart by NaN; where a
    value is NaN there is nothing."""
    gap = np.full((1, 2), np.nan)
    pieces = contour_generator(across, up, np.ma.masked_invalid(values)).lines(level)
    return np.concatenate([gap, *(part for piece in pieces for part in (np.asarray(piece), gap))])


def region_names(chart: MapChart) -> dict[int, tuple[float, float, str]]:
    """Region -> the middle of its name and the name in lines; slivers go unnamed.

    A name is near the middle of its region, within the map, apart from the other names, and off points and contour
    where there is room. The map is as small as on a phone: on a larger one the names are further apart.
    """
    placed: dict[int, tuple[float, float, str]] = {}
    boxes: list[tuple[float, float, float, float]] = []
    drawn_x = np.concatenate([chart.contour.x, *(points.x for points in chart.points)])
    drawn_y = np.concatenate([chart.contour.y, *(points.y for points in chart.points)])
    drawn = np.isfinite(drawn_x)  # between parts of a contour there is nothing
    marks = share(drawn_x[drawn], chart.x), share(drawn_y[drawn], chart.y)
    # The smallest region first: it has the least choice.
    for index in np.argsort(np.bincount(chart.winner.ravel(), minlength=len(chart.names)), kind="stable"):
        rows, columns = np.nonzero(chart.winner == index)
        if len(rows) < max(_SLIVER * chart.winner.size, 1):
            continue
        lines = chart.names[index].replace(", ", ",\n").split("\n")
        half_x, half_y = max(map(len, lines)) * _LETTER / 2 + _AROUND[0], len(lines) * _LINE / 2 + _AROUND[1]
        x, y = share(chart.x[columns], chart.x), share(chart.y[rows], chart.y)
        cost = (x - x.mean()) ** 2 + (y - y.mean()) ** 2
        cost += 100 * (np.maximum(half_x - np.minimum(x, 1 - x), 0) + np.maximum(half_y - np.minimum(y, 1 - y), 0))
        for other_x, other_y, wide, high in boxes:
            cost += 10 * ((np.abs(x - other_x) < half_x + wide) & (np.abs(y - other_y) < half_y + high))
        # How far from the middle of the name the nearest mark is, in halves of the name: 1 is beside it.
        away = np.maximum(np.abs(x[:, None] - marks[0]) / half_x, np.abs(y[:, None] - marks[1]) / half_y)
        cost += 0.1 * np.maximum(1.0 - away.min(axis=1, initial=1.0), 0.0)
        best = int(np.argmin(cost))
        boxes.append((x[best], y[best], half_x, half_y))
        placed[int(index)] = float(chart.x[columns[best]]), float(chart.y[rows[best]]), "\n".join(lines)
    return placed


def share(values: Array, axis: Array, *, is_log: bool = True) -> Array:
    """Position of values along an axis: 0 at its beginning, 1 at its end."""
    if is_log:
        values, axis = np.log(values), np.log(axis)
    return np.asarray((values - axis[0]) / (axis[-1] - axis[0]))

"""Where things are on a map: a level's contour, and the name of a region, the same place on screen and on paper."""

from __future__ import annotations

import numpy as np
from contourpy import contour_generator

from app.charts.kinds import Array, MapChart

_SLIVER = 0.004  # of the map: too little to carry a name


def contour(across: Array, up: Array, values: Array, level: float) -> Array:
    """Where values (m, n) over across (n,) and up (m,) are at a level: points (k, 2), pieces apart by NaN; where a
    value is NaN there is nothing."""
    gap = np.full((1, 2), np.nan)
    pieces = contour_generator(across, up, np.ma.masked_invalid(values)).lines(level)
    return np.concatenate([gap, *(part for piece in pieces for part in (np.asarray(piece), gap))])


def middle_of(chart: MapChart, index: int) -> tuple[float, float, str] | None:
    """Where the name of a region stands: of its cells, the one nearest to their middle; slivers go unnamed."""
    rows, columns = np.nonzero(chart.winner == index)
    if len(rows) < _SLIVER * chart.winner.size:
        return None
    width = chart.winner.shape[1]
    # A name reaches about a sixth of the map to each side of its place: keep it off the edges where it can be.
    off = 10 * np.maximum(np.abs(columns - width / 2) - width / 3, 0)
    nearest = np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2 + off**2)
    return float(chart.x[columns[nearest]]), float(chart.y[rows[nearest]]), chart.names[index]

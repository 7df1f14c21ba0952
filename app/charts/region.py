"""Where the name of a region of a map stands: the same place on screen and on paper."""

from __future__ import annotations

import numpy as np

from app.charts.kinds import MapChart

_SLIVER = 0.004  # of the map: too little to carry a name


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

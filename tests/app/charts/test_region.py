"""Names on maps: apart from one another and within the map, as small as on a phone."""

from itertools import combinations
from math import log

import pytest

from app.charts.region import region_names
from app.charts.screen.maps import MapFigure
from app.examples import EXAMPLES, example
from app.subjects.explore.charts import map_chart
from app.subjects.sar.charts import winner_chart
from nav_model.budget import analyse
from nav_model.explore.margins import ALL

Box = tuple[float, float, float, float]


def _touch(a: Box, b: Box) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])


def _check(boxes: list[Box], wide: float, high: float) -> None:
    assert boxes
    assert not [pair for pair in combinations(boxes, 2) if _touch(*pair)]
    assert all(a >= 0 and b >= 0 and c <= wide and d <= high for a, b, c, d in boxes)


def _along(value, axis, size):
    """Pixels along a log axis."""
    first, last = float(axis[0]), float(axis[-1])
    return size * log(value / first) / log(last / first)


@pytest.mark.parametrize("name", EXAMPLES)
def test_names_of_regions_on_a_phone(name):
    chart = winner_chart(analyse(example(name)))
    boxes = []
    for x, y, text in region_names(chart).values():
        lines = text.split("\n")
        across, up = _along(x, chart.x, 288), _along(y, chart.y, 232)
        wide, high = 6.5 * max(map(len, lines)) / 2, 15 * len(lines) / 2
        boxes.append((across - wide, up - high, across + wide, up + high))
    _check(boxes, 288, 232)


@pytest.mark.parametrize(
    ("narrow", "wide", "high", "least"), [(True, 205, 225, 4), (False, 800, 370, 12), (False, 960, 590, 12)]
)
def test_names_of_the_catalogue_on_a_map(narrow, wide, high, least):
    chart = map_chart(example("mems_x_band"), "imu.angle_random_walk", "imu.velocity_random_walk", ALL)
    plot = MapFigure(chart, narrow=narrow).plot
    source = next(
        s for r in plot.renderers if (s := getattr(r, "data_source", None)) and s.name.endswith("catalogue")
    )
    boxes = []
    for x, y, right, down, align, text in zip(
        *(source.data[key] for key in ("x", "y", "right", "down", "align", "name")), strict=True
    ):
        if text:
            size = 6.0 * len(text)
            left = _along(x, chart.x, wide) + right - {"left": 0, "center": size / 2, "right": size}[align]
            up = _along(y, chart.y, high) - down
            boxes.append((left, up - 6.5, left + size, up + 6.5))
    _check(boxes, wide, high)
    assert len(boxes) >= least

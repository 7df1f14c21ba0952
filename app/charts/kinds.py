"""The kinds of charts, as plain data without a plotting library.

A chart's structure (its series, by key) does not depend on the design; only the numbers do, so a figure on screen is
made once and updated. A series without values is NaN. Lines that share one `x` array object are sent to the browser
together.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.text.csv_text import csv_text
from nav_model.explore.trade_map import MapPoint, TradeMap

Array = NDArray[np.float64]
CLOCK = "time [s]"
"""Label of the time axis of a flight. Its ticks are minutes and seconds, "8:10"; its numbers stay seconds."""
DataRow = tuple[str | float, ...]
"""A row of a chart's numbers as a table, which `to_csv` writes with full precision."""


def spread_of(axis: str) -> str:
    """The spread of an axis's values, from its label.

    >>> spread_of("position, 95 % [m]"), spread_of("height [m]")
    ('95 %', '1σ')
    """
    return axis.rpartition(" [")[0].rpartition(", ")[2] if ", " in axis else "1σ"


@dataclass(frozen=True)
class Line:
    """A curve. ``source`` says where it comes from: equation and method, shown on hover and in print; ``end``: its
    name at its end, where curves are named there (None: the label; empty: none)."""

    key: str
    label: str
    x: Array
    y: Array
    style: str
    source: str = ""
    end: str | None = None


@dataclass(frozen=True)
class Band:
    """The area between two curves."""

    key: str
    label: str
    x: Array
    low: Array
    high: Array
    style: str
    source: str = ""


@dataclass(frozen=True)
class Points:
    """Named points. ``sizes`` in pixels, where they say something (the brightness of a star). ``marker`` "name": on
    screen the names themselves stand there."""

    key: str
    label: str
    x: Array
    y: Array
    names: tuple[str, ...]
    style: str
    marker: str = "circle"
    source: str = ""
    sizes: Array | None = None


@dataclass(frozen=True)
class LimitLine:
    """A requirement's limit over a stretch of the x axis; a NaN level is not drawn."""

    key: str
    label: str
    start: float
    stop: float
    level: float


@dataclass(frozen=True)
class Span:
    """A stretch of the x axis, shaded and named; one with a NaN start is not drawn. ``style``: of its colour, if
    it has one, such as that of a verdict; ``faint``: hardly shaded, as what is darker lies in it."""

    key: str
    label: str
    start: float
    stop: float
    style: str = ""
    faint: bool = False


MOST_OUTAGES = 4
"""Shaded spans a chart of a flight has room for; those a flight does not have are not drawn."""


def without_fixes(outages: Iterable[tuple[float, float]]) -> tuple[Span, ...]:
    """The outages of a flight as spans."""
    given = [*outages][:MOST_OUTAGES]
    parked = [(math.nan, math.nan)] * (MOST_OUTAGES - len(given))
    return tuple(Span(f"outage {i}", "no fixes", start, stop) for i, (start, stop) in enumerate(given + parked))


@dataclass(frozen=True)
class _Titled:
    """Fields of every chart."""

    key: str
    title: str
    x_label: str


@dataclass(frozen=True)
class _OnAxes(_Titled):
    """Fields of every chart on two axes."""

    y_label: str


@dataclass(frozen=True)
class Chart(_OnAxes):
    """A chart of curves. ``knowledge`` is its "how do we know" line; ``square``: as high as it is wide; ``aside``: a
    few words beside its title on a page; ``named_at_ends``: on paper its lines are named there, not in the legend."""

    lines: tuple[Line, ...]
    bands: tuple[Band, ...] = ()
    points: tuple[Points, ...] = ()
    limits: tuple[LimitLine, ...] = ()
    spans: tuple[Span, ...] = ()
    x_log: bool = False
    y_log: bool = False
    y_range: tuple[float, float] | None = None
    x_range: tuple[float, float] | None = None
    square: bool = False
    knowledge: str = ""
    aside: str = ""
    named_at_ends: bool = False

    def rows(self) -> Iterator[DataRow]:
        """Every number drawn, as rows of a table: series, x, y, (upper y of a band or a point's name)."""
        yield ("series", self.x_label, self.y_label, "upper or name", "source")
        for line in self.lines:
            for x, y in zip(line.x, line.y, strict=True):
                if not math.isnan(y):
                    yield (line.label, x, y, "", line.source)
        for band in self.bands:
            for x, low, high in zip(band.x, band.low, band.high, strict=True):
                yield (band.label, x, low, high, band.source)
        for points in self.points:
            for x, y, name in zip(points.x, points.y, points.names, strict=True):
                yield (points.label, x, y, name, points.source)
        for limit in self.limits:
            if not math.isnan(limit.level):
                for x in (limit.start, limit.stop):
                    yield ("limit", x, limit.level, limit.label, "requirement")


TOTAL = "total"
"""Label of the bar that is the sum of those above it."""


@dataclass(frozen=True)
class Bar:
    """One row of a bar chart: two lengths in its unit, the same in millimetres, and where they come from.

    ``limited``: whether the chart's limits hold for it. ``parts``: what it is made of, the largest first, with the
    share of each.
    """

    label: str
    first: float
    second: float
    first_mm: float
    second_mm: float
    source: str
    limited: bool = False
    parts: tuple[tuple[str, float], ...] = ()

    @property
    def shows(self) -> bool:
        """True if either bar has a length above zero."""
        return any(math.isfinite(length) and length > 0 for length in (self.first, self.second))


@dataclass(frozen=True)
class BarChart(_Titled):
    """Horizontal bars of an angle, two to a row, each kind with a limit (NaN when there is none).

    ``x_label`` ends with the unit of them all: "[°]" or "[rad]".
    """

    first_label: str
    second_label: str
    bars: tuple[Bar, ...]
    first_limit: float
    second_limit: float
    knowledge: str = ""

    @property
    def unit(self) -> str:
        """The unit after a number: "°", or " rad" with its space."""
        return " rad" if self.x_label.endswith("[rad]") else "°"

    def rows(self) -> Iterator[DataRow]:
        """Every number drawn, as rows of a table."""
        kinds = (self.first_label, self.second_label)
        unit = self.unit.strip()
        yield ("source", *(f"{kind} [{unit}]" for kind in kinds), *(f"{kind} [mm]" for kind in kinds), "equation")
        for bar in self.bars:
            yield (bar.label, bar.first, bar.second, bar.first_mm, bar.second_mm, bar.source)


@dataclass(frozen=True)
class Dot:
    """One row of a dot chart [degrees]: a closed form (NaN: none), what runs gave, their 5-95 % band; ``note``: a few
    words beside the label."""

    label: str
    closed: float
    ensemble: float
    low: float
    high: float
    source: str
    note: str = ""


@dataclass(frozen=True)
class DotChart(_Titled):
    """Dots and bands on a log axis, a row each, with one limit (NaN: none).

    ``millimetres``: of line of sight for one degree, for the hover and the table.
    """

    dots: tuple[Dot, ...]
    limit: float
    millimetres: float
    knowledge: str = ""

    def rows(self) -> Iterator[DataRow]:
        """Every number drawn, as rows of a table."""
        names = ("formula", "ensemble rms", "ensemble 5 %", "ensemble 95 %")
        yield ("strategy", *(f"{n} [°]" for n in names), *(f"{n} [mm]" for n in names), "source")
        for dot in self.dots:
            values = (dot.closed, dot.ensemble, dot.low, dot.high)
            yield (dot.label, *values, *(self.millimetres * value for value in values), dot.source)
        yield ("limit", self.limit, *[""] * 8)


@dataclass(frozen=True)
class MapChart(_OnAxes):
    """A map on two log axes: regions with their names, points and one contour.

    ``x`` (n,), ``y`` (m,) evenly spaced in the logarithm; ``winner`` (m, n) index into ``names``;
    ``values`` (m, n) what the contour is a level of; ``styles``: one for each name.
    """

    value_label: str
    x: Array
    y: Array
    winner: NDArray[np.intp]
    values: Array
    names: tuple[str, ...]
    styles: tuple[str, ...]
    points: tuple[Points, ...]
    contour: Line
    knowledge: str = ""

    def rows(self) -> Iterator[DataRow]:
        """Every cell of the map, then the points."""
        yield (self.x_label, self.y_label, "name", self.value_label)
        for i, y in enumerate(self.y):
            for j, x in enumerate(self.x):
                yield (x, y, self.names[self.winner[i, j]], self.values[i, j])
        for points in self.points:
            for x, y, name in zip(points.x, points.y, points.names, strict=True):
                yield (x, y, name, points.label)


@dataclass(frozen=True)
class PictureChart(_OnAxes):
    """Images side by side on one scale, from `floor_db` to 0 dB over `reference`; y upwards, the same axes for all.

    ``x`` (n,), ``y`` (m,) evenly spaced; ``power_db`` (k, m, n); ``names`` and ``captions``: one for each image.
    """

    x: Array
    y: Array
    power_db: Array
    names: tuple[str, ...]
    captions: tuple[str, ...]
    reference: str
    floor_db: float = -40.0
    knowledge: str = ""

    @property
    def axes(self) -> str:
        """Both axes in words, for images without ticks."""
        return f"{_extent(self.x_label, self.x)} across, {_extent(self.y_label, self.y)} upwards"


LEVELS = (0.5, 1.0, 2.0)
"""Contours of a map, as multiples of the limit (or of the design's own value when there is no limit)."""


@dataclass(frozen=True)
class RankBar:
    """Effect of one change of one input on a figure: reduction in per cent, and in words; ``bought``: whether a part
    or an installation changes, not the geometry."""

    label: str
    percent: float
    doubled: bool
    sentence: str
    slope: float
    bought: bool = True


@dataclass(frozen=True)
class RankChart(_Titled):
    """Bars, the strongest first."""

    bars: tuple[RankBar, ...]
    knowledge: str

    def rows(self) -> Iterator[DataRow]:
        """Every bar as a row of a table."""
        yield ("change", self.x_label, "d ln(result)/d ln(input)", "in words")
        for bar in self.bars:
            yield (bar.label, bar.percent, bar.slope, bar.sentence)


@dataclass(frozen=True)
class TradeMapChart(_OnAxes):
    """A map: ``ratio`` (len(y), len(x)) of the result to its limit, contours, units of the catalogue, the design.

    Axes are in the units shown. ``contours`` holds one curve for each of `LEVELS`, pieces separated by NaN. ``level``
    is what ``ratio`` is over: the limit, or the design's own value. ``decides``: no flight judges
    after it.
    """

    x: Array
    y: Array
    x_log: bool
    y_log: bool
    ratio: np.ndarray
    contours: tuple[tuple[Array, Array], ...]
    reference: str
    points: tuple[MapPoint, ...]
    points_x: Array
    points_y: Array
    here: tuple[float, float]
    knowledge: str
    trade: TradeMap
    level: float
    decides: bool

    @property
    def limited(self) -> bool:
        """True if ``level`` is a limit."""
        return not math.isnan(self.trade.limit)

    @property
    def structure(self) -> tuple[str, str, str, bool]:
        """The parts that a figure's structure depends on; if they change, a new figure is needed."""
        return self.x_label, self.y_label, self.trade.result, self.decides

    def rows(self) -> Iterator[DataRow]:
        """Every cell of the map, then the catalogue."""
        yield (self.x_label, self.y_label, f"{self.trade.result} over {self.reference}", "name")
        for y, row in zip(self.y, self.ratio, strict=True):
            for x, value in zip(self.x, row, strict=True):
                yield (x, y, value, "")
        for x, y, point in zip(self.points_x, self.points_y, self.points, strict=True):
            yield (x, y, point.value / self.level, point.name)


def _extent(label: str, values: Array) -> str:
    name, _, unit = label.partition(" [")
    return f"{name} {values[0]:.3g} to {values[-1]:.3g} {unit.rstrip(']')}".replace("-", "−")


Plotted = Chart | MapChart
"""Charts that the screen has as a figure with axes; rows of bars and dots are HTML."""

AnyChart = Plotted | BarChart | DotChart
Drawing = AnyChart | PictureChart
"""Whatever a report shows as a figure."""


def to_csv(chart: AnyChart | RankChart | TradeMapChart) -> str:
    """A chart's data as CSV text, full precision."""
    return csv_text(chart.rows())

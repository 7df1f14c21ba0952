"""Maps of two inputs as Bokeh figures: made once, then updated."""

from pathlib import Path
from typing import Any

import numpy as np
from bokeh.models import ColorBar, CustomJSTickFormatter, FixedTicker, HoverTool, LogColorMapper, Range1d

from app.charts.kinds import LEVELS, Array, TradeMapChart
from app.charts.region import share
from app.charts.screen.axes import empty_figure
from app.charts.screen.figures import FACE, fill, image_columns
from app.charts.screen.sources import Sources
from app.charts.styles import STYLES
from nav_model.explore.trade_map import MapPoint

# Light meets the limit, dark does not; the steps are told apart in grey too.
_PALETTE = ("#f4f8fb", "#dfebf4", "#c3d9ea", "#93b7d3", "#5d8fb5", "#2f6690")
_RANGE = (1 / 8, 8.0)
_CONTOUR = {0.5: ("dotted", 1.5, "half"), 1.0: ("solid", 3.0, "limit"), 2.0: ("dashed", 1.5, "twice")}
_INK = "#3b4650"  # of contours, and of a limit after which a flight decides
# The map in a window of 1280 x 720 and of 390 pixels: width, height, how far above or below its mark a name may be.
_ON_A_SCREEN, _ON_A_PHONE = (800.0, 370.0, 42.0), (205.0, 225.0, 14.0)
_TIMES = Path(__file__).with_name("times_labels.js").read_text("utf-8")


class MapFigure:
    """A map with its contours, the catalogue's units and the design's cross; narrow: names as on a phone."""

    def __init__(self, chart: TradeMapChart, *, narrow: bool = False) -> None:
        self._room = _ON_A_PHONE if narrow else _ON_A_SCREEN
        self.plot = empty_figure(
            chart,
            x_log=chart.x_log,
            y_log=chart.y_log,
            x_range=Range1d(chart.x[0], chart.x[-1]),
            y_range=Range1d(chart.y[0], chart.y[-1]),
            tools="save",
            toolbar_location="right",
        )
        fill(self.plot)
        self.plot.grid.visible = False
        self._sources = sources = Sources(_columns(chart, self._room), f"{chart.key} ")
        mapper = LogColorMapper(palette=list(_PALETTE), low=_RANGE[0], high=_RANGE[1], nan_color="#ffffff00")
        image = self.plot.image("image", "x", "y", "dw", "dh", source=sources["image"], color_mapper=mapper)
        red = STYLES["limit"].colour if chart.decides else _INK
        for level, (dash, width, word) in _CONTOUR.items():
            self.plot.line("x", "y", source=sources[f"contour {word}"], line_color=red if level == 1 else _INK,
                           line_dash=dash, line_width=width)  # fmt: skip
        marks = self.plot.scatter(
            "x", "y", marker="marker", size=8, source=sources["catalogue"], fill_color="#ffffff",
            line_color="#10151a", line_width=1.6, level="overlay",
        )  # fmt: skip
        self.plot.text(
            "x", "y", text="name", x_offset="right", y_offset="down", text_align="align", source=sources["catalogue"],
            text_baseline="middle", **FACE, text_color="#10151a", background_fill_color="#ffffff",
            background_fill_alpha=0.7,
        )  # fmt: skip
        cross = {"marker": "cross", "size": 26, "line_width": 3.5, "line_color": STYLES["this design"].colour}
        self.plot.scatter("x", "y", source=sources["design"], **cross)
        self.plot.add_layout(
            ColorBar(
                color_mapper=mapper, width=10, title="× " + chart.reference.replace("this design's value", "now"),
                ticker=FixedTicker(ticks=[0.125, 0.25, 0.5, 1, 2, 4, 8]), title_text_font_size="12px",
                formatter=CustomJSTickFormatter(code=_TIMES),
            ),
            "right",
        )  # fmt: skip
        self.plot.add_tools(
            HoverTool(renderers=[image], tooltips=f"@image{{0.000}} × {chart.reference}<br>at $x, $y", visible=False),
            HoverTool(renderers=[marks], tooltips="<b>@unit</b><br>@said", visible=False),
        )

    def feed(self, chart: TradeMapChart) -> None:
        """Show another map of the same structure."""
        self._sources.feed(_columns(chart, self._room))
        for span, values in ((self.plot.x_range, chart.x), (self.plot.y_range, chart.y)):
            if (span.start, span.end) != (values[0], values[-1]):
                span.update(start=float(values[0]), end=float(values[-1]))


def _columns(chart: TradeMapChart, room: tuple[float, float, float]) -> dict[str, dict[str, Any]]:
    """Source name -> columns."""
    curves = zip(LEVELS, chart.contours, strict=True)
    return {
        "image": image_columns(chart.ratio, chart.x, chart.y, x_log=chart.x_log, y_log=chart.y_log),
        **{f"contour {_CONTOUR[level][2]}": {"x": x, "y": y} for level, (x, y) in curves},
        "catalogue": _points(chart, room),
        "design": {"x": [chart.here[0]], "y": [chart.here[1]]},
    }


def _points(chart: TradeMapChart, room: tuple[float, float, float]) -> dict[str, Any]:
    return {
        "x": chart.points_x,
        "y": chart.points_y,
        "unit": [point.name for point in chart.points],
        "marker": ["x" if point.met is False else "circle" for point in chart.points],
        **_labels(chart, *room),
        "said": [_margin_text(chart, point) for point in chart.points],
    }


def _margin_text(chart: TradeMapChart, point: MapPoint) -> str:
    """Text on whether a unit passes, and its margin."""
    if point.met is None:
        return "no limit is given"
    times = point.value / chart.level
    margin = f"margin {100 * (1 - times):+.0f} %".replace("-", "−") if times <= 1 else f"{times:.3g} × the limit"
    return f"{'meets' if point.met else 'does not meet'} the limit, {margin}"


def _labels(chart: TradeMapChart, wide: float, high: float, reach: float) -> dict[str, list[Any]]:
    """The place of each name beside its mark: the first that covers no other name or mark on a map of this size in
    pixels, or on a larger one, where marks are further apart. A name without a place is shown on hover only."""
    x = share(chart.points_x, chart.x, is_log=chart.x_log)
    y = share(chart.points_y, chart.y, is_log=chart.y_log)
    # A box is left, top, right and bottom; each has a row for each of the sizes.
    marks = np.stack([wide * np.outer(_SIZES[:, 0], x), -high * np.outer(_SIZES[:, 1], y)] * 2, axis=-1)
    taken = list(np.moveaxis(marks + np.array([-6, -6, 6, 6]), 1, 0))
    placed: dict[str, list[Any]] = {"right": [], "down": [], "align": [], "name": []}
    for index, point in enumerate(chart.points):
        width = 7.0 * len(point.name)
        for right, lower, align in (place for place in _PLACES if abs(place[1]) <= reach):
            left = right - {"left": 0, "right": width, "center": width / 2}[align]
            box = marks[:, index] + np.array([left, lower - 7, left + width, lower + 7])
            first = box[0]  # what is inside the smallest map is inside a larger one
            inside = first[0] > 0 and first[2] < wide and first[1] > -high and first[3] < 0
            if inside and not _overlap(box, np.array(taken)):
                taken.append(box)
                name = point.name
                break
        else:
            right, lower, align, name = 0, 0, "left", ""
        for key, value in zip(placed, (right, lower, align, name), strict=True):
            placed[key].append(value)
    return placed


_SIZES = np.array([(1.0, 1.0), (1.0, 1.25), (1.2, 1.6), (1.5, 1.0), (1.5, 1.5), (1.5, 2.0)])
"""Of larger maps, across and down, over the smallest, which is the first."""
_PLACES = tuple(
    (right, lower, align)
    for lower in (0, -14, 14, -28, 28, -42, 42)
    for right, align in ((9, "left"), (-9, "right"), (0, "center"))
    if lower or align != "center"
)


def _overlap(box: Array, others: Array) -> bool:
    """True if a box (sizes, 4) meets one of the others (k, sizes, 4) at any of the sizes."""
    return bool(np.any(np.all((box[:, :2] < others[..., 2:]) & (others[..., :2] < box[:, 2:]), axis=-1)))

"""Charts as Bokeh figures: made once, then updated.

A `DrawnChart` keeps the sources of one figure. `feed` sends only what changed, so a slider step costs one message
with the changed arrays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np
from bokeh.core.properties import field as field_of
from bokeh.core.properties import value
from bokeh.models import (
    BoxAnnotation,
    ColumnDataSource,
    Glyph,
    GlyphRenderer,
    HoverTool,
    Label,
    LinearColorMapper,
    Scatter,
    Segment,
    Text,
    VArea,
)
from bokeh.models import Line as LineGlyph
from bokeh.plotting import figure

from app.charts.kinds import Array, Chart, Line, MapChart, Plotted
from app.charts.region import region_names
from app.charts.screen.axes import TOOLS, empty_figure, line_look
from app.charts.screen.sources import Sources
from app.charts.styles import INK, STYLES, behind_text

_FONT = "Roboto, 'Segoe UI', system-ui, sans-serif"
FACE: dict[str, Any] = {"text_font": value(_FONT), "text_font_size": "12px"}
CHIP: dict[str, Any] = {"text_color": "white", **FACE, "padding": [3, 0], "border_radius": 3}
"""Of a text inside a frame: white on a dark ground (`behind_text`), which is read on a light page and a dark one."""
_BESIDE = 42  # pixels by which axis and toolbar beside a frame exceed the axis under it
_LEAST = 180  # pixels of height of a figure that fills its place


@dataclass
class DrawnChart:
    """A Bokeh figure and its data sources. `plot` goes on a page or into a report."""

    plot: figure
    _sources: Sources
    _spans: dict[str, tuple[BoxAnnotation, Label]] = field(default_factory=dict)
    _lines: Sequence[GlyphRenderer] = ()

    def feed(self, chart: Plotted) -> None:
        """Show another chart of the same structure."""
        self._sources.feed(_columns(chart))
        if isinstance(chart, Chart):
            self._feed_frame(chart)

    def _feed_frame(self, chart: Chart) -> None:
        for renderer, line in zip(self._lines, chart.lines, strict=True):
            renderer.name = _hovered(line)  # such as which run a line is
        for span in chart.spans:
            box, label = self._spans[span.key]
            box.visible = label.visible = not math.isnan(span.start)
            if box.visible:
                box.update(left=span.start, right=span.stop)
                label.x = span.start
        self.plot.match_aspect = chart.square and self.plot.sizing_mode == "stretch_both"
        if chart.y_range is not None:
            start, end = chart.y_range
            self.plot.y_range.update(start=start, end=end, reset_start=start, reset_end=end)


def to_bokeh(chart: Plotted, height: int | None = 320) -> DrawnChart:
    """A figure for a chart, as wide as its place; with a height of None also as high as its place."""
    if isinstance(chart, Chart):
        return _curves(chart, height)
    return _regions(chart, height)


def fill(plot: figure) -> None:
    """Make a figure as high as its place; its tools appear beside it only while the pointer is on it."""
    plot.update(height=None, min_height=_LEAST, sizing_mode="stretch_both")
    plot.toolbar.autohide = True


def _columns(chart: Plotted) -> dict[str, dict[str, Any]]:
    """Source name -> columns. Lines that share an x array share a source."""
    columns: dict[str, dict[str, Any]] = {}
    for points in chart.points:
        sizes = {} if points.sizes is None else {"size": points.sizes}
        columns[f"points {points.key}"] = {"x": points.x, "y": points.y, "name": list(points.names), **sizes}
    if isinstance(chart, MapChart):
        return columns | _map_columns(chart)
    for line in chart.lines:
        columns.setdefault(_line_source(chart, line.x), {"x": line.x})[_column(line)] = line.y
    for band in chart.bands:
        columns[f"band {band.key}"] = {"x": band.x, "low": band.low, "high": band.high}
    if chart.limits:
        columns["limits"] = {
            "x0": [limit.start for limit in chart.limits],
            "x1": [limit.stop for limit in chart.limits],
            "y": [limit.level for limit in chart.limits],
            "name": [limit.label for limit in chart.limits],
        }
    return columns


def _map_columns(chart: MapChart) -> dict[str, dict[str, Any]]:
    places = list(region_names(chart).values())
    return {
        "map": image_columns(chart.winner.astype(np.uint8), chart.x, chart.y, x_log=True, y_log=True),
        "regions": {
            "x": [x for x, _, _ in places],
            "y": [y for _, y, _ in places],
            "name": [name for *_, name in places],
        },
        "contour": {"x": chart.contour.x, "y": chart.contour.y},
    }


def image_columns(cells: np.ndarray, x: Array, y: Array, *, x_log: bool, y_log: bool) -> dict[str, Any]:
    """Columns of a picture of cells (m, n) with their points in the middle. The grid is even where the axis is
    straight, so the corners place every cell."""
    (left, right), (bottom, top) = _edges(x, x_log), _edges(y, y_log)
    return {"image": [cells], "x": [left], "y": [bottom], "dw": [right - left], "dh": [top - bottom]}


def _edges(values: Array, is_log: bool) -> tuple[float, float]:
    """Where the first cell begins and the last one ends."""
    straight = np.log(values) if is_log else values
    half = (straight[-1] - straight[0]) / (len(straight) - 1) / 2
    ends = np.array([straight[0] - half, straight[-1] + half])
    low, high = np.exp(ends) if is_log else ends
    return float(low), float(high)


def _column(line: Line) -> str:
    return f"y of {line.key}"


def _hovered(line: Line) -> str:
    """Text of a line when it is hovered: its renderer's name, so one hover tool serves all lines of a figure."""
    return f"{line.label}: {line.source}"


def _line_source(chart: Chart, x: Any) -> str:
    return f"lines {next(i for i, line in enumerate(chart.lines) if line.x is x)}"


def _curves(chart: Chart, height: int | None) -> DrawnChart:
    plot = empty_figure(
        chart,
        x_log=chart.x_log,
        y_log=chart.y_log,
        height=height or _LEAST,
        sizing_mode="stretch_width",
        tools=TOOLS,
        toolbar_location="right",
        active_drag=None,
        **{name: ends for name in ("x_range", "y_range") if (ends := getattr(chart, name))},
    )
    if height is None:
        fill(plot)
    elif chart.square:
        wide = height + _BESIDE  # so that the frame itself is square
        plot.update(sizing_mode="scale_width", max_width=wide, aspect_ratio=wide / height)
    sources = Sources(_columns(chart), f"{chart.key} ")
    spans = {span.key: _span(plot, span.label) for span in chart.spans}
    for band in chart.bands:
        style = STYLES[band.style]
        source = sources[f"band {band.key}"]
        add_glyph(plot, source, VArea(x="x", y1="low", y2="high", fill_color=style.colour, fill_alpha=0.25))
        for edge in ("low", "high"):  # a thin band would vanish without them
            add_glyph(plot, source, LineGlyph(x="x", y=edge, line_color=style.colour, line_alpha=0.6))
    lines = []
    for line in chart.lines:
        glyph = LineGlyph(x="x", y=field_of(_column(line)), **line_look(STYLES[line.style]))
        lines.append(add_glyph(plot, sources[_line_source(chart, line.x)], glyph, _hovered(line)))
    x_unit, y_unit = unit_of(chart.x_label), unit_of(chart.y_label)
    _hover(plot, lines, f"<b>$name</b><br>$snap_y{{0.000e+0}} {y_unit} at @x{{0.000}} {x_unit}")
    for points in chart.points:
        style = STYLES[points.style]
        source = sources[f"points {points.key}"]
        if points.marker == "name":
            middle = {"text_align": "center", "text_baseline": "middle"}
            ground = behind_text(style.colour)
            add_glyph(plot, source, Text(x="x", y="y", text="name", background_fill_color=ground, **CHIP, **middle))
            continue
        glyph = Scatter(
            x="x", y="y", marker=value(points.marker), size=9 if points.sizes is None else "size",
            fill_color=style.colour, line_color=style.colour, line_width=style.width if points.marker == "x" else 1.0,
        )  # fmt: skip
        renderer = add_glyph(plot, source, glyph)
        _hover(
            plot, [renderer], f"<b>@name</b>: {escape(points.source)}<br>@y{{0.000}} {y_unit} at @x{{0.000}} {x_unit}"
        )
    if chart.limits:
        glyph = Segment(x0="x0", y0="y", x1="x1", y1="y", **line_look(STYLES["limit"]))
        renderer = add_glyph(plot, sources["limits"], glyph)
        _hover(plot, [renderer], f"<b>@name</b><br>@y{{0.000}} {y_unit}")
    made = DrawnChart(plot, sources, spans, lines)
    made.feed(chart)  # places the spans
    return made


def _regions(chart: MapChart, height: int | None) -> DrawnChart:
    """Regions by colour and name, points and one contour."""
    sources = Sources(_columns(chart), f"{chart.key} ")
    plot = empty_figure(
        chart, x_log=True, y_log=True, height=height or _LEAST, sizing_mode="stretch_width", tools=TOOLS,
        toolbar_location="right", active_drag=None,
    )  # fmt: skip
    plot.x_range.range_padding = plot.y_range.range_padding = 0
    plot.grid.visible = False
    colours = [STYLES[style].colour for style in chart.styles]
    mapper = LinearColorMapper(palette=colours, low=-0.5, high=len(colours) - 0.5)
    plot.image("image", x="x", y="y", dw="dw", dh="dh", source=sources["map"], color_mapper=mapper, global_alpha=0.55)
    plot.text(
        "x", "y", text="name", source=sources["regions"], text_align="center", text_baseline="middle",
        **FACE, text_color="#1b2329", background_fill_color="#ffffff", background_fill_alpha=0.8,
        padding=4, border_radius=4,
    )  # fmt: skip
    look = line_look(STYLES[chart.contour.style]) | {"line_width": 2.2}
    plot.line("x", "y", source=sources["contour"], **look)
    for points in chart.points:
        style = STYLES[points.style]
        look = {"size": 7, "line_width": 0.8, "line_color": "#ffffff"}
        if points.marker == "cross":
            look = {"size": 16, "line_width": 3, "line_color": style.colour}
        marks = plot.scatter(
            "x", "y", source=sources[f"points {points.key}"], marker=points.marker, fill_color=style.colour, **look
        )
        _hover(plot, [marks], f"<b>@name</b>: {escape(points.source)}")
    if height is None:
        fill(plot)
    return DrawnChart(plot, sources)


def add_glyph(plot: figure, source: ColumnDataSource, glyph: Glyph, name: str | None = None) -> GlyphRenderer:
    """Add a glyph without the variants for selected and muted data that the plotting functions add: nothing is
    selected here, and every model delays the first view."""
    plain = {"selection_glyph": None, "nonselection_glyph": None, "muted_glyph": None}
    return plot.add_glyph(source, glyph, name=name, **plain)


def unit_of(label: str) -> str:
    """The unit in an axis label.

    >>> unit_of("position, 1σ [m]")
    'm'
    """
    return label.rpartition("[")[2].rstrip("]")


def _hover(plot: figure, renderers: list[Any], tooltip: str) -> None:
    plot.add_tools(HoverTool(renderers=renderers, tooltips=tooltip, visible=False))


def _span(plot: figure, text: str) -> tuple[BoxAnnotation, Label]:
    box = BoxAnnotation(left=0.0, right=0.0, fill_color="#7b8794", fill_alpha=0.18, line_alpha=0)
    label = Label(
        x=0.0, y=6, x_offset=3, y_units="screen", text=text, background_fill_color=INK, **CHIP | {"text_font": _FONT}
    )
    plot.add_layout(box)
    plot.add_layout(label)
    return box, label

"""Charts stacked on one time axis: one crosshair, one read-out of all curves, one message when they change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.events import MouseLeave, MouseMove
from bokeh.models import ColumnDataSource, CrosshairTool, CustomJS, Range1d, Segment, Text, VStrip
from bokeh.models import Line as LineGlyph
from bokeh.models import Span as Rule
from bokeh.plotting import figure

from app.charts.kinds import CLOCK, Chart, Line, Span
from app.charts.screen.axes import empty_figure, in_minutes, line_look
from app.charts.screen.figures import CHIP, add_glyph, unit_of
from app.charts.screen.sources import Sources
from app.charts.styles import GREY, INK, STYLES, behind_text

_LEFT = 90  # pixels left of every frame, so that the frames are aligned: room for "0.0005" and the axis' name
_RIGHT = 30  # pixels right of every frame: the tools beside the first one
_NARROW_SPAN = 0.15  # of the time axis: the name of a narrower span is in its middle
_HEIGHT = 70  # pixels of a frame on a low screen: names that have room in it have room in a higher one
_ROOM, _FARTHEST = 16.0, 40  # pixels of a name, and between it and its curve at most
_NAMED = 0.18  # of the time axis: the names at the ends of curves are as long
_FAINT: dict[str, Any] = {"line_alpha": 0.4, "line_width": 1.4}
_STEPS = (1.0, 2.0, 5.0, 10.0)
_READ_OUT = "".join(Path(__file__).with_name(name).read_text("utf-8") for name in ("clock.js", "read_out.js"))
_Range = tuple[float, float]


class Timelines:
    """Figures under one another, updated together.

    Parameters
    ----------
    charts : sequence of Chart
        All lines of all of them on one time array; limits and spans as they like. Their structure must not depend on
        what is fed later.
    beside : Timelines, optional
        Another stack, whose time axis this one shares.

    Attributes
    ----------
    plots : tuple of figure
        One for each chart, as high as its place; the last has the time axis.

    Examples
    --------
    >>> stack = Timelines(timelines(budget))
    >>> stack.compare(timelines(budget))  # faint beside what is fed, until compare(None)
    >>> stack.feed(timelines(other))
    """

    def __init__(self, charts: Sequence[Chart], beside: Timelines | None = None) -> None:
        first = charts[0]
        self._others: Sequence[Chart] = ()
        heights = self._heights(charts)
        self._sources = Sources(_columns(charts, heights))
        self._nothing = {name: np.array([np.nan]) for name in _curves(charts)}
        self._was = ColumnDataSource(self._nothing, name="timelines compared")
        self._x_range = beside.plots[0].x_range if beside else Range1d(*_ends(charts))
        crosshair = CrosshairTool(overlay=Rule(dimension="height", line_dash="dotted", line_color=GREY))
        self.plots: tuple[figure, ...] = tuple(
            self._plot(chart, height, crosshair, chart is first, chart is charts[-1])
            for chart, height in zip(charts, heights, strict=True)
        )
        self._read_out(charts)
        self._feed_frame(charts, heights)
        assert all(line.x is first.lines[0].x for chart in charts for line in chart.lines)

    def feed(self, charts: Sequence[Chart]) -> None:
        """Show other charts of the same structure."""
        heights = self._heights(charts)
        self._sources.feed(_columns(charts, heights))
        self._feed_frame(charts, heights)

    def compare(self, charts: Sequence[Chart] | None) -> None:
        """Show other charts faintly for comparison, or none; with the next feed the axes show them whole.

        Two feeds in one message may tell the browser of columns whose lengths differ.
        """
        self._was.data = _curves(charts) if charts else dict(self._nothing)
        self._others = charts or ()

    def _heights(self, charts: Sequence[Chart]) -> list[_Range]:
        """Bounds of each chart's y axis."""
        others: Sequence[Chart | None] = self._others or [None] * len(charts)
        return [chart.y_range or _nice_range(chart, other) for chart, other in zip(charts, others, strict=True)]

    def _read_out(self, charts: Sequence[Chart]) -> None:
        """The values at the time under the pointer, above each frame, in the units of the axes."""
        sources = [ColumnDataSource({"x": [], "y": [], "text": []}, name=f"{chart.key} read-out") for chart in charts]
        for plot, source in zip(self.plots, sources, strict=True):
            look = {"text_baseline": "bottom", "y_offset": -1}
            glyph = Text(x="x", y="y", text="text", background_fill_color=INK, **CHIP, **look)
            add_glyph(plot, source, glyph).level = "overlay"  # which is not clipped: above the frame, over no curve
        curves, axes = self._sources["timelines"], [plot.yaxis[0] for plot in self.plots]
        arguments = {"curves": curves, "plots": list(self.plots), "axes": axes, "sources": sources}
        self._told = CustomJS(args={**arguments, "charts": _texts(charts)}, code=_READ_OUT)
        for plot in self.plots:
            for event in (MouseMove, MouseLeave):
                plot.js_on_event(event, self._told)

    def _feed_frame(self, charts: Sequence[Chart], heights: Sequence[_Range]) -> None:
        if (texts := _texts(charts)) != self._told.args["charts"]:  # such as another quantity's
            self._told.args = {**self._told.args, "charts": texts}
        start, end = _ends(charts)
        self._x_range.update(start=start, end=end, reset_start=start, reset_end=end)
        for plot, chart, (low, high) in zip(self.plots, charts, heights, strict=True):
            plot.yaxis[0].axis_label = chart.y_label.replace(", ", ",\n", 1)  # as high as a frame of a low screen
            plot.y_range.update(start=low, end=high, reset_start=low, reset_end=high)

    def _plot(self, chart: Chart, height: _Range, crosshair: CrosshairTool, first: bool, last: bool) -> figure:
        plot = empty_figure(
            chart,
            y_log=chart.y_log,
            sizing_mode="stretch_both",
            min_height=100,
            x_axis_label=chart.x_label if last else None,
            x_range=self._x_range,
            y_range=Range1d(*height),
            tools="xpan,xbox_zoom,reset,save",
            toolbar_location="right" if first else None,
            active_drag=None,
            min_border_left=_LEFT,
            min_border_right=_RIGHT,
            min_border_top=18 * _rows(chart),  # the read-out
            min_border_bottom=0 if last else 12,  # half a label, or the rest of a name longer than its axis
        )
        plot.yaxis[0].update(axis_label_text_font_size="12px", axis_label_text_line_height=1.0, axis_label_standoff=0)
        plot.toolbar.autohide = True
        plot.xaxis.visible = last
        if last and chart.x_label == CLOCK:
            in_minutes(plot.xaxis[0])
        strips = VStrip(x0="x0", x1="x1", fill_color="colour", fill_alpha="alpha", line_alpha=0)
        add_glyph(plot, self._sources[f"{chart.key} spans"], strips)
        for line in chart.lines:
            look = line_look(STYLES[line.style])
            name = _column(chart, line.key)
            add_glyph(plot, self._was, LineGlyph(x="x", y=name, **look | _FAINT))
            glyph = LineGlyph(x="x", y=name, **look)
            add_glyph(plot, self._sources["timelines"], glyph, line.label)
        limits = Segment(x0="x0", y0="y", x1="x1", y1="y", **line_look(STYLES["limit"]))
        add_glyph(plot, self._sources[f"{chart.key} limits"], limits)
        label = Text(
            x="x", y="y", text="text", background_fill_color="colour", y_offset="offset", x_offset="shift",
            angle="angle", text_align="align", text_baseline="bottom", **CHIP,
        )  # fmt: skip
        add_glyph(plot, self._sources[f"{chart.key} labels"], label)
        plot.add_tools(crosshair)
        return plot


def _texts(charts: Sequence[Chart]) -> list[dict[str, Any]]:
    """The words of the read-out."""
    return [
        {
            "lines": [[line.label, _column(chart, line.key)] for line in chart.lines],
            "unit": unit_of(chart.x_label),
            "clock": chart.x_label == CLOCK,
            "rows": _rows(chart),
        }
        for chart in charts
    ]


def _rows(chart: Chart) -> int:
    """Rows of a chart's read-out on the narrowest screen with two columns."""
    return 1 + (sum(len(line.label) for line in chart.lines) > 64)


def _column(chart: Chart, key: str) -> str:
    return f"{chart.key} {key}"


def _curves(charts: Sequence[Chart]) -> dict[str, Any]:
    curves: dict[str, Any] = {"x": charts[0].lines[0].x}
    return curves | {_column(chart, line.key): line.y for chart in charts for line in chart.lines}


def _columns(charts: Sequence[Chart], heights: Sequence[_Range]) -> dict[str, dict[str, Any]]:
    """Source name -> columns."""
    columns = {"timelines": _curves(charts)}
    for chart, height in zip(charts, heights, strict=True):
        columns[f"{chart.key} limits"] = {
            "x0": [limit.start for limit in chart.limits],
            "x1": [limit.stop for limit in chart.limits],
            "y": [limit.level for limit in chart.limits],
        }
        columns[f"{chart.key} spans"] = {
            "x0": [span.start for span in chart.spans],
            "x1": [span.stop for span in chart.spans],
            "colour": [_colour(span) for span in chart.spans],
            "alpha": [0.08 if span.faint else 0.2 for span in chart.spans],
        }
        columns[f"{chart.key} labels"] = _labels(chart, height, chart is charts[-1])
    return columns


def _labels(chart: Chart, height: _Range, last: bool) -> dict[str, Any]:
    """Each curve's name at its end.

    The span's name is in the last chart, on the time axis if it has a colour, else upright at the beginning of a wide
    span: the names of curves may be at its end.
    """
    ends = []
    for line in chart.lines:
        seen = np.flatnonzero(np.isfinite(line.y))
        if len(seen) and line.end != "" and (line.y[seen[-1]] > 0 or not chart.y_log):
            ends.append((float(line.x[seen[-1]]), float(line.y[seen[-1]]), line))
    ends.sort(key=lambda end: (end[0], -end[1]))
    offsets = _offsets(chart, [line for *_, line in ends], height)
    rows: list[tuple[Any, ...]] = [
        (x, y, line.end or line.label, behind_text(STYLES[line.style].colour), offset, -2.0, 0.0, "right")
        for (x, y, line), offset in zip(ends, offsets, strict=True)
    ]
    for points in chart.points:  # moments, named at the foot of the frame
        rows += [
            (
                x,
                height[0],
                name,
                behind_text(STYLES[points.style].colour),
                -2.0,
                0.0,
                0.0,
                _towards_the_middle(chart, x),
            )
            for x, name in zip(points.x, points.names, strict=True)
        ]
    if last:
        for span in chart.spans:
            if span.style and span.label:
                middle = (span.start + span.stop) / 2
                rows.append((middle, height[0], span.label, behind_text(_colour(span)), -2.0, 0.0, 0.0, "center"))
            elif not span.style and math.isfinite(span.start):
                wide = span.stop - span.start > _NARROW_SPAN * np.ptp(chart.lines[0].x)
                x, shift = (span.start, 14.0) if wide else ((span.start + span.stop) / 2, 6.0)
                rows.append((x, height[1], span.label, behind_text(GREY), 6.0, shift, math.pi / 2, "right"))
    names = ("x", "y", "text", "colour", "offset", "shift", "angle", "align")
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def _towards_the_middle(chart: Chart, x: float) -> str:
    """Alignment of a name at a time, so that the frame does not cut it."""
    start, end = _ends([chart])
    return "left" if x < start + 0.1 * (end - start) else "right" if x > end - 0.1 * (end - start) else "center"


def _colour(span: Span) -> str:
    return STYLES[span.style].colour if span.style else GREY


def _offsets(chart: Chart, named: Sequence[Line], height: _Range) -> list[float]:
    """Pixels by which each name is below the end of its curve: at the nearest place above the curve, or below it,
    where it covers no curve, no limit, no other name and no edge of the frame."""
    low, high = (_place(chart, bound) for bound in height)

    def pixel(value: float) -> float:
        return _HEIGHT * (_place(chart, value) - low) / (high - low)

    start, end = _ends([chart])
    begins = end - _NAMED * (end - start)

    def extent(line: Line) -> tuple[float, float] | None:
        """Pixels between which a curve is where names are."""
        seen = np.isfinite(line.y) & (line.y > 0 if chart.y_log else True)
        if not seen.any() or line.x[seen][-1] < begins:
            return None
        x, y = line.x[seen], line.y[seen]
        values = [float(np.interp(begins, x, y)), *map(float, y[x >= begins])]
        return pixel(min(values)), pixel(max(values))

    curves = {line.key: place for line in chart.lines if (place := extent(line))}
    levels = [pixel(limit.level) for limit in chart.limits if limit.stop >= begins and not math.isnan(limit.level)]
    names: list[tuple[float, float]] = [(-math.inf, 1.0), (_HEIGHT - 1.0, math.inf)]
    offsets = []
    for line in named:
        below, above = curves[line.key]
        # Beyond a limit or another curve with a name it would seem to be of that one.
        others = [curves[other.key] for other in named if other is not line] + [(y, y) for y in levels]
        lowest = max((top for _, top in others if top <= below), default=-math.inf)
        highest = min((foot for foot, _ in others if foot >= above and foot > below), default=math.inf)
        steps = range(0, _FARTHEST, 2)
        places = [foot for step in steps for foot in (above + 2.0 + step, below - 2.0 - _ROOM - step)]
        between = [foot for foot in places if foot > lowest and foot + _ROOM < highest] or places
        # Where there is no room between curves, a name covers one rather than another name or the frame.
        for taken in ([*names, *curves.values()], names):
            free = [foot for foot in between if all(foot + _ROOM <= a or foot >= b for a, b in taken)]
            if free:
                break
        foot = free[0] if free else between[0]
        names.append((foot, foot + _ROOM))
        offsets.append(pixel(float(line.y[np.isfinite(line.y)][-1])) - foot)
    return offsets


def _place(chart: Chart, value: float) -> float:
    return math.log10(value) if chart.y_log else value


def _nice_range(chart: Chart, other: Chart | None) -> _Range:
    """Bounds of the y axis at steps of 1-2-5, so that the axis does not move with every slider step; ``other`` is
    shown faintly beside it."""
    levels = [limit.level for limit in chart.limits if math.isfinite(limit.level)]
    lines = chart.lines if other is None else chart.lines + other.lines
    values = np.concatenate([*(line.y[np.isfinite(line.y)] for line in lines), np.array(levels, float)])
    if chart.y_log:
        values = values[values > 0]
    if not len(values):
        return (0.1, 10.0) if chart.y_log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if not chart.y_log:
        return min(low, 0.0), _step(high * 1.05 or 1.0, up=True)
    low = max(low, high * 1e-5)  # a growth that starts at zero would take all the room
    room = (high / low) ** 0.13  # for a name: above the highest curve, of many curves also below the lowest
    many = sum(bool(np.isfinite(line.y[-1])) for line in chart.lines) > 2
    return _step(low / (max(1.15, room) if many else 1.15), up=False), _step(high * max(1.3, room), up=True)


def _step(value: float, *, up: bool) -> float:
    decade = 10.0 ** math.floor(math.log10(value))
    if up:
        return next(step * decade for step in _STEPS if step * decade >= value * (1 - 1e-12))
    return max(step * decade for step in _STEPS if step * decade <= value * (1 + 1e-12))


def _ends(charts: Sequence[Chart]) -> tuple[float, float]:
    x = charts[0].lines[0].x
    return float(x[0]), float(x[-1])

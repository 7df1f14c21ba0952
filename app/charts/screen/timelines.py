"""Charts stacked on one time axis: one crosshair, one hover with all curves, one message when they change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from bokeh.models import (
    BoxAnnotation,
    ColumnDataSource,
    CrosshairTool,
    HoverTool,
    Range1d,
    Segment,
    Text,
)
from bokeh.models import Line as LineGlyph
from bokeh.models import Span as Rule
from bokeh.plotting import figure

from app.charts.kinds import Chart, Limit, Line
from app.charts.screen.figures import TEXT_SIZE, add_glyph, same, unit_of
from app.charts.screen.log_axis import mark_in_powers
from app.charts.styles import DASHES, GREY, STYLES

_LEFT = 72  # pixels left of every frame, so that the frames are aligned
_NARROW_SPAN = 0.15  # of the time axis: the name of a narrower span is in its middle
_HEIGHT = 190  # pixels of a frame on the usual screen
_NEAR = 0.13  # of the height: nearer labels would touch, and the lower one goes below its curve
_FAINT: dict[str, Any] = {"line_alpha": 0.4, "line_width": 1.4}
_STEPS = (1.0, 2.0, 5.0, 10.0)
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
    >>> stack.feed(timelines(other))
    >>> stack.compare(timelines(budget))  # faint beside it, until compare(None)
    """

    def __init__(self, charts: Sequence[Chart], beside: Timelines | None = None) -> None:
        first = charts[0]
        heights = _heights(charts)
        self._sent: dict[str, dict[str, Any]] = _columns(charts, heights)
        self._sources = {name: ColumnDataSource(dict(data), name=name) for name, data in self._sent.items()}
        nothing = {name: np.array([np.nan]) for name in self._sent["timelines"]}
        self._was = ColumnDataSource(nothing, name="timelines compared")
        self._x_range = beside.plots[0].x_range if beside else Range1d(*_ends(charts))
        crosshair = CrosshairTool(overlay=Rule(dimension="height", line_dash="dotted", line_color=GREY))
        tooltip = _tooltip(charts)
        self._boxes: list[list[BoxAnnotation]] = []
        self.plots: tuple[figure, ...] = tuple(
            self._plot(chart, height, crosshair, tooltip, chart is charts[-1])
            for chart, height in zip(charts, heights, strict=True)
        )
        self._feed_frame(charts, heights)
        assert all(line.x is first.lines[0].x for chart in charts for line in chart.lines)

    def feed(self, charts: Sequence[Chart]) -> None:
        """Show other charts of the same structure."""
        heights = _heights(charts)
        columns = _columns(charts, heights)
        for name, new in columns.items():
            sent = self._sent[name]
            if changed := {key: value for key, value in new.items() if not same(sent[key], value)}:
                if len(next(iter(new.values()))) == len(next(iter(sent.values()))):
                    self._sources[name].data.update(changed)
                else:
                    self._sources[name].data = dict(new)
        self._sent = columns
        self._feed_frame(charts, heights)

    def compare(self, charts: Sequence[Chart] | None) -> None:
        """Show other charts faintly for comparison, or none."""
        curves = _curves(charts) if charts else {name: np.array([np.nan]) for name in self._sent["timelines"]}
        self._was.data = curves

    def _feed_frame(self, charts: Sequence[Chart], heights: Sequence[_Range]) -> None:
        start, end = _ends(charts)
        if (self._x_range.start, self._x_range.end) != (start, end):
            self._x_range.update(start=start, end=end, reset_start=start, reset_end=end)
        for plot, chart, (low, high), boxes in zip(self.plots, charts, heights, self._boxes, strict=True):
            if plot.yaxis[0].axis_label != chart.y_label:
                plot.yaxis[0].axis_label = chart.y_label
            if (plot.y_range.start, plot.y_range.end) != (low, high):
                plot.y_range.update(start=low, end=high, reset_start=low, reset_end=high)
            for box, span in zip(boxes, chart.spans, strict=True):
                shown = math.isfinite(span.start)
                if box.visible != shown:
                    box.visible = shown
                if shown and (box.left, box.right) != (span.start, span.stop):
                    box.update(left=span.start, right=span.stop)

    def _plot(self, chart: Chart, height: _Range, crosshair: CrosshairTool, tooltip: str, last: bool) -> figure:
        plot = figure(
            name=chart.key,
            sizing_mode="stretch_both",
            min_height=130,
            x_axis_label=chart.x_label if last else None,
            y_axis_label=chart.y_label,
            y_axis_type="log" if chart.y_log else "linear",
            x_range=self._x_range,
            y_range=Range1d(*height),
            tools="xpan,xbox_zoom,reset,save",
            toolbar_location=None if self._boxes else "above",
            toolbar_inner=True,
            active_drag=None,
            min_border_left=_LEFT,
            min_border_right=12,
            min_border_top=7,  # half a label of the axis
            min_border_bottom=0 if last else 7,
        )
        plot.toolbar.logo = None
        plot.toolbar.autohide = True
        plot.styles = TEXT_SIZE
        plot.xaxis.visible = last
        if chart.y_log:
            mark_in_powers(plot.yaxis[0])
        boxes = [
            BoxAnnotation(left=0.0, right=0.0, fill_color=GREY, fill_alpha=0.2, line_alpha=0) for _ in chart.spans
        ]
        for box in boxes:
            plot.add_layout(box)
        self._boxes.append(boxes)
        lines = []
        for line in chart.lines:
            style = STYLES[line.style]
            look: dict[str, Any] = {"line_color": style.colour, "line_dash": DASHES[style.dash]}
            name = _column(chart, line.key)
            add_glyph(plot, self._was, LineGlyph(x="x", y=name, **look | _FAINT))
            lines.append(
                add_glyph(
                    plot,
                    self._sources["timelines"],
                    LineGlyph(x="x", y=name, line_width=style.width, **look),
                    line.label,
                )
            )
        red = STYLES["limit"]
        thin: dict[str, Any] = {"line_color": red.colour, "line_dash": DASHES[red.dash], "line_width": red.width}
        add_glyph(plot, self._sources[f"{chart.key} limits"], Segment(x0="x0", y0="y", x1="x1", y1="y", **thin))
        label = Text(
            x="x", y="y", text="text", text_color="colour", y_offset="offset", x_offset="shift", angle="angle",
            text_align="align", text_font_size="12px", text_baseline="bottom",
        )  # fmt: skip
        add_glyph(plot, self._sources[f"{chart.key} labels"], label)
        hover = HoverTool(
            renderers=lines[:1], mode="vline", tooltips=tooltip, visible=False, attachment="horizontal",
            formatters={f"@{{{name}}}": "printf" for name in self._sent["timelines"]} | {"@x": "printf"},
        )  # fmt: skip
        plot.add_tools(crosshair, hover)
        return plot


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
        columns[f"{chart.key} labels"] = _labels(chart, height, chart is charts[-1])
    return columns


def _labels(chart: Chart, height: _Range, last: bool) -> dict[str, Any]:
    """Each curve's name at its end, above it or below the one it would touch; the span's name in the last chart, at
    the beginning of a wide span: the names of curves may be at its end."""
    low, high = (_place(chart, bound) for bound in height)
    ends = []
    for line in chart.lines:
        seen = np.flatnonzero(np.isfinite(line.y))
        if len(seen) and line.end != "":
            ends.append((float(line.x[seen[-1]]), float(line.y[seen[-1]]), line))
    ends.sort(key=lambda end: -end[1])
    offsets = [-4.0] * len(ends)
    for i, (upper, lower) in enumerate(pairwise(ends), 1):
        if _place(chart, upper[1]) - _place(chart, lower[1]) < _NEAR * (high - low):
            offsets[i] = 17.0 + _HEIGHT * min(_fall(chart, lower[2]) / (high - low), _NEAR)
    rows: list[tuple[Any, ...]] = [
        (x, y, line.end or line.label, STYLES[line.style].colour, offset, -2.0, 0.0, "right")
        for (x, y, line), offset in zip(ends, offsets, strict=True)
    ]
    if last:
        for span in chart.spans:
            if math.isfinite(span.start):
                wide = span.stop - span.start > _NARROW_SPAN * np.ptp(chart.lines[0].x)
                x, shift = (span.start, 14.0) if wide else ((span.start + span.stop) / 2, 6.0)
                rows.append((x, height[1], span.label, GREY, 6.0, shift, math.pi / 2, "right"))
    names = ("x", "y", "text", "colour", "offset", "shift", "angle", "align")
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def _fall(chart: Chart, line: Line) -> float:
    """How much lower a curve is where the name below its end begins, as the name must be below the whole curve."""
    begins = line.x[-1] - 0.18 * (line.x[-1] - line.x[0])
    at_start, at_end = (_place(chart, float(np.interp(x, line.x, line.y))) for x in (begins, line.x[-1]))
    return max(at_end - at_start, 0.0)


def _place(chart: Chart, value: float) -> float:
    return math.log10(value) if chart.y_log else value


def _heights(charts: Sequence[Chart]) -> list[_Range]:
    """Bounds of each chart's y axis."""
    return [chart.y_range or _nice_range(chart) for chart in charts]


def _nice_range(chart: Chart) -> _Range:
    """Bounds of the y axis at steps of 1-2-5, so that the axis does not move with every slider step."""
    levels = [limit.level for limit in chart.limits if _drawn(limit)]
    values = np.concatenate([*(line.y[np.isfinite(line.y)] for line in chart.lines), np.array(levels, float)])
    if chart.y_log:
        values = values[values > 0]
    if not len(values):
        return (0.1, 10.0) if chart.y_log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if not chart.y_log:
        return min(low, 0.0), _step(high * 1.05 or 1.0, up=True)
    low = max(low, high * 1e-5)  # a growth that starts at zero would take all the room
    return _step(low / 1.15, up=False), _step(high * max(1.3, (high / low) ** 0.13), up=True)  # room for a label


def _step(value: float, *, up: bool) -> float:
    decade = 10.0 ** math.floor(math.log10(value))
    if up:
        return next(step * decade for step in _STEPS if step * decade >= value * (1 - 1e-12))
    return max(step * decade for step in _STEPS if step * decade <= value * (1 + 1e-12))


def _drawn(limit: Limit) -> bool:
    return math.isfinite(limit.level)


def _ends(charts: Sequence[Chart]) -> tuple[float, float]:
    x = charts[0].lines[0].x
    return float(x[0]), float(x[-1])


def _tooltip(charts: Sequence[Chart]) -> str:
    """Every curve of every chart at the time under the pointer."""
    rows = "".join(
        f'<tr><td style="color:{STYLES[line.style].colour}">■</td><td>{chart.y_label.partition(",")[0]}, {line.label}'
        f'</td><td style="text-align:right">@{{{_column(chart, line.key)}}}{{%.3g}} {unit_of(chart.y_label)}'
        "</td></tr>"
        for chart in charts
        for line in chart.lines
    )
    return f"<b>@x{{%.1f}} {unit_of(charts[0].x_label)}</b><table>{rows}</table>"

"""Empty figures: what the screen has in common of every chart on two axes, and of every line."""

from __future__ import annotations

from typing import Any

from bokeh.plotting import figure

from app.charts.kinds import Chart, MapChart, TradeMapChart
from app.charts.screen.log_axis import mark_in_powers
from app.charts.styles import DASHES, Style

TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
# The page's theme sets chart text in em; this is what an em is.
_TEXT_SIZE = {"font-size": "13px", "--bokeh-font-size": "13px"}


def empty_figure(
    chart: Chart | MapChart | TradeMapChart, *, x_log: bool = False, y_log: bool = False, **look: Any
) -> figure:
    """A figure with a chart's name and axes; ``look``: what else Bokeh takes."""
    kinds = {"x_axis_type": "log" if x_log else "linear", "y_axis_type": "log" if y_log else "linear"}
    labels = {"x_axis_label": chart.x_label, "y_axis_label": chart.y_label}
    plot = figure(name=chart.key, **{**kinds, **labels, **look})
    plot.toolbar.logo = None
    plot.styles = _TEXT_SIZE
    for axis, is_log in ((plot.xaxis, x_log), (plot.yaxis, y_log)):
        if is_log:
            mark_in_powers(axis[0])
    return plot


def line_look(style: Style) -> dict[str, Any]:
    """How a glyph draws a line of a style."""
    return {"line_color": style.colour, "line_dash": DASHES[style.dash], "line_width": style.width}

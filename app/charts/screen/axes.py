"""Empty figures: what the screen has in common of every chart on two axes, and of every line.

Logarithmic axes are ticked at powers of ten as 10ⁿ, and at 2 and 5 between them where there is room.
"""

from pathlib import Path
from typing import Any

from bokeh.models import AdaptiveTicker, Axis, CustomJSTicker, CustomJSTickFormatter, LogAxis
from bokeh.plotting import figure

from app.charts.kinds import Chart, MapChart, TradeMapChart
from app.charts.styles import DASHES, Style

TOOLS = "pan,box_zoom,wheel_zoom,reset,save"
_LABELS, _MAJOR, _MINOR = (
    Path(__file__).with_name(f"{name}.js").read_text("utf-8") for name in ("power_labels", "log_major", "log_minor")
)
_CLOCK = Path(__file__).with_name("clock.js").read_text("utf-8")
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


def mark_in_powers(axis: LogAxis) -> None:
    """Tick and label a logarithmic axis."""
    axis.ticker = CustomJSTicker(major_code=_MAJOR, minor_code=_MINOR)
    axis.formatter = CustomJSTickFormatter(code=_LABELS)


def in_minutes(axis: Axis) -> None:
    """Tick an axis of seconds at whole minutes, or parts of them, and label it so: "8:10"."""
    axis.ticker = AdaptiveTicker(base=60, mantissas=[1, 2, 5, 10, 15, 30])
    axis.formatter = CustomJSTickFormatter(code=f"{_CLOCK}\nreturn clock(tick)")
    axis.axis_label = "time [min:s]"


def line_look(style: Style) -> dict[str, Any]:
    """Properties of a glyph that draws a line of a style."""
    return {"line_color": style.colour, "line_dash": DASHES[style.dash], "line_width": style.width}

"""Charts as SVG for paper: Matplotlib's object interface, no pyplot, live text in the report's own face.

Drawn at the size it is printed, so a point of text is a point on paper. The same chart gives the same bytes.
"""

from __future__ import annotations

import io
import math
import textwrap
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from app.charts.description import STYLES, BarChart, Chart

WIDTH = 166.0  # mm: the text width of an A4 page
PLOT_HEIGHT = 46.0  # mm, axes and their labels; the legend comes below
_LEGEND_ROW = 4.4  # mm
FONT = "Libertinus Serif"  # comes with Typst, which sets the text
_MEASURED_IN = ("STIXGeneral", "DejaVu Serif")  # come with Matplotlib; widths close to those of `FONT`

_DASHES: dict[str, Any] = {
    "solid": "-",
    "dashed": (0, (6, 2.5)),
    "dotted": (0, (1.2, 1.8)),
    "dotdash": (0, (1.2, 2, 5, 2)),
    "dashdot": (0, (7, 2, 1.2, 2, 1.2, 2)),
}
_MARKERS = {"circle": "o", "diamond": "D", "square": "s", "triangle": "^", "x": "x"}
_Y_LABEL_LENGTH = 26  # characters that fit beside the axes
_LINE_SCALE = 0.62  # a pixel on screen, in points on paper
_INK, _RULE = "#1c2329", "#c9d0d6"
_SETTINGS = {
    "svg.fonttype": "none",
    "svg.hashsalt": "navbudget",
    "font.family": list(_MEASURED_IN),
    "font.size": 8.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.linewidth": 0.6,
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "grid.color": _RULE,
    "grid.linewidth": 0.4,
    "hatch.linewidth": 0.6,
    "axes.unicode_minus": True,
}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_settings_lock = threading.Lock()


def to_svg(chart: Chart | BarChart, width: float = WIDTH, plot_height: float = PLOT_HEIGHT) -> str:
    """A chart as the text of an SVG file, `width` millimetres wide; the legend's rows add to `plot_height`."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with _settings():
        figure = Figure(layout="constrained")
        canvas = FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        handles = _curves(axes, chart) if isinstance(chart, Chart) else _bars(axes, chart)
        columns = 3 if len(handles) != 4 else 2
        height = plot_height + _LEGEND_ROW * math.ceil(len(handles) / columns)
        figure.set_size_inches(width / 25.4, height / 25.4)
        figure.legend(handles=handles, loc="outside lower left", ncols=columns, frameon=False, handlelength=3.4)
        text = io.StringIO()
        canvas.print_svg(text, metadata={"Date": None, "Creator": None})
    return text.getvalue().replace(", ".join(f"'{family}'" for family in _MEASURED_IN), f"'{FONT}'")


@contextmanager
def _settings() -> Iterator[None]:
    """Our settings over Matplotlib's own, whatever a matplotlibrc says. They are global: one at a time."""
    import matplotlib

    with _settings_lock, matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        yield


def _plain(axes: Any) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(width=0.6, length=3)
    axes.tick_params(which="minor", width=0.4, length=1.8)
    axes.set_axisbelow(True)


def power_of_ten(value: float, _position: int = 0) -> str:
    """A tick of a log axis: 10ⁿ at whole powers, a plain number or m·10ⁿ between them."""
    exponent = math.log10(value)
    if abs(exponent - round(exponent)) < 1e-6:
        return "10" + str(round(exponent)).translate(_SUPERSCRIPTS)
    if 1e-3 <= value < 1e4:
        return f"{float(f'{value:.2g}'):g}"
    below = math.floor(exponent)
    return f"{value / 10.0**below:.2g}·10" + str(below).translate(_SUPERSCRIPTS)


def _log_axis(axis: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = math.log10(high / low)
    subs = (1.0,) if decades > 2.5 else (1.0, 2.0, 5.0)
    axis.set_major_locator(LogLocator(subs=subs, numticks=12))
    axis.set_major_formatter(FuncFormatter(power_of_ten))
    axis.set_minor_formatter(NullFormatter())


def _in_lines(label: str) -> str:
    """A long label of the y axis in two lines of about the same length."""
    return (
        label if len(label) <= _Y_LABEL_LENGTH else textwrap.fill(label, len(label) // 2 + 4, break_on_hyphens=False)
    )


def _curves(axes: Any, chart: Chart) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    _plain(axes)
    axes.grid(visible=True)
    axes.set(xlabel=chart.x_label, ylabel=_in_lines(chart.y_label))
    if chart.x_log:
        axes.set_xscale("log")
    if chart.y_log:
        axes.set_yscale("log")
    handles: list[Any] = []
    for span in chart.spans:
        if math.isnan(span.start):
            continue
        axes.axvspan(span.start, span.stop, color="#7b8794", alpha=0.18, linewidth=0)
        handles.append(Patch(color="#7b8794", alpha=0.18, linewidth=0, label=span.label))
    for band in chart.bands:
        colour = STYLES[band.style].colour
        axes.fill_between(band.x, band.low, band.high, color=colour, alpha=0.25, linewidth=0)
        handles.append(Patch(color=colour, alpha=0.25, linewidth=0, label=band.label))
    for line in chart.lines:
        style = STYLES[line.style]
        look = {"color": style.colour, "linestyle": _DASHES[style.dash], "linewidth": style.width * _LINE_SCALE}
        axes.plot(line.x, line.y, **look)
        handles.append(Line2D([], [], label=line.label, **look))
    for points in chart.points:
        look = {
            "color": STYLES[points.style].colour,
            "marker": _MARKERS[points.marker],
            "linestyle": "none",
            "markersize": 4.5,
        }
        axes.plot(points.x, points.y, zorder=3, **look)
        handles.append(Line2D([], [], label=points.label, **look))
    drawn = [limit for limit in chart.limits if not math.isnan(limit.level)]
    style = STYLES["limit"]
    look = {"color": style.colour, "linestyle": _DASHES[style.dash], "linewidth": style.width * _LINE_SCALE}
    for limit in drawn:
        axes.plot([limit.start, limit.stop], [limit.level] * 2, **look)
    if drawn:
        handles.append(Line2D([], [], label="limit, brought to 1σ", **look))
    if chart.x_range is not None:
        axes.set_xlim(*chart.x_range)
    if chart.square:
        axes.set_box_aspect(1.0)
    if chart.y_range is not None:
        axes.set_ylim(*chart.y_range)
    if not chart.x_log:
        axes.margins(x=0)
    for is_log, axis in ((chart.x_log, axes.xaxis), (chart.y_log, axes.yaxis)):
        if is_log:
            _log_axis(axis)
    return handles


_BAR_KINDS = (("first", STYLES["quadratic"].colour, -0.19, "", "dashdot"),
              ("second", STYLES["with cubic"].colour, 0.19, "/////", "dotted"))  # fmt: skip


def _bars(axes: Any, chart: BarChart) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    _plain(axes)
    axes.grid(visible=True, axis="x")
    axes.set_xlabel(chart.x_label)
    rows = range(len(chart.bars))
    handles: list[Any] = []
    for kind, colour, offset, hatch, dash in _BAR_KINDS:
        lengths = [getattr(bar, kind) for bar in chart.bars]
        look = {
            "facecolor": colour if not hatch else "white",
            "edgecolor": colour,
            "linewidth": 0.6,
            "hatch": hatch or None,
        }
        axes.barh([row + offset for row in rows], lengths, height=0.34, **look)
        label = getattr(chart, f"{kind}_label")
        handles.append(Patch(label=label, **look))
        limit = getattr(chart, f"{kind}_limit")
        if not math.isnan(limit):
            line = {
                "color": STYLES["limit"].colour,
                "linestyle": _DASHES[dash],
                "linewidth": STYLES["limit"].width * _LINE_SCALE,
            }
            axes.axvline(limit, **line)
            handles.append(Line2D([], [], label=f"limit on {label}, at 1σ", **line))
    axes.set_yticks(list(rows), [bar.label for bar in chart.bars])
    axes.invert_yaxis()
    axes.set_xlim(left=0)
    axes.tick_params(axis="y", length=0)
    return handles

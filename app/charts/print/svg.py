"""Charts as SVG for paper: Matplotlib's object interface, no pyplot, live text in the report's own face.

Drawn at the size it is printed, so a point of text is a point on paper. The same chart gives the same bytes.
"""

import io
import math
import textwrap
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from app.charts.kinds import CLOCK, BarChart, Chart, DotChart, Drawing, MapChart, PictureChart, Points, spread_of
from app.charts.print.grid import ROW_HEIGHT, draw_dots, draw_map, draw_pictures, pictures_height
from app.charts.print.look import (
    BEHIND,
    LINE_SCALE,
    MARKERS,
    clock_axis,
    label_ends,
    label_points,
    log_axis,
    pen,
    plain,
)
from app.charts.styles import STYLES

WIDTH = 166.0  # mm: the text width of an A4 page
PLOT_HEIGHT = 46.0  # mm, axes and their labels; the legend comes below
_MAP_HEIGHT = 92.0
_SQUARE_HEIGHT = 96.0
_LEGEND_ROW = 4.4  # mm
FONT = "Libertinus Serif"  # comes with Typst, which sets the text
_MEASURED_IN = "'STIXGeneral', 'DejaVu Serif'"  # come with Matplotlib; widths close to those of `FONT`

_Y_LABEL_LENGTH = 26  # characters that fit beside the axes
_STYLE = Path(__file__).with_name("paper.mplstyle")
_settings_lock = threading.Lock()


def to_svg(chart: Drawing) -> str:
    """A chart as the text of an SVG file, as wide as the text of a page; the legend's rows add to its height."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with _settings():
        figure = Figure(layout="constrained")
        canvas = FigureCanvasSVG(figure)
        height = _draw(figure, chart)
        handles = _legend_of(figure.axes[0])
        columns = 3 if len(handles) != 4 else 2
        height += _LEGEND_ROW * math.ceil(len(handles) / columns)
        figure.set_size_inches(WIDTH / 25.4, height / 25.4)
        if handles:
            figure.legend(handles=handles, loc="outside lower left", ncols=columns, frameon=False, handlelength=3.4)
        if isinstance(chart, Chart) and chart.named_at_ends:
            label_ends(figure, figure.axes[0], chart.lines)
        if isinstance(chart, Chart | MapChart):
            label_points(figure, figure.axes[0], _named_once(chart.points))
        text = io.StringIO()
        canvas.print_svg(text, metadata={"Date": None, "Creator": None})
    return text.getvalue().replace(_MEASURED_IN, f"'{FONT}'")


def _draw(figure: Any, chart: Drawing) -> float:
    """Draw a chart; its height without the legend [mm]."""
    if isinstance(chart, PictureChart):
        draw_pictures(figure, chart)
        return pictures_height(chart, WIDTH)
    axes = figure.add_subplot()
    plain(axes)
    if isinstance(chart, Chart):
        _curves(axes, chart)
        return _SQUARE_HEIGHT if chart.square else PLOT_HEIGHT
    if isinstance(chart, BarChart):
        _bars(axes, chart)
        return PLOT_HEIGHT
    if isinstance(chart, DotChart):
        draw_dots(axes, chart)
        return 13.0 + ROW_HEIGHT * len(chart.dots)
    draw_map(axes, chart)
    return _MAP_HEIGHT


def _legend_of(axes: Any) -> list[Any]:
    """Artists that have a name, each name once."""
    handles, labels = axes.get_legend_handles_labels()
    return [handle for place, handle in enumerate(handles) if labels[place] not in labels[:place]]


def _named_once(points: Sequence[Points]) -> list[Points]:
    """Name the points, as paper has no hover; of groups with the same names only the first."""
    beside = [group for group in points if group.marker != "name"]
    return [group for i, group in enumerate(beside) if group.names not in [other.names for other in beside[:i]]]


@contextmanager
def _settings() -> Iterator[None]:
    """Our settings over Matplotlib's own, whatever a matplotlibrc says. They are global: one at a time."""
    import matplotlib

    with _settings_lock, matplotlib.rc_context():
        matplotlib.rc_file(_STYLE)
        yield


def _in_lines(label: str) -> str:
    """A long label of the y axis in two lines of about the same length."""
    return (
        label if len(label) <= _Y_LABEL_LENGTH else textwrap.fill(label, len(label) // 2 + 4, break_on_hyphens=False)
    )


def _curves(axes: Any, chart: Chart) -> None:
    axes.grid(visible=True)
    axes.set(xlabel=chart.x_label, ylabel=_in_lines(chart.y_label))
    if chart.x_log:
        axes.set_xscale("log")
    if chart.y_log:
        axes.set_yscale("log")
    for span in chart.spans:
        if not math.isnan(span.start):
            colour, label = STYLES[span.style or "everything"].colour, "" if span.style else span.label
            axes.axvspan(
                span.start, span.stop, label=label, color=colour, alpha=0.08 if span.faint else 0.18, linewidth=0
            )
            if span.style and span.label:  # one of several, each by its own name
                place = {"transform": axes.get_xaxis_transform(), "ha": "center", "va": "bottom"}
                axes.text((span.start + span.stop) / 2, 1.01, span.label, fontsize=7.5, **place)
    for band in chart.bands:
        pale: dict[str, Any] = {"color": STYLES[band.style].colour, "alpha": 0.25, "linewidth": 0}
        axes.fill_between(band.x, band.low, band.high, label=band.label, **pale)
    for line in chart.lines:
        axes.plot(line.x, line.y, label="" if chart.named_at_ends else line.label, **pen(STYLES[line.style]))
    for points in chart.points:
        if points.marker == "name":
            for x, y, name in zip(points.x, points.y, points.names, strict=True):
                axes.text(x, y, name, ha="center", va="center", fontsize=8, bbox=BEHIND, zorder=5)
            continue
        mark = {"color": STYLES[points.style].colour, "marker": MARKERS[points.marker]}
        look: dict[str, Any] = {**mark, "linestyle": "none", "markersize": 4.5, "label": points.label}
        if points.sizes is None:  # whole even on the edge of the frame, unless the frame was chosen
            axes.plot(points.x, points.y, zorder=3, clip_on=bool(chart.x_range or chart.y_range), **look)
        else:
            sizes = (LINE_SCALE * points.sizes) ** 2
            axes.scatter(points.x, points.y, s=sizes, linewidths=0.9, zorder=3, **mark)
            axes.plot([], [], **look)
    for limit in chart.limits:
        if not math.isnan(limit.level):
            text = f"limit (scaled to {spread_of(chart.y_label)})"
            axes.plot([limit.start, limit.stop], [limit.level] * 2, label=text, **pen(STYLES["limit"]))
    if chart.x_range is not None:
        axes.set_xlim(*chart.x_range)
    if chart.square:
        axes.set_box_aspect(1.0)
        axes.set_aspect("equal", adjustable="datalim")
    if chart.y_range is not None:
        axes.set_ylim(*chart.y_range)
    if not chart.x_log:
        axes.margins(x=0)
    for is_log, axis in ((chart.x_log, axes.xaxis), (chart.y_log, axes.yaxis)):
        if is_log:
            log_axis(axis)
    if chart.x_label == CLOCK:
        clock_axis(axes.xaxis)


def _beginning(label: str) -> str:
    """As much of a bar's label as leaves room for the bars."""
    first, *more = textwrap.wrap(label, _Y_LABEL_LENGTH)
    return f"{first} …" if more else first


_BAR_KINDS = (("first", STYLES["quadratic"].colour, -0.19, "", "dashdot"),
              ("second", STYLES["with cubic"].colour, 0.19, "/////", "dotted"))  # fmt: skip


def _bars(axes: Any, chart: BarChart) -> None:
    axes.grid(visible=True, axis="x")
    axes.set_xlabel(chart.x_label)
    bars = [bar for bar in chart.bars if bar.shows]
    rows = range(len(bars))
    for kind, colour, offset, hatch, dash in _BAR_KINDS:
        lengths = [getattr(bar, kind) for bar in bars]
        label, limit = getattr(chart, f"{kind}_label"), getattr(chart, f"{kind}_limit")
        axes.barh(
            [row + offset for row in rows], lengths, height=0.34, label=label, facecolor="white" if hatch else colour,
            edgecolor=colour, linewidth=0.6, hatch=hatch or None,
        )  # fmt: skip
        if not math.isnan(limit):
            text = f"limit on {label}, at {spread_of(chart.x_label)}"
            axes.axvline(limit, label=text, **pen(STYLES["limit"], dash))
    axes.set_yticks(list(rows), [_beginning(bar.label) for bar in bars])
    axes.set_ylim(len(bars) - 0.5, -0.5)  # a last row without a second bar stays whole
    axes.set_xlim(left=0)
    axes.tick_params(axis="y", length=0)

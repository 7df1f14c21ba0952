"""Charts on paper that are not curves: dots in rows, maps of the best strategy, pictures in decibels."""

import math
from typing import Any

import numpy as np

from app.charts.kinds import DotChart, MapChart, PictureChart
from app.charts.print.look import MARKERS, log_axis, pen
from app.charts.region import region_names
from app.charts.styles import STYLES

ROW_HEIGHT = 6.2  # mm a row of dots
_HATCHES = ("", "////", "....", "\\\\\\\\", "xxxx", "----")  # a region each, so that grey tells them apart
_PICTURES_ACROSS = 3
_PICTURE_WORDS = 10.5  # mm of name and caption over each picture
_LEFT, _RIGHT, _FOOT = 13.0, 2.0, 24.0  # mm beside and under the pictures: ticks, label, scale
_MOST_HIGH = 44.0  # mm of one picture


def draw_dots(axes: Any, chart: DotChart) -> None:
    """Rows of dots."""
    axes.grid(visible=True, axis="x")
    axes.set(xlabel=chart.x_label, xscale="log")
    rows = np.arange(len(chart.dots))
    band, form = STYLES["horizontal"].colour, STYLES["vertical"].colour
    low, high, runs, closed = (
        np.array([getattr(dot, name) for dot in chart.dots], float) for name in ("low", "high", "ensemble", "closed")
    )
    if not np.isnan(runs).all():
        pale: dict[str, Any] = {"color": band, "alpha": 0.35, "linewidth": 0}
        axes.barh(rows, high - low, left=low, height=0.42, label="runs, 5 to 95 %", **pale)
        axes.plot(runs, rows, color=band, marker="o", linestyle="none", markersize=4.5, label="runs, rms")
    axes.plot(
        closed, rows, color=form, marker="D", linestyle="none", markersize=6.5, fillstyle="none", markeredgewidth=1.1,
        label="formula",
    )  # fmt: skip
    if not math.isnan(chart.limit):
        axes.axvline(chart.limit, label="limit", **pen(STYLES["limit"]))
    axes.set_yticks(rows, [dot.label for dot in chart.dots])
    axes.set_ylim(len(chart.dots) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    log_axis(axes.xaxis)


def draw_map(axes: Any, chart: MapChart) -> None:
    """Regions by colour, hatch and name, points and the contour."""
    axes.set(xlabel=chart.x_label, ylabel=chart.y_label, xscale="log", yscale="log")
    axes.set(xlim=(chart.x[0], chart.x[-1]), ylim=(chart.y[0], chart.y[-1]))
    named = region_names(chart)
    for index, (name, style) in enumerate(zip(chart.names, chart.styles, strict=True)):
        here = chart.winner == index
        if not here.any():
            continue
        hatch, edge, colour = _HATCHES[index % len(_HATCHES)], STYLES[style].colour, _pale(STYLES[style].colour)
        drawn = axes.contourf(
            chart.x, chart.y, here.astype(float), levels=[0.5, 1.5], colors=[colour], hatches=[hatch], zorder=1
        )
        drawn.set_edgecolor(edge)
        drawn.set_linewidth(0.3)
        axes.fill([], [], label=name, facecolor=colour, edgecolor=edge, hatch=hatch or None, linewidth=0.4)
        if index in named:
            x, y, lines = named[index]
            box = {"facecolor": "white", "alpha": 0.85, "edgecolor": "none", "pad": 1.6}
            axes.text(x, y, lines, ha="center", va="center", bbox=box, zorder=4)
    if not np.isnan(chart.contour.y).all():
        line = pen(STYLES[chart.contour.style], width=1.3)
        axes.plot(chart.contour.x, chart.contour.y, zorder=2, label=chart.contour.label, **line)
    for points in chart.points:
        cross = points.marker == "cross"
        look: dict[str, Any] = {
            "color": STYLES[points.style].colour, "marker": MARKERS[points.marker], "linestyle": "none",
            "markersize": 10 if cross else 4.5, "markeredgewidth": 2.2 if cross else 0.6,
            "markeredgecolor": STYLES[points.style].colour if cross else "white",
        }  # fmt: skip
        axes.plot(points.x, points.y, zorder=3, label=points.label, **look)
    for axis in (axes.xaxis, axes.yaxis):
        log_axis(axis)


def _pale(colour: str) -> tuple[float, float, float]:
    """A colour as thinned with white; transparent ones would show where two regions meet."""
    from matplotlib.colors import to_rgb

    r, g, b = (1 - 0.5 * (1 - part) for part in to_rgb(colour))
    return r, g, b


def draw_pictures(figure: Any, chart: PictureChart) -> None:
    """The images in rows of three over one scale; there is no legend."""
    across = min(_PICTURES_ACROSS, len(chart.names))
    down = math.ceil(len(chart.names) / across)
    extent = (chart.x[0], chart.x[-1], chart.y[0], chart.y[-1])
    every = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
    drawn: Any = None
    for index, axes in enumerate(every.flat):
        if index >= len(chart.names):
            axes.set_visible(False)
            continue
        drawn = axes.imshow(
            chart.power_db[index], cmap="viridis", vmin=chart.floor_db, vmax=0.0, origin="lower", extent=extent,
            aspect="auto", interpolation="nearest",
        )  # fmt: skip
        axes.set_title(f"{chart.names[index]}\n{chart.captions[index]}", fontsize=8, loc="left")
        axes.tick_params(width=0.6, length=2.5)
        row, column = divmod(index, across)
        if row == down - 1 or index + across >= len(chart.names):
            axes.set_xlabel(chart.x_label)
        if column == 0:
            axes.set_ylabel(chart.y_label)
    bar = figure.colorbar(drawn, ax=every, orientation="horizontal", aspect=50, fraction=0.05, pad=0.02)
    bar.set_label(f"power [dB] {chart.reference.partition(';')[0]}")
    bar.outline.set_linewidth(0.5)


def pictures_height(chart: PictureChart, width: float) -> float:
    """Millimetres for pictures in their own proportions, kept low enough for a page."""
    across = min(_PICTURES_ACROSS, len(chart.names))
    down = math.ceil(len(chart.names) / across)
    each = (width - _LEFT) / across - _RIGHT
    high = min(each * float(np.ptp(chart.y) / np.ptp(chart.x)), _MOST_HIGH)
    return down * (high + _PICTURE_WORDS) + _FOOT

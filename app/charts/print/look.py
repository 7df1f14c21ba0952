"""The look of all charts on paper: dashes, markers, axes, names beside points."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from app.charts.kinds import Line, Points
from app.charts.styles import STYLES, Style, behind_text
from nav_model.base.units import clock

DASHES: dict[str, Any] = {
    "solid": "-",
    "dashed": (0, (6, 2.5)),
    "dotted": (0, (1.2, 1.8)),
    "dotdash": (0, (1.2, 2, 5, 2)),
    "dashdot": (0, (7, 2, 1.2, 2, 1.2, 2)),
}
MARKERS = {"circle": "o", "diamond": "D", "square": "s", "triangle": "^", "x": "x", "cross": "+", "name": "o"}
LINE_SCALE = 0.62  # a pixel on screen, in points on paper
_MINUTE_STEPS = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600)  # s
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Where a name may stand beside its point: offset in points, alignment.
_BESIDE = ((5, 0, "left", "center"), (-5, 0, "right", "center"), (0, 5, "center", "bottom"), (0, -5, "center", "top"))
_NAME_SIZE = 6.5
_NAME_ROOM = 9.0  # points between the names of two lines
BEHIND = {"facecolor": "white", "alpha": 0.65, "edgecolor": "none", "pad": 0.6}


def pen(style: Style, dash: str = "", width: float = 1.0) -> dict[str, Any]:
    """A style as Matplotlib draws a line, in another dash or so many times as wide if asked for."""
    return {
        "color": style.colour, "linestyle": DASHES[dash or style.dash],
        "linewidth": width * style.width * LINE_SCALE,
    }  # fmt: skip


def plain(axes: Any) -> None:
    """Axes without a box, with short ticks, grid below."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(width=0.6, length=3)
    axes.tick_params(which="minor", width=0.4, length=1.8)
    axes.set_axisbelow(True)


def plain_number(value: float, _position: int = 0) -> str:
    """A tick of a log axis near one."""
    return f"{float(f'{value:.2g}'):.10f}".rstrip("0").rstrip(".")


def power_of_ten(value: float, _position: int = 0) -> str:
    """A tick of a log axis that goes far from one: 10ⁿ at whole powers, m·10ⁿ between them."""
    exponent = math.log10(value)
    if abs(exponent - round(exponent)) < 1e-6:
        return "10" + str(round(exponent)).translate(_SUPERSCRIPTS)
    below = math.floor(exponent)
    return f"{value / 10.0**below:.2g}·10" + str(below).translate(_SUPERSCRIPTS)


def log_axis(axis: Any) -> None:
    """Ticks at the powers of ten of a log axis, with 2 and 5 between them where it is short, all in one notation."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = math.log10(high / low)
    subs = (1.0,) if decades > 2.5 else (1.0, 2.0, 5.0)
    axis.set_major_locator(LogLocator(subs=subs, numticks=12))
    near_one = low >= 1e-4 and high < 1e5
    axis.set_major_formatter(FuncFormatter(plain_number if near_one else power_of_ten))
    axis.set_minor_formatter(NullFormatter())


def clock_axis(axis: Any) -> None:
    """Ticks of an axis of seconds at whole minutes, or parts of them, as "8:10"."""
    from matplotlib.ticker import FuncFormatter, MultipleLocator

    start, end = axis.get_view_interval()
    step = next((step for step in _MINUTE_STEPS if end - start <= 8 * step), _MINUTE_STEPS[-1])
    axis.set_major_locator(MultipleLocator(step))
    axis.set_major_formatter(FuncFormatter(lambda seconds, _: clock(seconds)))
    axis.set_label_text("time [min:s]")


def label_ends(figure: Any, axes: Any, lines: Sequence[Line]) -> None:
    """Write the name of each line beside its end, right of the frame, spread so that no name covers another."""
    figure.draw_without_rendering()  # settles the scales
    height = axes.get_window_extent().height / figure.dpi * 72  # points
    ends = []
    for line in lines:
        seen = np.flatnonzero(np.isfinite(line.y) & (line.y > 0))
        if len(seen):
            x, y = float(line.x[seen[-1]]), float(line.y[seen[-1]])
            ends.append((float(axes.transAxes.inverted().transform(axes.transData.transform((x, y)))[1]), x, y, line))
    ends.sort(key=lambda end: end[0])
    room, below = _NAME_ROOM / height, -math.inf
    places = []
    for place, *_ in ends:
        below = max(place, below + room)
        places.append(below)
    top = 1 - room / 2
    for n in reversed(range(len(places))):  # from the top, back into the frame
        places[n] = min(places[n], top)
        top = places[n] - room
    for place, (_, x, y, line) in zip(places, ends, strict=True):
        colour = behind_text(STYLES[line.style].colour)
        axes.annotate(
            line.label, (x, y), (1.02, place), textcoords="axes fraction", va="center", fontsize=8, color=colour,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.4, "shrinkA": 0, "shrinkB": 0},
            annotation_clip=False,
        )  # fmt: skip


def label_points(figure: Any, axes: Any, groups: Sequence[Points]) -> None:
    """Write the name of each point beside it, where it covers neither another name nor another point.

    The last groups come first: they are the ones that matter most (the design itself).
    """
    if not groups:
        return
    figure.draw_without_rendering()  # settles the layout, so that places in pixels are final
    frame = axes.get_window_extent()
    places = [tuple(axes.transData.transform((x, y))) for p in groups for x, y in zip(p.x, p.y, strict=True)]
    taken = [text.get_window_extent().padded(1.0) for text in axes.texts]
    for points in reversed(groups):
        for x, y, name in zip(points.x, points.y, points.names, strict=True):
            here = axes.transData.transform((x, y))
            for dx, dy, horizontal, vertical in _BESIDE:
                text = axes.annotate(
                    name, (x, y), (dx, dy), textcoords="offset points", ha=horizontal, va=vertical,
                    fontsize=_NAME_SIZE, bbox=BEHIND, zorder=5,
                )  # fmt: skip
                box = text.get_window_extent().padded(1.0)
                others = (p for p in places if abs(p[0] - here[0]) + abs(p[1] - here[1]) > 1.0)
                inside = frame.x0 < box.x0 and box.x1 < frame.x1 and frame.y0 < box.y0 and box.y1 < frame.y1
                if inside and not any(box.contains(*p) for p in others) and not any(box.overlaps(t) for t in taken):
                    taken.append(box)
                    break
                text.remove()

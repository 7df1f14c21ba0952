"""A chart in a few sentences, for screen readers: its axes and main values."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from app.charts.kinds import Array, BarChart, Chart, DotChart, Drawing, Line, MapChart, PictureChart, TradeMapChart

_MOST = 6  # rows told one by one


def in_words(chart: Drawing | TradeMapChart) -> str:
    """Kind, axes and key values of a chart."""
    return _WORDS[type(chart)](chart)


def _curves(chart: Chart) -> str:
    parts = [f"Curves of {_axis(chart.y_label)} against {_axis(chart.x_label)}."]
    parts += [words for line in chart.lines if (words := _line(line))]
    for band in chart.bands:
        seen = np.flatnonzero(np.isfinite(band.low) & np.isfinite(band.high))
        if len(seen):
            last = seen[-1]
            parts.append(
                f"{band.label}: {_n(band.low[last])} to {_n(band.high[last])} at the end, {_n(band.x[last])}."
            )
    for points in chart.points:
        count = int(np.sum(np.isfinite(points.y)))
        if count == 1:
            at = int(np.flatnonzero(np.isfinite(points.y))[0])
            parts.append(f"{points.label}: {_n(points.y[at])} at {_n(points.x[at])}.")
        elif count:
            parts.append(f"{points.label}: {count} points.")
    for limit in chart.limits:
        if math.isfinite(limit.level):
            parts.append(f"{limit.label[:1].upper()}{limit.label[1:]}: {_n(limit.level)}.")
    return " ".join(parts)


def _line(line: Line) -> str:
    """First and last value, and the highest where it lies between them; what only rounding leaves is 0."""
    seen = np.flatnonzero(np.isfinite(line.y))
    if not len(seen):
        return ""
    x, y = (np.where(np.abs(of) < np.finfo(float).eps * np.max(np.abs(of[seen])), 0.0, of) for of in (line.x, line.y))
    first, last = int(seen[0]), int(seen[-1])
    top = int(seen[np.argmax(y[seen])])
    peak = f", highest {_at(x, y, top)}" if y[top] > 1.02 * max(y[first], y[last]) + 1e-300 else ""
    return f"{line.label}: {_at(x, y, first)} to {_at(x, y, last)}{peak}."


def _bars(chart: BarChart) -> str:
    rows, unit = sorted(chart.bars, key=lambda bar: -bar.second)[:_MOST], chart.unit
    bars = "; ".join(
        f"{bar.label} {_n(bar.first)}{unit} {chart.first_label}, {_n(bar.second)}{unit} {chart.second_label}"
        + "".join(f", {100 * share:.0f} % of it {name}" for name, share in bar.parts)
        for bar in rows
    )
    limits = ", ".join(
        f"{label} {_n(limit)}{unit}"
        for label, limit in ((chart.first_label, chart.first_limit), (chart.second_label, chart.second_limit))
        if math.isfinite(limit)
    )
    return f"Bars of {_axis(chart.x_label)}, largest first: {bars}." + (f" Limits: {limits}." if limits else "")


def _dots(chart: DotChart) -> str:
    dots = []
    for dot in chart.dots:
        values = [("formula", dot.closed), ("runs", dot.ensemble)]
        values_text = ", ".join(f"{name} {_n(value)}°" for name, value in values if math.isfinite(value))
        if values_text:
            dots.append(f"{dot.label}: {values_text}")
    limit = f" Limit {_n(chart.limit)}°." if math.isfinite(chart.limit) else ""
    return f"Bars of {_axis(chart.x_label)}: {'; '.join(dots)}.{limit}"


def _map(chart: MapChart) -> str:
    shares = np.bincount(chart.winner.ravel(), minlength=len(chart.names)) / chart.winner.size
    names = ", ".join(
        f"{name} on {100 * share:.0f} %" for name, share in zip(chart.names, shares, strict=True) if share > 0.005
    )
    points = "".join(
        f" {points.label}: {name} at {_n(x)}, {_n(y)}."
        for points in chart.points
        for name, x, y in list(zip(points.names, points.x, points.y, strict=True))[:_MOST]
    )
    return f"Map of {_axis(chart.y_label)} against {_axis(chart.x_label)}; which holds where: {names}.{points}"


def _pictures(chart: PictureChart) -> str:
    names = "; ".join(f"{name}, {caption}" for name, caption in zip(chart.names, chart.captions, strict=True))
    return f"Images over one scale, {chart.axes}: {names}."


def _trade(chart: TradeMapChart) -> str:
    met = 100 * float(np.mean(chart.ratio <= 1))
    x, y = chart.here
    return (
        f"Map over {_axis(chart.x_label)} and {_axis(chart.y_label)} of the result against {chart.reference}: "
        f"met on {met:.0f} % of the map. This design is at {_n(x)}, {_n(y)}."
    )


def _at(x: Array, y: Array, index: int) -> str:
    return f"{_n(y[index])} at {_n(x[index])}"


def _axis(label: str) -> str:
    """An axis label with its unit in words' order."""
    name, _, unit = label.partition(" [")
    return f"{name} in {unit.rstrip(']')}" if unit not in {"", "1]"} else name


def _n(value: Any) -> str:
    return f"{float(value):.3g}".replace("-", "−")


_WORDS: dict[type, Callable[[Any], str]] = {
    Chart: _curves,
    BarChart: _bars,
    DotChart: _dots,
    MapChart: _map,
    PictureChart: _pictures,
    TradeMapChart: _trade,
}

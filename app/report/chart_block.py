"""Charts as blocks of a report, each with what it shows in words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from app.charts.description import BarChart, Chart, DotChart, Drawing, MapChart, PictureChart
from app.report.document import ChartBlock


def chart_block(chart: Drawing, key: str) -> ChartBlock:
    """A chart with its description; what has nothing to show leaves no trace, not even in the legend."""
    if isinstance(chart, Chart):
        chart = _with_something_to_show(chart)
    return ChartBlock(f"{key}-chart-{chart.key}", chart, f"{chart.title}. {_series(chart)} {chart.knowledge}")


def _with_something_to_show(chart: Chart) -> Chart:
    return replace(
        chart,
        lines=tuple(line for line in chart.lines if not np.isnan(line.y).all()),
        spans=tuple(span for span in chart.spans if not math.isnan(span.start)),
        limits=tuple(limit for limit in chart.limits if not math.isnan(limit.level)),
    )


def _series(chart: Drawing) -> str:
    if isinstance(chart, BarChart):
        return f"Bars for {', '.join(bar.label for bar in chart.bars)}."
    if isinstance(chart, DotChart):
        return f"{chart.x_label} for {', '.join(dot.label for dot in chart.dots)}: closed form and runs."
    if isinstance(chart, MapChart):
        return f"{chart.y_label} against {chart.x_label}: regions {', '.join(chart.names)}."
    if isinstance(chart, PictureChart):
        said = "; ".join(f"{name}, {caption}" for name, caption in zip(chart.names, chart.captions, strict=True))
        return f"Images over one scale, {chart.axes}: {said}."
    labels = [item.label for group in (chart.bands, chart.lines, chart.points) for item in group]
    return f"{chart.y_label} against {chart.x_label}: {', '.join(labels)}."

"""Charts as blocks of a report, each with a description in words."""

import math
from dataclasses import replace

import numpy as np

from app.charts.kinds import Chart, Drawing
from app.charts.words import in_words
from app.document.blocks import ChartBlock


def chart_block(chart: Drawing, key: str) -> ChartBlock:
    """A chart with its description; series without values are removed, also from the legend."""
    if isinstance(chart, Chart):
        chart = _with_something_to_show(chart)
    return ChartBlock(f"{key}-chart-{chart.key}", chart, f"{chart.title}. {in_words(chart)} {chart.knowledge}")


def _with_something_to_show(chart: Chart) -> Chart:
    return replace(
        chart,
        lines=tuple(line for line in chart.lines if not np.isnan(line.y).all()),
        spans=tuple(span for span in chart.spans if not math.isnan(span.start)),
        limits=tuple(limit for limit in chart.limits if not math.isnan(limit.level)),
    )

"""Rows of dots and bands as HTML: a ranking that screen readers can read, without a canvas."""

import math
from html import escape

from app.charts.kinds import Dot, DotChart
from app.document.numbers import number

_COMING = "…"
_WIDEST = 30.0
"""The axis ends at so many times the limit, or the least value where that is more; an arrow is for what is beyond."""


def ranks_html(chart: DotChart, best: str = "") -> str:
    """A dot chart as a table with a bar in each row, on a logarithmic axis; ``best``: the label that is marked."""
    scale, marked = _LogScale(chart), ' class="best"'
    rows = "".join(
        f'<tr{marked if dot.label == best else ""}><th scope="row">{escape(dot.label)}'
        f'<small>{escape(dot.note)}</small></th><td title="{escape(_tip(dot, chart))}">'
        f"<div>{scale.marks(dot)}</div></td>{_figure(dot)}</tr>"
        for dot in chart.dots
    )
    columns = ["Strategy", "", "[°]"]
    caption = f"{escape(chart.title)}: {escape(chart.x_label)}"
    heads = "".join(f'<th scope="col">{head}</th>' if head else "<td></td>" for head in columns)
    return (
        f'<table class="ranks"><caption class="hidden">{caption}</caption><thead><tr>{heads}</tr></thead>'
        f'<tbody>{rows}</tbody><tfoot aria-hidden="true"><tr><td></td><td><div>{scale.axis()}</div>'
        f"<small>{escape(chart.x_label)}</small></td><td></td></tr></tfoot></table>"
    )


def _value(dot: Dot) -> float:
    return dot.closed if math.isnan(dot.ensemble) else dot.ensemble


def _figure(dot: Dot) -> str:
    angle = _value(dot)
    return f'<td class="quiet">{_COMING}</td>' if math.isnan(angle) else f'<td class="num">{number(angle)}</td>'


def _tip(dot: Dot, chart: DotChart) -> str:
    parts = [] if math.isnan(dot.closed) else [f"formula {number(dot.closed)}°"]
    if not math.isnan(dot.ensemble):
        parts.append(f"runs {number(dot.ensemble)}° rms, 5 to 95 %: {number(dot.low)}° to {number(dot.high)}°")
    if math.isfinite(_value(dot)):
        parts.append(f"{number(chart.millimetres * _value(dot))} mm along the line of sight")
    return "; ".join((*parts, dot.source))


class _LogScale:
    """From a 1, 2 or 5 below everything that is shown to one above it, or above what is near enough to compare."""

    def __init__(self, chart: DotChart) -> None:
        values = [v for dot in chart.dots for v in (dot.closed, dot.ensemble, dot.low, dot.high)] + [chart.limit]
        positive = [value for value in values if math.isfinite(value) and value > 0] or [1.0, 10.0]
        ranked = [value for dot in chart.dots if (value := _value(dot)) > 0]
        near = max(value for value in (min(ranked, default=0.0), chart.limit, 0.0) if not math.isnan(value))
        most = min(max(positive), _WIDEST * near) if near else max(positive)
        self._low = _step(min(positive) / 1.5)
        self._high = max(-_step(1 / most), self._low + 1)
        self._limit = chart.limit

    def _share(self, value: float) -> float:
        return min(100 * (math.log10(value) - self._low) / (self._high - self._low), 100.0) if value > 0 else 0.0

    def marks(self, dot: Dot) -> str:
        """Bar to the rms of the runs, their band, the formula's diamond, the limit; an arrow for what is beyond."""
        html = ""
        if math.isfinite(dot.ensemble):
            low, high = self._share(dot.low), self._share(dot.high)
            html += f'<i style="width:{self._share(dot.ensemble):.2f}%"></i>'
            html += f'<s style="left:{low:.2f}%;width:{high - low:.2f}%"></s>'
        if _value(dot) > 10.0**self._high:
            html += "<em>→</em>"
        elif math.isfinite(dot.closed):
            html += f'<b style="left:{self._share(dot.closed):.2f}%"></b>'
        if math.isfinite(self._limit):
            html += f'<u style="left:{self._share(self._limit):.2f}%"></u>'
        return html

    def axis(self) -> str:
        """A mark at both ends, and at the decades that are not near them."""
        inner = range(math.ceil(self._low + 0.5), math.floor(self._high - 0.5) + 1)
        return "".join(
            f'<span style="left:{self._share(10.0**d):.1f}%">{number(10.0**d, 1, given=True)}</span>'
            for d in (self._low, *inner, self._high)
        )


def _step(value: float) -> float:
    """Logarithm of the largest 1, 2 or 5 of a decade that is not above a value."""
    decade = math.floor(math.log10(value))
    return decade + math.log10(max(step for step in (1, 2, 5) if step <= value / 10.0**decade))

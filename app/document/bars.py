"""Bars as HTML: tables that screen readers can read, without a canvas."""

import math
from collections.abc import Callable
from html import escape
from pathlib import Path

from app.charts.kinds import TOTAL, Bar, BarChart, RankChart
from app.document.numbers import number, percent

_NAMED = 0.45  # of the axis: a shorter part has no room for its name
_NUMBER = 0.3  # of the axis: what a number after its bar takes

ROWS_SHEET = Path(__file__).with_name("rows.css").read_text("utf-8")
"""Style of rows of bars and of dots, wherever they are."""

_STEPS = (1, 1.5, 2, 3, 4, 5, 6, 8, 10, 15)


def bars_html(chart: BarChart, was: BarChart | None = None) -> str:
    """A bar chart as a table with a bar in each cell.

    Rows without values are omitted. The total is emphasised; values before a change (``was``) are outlines.
    """
    old = {bar.label: bar for bar in was.bars} if was else {}
    first, second = (_BarScale(chart, was, kind) for kind in ("first", "second"))
    rows = "".join(
        f'<tr{_class(bar)}><th scope="row">{escape(bar.label)}</th>'
        f"{first.cell(bar, old.get(bar.label))}{second.cell(bar, old.get(bar.label))}</tr>"
        for bar in chart.bars
        if bar.shows or (bar.label in old and old[bar.label].shows)
    )
    unit = chart.unit.strip()
    labels = (chart.first_label, chart.second_label)
    heads = "".join(f'<th scope="col">{escape(label)} [{unit}]</th>' for label in labels)
    return (
        f'<table class="bars"><caption class="hidden">{escape(chart.title)}: {escape(chart.x_label)}</caption>'
        f"<thead><tr><td></td>{heads}</tr></thead><tbody>{rows}</tbody>"
        f'<tfoot aria-hidden="true"><tr><td></td>{first.axis()}{second.axis()}</tr></tfoot></table>'
    )


def effects_html(chart: RankChart) -> str:
    """A ranking as a table with a bar in each row; those of doubled inputs are hatched."""
    most = max((bar.percent for bar in chart.bars), default=1.0)
    rows = "".join(
        f'<tr{" class=doubled" if bar.doubled else ""}><th scope="row">{escape(bar.label)}</th>'
        f'<td style="padding-right:60px" title="{escape(bar.sentence)}"><div>'
        f'<i style="width:{(length := 100 * bar.percent / most):.1f}%"></i>'
        f'<span class="num" style="left:{length:.1f}%">{percent(bar.percent / 100)}</span></div></td></tr>'
        for bar in chart.bars
    )
    return (
        f'<table class="bars"><caption class="hidden">{escape(chart.title)}</caption>'
        f'<thead><tr><td></td><th scope="col">{escape(chart.x_label)}</th></tr></thead><tbody>{rows}</tbody></table>'
    )


def _class(bar: Bar) -> str:
    kinds = [kind for kind, holds in (("total", bar.label == TOTAL), ("limited", bar.limited)) if holds]
    return f' class="{" ".join(kinds)}"' if kinds else ""


class _BarScale:
    """One of the two kinds of bars, over one length of the axis."""

    def __init__(self, chart: BarChart, was: BarChart | None, kind: str) -> None:
        self._length: Callable[[Bar], float] = lambda bar: getattr(bar, kind)
        self._metres: Callable[[Bar], float] = lambda bar: getattr(bar, f"{kind}_mm")
        self._unit = chart.unit
        self._limit = getattr(chart, f"{kind}_limit")
        lengths = [self._length(bar) for part in (chart, was) if part for bar in part.bars] + [self._limit]
        self._most = _round_up(max((length for length in lengths if math.isfinite(length)), default=0.0))
        texts = [self._label(bar) for bar in chart.bars if math.isfinite(self._length(bar))]
        room = max([40 + 4 * len(self._unit), *(_width(text) for text in texts)])
        self._room = f'style="padding-right:{room:.0f}px"'  # for the number after the longest bar

    def _label(self, bar: Bar) -> str:
        return f"{number(self._length(bar))}{self._unit}"

    def _share(self, length: float) -> str:
        return f"{100 * min(length / self._most, 1):.2f}%"

    def cell(self, bar: Bar, was: Bar | None) -> str:
        length = self._length(bar)
        if not math.isfinite(length):
            return "<td></td>"
        tip = f"{self._label(bar)} = {number(self._metres(bar))} mm along the line of sight; {bar.source}"
        over = ' class="over"' if bar.limited and length > self._limit else ""
        outline = f'<b style="width:{self._share(self._length(was))}"></b>' if was else ""
        limit = ""
        if bar.limited and math.isfinite(self._limit):
            share = self._share(self._limit)
            # After the line, unless that is too close to the end.
            beside = f"left:{share}" if self._limit < 0.75 * self._most else f"right:calc(100% - {share})"
            limit = (
                f'<u style="left:{share}"></u><em style="{beside}">'
                f"limit {number(self._limit, given=True)}{self._unit}</em>"
            )
        reach = max(length, self._length(was)) if was else length
        if bar.limited and 0 < self._limit - reach < _NUMBER * self._most:  # its line would run through the number
            reach = self._limit
        return (
            f'<td {self._room} title="{escape(tip)}"><div{over}>'
            f'<i style="width:{self._share(length)}">{self._parts(bar, length)}</i>'
            f'{outline}{limit}<span class="num" style="left:{self._share(reach)}">{self._label(bar)}</span>'
            "</div></td>"
        )

    def _parts(self, bar: Bar, length: float) -> str:
        """Parts of the bar, in the shares of the variance; the first is named where there is room."""
        html = ""
        for n, (name, share) in enumerate(bar.parts):
            label = f"{escape(name)} {percent(share)}"
            room = n == 0 and share * length > _NAMED * self._most
            html += f'<s style="width:{100 * share:.1f}%" title="{label}">{label if room else ""}</s>'
        return html

    def axis(self) -> str:
        half, most = (number(length, given=True) for length in (self._most / 2, self._most))
        return f"<td {self._room}><div><span>0</span><span>{half}</span><span>{most}</span></div></td>"


def _width(text: str) -> float:
    """Width [px] reserved for a number: generous for digits, less for punctuation."""
    return 8 + sum(7.2 if letter.isdecimal() else 5 for letter in text)


def _round_up(most: float) -> float:
    """The end of an axis: it stands still while a slider moves the bars."""
    if most <= 0:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(most))
    return next(step * decade for step in _STEPS if step * decade >= most)

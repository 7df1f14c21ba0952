"""A chart as it stands on a page: title, figure, how we know, and its data to take away."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from functools import partial
from html import escape
from typing import Any, Generic, TypeVar

import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import AnyChart, RankChart, TradeMapChart, to_csv
from app.charts.legend import legend_html
from app.charts.print.svg import to_svg
from app.charts.screen.figures import to_bokeh
from app.charts.words import in_words
from app.document.prose import prose
from app.session import Session
from app.ui.grid import cell
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME, PRINT_NOTHING, PRINT_WHOLE
from app.ui.turns import in_turns
from app.work.pool import elsewhere
from nav_model.budget import Budget

_T = TypeVar("_T")


class ChartPane(Generic[_T]):
    """One chart on a page, drawn from whatever its description takes: title, figure, how we know, and its data to
    take away."""

    def __init__(self, describe: Callable[[_T], AnyChart], current: Callable[[], _T], height: int) -> None:
        self._describe = describe
        self._current = current
        chart = describe(current())
        self.figure = to_bokeh(chart, height)
        self._title = html_pane(_heading(chart), margin=(10, 14, 0, 14))
        self._know = html_pane(_know(chart))
        look = {"variant": "text", "margin": (0, 8)}
        self._takes = [
            pmui.FileDownload(callback=make, filename=f"{chart.key}.{suffix}", label=label, **look)
            for make, suffix, label in zip((self._csv, self._svg), ("csv", "svg"), _labels(chart), strict=True)
        ]
        self.view = pn.Column(
            self._title,
            # In a native column: in a Material layout a figure breaks when replaced (panel-material-ui#548).
            pn.Column(pn.pane.Bokeh(self.figure.plot, sizing_mode="stretch_width")),
            self._know,
            pn.FlexBox(*self._takes, stylesheets=[PRINT_NOTHING]),
            styles=FRAME,
            stylesheets=[PRINT_WHOLE],
        )

    def show(self, data: _T) -> None:
        """Feed the figure."""
        chart = self._describe(data)
        self.figure.feed(chart)
        if self._title.object != _heading(chart):
            self._title.object = _heading(chart)
            for take, label in zip(self._takes, _labels(chart), strict=True):
                take.label = label
        self._know.object = _know(chart)

    async def _svg(self) -> io.BytesIO:
        """The chart as it prints, drawn in a worker: the plotting library would hold up every slider."""
        return io.BytesIO((await elsewhere(to_svg, self._describe(self._current()))).encode("utf-8"))

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(self._describe(self._current())).encode("utf-8"))


class ChartView(ChartPane[Budget]):
    """A chart of the budget in force."""

    def __init__(self, describe: Callable[[Budget], AnyChart], session: Session, height: int) -> None:
        super().__init__(describe, lambda: session.budget, height)


def chart_cells(
    layout: Sequence[tuple[Callable[[Any], AnyChart], int, int]],
    make: Callable[[Callable[[Any], AnyChart], int], ChartPane[Any]],
    made: list[Any],
) -> list[pn.Column]:
    """Cells for a `grid` that fill up with charts, a few in each turn of the server (`in_turns`).

    The layout says of each what describes it, its height in pixels and its columns of twelve; ``made`` grows by what
    ``make`` makes of the first two. What else stands in a cell stands under the chart.
    """
    cells = [cell(columns) for *_, columns in layout]

    def add(index: int) -> None:
        describe, height, _ = layout[index]
        made.append(make(describe, height))
        cells[index].insert(0, made[-1].view)

    in_turns([partial(add, index) for index in range(len(layout))])
    return cells


def _heading(chart: AnyChart) -> str:
    return f"<h3>{escape(chart.title)}</h3>"


def _labels(chart: AnyChart) -> tuple[str, str]:
    return f"{chart.title}: CSV", f"{chart.title}: SVG"


def _know(chart: AnyChart) -> str:
    return f"{described(chart)}{legend_html(chart)}{source_note(chart.knowledge)}"


def source_note(knowledge: str) -> str:
    """Where a figure comes from and by which method, as HTML."""
    return f'<p class="know quiet"><b>Source and method:</b> {prose(knowledge)}</p>'


def described(chart: AnyChart | RankChart | TradeMapChart) -> str:
    """What a chart shows, in words, for screen readers: a canvas says nothing to them."""
    return f'<p class="hidden">What the chart shows: {escape(in_words(chart))}</p>'

"""A chart on a page: title, figure, source and method."""

from collections.abc import Callable
from html import escape
from typing import Generic, TypeVar

import panel as pn

from app.charts.kinds import AnyChart, Chart, Plotted, TradeMapChart
from app.charts.legend import legend_html
from app.charts.screen.figures import to_bokeh
from app.charts.words import in_words
from app.document.pane import prose
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME, ON_A_PHONE, PRINT_WHOLE
from app.ui.turns import debounce

_T = TypeVar("_T")


class ChartPane(Generic[_T]):
    """One chart on a page, drawn by a function of any input: title, figure, source and method.

    With a height of None it fills its place (`app.ui.first_screen`): title, legend and a button for source and method
    share one line. Its texts are updated when a slider stops; ``moving``, if given, describes the part that follows
    at once.
    """

    def __init__(
        self,
        describe: Callable[[_T], Plotted],
        current: Callable[[], _T],
        height: int | None = None,
        moving: Callable[[_T], Plotted] | None = None,
    ) -> None:
        self._moving = moving or describe
        chart = describe(current())
        self._fills = height is None
        self.figure = to_bokeh(chart, height)
        self._title = html_pane(self._heading(chart), margin=(6, 10, 0, 10) if self._fills else (10, 14, 0, 14))
        sizing = "stretch_both" if self._fills else "stretch_width"
        # In a native column: in a Material layout a figure breaks when replaced (panel-material-ui#548).
        phone = [ON_A_PHONE] if self._fills else []
        figure = pn.Column(pn.pane.Bokeh(self.figure.plot, sizing_mode=sizing), sizing_mode=sizing, stylesheets=phone)
        if self._fills:
            self._tell_soon = debounce(lambda: self._title.say(self._heading(describe(current()))))
            self.view = pn.Column(self._title, figure, sizing_mode=sizing, stylesheets=[PRINT_WHOLE])
            return
        self._know = html_pane(_know(chart))
        self.view = pn.Column(self._title, figure, self._know, styles=FRAME, stylesheets=[PRINT_WHOLE])

    def show(self, data: _T) -> None:
        """Update the figure."""
        chart = self._moving(data)
        self.figure.feed(chart)
        if self._fills:
            self._tell_soon()
        else:
            self._title.say(self._heading(chart))
            self._know.say(_know(chart))

    def _heading(self, chart: Plotted) -> str:
        if self._fills:
            beside = f'<span class="quiet fine">{escape(chart.aside)}</span>' if isinstance(chart, Chart) else ""
            return head_html(chart.title, chart.knowledge, beside, legend_html(chart), described(chart))
        return f"<h3>{escape(chart.title)}</h3>"


def head_html(title: str, knowledge: str, *more: str) -> str:
    """The line above a chart that fills its place: title, ``more`` such as a legend, and a button that opens source
    and method."""
    how = f'<summary title="Source and method" aria-label="Source and method: {escape(title)}">i</summary>'
    return (
        f'<div class="head"><h3>{escape(title)}</h3>{"".join(more)}'
        f'<details class="how">{how}<div>{prose(knowledge)}</div></details></div>'
    )


def _know(chart: Plotted) -> str:
    return f"{described(chart)}{legend_html(chart)}{source_note(chart.knowledge)}"


def source_note(knowledge: str) -> str:
    """Where a figure comes from and by which method, as HTML."""
    return f'<p class="know quiet"><b>Source and method:</b> {prose(knowledge)}</p>'


def described(chart: AnyChart | TradeMapChart) -> str:
    """The description of a chart for screen readers, which cannot read a canvas."""
    return f'<p class="hidden">What the chart shows: {escape(in_words(chart))}</p>'

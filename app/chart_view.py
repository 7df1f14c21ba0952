"""A chart as it stands on a page: title, figure, how we know, and its data to take away."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from html import escape

import panel as pn
import panel_material_ui as pmui

from app.charts.description import AnyChart, to_csv
from app.charts.in_print import to_svg
from app.charts.legend import legend_html
from app.charts.on_screen import to_bokeh
from app.state import Session
from app.theme import FRAME, SHEET
from app.workers import elsewhere
from nav_model.budget import Budget

_MARK = re.compile(r"\[[A-Z]-\d+\]")


def prose(text: str) -> str:
    """Text for our own HTML: escaped, equation marks such as [T-9] kept in one piece."""
    return _MARK.sub(r'<span class="nw">\g<0></span>', escape(text))


def html_pane(text: str, margin: int | tuple[int, ...] = (4, 10)) -> pn.pane.HTML:
    """Our own HTML, in the product's sheet."""
    return pn.pane.HTML(text, stylesheets=[SHEET], sizing_mode="stretch_width", margin=margin)


class ChartView:
    """One chart on the page: title, figure, how we know, and its data to take away."""

    def __init__(self, describe: Callable[[Budget], AnyChart], session: Session, height: int) -> None:
        self._describe = describe
        self._session = session
        chart = describe(session.budget)
        self.figure = to_bokeh(chart, height)
        self._know = html_pane(_know(chart))
        look = {"description": "", "variant": "text", "size": "small", "margin": (0, 8)}
        data = pmui.FileDownload(
            callback=self._csv, filename=f"{chart.key}.csv", label=f"{chart.title}: data (CSV)", **look
        )
        picture = pmui.FileDownload(
            callback=self._svg, filename=f"{chart.key}.svg", label=f"{chart.title}: picture (SVG)", **look
        )
        self.view = pn.Column(
            html_pane(f"<h3>{escape(chart.title)}</h3>", margin=(10, 14, 0, 14)),
            # The figure stands in a native column: directly in a Material layout it breaks when replaced.
            pn.Column(pn.pane.Bokeh(self.figure.plot, sizing_mode="stretch_width"), sizing_mode="stretch_width"),
            self._know,
            pn.FlexBox(data, picture, margin=0, sizing_mode="stretch_width"),
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )

    def show(self, budget: Budget) -> None:
        """Feed the figure."""
        chart = self._describe(budget)
        self.figure.feed(chart)
        self._know.object = _know(chart)

    async def _svg(self) -> io.BytesIO:
        """The chart as it prints, drawn in a worker: the plotting library would hold up every slider."""
        return io.BytesIO((await elsewhere(to_svg, self._describe(self._session.budget))).encode("utf-8"))

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(self._describe(self._session.budget)).encode("utf-8"))


def _know(chart: AnyChart) -> str:
    return f'{legend_html(chart)}<p class="know quiet"><b>How do we know:</b> {prose(chart.knowledge)}</p>'

"""The map of the Explore page: two inputs against a result; a click adopts the place."""

from __future__ import annotations

import io
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.events import Tap

from app.charts.kinds import TradeMapChart, to_csv
from app.charts.screen.maps import MapFigure
from app.declared import declared, held
from app.session import Session
from app.subjects.explore.charts import map_chart
from app.ui.chart_pane import described, source_note
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from nav_model.budget import Budget
from nav_model.budget.figures import FIGURES, VARIABLES
from nav_model.design.parts import PARTS
from nav_model.explore.margins import ALL, label_of, limits, quantity
from nav_model.explore.trade_map import RESULTS, changes_at

_X, _Y = "imu.angle_random_walk", "imu.velocity_random_walk"
_DIGITS = 3


_TITLES = {part.section: part.title for part in PARTS}
_INPUTS = {f"{_TITLES[key.partition('.')[0]]}: {quantity(key).label}": key for key in VARIABLES}


class MapPanel(pn.viewable.Viewer):
    """Three choosers, the map, and what a click did."""

    session = held(Session)
    x: str = declared(param.Selector(objects=_INPUTS, default=_X, label="X axis"))
    y: str = declared(param.Selector(objects=_INPUTS, default=_Y, label="Y axis"))
    result: str = declared(param.Selector(objects={label_of(name): name for name in RESULTS}, label="Result"))

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, result=ALL if limits(session.design) else next(iter(FIGURES)))
        self._said = html_pane("", margin=(0, 14))
        self._title = html_pane("", margin=(10, 14, 0, 14))
        self._know = html_pane("")
        self._place = pn.Column()
        self._drawn: MapFigure | None = None
        self._chart: TradeMapChart | None = None
        self._draw()

    def __panel__(self) -> pn.Column:
        choosers = (
            pmui.Select.from_param(parameter, width=240, margin=(10, 8, 0, 8))
            for parameter in (self.param.x, self.param.y, self.param.result)
        )
        return pn.Column(
            self._title,
            pn.FlexBox(*choosers, margin=(0, 6)),
            self._said,
            self._place,
            self._know,
            download("Map: CSV", "map.csv", self._csv),
            styles=FRAME,
        )

    def show(self, budget: Budget) -> None:
        """Follow the budget in force: the cross moves, the map where it must."""
        self._draw()

    @param.depends("x", "y", "result", watch=True)
    def _draw(self) -> None:
        budget = self.session.budget
        if self.x == self.y:
            self._say("Choose two different inputs.")
            return
        if self.result == ALL and not budget.verdict.checks:
            self._say("No requirement is set: map a single figure, or give a limit under Requirements.")
            return
        self._say("")
        chart = map_chart(budget.design, self.x, self.y, self.result)
        if self._drawn is None or self._chart is None or self._chart.structure != chart.structure:
            self._drawn = MapFigure(chart)
            self._drawn.plot.on_event(Tap, self._tapped)
            self._place.objects = [pn.pane.Bokeh(self._drawn.plot, sizing_mode="stretch_width")]
        else:
            self._drawn.feed(chart)
        self._chart = chart
        self._title.object = f"<h3>{escape(chart.title)}</h3>"
        self._know.object = (
            f"{described(chart)}<p>Orange cross: this design. Red line: {escape(chart.reference)}; dotted: half of "
            "it; dashed: twice. Lighter is better. Click the map to adopt a point.</p>"
            f"{source_note(chart.knowledge)}"
        )

    def _tapped(self, event: Any) -> None:
        chart = self._chart
        if chart is None or event.x is None or event.y is None:
            return
        design, trade = self.session.design, chart.trade
        places = [
            _place(key, value, design.unit(key) if quantity(key).dimension else "")
            for key, value in ((trade.x_key, event.x), (trade.y_key, event.y))
        ]
        changes = changes_at(trade, *places)
        units = {key: design.unit(key) for key in changes if quantity(key).dimension}
        problem = self.session.change(changes, units)
        self._say("" if problem is None else f"Not adopted. {problem}")

    def _say(self, text: str) -> None:
        self._said.object = f'<p role="status">{escape(text)}</p>' if text else ""

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(map_chart(self.session.design, self.x, self.y, self.result)).encode())


def _place(key: str, value: float, unit: str) -> float:
    """SI of a place clicked, rounded as a person would type it, so that its box shows no more digits."""
    text = f"{value:.{_DIGITS}g}"
    return float(quantity(key).read(f"{text} {unit}").value if unit else text)

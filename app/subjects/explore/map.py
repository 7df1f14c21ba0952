"""The map of the page Close it: a result over two inputs; a click applies the place to the design."""

from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.events import Tap

from app.charts.kinds import TradeMapChart, to_csv
from app.charts.screen.maps import MapFigure
from app.declared import chosen
from app.document.blocks import Answer
from app.document.verdict import before_flight
from app.session import Session
from app.subjects.explore.charts import map_chart
from app.subjects.explore.question import Question, unlimited
from app.subjects.explore.sweep_inputs import input_labels
from app.subjects.explore.tables import map_answer
from app.ui.chart_pane import described, head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.study_settings import StudySettings
from app.ui.theme import ON_A_PHONE
from nav_model.budget import Budget
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import decisive
from nav_model.design.figures import FIGURES
from nav_model.design.parts import quantity
from nav_model.explore.margins import ALL, label_of, limits
from nav_model.explore.trade_map import RESULTS, changes_at

_INPUTS = input_labels()


class MapPanel(Question):
    """Three selectors, the map, and the result of a click."""

    x = chosen("imu.angle_random_walk", _INPUTS, "X axis")
    y = chosen("imu.velocity_random_walk", _INPUTS, "Y axis")
    result = chosen(RESULTS[0], {label_of(name): name for name in RESULTS}, "Result")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._head = html_pane("", margin=(6, 10, 0, 10))
        self._place = pn.Column(sizing_mode="stretch_both", stylesheets=[ON_A_PHONE])
        self._drawn: MapFigure | None = None
        self._chart: TradeMapChart | None = None
        self._settings = StudySettings(session, "map", self, ("x", "y", "result"), lambda: None)
        if self.result == ALL and not limits(session.design):
            self.result = next(iter(FIGURES))

    def __panel__(self) -> pn.Column:
        choosers = (
            pmui.Select.from_param(parameter, width=270, margin=(10, 8, 0, 8))
            for parameter in (self.param.x, self.param.y, self.param.result)
        )
        csv = download("Map: CSV", "map.csv", lambda: to_csv(self._now()))
        tools = pn.FlexBox(*choosers, csv, align_items="center")
        return first_screen(
            tools, left=[pn.Column(self._head, self._place, sizing_mode="stretch_both")], height="100%"
        )

    def show(self, budget: Budget) -> None:
        """Follow the current budget: the cross moves, the map where it must."""
        self._draw()

    @param.depends("x", "y", "result", watch=True)
    def _draw(self) -> None:
        budget = self.session.budget
        if self.x == self.y:
            self.answer = Answer("Choose two different inputs", "warn", ("Both axes have the same input.",))
            return
        if self.result == ALL and not budget.straight_leg().checks:
            self.answer = unlimited(budget).more("Or choose a single result.")
            return
        chart = self._now()
        self.answer = map_answer(chart, self._value(budget, chart))
        if self._drawn is None or self._chart is None or self._chart.structure != chart.structure:
            self._drawn = MapFigure(chart, narrow=self.session.narrow)
            self._drawn.plot.on_event(Tap, self._tapped)
            self._place.objects = [pn.pane.Bokeh(self._drawn.plot, sizing_mode="stretch_both")]
        else:
            self._drawn.feed(chart)
        self._chart = chart
        key = (
            f'<span class="quiet fine">Cross: this design. Solid line: {escape(chart.reference)}; dotted: half; '
            f"dashed: twice. Lighter is better. ○ passes, ✕ fails{before_flight(self.session.design)}.</span>"
        )
        self._head.object = head_html(chart.title, chart.knowledge, described(chart), key)

    def _now(self) -> TradeMapChart:
        return map_chart(self.session.design, self.x, self.y, self.result)

    def _value(self, budget: Budget, chart: TradeMapChart) -> float:
        """The result of the design itself, over the map's reference."""
        if self.result == ALL:
            return 1 - min(check.margin for check in budget.straight_leg().checks)
        sigma = figures(inputs_of(budget.design), (self.result,))[self.result]
        return float(decisive(budget.design, self.result)[0] * sigma) / chart.level

    def _tapped(self, event: Any) -> None:
        chart = self._chart
        if chart is None or event.x is None or event.y is None:
            return
        design, trade = self.session.design, chart.trade
        # Rounded as a person would type it, so that its box shows no more digits.
        clicked = ((trade.x_key, event.x), (trade.y_key, event.y))
        places = [quantity(key).read(f"{value:.3g} {design.unit(key)}").value for key, value in clicked]
        changes = changes_at(trade, *places)
        units = {key: unit for key in changes if (unit := design.unit(key))}
        problem = self.session.change(changes, units)
        if problem:
            self.answer = Answer("Not applied", "warn", (str(problem),))

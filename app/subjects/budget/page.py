"""The Budget page: the answer, the key figures, then the charts that explain them."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn

from app.charts.kinds import BarChart, Chart
from app.declared import held
from app.document.pane import html_of
from app.document.verdict import verdict_of
from app.report.cautions import caution_list
from app.session import Session
from app.subjects.budget import charts
from app.subjects.budget.tables import key_figures, requirement_table
from app.ui.chart_pane import ChartView
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.turns import in_turns
from nav_model.budget import Budget

# Chart, height in pixels, columns of twelve on a wide screen.
_LAYOUT: tuple[tuple[Callable[[Budget], Chart | BarChart], int, int], ...] = (
    (charts.position_chart, 380, 12),
    (charts.velocity_chart, 300, 6),
    (charts.attitude_chart, 300, 6),
    (charts.phase_chart, 360, 6),
    (charts.response_chart, 360, 6),
    (charts.regime_chart, 340, 12),
)

_TIMELINES = 3  # the first charts share their time axis
_AROUND = 100  # pixels of title, legend and line of knowledge around a figure, at least


class BudgetPage(pn.viewable.Viewer):
    """Everything below the tab.

    The first screen is made at once: the answer and the first chart. The other charts follow when it stands, so
    that nobody waits for what is below the fold.
    """

    session = held(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._answer = html_pane(answer(session.budget))
        self._charts: list[ChartView] = []
        # About the height of what will stand in each, so that nothing jumps.
        self._cells = [cell(columns, min_height=height + _AROUND) for _, height, columns in _LAYOUT]
        self._view = pn.Column(self._answer, grid(*self._cells))
        self._add_chart()
        pn.state.onload(lambda: in_turns([self._add_chart] * (len(_LAYOUT) - 1)))  # in a script or a test: at once

    def __panel__(self) -> pn.Column:
        return self._view

    def _add_chart(self) -> None:
        describe, height, _ = _LAYOUT[len(self._charts)]
        chart = ChartView(describe, self.session, height)
        if 0 < len(self._charts) < _TIMELINES:  # one time axis: panning one pans all
            chart.figure.plot.x_range = self._charts[0].figure.plot.x_range
        self._cells[len(self._charts)].append(chart.view)
        self._charts.append(chart)

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._answer.object = answer(budget)
        for chart in self._charts:
            chart.show(budget)


def answer(budget: Budget) -> str:
    """Everything above the charts, one pane so that a slider step sends it once."""
    return html_of(verdict_of(budget), key_figures(budget), requirement_table(budget), caution_list(budget))

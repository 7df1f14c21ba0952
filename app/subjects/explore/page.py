"""The Explore page: what would close the design, what to improve first, and which sensors would do."""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import to_csv
from app.charts.screen.maps import RankFigure
from app.document.prose import prose
from app.session import Session
from app.subjects.explore.charts import RankChart, rank_chart
from app.subjects.explore.map import MapPanel, download
from app.subjects.explore.search import SearchPanel
from app.subjects.explore.tables import answer, solved_table, unsolved
from app.subjects.explore.uncertainty import UncertaintyPanel
from app.ui.chart_pane import described
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from app.ui.turns import in_turns
from nav_model.budget import Budget
from nav_model.budget.figures import FIGURES
from nav_model.explore.margins import label_of
from nav_model.explore.solve import Solution, solve


class _Part(Protocol):
    view: Any

    def show(self, budget: Budget) -> None: ...


class ExplorePage:
    """Everything below the tab."""

    def __init__(self, session: Session) -> None:
        self._answer = html_pane("")
        self._solved = html_pane("")
        self._parts: list[_Part] = []
        cells = [cell(columns) for _, columns in _LAYOUT]
        self.view = pn.Column(self._answer, self._solved, grid(*cells), sizing_mode="stretch_width")
        self._answer_for(session.budget)

        def add(index: int) -> None:
            self._parts.append(_LAYOUT[index][0](session))
            cells[index].append(self._parts[-1].view)

        in_turns([partial(add, index) for index in range(len(_LAYOUT))])

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._answer_for(budget)
        for part in self._parts:
            part.show(budget)

    def _answer_for(self, budget: Budget) -> None:
        solutions: tuple[Solution, ...] = ()
        if budget.verdict.checks:
            try:
                solutions = solve(budget.design, verify="together")
            except ArithmeticError as error:  # an answer that does not hold is not shown
                self._answer.object = unsolved(str(error))
                self._solved.object = ""
                return
        self._answer.object = answer(budget, solutions)
        self._solved.object = solved_table(budget, solutions)


class _RankPanel:
    """The ranking, with the figure it is of."""

    def __init__(self, session: Session) -> None:
        self._session = session
        tightest = session.budget.verdict.tightest
        self._figure = pmui.Select(
            label="Figure to improve",
            description="",
            options={label_of(name): name for name in FIGURES},
            value=tightest.name if tightest else "quadratic_phase",
            size="small",
            sizing_mode="stretch_width",
            margin=(10, 14, 0, 14),
        )
        chart = rank_chart(session.design, self._figure.value)
        self._chart = RankFigure(chart)
        self._title = html_pane(f"<h3>{escape(chart.title)}</h3>", margin=(10, 14, 0, 14))
        self._know = html_pane(_know(chart))
        self._figure.param.watch(lambda _: self.show(self._session.budget), "value")
        self.view = pn.Column(
            self._title,
            self._figure,
            pn.Column(pn.pane.Bokeh(self._chart.plot, sizing_mode="stretch_width"), sizing_mode="stretch_width"),
            self._know,
            download("Ranking: CSV", "ranking.csv", self._csv),
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )

    def show(self, budget: Budget) -> None:
        chart = rank_chart(budget.design, self._figure.value)
        self._chart.feed(chart)
        self._title.object = f"<h3>{escape(chart.title)}</h3>"
        self._know.object = _know(chart)

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(rank_chart(self._session.design, self._figure.value)).encode())  # type: ignore[arg-type]


def _know(chart: RankChart) -> str:
    lead = chart.bars[0].sentence if chart.bars else ""
    return (
        f"{described(chart)}<p>{escape(lead)} Hatched bars are inputs to double, plain ones to halve.</p>"
        f'<p class="know quiet"><b>How do we know:</b> {prose(chart.knowledge)}</p>'
    )


# What makes each part, columns of twelve on a wide screen.
_LAYOUT: tuple[tuple[Callable[[Session], _Part], int], ...] = (
    (MapPanel, 7),
    (_RankPanel, 5),
    (SearchPanel, 12),
    (UncertaintyPanel, 12),
)

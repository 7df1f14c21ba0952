"""What would close the design: the largest value of each input, with a button, and what to improve first."""

from __future__ import annotations

import io
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import to_csv
from app.charts.screen.maps import RankFigure
from app.declared import declared
from app.document.blocks import Block
from app.document.pane import html_of
from app.session import Session
from app.subjects.explore.charts import rank_chart
from app.subjects.explore.question import NO_LIMIT, Question
from app.subjects.explore.tables import answer, each_table, largest, solved_blocks, unsolved
from app.ui.chart_pane import described, head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.theme import ON_A_PHONE
from nav_model.budget import Budget
from nav_model.budget.figures import FIGURES
from nav_model.explore.margins import label_of
from nav_model.explore.solve import Solution, solve


class SolvedPanel(Question):
    """The solved values on the left, the ranking of one figure's inputs on the right."""

    figure: str = declared(
        param.Selector(objects={label_of(name): name for name in FIGURES}, label="Figure to improve")
    )

    def __init__(self, session: Session) -> None:
        tightest = session.budget.verdict.tightest
        super().__init__(session=session, figure=tightest.name if tightest else "quadratic_phase")
        self._solutions: tuple[Solution, ...] = ()
        self._table = SortableTable(sizing_mode="stretch_width", margin=(0, 12))
        self._table.param.watch(self._take, "chosen")
        self._each = html_pane("")
        self._ranking = RankFigure(rank_chart(session.design, self.figure))
        self._head = html_pane("", margin=(6, 10, 0, 10))

    def __panel__(self) -> pn.Column:
        folded = Folded([("Each requirement alone", lambda: self._each)])
        chooser = pmui.Select.from_param(self.param.figure, sizing_mode="stretch_width", margin=(8, 12, 0, 12))
        plot = pn.pane.Bokeh(self._ranking.plot, sizing_mode="stretch_both")
        figure = pn.Column(plot, sizing_mode="stretch_both", stylesheets=[ON_A_PHONE])
        return first_screen(
            left=[pn.Column(self._table, folded, sizing_mode="stretch_both", styles={"overflow": "auto"})],
            right=[
                pn.Column(
                    self._head, chooser, figure, download("Ranking: CSV", "ranking.csv", self._csv),
                    sizing_mode="stretch_both",
                )
            ],
            height="100%",
        )  # fmt: skip

    def show(self, budget: Budget) -> None:
        """Solve and rank again."""
        self._rank()
        self._solutions = ()
        blocks: tuple[Block, ...] = ()
        if not budget.verdict.checks:
            self.answer = NO_LIMIT
        else:
            try:
                self._solutions = solve(budget.design, verify="together")
            except ArithmeticError as error:  # a value that does not hold is not shown
                self.answer = unsolved(str(error))
            else:
                self.answer, blocks = answer(budget, self._solutions), solved_blocks(budget, self._solutions)
        said = html_of(*blocks)
        if self._table.html != said:
            self._table.html = said
        self._each.object = html_of(each_table(budget.design, self._solutions)) if self._solutions else ""

    def _take(self, event: Any) -> None:
        """Apply the largest value of the chosen input to the design."""
        solution = next((solution for solution in self._solutions if solution.key == event.new), None)
        self._table.chosen = ""  # so that the same one can be pressed again
        if solution is not None and solution.together.value is not None:
            value, unit = largest(self.session.design, solution.key, solution.together.value)
            problem = self.session.change({solution.key: value}, {solution.key: unit} if unit else None)
            if problem:
                self.answer = unsolved(str(problem))

    @param.depends("figure", watch=True)
    def _rank(self) -> None:
        chart = rank_chart(self.session.design, self.figure)
        self._ranking.feed(chart)
        lead = f'<p class="quiet fine">{chart.bars[0].sentence}</p>' if chart.bars else ""
        head = head_html(chart.title, chart.knowledge, described(chart)) + lead
        if self._head.object != head:
            self._head.object = head

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(rank_chart(self.session.design, self.figure)).encode())

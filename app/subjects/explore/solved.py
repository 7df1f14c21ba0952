"""Changes that would close the design: the largest value of each input, with a button, and what to improve first."""

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import to_csv
from app.declared import chosen
from app.document.bars import effects_html
from app.document.blocks import Answer
from app.document.closing import Way, value_ways
from app.document.pane import html_of, prose
from app.session import Session
from app.subjects.explore.charts import rank_chart
from app.subjects.explore.question import NO_LIMIT, Question
from app.subjects.explore.tables import answer, solved_blocks
from app.ui.chart_pane import head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.theme import NARROW
from nav_model.budget import Budget
from nav_model.explore.margins import label_of
from nav_model.explore.rank import RANKED
from nav_model.explore.solve import solve


class SolvedPanel(Question):
    """The solved values on the left, the ranking of one figure's inputs on the right."""

    figure = chosen(RANKED[0], {label_of(name): name for name in RANKED}, "Quantity to improve")

    def __init__(self, session: Session) -> None:
        tightest = session.budget.straight_leg().tightest
        limited = tightest.on if tightest else ""
        super().__init__(session=session, figure=limited if limited in RANKED else RANKED[0])
        self._ways: tuple[Way, ...] = ()
        self._table = SortableTable(self._take, margin=(0, 12))
        self._head, self._ranking = html_pane("", margin=(6, 10, 0, 10)), html_pane("", margin=(0, 10, 6, 10))
        self._ranking.sizing_mode = "stretch_both"

    def __panel__(self) -> pn.Column:
        chooser = pmui.Select.from_param(self.param.figure, sizing_mode="stretch_width", margin=(8, 12, 0, 12))
        csv = download("Ranking: CSV", "ranking.csv", lambda: to_csv(rank_chart(self.session.design, self.figure)))
        return first_screen(
            left=[pn.Column(self._table, sizing_mode="stretch_both", styles={"overflow": "auto"})],
            right=[
                pn.Column(
                    self._head, chooser, self._ranking, csv,
                    sizing_mode="stretch_both", stylesheets=[NARROW],
                )
            ],
            height="100%",
        )  # fmt: skip

    def show(self, budget: Budget) -> None:
        """Solve and rank again."""
        self._rank()
        self._ways, html = (), ""
        self.answer = NO_LIMIT
        if budget.straight_leg().checks:
            solutions = solve(budget.design, verify=False)
            self._ways = value_ways(budget.design, solutions)
            self.answer = answer(budget, solutions, self._ways)
            html = html_of(*solved_blocks(budget, solutions, self._ways))
        self._table.html = html

    def _take(self, text: str) -> None:
        """Apply the largest value of the chosen input to the design."""
        way = next((way for way in self._ways if way.text == text), None)
        if way is not None:
            problem = self.session.change(way.changes, way.written)
            if problem:
                self.answer = Answer("Not applied", "warn", (str(problem),))

    @param.depends("figure", watch=True)
    def _rank(self) -> None:
        chart = rank_chart(self.session.design, self.figure)
        self._ranking.say(effects_html(chart))
        lead = next((f'<p class="quiet fine">{prose(bar.sentence)}</p>' for bar in chart.bars if bar.bought), "")
        hatched = any(bar.doubled for bar in chart.bars)
        key = '<span class="quiet fine">Plain: halved. Hatched: doubled.</span>' if hatched else ""
        head = head_html(chart.title, chart.knowledge, key) + lead
        self._head.say(head)

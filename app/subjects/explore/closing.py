"""Sets of levers that close the design, and each lever alone; beside them one value at a time, and
what to improve first."""

from collections.abc import Mapping

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import to_csv
from app.declared import chosen, required
from app.document.bars import effects_html
from app.document.blocks import Answer, Text
from app.document.closing import (
    GROUP_WORDS,
    Way,
    alone_table,
    closing_answer,
    closing_options,
    set_name,
    sets_table,
    value_ways,
)
from app.document.pane import html_of, prose
from app.session import Session
from app.subjects.explore.charts import rank_chart
from app.subjects.explore.question import Question, unlimited
from app.subjects.explore.ranking import changes_that_close
from app.subjects.explore.tables import headroom_answer, solved_blocks
from app.ui.chart_pane import head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.sortable_table import WHOLE, SortableTable
from app.ui.study_settings import StudySettings
from app.ui.theme import NARROW, SWITCH
from app.work.pool import run_in_pool
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.explore.closing import LeverSet
from nav_model.explore.levers import ASKED_FOR
from nav_model.explore.margins import label_of
from nav_model.explore.rank import RANKED

_COMPUTING = Answer("What would close it", "open", ("Computing …",))
_USUAL = ",".join(name for name in GROUP_WORDS if name not in ASKED_FOR)
_RESERVES = {"No reserve": "0", "5 % reserve": "5", "10 % reserve": "10", "20 % reserve": "20"}


class ClosingPanel(Question):
    """Sets of levers on the left, single values and the ranking of one figure's inputs on the right."""

    run = required(Run)
    figure = chosen(RANKED[0], {label_of(name): name for name in RANKED}, "Quantity to improve")
    changes = param.String(default=_USUAL, doc="Groups of levers that may change, with commas.")
    reserve = chosen("0", _RESERVES, "Reserve")

    def __init__(self, session: Session) -> None:
        tightest = session.budget.straight_leg().tightest
        limited = tightest.on if tightest else ""
        figure = limited if limited in RANKED else RANKED[0]
        super().__init__(session=session, run=session.new_run(), figure=figure)
        self._ways: Mapping[str, Way | LeverSet] = {}
        self._sets, self._alone, self._values = (
            SortableTable(self._take, margin=(0, 12), stylesheets=[WHOLE]) for _ in range(3)
        )
        self._head, self._ranking = html_pane("", margin=(6, 10, 0, 10)), html_pane("", margin=(0, 10, 6, 10))
        self._settings = StudySettings(session, "close", self, ("changes", "reserve"), self._again)
        self._groups = pmui.CheckButtonGroup(
            label="May change",
            options={words: name for name, words in GROUP_WORDS.items()},
            value=self.changes.split(","),
            margin=(8, 10),
            stylesheets=[SWITCH],
        )
        self._groups.param.watch(self._choose, "value")

    def __panel__(self) -> pn.Column:
        label = html_pane('<span class="quiet">May change</span>', margin=(14, 0, 0, 12))
        label.param.update(sizing_mode=None, width=90)  # on the line of the groups
        tools = pn.FlexBox(
            label,
            self._groups,
            pmui.Select.from_param(self.param.reserve, width=150, margin=(8, 10), size="small"),
            align_items="center",
        )
        chooser = pmui.Select.from_param(self.param.figure, sizing_mode="stretch_width", margin=(8, 12, 0, 12))
        csv = download("Ranking: CSV", "ranking.csv", lambda: to_csv(rank_chart(self.session.design, self.figure)))
        scroll = {"overflow": "auto"}
        return first_screen(
            tools,
            left=[pn.Column(self._sets, self._alone, sizing_mode="stretch_both", styles=scroll)],
            right=[
                pn.Column(
                    self._values, self._head, chooser, self._ranking, csv,
                    sizing_mode="stretch_both", styles=scroll, stylesheets=[NARROW],
                )
            ],
            height="100%",
        )  # fmt: skip

    def _choose(self, event: param.parameterized.Event) -> None:
        self.changes = ",".join(name for name in GROUP_WORDS if name in event.new)

    @param.depends("changes", "reserve", watch=True)
    def _again(self) -> None:
        self._groups.value = self.changes.split(",")
        self.show(self.session.budget)

    def show(self, budget: Budget) -> None:
        """Rank again, and solve in a worker; what was asked for an earlier design is dropped."""
        self._rank()
        if not budget.straight_leg().checks:
            self.run.cancel()
            answer = unlimited(budget)
            self._fill({}, answer, html_of(Text(answer.sentences[0])), "", "")
            return
        self.answer = _COMPUTING
        self._ways = {}  # buttons of an earlier design do nothing
        question = budget.design, closing_options(self._settings.text, self.session.offers)
        pn.state.execute(lambda: self.run.start(lambda _: run_in_pool(changes_that_close, *question)))

    @param.depends("run.running", watch=True)
    def _solved(self) -> None:
        if self.run.running or self.run.cancelled:
            return
        if self.run.message:
            self._fill({}, Answer("Not solved", "warn", (self.run.message,)))
            return
        budget, (solutions, closing) = self.session.budget, self.run.result
        design, ways = budget.design, value_ways(budget.design, solutions)
        self._fill(
            {way.text: way for way in ways} | {set_name(each): each for each in closing.sets},
            headroom_answer(budget, solutions, ways) if closing.closes else closing_answer(budget, closing),
            html_of(sets_table(design, closing.sets)) if closing.sets else "",
            html_of(alone_table(design, closing)) if closing.alone else "",
            html_of(*solved_blocks(budget, solutions, ways)),
        )

    def _fill(self, ways: Mapping[str, Way | LeverSet], answer: Answer, *tables: str) -> None:
        self._ways = ways
        self._sets.html, self._alone.html, self._values.html = tables or ("", "", "")
        self.answer = answer

    def _take(self, text: str) -> None:
        """Apply the chosen set, or the largest value of the chosen input, to the design."""
        way = self._ways.get(text)
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

"""The comparison's part of the Review page: up to six revisions side by side."""

import panel as pn
import param

from app.declared import declared, required
from app.document.bars import bars_html
from app.document.blocks import Answer
from app.document.display import display_of
from app.document.numbers import signed_percent
from app.document.pane import html_of
from app.document.wording import design_labels
from app.library.store import Revision, fly_ahead
from app.report import report_bytes
from app.report.comparison import closing_words, difference_tables, phase_comparison, position_comparison
from app.subjects.review.desk import LOOK, Desk, listed
from app.ui.chart_pane import ChartPane, described, source_note
from app.ui.fields import TextInput
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError

_NOTHING = Answer("Nothing to compare yet", "open", ("Tick two to six designs in the library, then press Compare.",))
_HEIGHT = 340  # of a chart in pixels


class CompareView(View):
    """Verdicts, differences, curves, link and report of the revisions last compared."""

    desk = required(Desk)
    answer: Answer = declared(param.ClassSelector(class_=Answer, default=_NOTHING, instantiate=False))

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk=desk)
        self._revisions: tuple[Revision, ...] = ()
        self._tables = html_pane("")
        self._charts = pn.Column()
        self._link = TextInput(label="Link to this comparison", sizing_mode="stretch_width", max_width=420, **LOOK)
        reports = desk.report_buttons("comparison", "Comparison report", self._report)
        self._tools = pn.FlexBox(*reports, self._link, align_items="center", visible=False, margin=(4, 4))
        self._view = pn.Column(self._tools, self._tables, self._charts)

    async def compare(self, revisions: tuple[Revision, ...]) -> bool:
        """Set revisions side by side; whether all of them could be computed."""
        await fly_ahead(revisions)
        try:
            budgets = [revision.budget() for revision in revisions]
        except InputError as error:
            self.desk.say(f"Not compared. {error}", wrong=True)
            return False
        labels = design_labels(len(budgets))
        self._revisions, display = revisions, display_of(self.desk.session.display)
        display = display.of(*(budget.design for budget in budgets))
        self._tables.object = listed(revisions, "Compared") + html_of(*difference_tables(budgets, labels, display))
        phase = display.bars(phase_comparison(budgets, labels))
        html = f"<h3>{phase.title}</h3>{bars_html(phase)}{described(phase)}{source_note(phase.knowledge)}"
        # A new figure for each comparison: it has as many lines as there are designs.
        self._charts.objects = [
            ChartPane(lambda at: display.timeline(position_comparison(*at)), lambda: (budgets, labels), _HEIGHT).view,
            pn.Column(html_pane(html, margin=(10, 14)), styles=FRAME),
        ]
        self._link.value = comparison_link(revisions)
        self._tools.visible = True
        tightest = [budget.verdict.tightest for budget in budgets]
        margins = (
            f"{label} {signed_percent(check.margin)}" for label, check in zip(labels, tightest, strict=True) if check
        )
        self.answer = Answer(closing_words(budgets), "open", (f"Least margins: {', '.join(margins)}.",))
        self.desk.say("")
        return True

    async def _report(self, suffix: str) -> bytes:
        budgets = [revision.budget() for revision in self._revisions]
        return await run_in_pool(report_bytes, budgets, suffix, None, (), (), None, self.desk.session.display)

    @param.depends("desk.session.display", watch=True)
    async def _tell_otherwise(self) -> None:
        """Follow how figures are shown."""
        if self._revisions:
            await self.compare(self._revisions)


def comparison_link(revisions: tuple[Revision, ...]) -> str:
    """The address of a comparison, for users of the same library."""
    query = f"?compare={','.join(revision.key for revision in revisions)}"
    location = pn.state.location
    if not location:
        return query
    port = f":{location.port}" if location.port else ""
    return f"{location.protocol}//{location.hostname}{port}{location.pathname}{query}"

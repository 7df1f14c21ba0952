"""The comparison's part of the Review page: up to six revisions side by side."""

from __future__ import annotations

import functools
import io
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.charts.legend import legend_html
from app.charts.screen.figures import to_bokeh
from app.document.pane import html_of
from app.document.prose import prose
from app.library.store import Revision
from app.report import report_bytes
from app.subjects.review.charts import phase_comparison, position_comparison
from app.subjects.review.comparison import difference_tables
from app.subjects.review.desk import BUTTON, LOOK, Desk
from app.ui.chart_pane import described
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from app.work.pool import elsewhere
from nav_model.errors import InputError

_EMPTY = "<p>Nothing to compare yet. Tick two to six designs or revisions in the library, then <i>Compare</i>.</p>"


class CompareView:
    """Verdicts, differences, curves, link and report of the revisions last compared."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._revisions: tuple[Revision, ...] = ()
        self._tables = html_pane(_EMPTY)
        self._charts = pn.Column(sizing_mode="stretch_width", margin=0)
        self._link = pmui.TextInput(
            label="Link to this comparison", sizing_mode="stretch_width", max_width=420, **LOOK
        )
        reports = [
            pmui.FileDownload(
                callback=functools.partial(self._report, kind), filename=f"comparison.{kind}",
                label=f"Comparison report ({kind.upper()})", **BUTTON,
            )
            for kind in ("html", "pdf")
        ]  # fmt: skip
        self._tools = pn.FlexBox(*reports, self._link, align_items="center", visible=False, margin=(4, 4))
        self.view = pn.Column(self._tools, self._tables, self._charts, sizing_mode="stretch_width")

    async def show(self, revisions: tuple[Revision, ...]) -> bool:
        """Set revisions side by side; whether all of them could be worked out."""
        try:
            budgets = [revision.budget() for revision in revisions]
        except InputError as error:
            self._desk.say(f"Not compared. {error}", wrong=True)
            return False
        labels = [f"D{i}" for i in range(1, len(budgets) + 1)]
        self._revisions = revisions
        origin = "".join(
            f"<li><b>{label}</b> {escape(r.name)}, revision {r.number}, by {escape(r.author)}</li>"
            for label, r in zip(labels, revisions, strict=True)
        )
        tables = html_of(*difference_tables(budgets, labels))
        charts = [_chart(draw(budgets, labels)) for draw in (position_comparison, phase_comparison)]
        self._tables.object = f'<ul class="legend" aria-label="Compared">{origin}</ul>{tables}'
        self._charts.objects = charts
        self._link.value = comparison_link(revisions)
        self._tools.visible = True
        closing = sum(budget.verdict.closes for budget in budgets)
        self._desk.say(f"{len(budgets)} revisions side by side, {closing} of which close.")
        return True

    async def _report(self, kind: str) -> io.BytesIO:
        self._desk.session.running = True
        try:
            budgets = [revision.budget() for revision in self._revisions]
            return io.BytesIO(await elsewhere(report_bytes, budgets, f".{kind}"))
        finally:
            self._desk.session.running = False


def comparison_link(revisions: tuple[Revision, ...]) -> str:
    """The address of a comparison, for whoever shares this library."""
    query = f"?compare={','.join(revision.key for revision in revisions)}"
    location = pn.state.location
    if not location:
        return query
    port = f":{location.port}" if location.port else ""
    return f"{location.protocol}//{location.hostname}{port}{location.pathname}{query}"


def _chart(chart: Any) -> pn.Column:
    # A new figure for each comparison: its lines are as many as the designs. It stands in native columns only.
    return pn.Column(
        html_pane(f"<h3>{escape(chart.title)}</h3>", margin=(10, 14, 0, 14)),
        pn.pane.Bokeh(to_bokeh(chart, 340).plot, sizing_mode="stretch_width"),
        html_pane(
            f"{described(chart)}{legend_html(chart)}"
            f'<p class="know quiet"><b>How do we know:</b> {prose(chart.knowledge)}</p>'
        ),
        styles=FRAME,
        sizing_mode="stretch_width",
        margin=(6, 10),
    )

"""Sweeps on the page Close it: grids of designs, run in a separate process, as a table and files."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import required
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.wording import box_text
from app.session import Session
from app.subjects.explore.question import Question
from app.subjects.explore.sweep_inputs import EXAMPLE, FIELDS, chosen_rows, sweep_file, usual_row
from app.subjects.explore.tables import sweep_answer, sweep_table
from app.ui.downloads import download, run_download
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.row_editor import RowEditor, Rows
from app.ui.run_bar import RunBar
from app.ui.sortable_table import WHOLE, SortableTable
from app.work.cancellable import run_alone
from app.work.pool import run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design.parts import labelled, quantity
from nav_model.explore.sweep import Column, to_csv, to_parquet, whole_sweep
from nav_model.explore.sweep_plan import SweepPlan, parse_plan

MOST_DESIGNS = 200_000
"""Of one sweep on the page: some 40 MB, and a minute where they are post-processed. The command takes more."""
_COMING = "<p class='quiet'>The designs, those that just pass first, appear here with the first sweep.</p>"
_ELSEWHERE = "Use fewer points, or download the sweep file and run “navbudget sweep FILE -o OUT.csv”."


@dataclass(frozen=True)
class Swept:
    """A finished sweep: its plan, and the results of every design."""

    plan: SweepPlan
    columns: Mapping[str, Column]


class SweepPanel(Question):
    """Inputs to vary, and how many designs that is; then the table."""

    of_design = False  # a sweep may be of an earlier one; its table says the processing

    run = required(Run)
    files = required(Run)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run(), files=session.new_run())
        self._plan: SweepPlan | None = None
        self.inputs = RowEditor(FIELDS, self._vary, noun="input", caption="Inputs to vary", ordered=True)
        self.inputs.rows = [usual_row(key, session.design) for key in EXAMPLE]
        self._count = html_pane("", margin=(4, 10))
        self.bar = RunBar(self.run, self.start, "Run sweep")
        self._table = SortableTable(self._take, html=_COMING, margin=(0, 12), stylesheets=[WHOLE])

    def __panel__(self) -> pn.Column:
        def taken(label: str, name: str, write: Any) -> pmui.FileDownload:
            async def made() -> bytes:
                swept = self.run.result
                return b"" if swept is None else await run_in_pool(write, swept.columns)

            file = download(label, name, run_download(self.files, made))
            file.disabled = self.run.param.result.rx.is_(None)
            return file

        setup = pn.Column(
            self.inputs,
            pn.FlexBox(
                self.bar,
                self._count,
                taken("Table: CSV", "sweep.csv", to_csv),
                taken("Table: Parquet", "sweep.parquet", to_parquet),
                download("Sweep file (TOML)", "sweep.toml", self._file),
                align_items="center",
            ),
        )
        table = pn.Column(self._table, sizing_mode="stretch_both", styles={"overflow": "auto"})
        return first_screen(setup, left=[table], height="100%")

    def _vary(self, rows: Rows) -> None:
        """Vary what the rows say; an input just chosen begins with its usual range."""
        self.inputs.rows = chosen_rows(rows, self.inputs.rows, self.session.design)
        self._read()

    def _file(self) -> str:
        return sweep_file(self.session.design, self.inputs.rows)

    def show(self, budget: Budget) -> None:
        """Follow the design: the sweep is of the current design."""
        self._read()

    def _read(self) -> None:
        """Work out what the rows ask for."""
        self._plan = None
        try:
            plan = parse_plan(self._file().encode())
        except InputError as error:
            self._say(str(labelled(error)), alert=True)
        else:
            if plan.rows > MOST_DESIGNS:
                most = f"{plan.rows:,} designs; at most {MOST_DESIGNS:,} on this page."
                self._say(f"{most} {_ELSEWHERE}", alert=True)
            else:
                self._plan = plan
                self._say(f"{plan.rows:,} designs.")
        self.bar.start.disabled = self._plan is None
        self._answer()

    def _say(self, text: str, *, alert: bool = False) -> None:
        html = f'<p role="status" style="margin: 0">{text}</p>'
        self._count.object = html_of(Answer("", "warn", (text,))) if alert else html

    def start(self) -> object:
        """Run the sweep of the rows; one under way is cancelled."""
        plan = self._plan
        if plan is None:
            return None

        async def sweep(run: Run) -> Swept:
            return Swept(plan, await run_alone(whole_sweep, plan, progress=lambda share, what: run.tell(what, share)))

        return self.run.start(sweep)

    @param.depends("run.result", watch=True)
    def _show(self) -> None:
        swept: Swept | None = self.run.result
        if swept is not None:
            self._table.html = html_of(sweep_table(swept.plan, swept.columns))
            self._answer()

    def _answer(self) -> None:
        swept: Swept | None = self.run.result
        if swept is None:
            hint = "An example is set: press Run sweep, or choose other inputs and ranges."
            self.answer = Answer("Sweep", "open", (hint,))
        else:
            stale = self._plan is None or self._plan.identity != swept.plan.identity
            self.answer = sweep_answer(swept.plan, swept.columns, stale)

    def _take(self, row: str) -> None:
        """Put the design of a row in force."""
        swept: Swept | None = self.run.result
        if swept is not None:
            changes: dict[str, Any] = {}
            for axis, place in zip(swept.plan.axes, swept.plan.indices(int(row), int(row) + 1), strict=True):
                changes |= axis.changes[int(place[0])]
                if isinstance(value := changes[axis.key], float):  # four digits, so that its box shows no more
                    text = box_text(self.session.design, axis.key, value)
                    changes[axis.key] = quantity(axis.key).read(text).value
            problem = self.session.change(changes)
            if problem:
                self._say(str(problem), alert=True)

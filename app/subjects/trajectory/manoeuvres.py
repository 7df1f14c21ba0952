"""What would close a flight: a block of the page that flies candidates in a worker, with a button for each option."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import panel as pn

from app.declared import required
from app.document.pane import html_of
from app.session import Session
from app.subjects.trajectory.options import option_label, options_answer, options_table
from app.subjects.trajectory.run import closing_options
from app.ui.html_pane import html_pane, stale_mark
from app.ui.run_bar import RunBar
from app.ui.sortable_table import SortableTable
from app.ui.view import View
from app.work.cancellable import run_alone
from app.work.run import Run
from nav_model.base.errors import InputError

if TYPE_CHECKING:
    from nav_model.design import Design
    from nav_model.explore.manoeuvre import Manoeuvres


class ManoeuvreBlock(View):
    """The options of the design's plan; one that is pressed is taken into the design, and can be undone.

    Parameters
    ----------
    session : Session
    states : callable
        States of the filter; 0 as by design.
    share : callable
        Called with the design and its options, for the report.
    """

    run = required(Run)

    def __init__(
        self, session: Session, states: Callable[[], int], share: Callable[[Design, Manoeuvres], object]
    ) -> None:
        super().__init__(run=session.new_run())
        self._session, self._states, self._share = session, states, share
        self._asked: Design | None = None  # what the options are of
        self._bar = RunBar(self.run, self.begin, "Fly the candidates")
        self._head = html_pane("", margin=(0, 10))
        self._table = SortableTable(self._take, margin=(0, 10))
        self._view = pn.Column(self._bar, self._head, self._table)
        self.run.param.watch(self._show, "result")

    def begin(self) -> asyncio.Task[None]:
        """Fly the candidates of the design; those under way are dropped."""
        design, states = self._session.design, self._states()

        async def work(run: Run) -> tuple[Design, Manoeuvres]:
            answer = await run_alone(
                closing_options, design, states, progress=lambda share, what: run.tell(what, share)
            )
            return design, answer

        return self.run.start(work)

    def follow(self) -> None:
        """Mark options of another design."""
        if self.run.result is not None:
            design, answer = self.run.result
            words, stale = options_answer(answer), ""
            if design != self._session.design:
                words, stale = (
                    replace(words, tone="open"),
                    stale_mark("Of the plan and design before the last change."),
                )
            self._head.say(stale + html_of(words))

    def _show(self, _: object) -> None:
        design, answer = self.run.result
        self._share(design, answer)
        self._table.html = html_of(options_table(answer)) if answer.options else ""
        self.follow()

    def _take(self, name: str) -> None:
        """Take an option into the design that it was flown from; what is flown there stays where others changed."""
        design, answer = self.run.result
        option = next((option for option in answer.options if option.name == name), None)
        if option is None:
            return
        if design != self._session.design:
            self._bar.message = "Not applied: the design has changed. Fly the candidates again."
            return
        problem: InputError | None = self._session.change(option.changes, option.written)
        done = f"{option_label(option)} is in the design now. You can undo."
        self._bar.message = done if problem is None else f"Not applied. {problem}"

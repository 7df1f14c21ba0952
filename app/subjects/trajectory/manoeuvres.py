"""Options that would close a flight: a block of the page that flies candidates in a worker, a button for each."""

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
from app.work.flight import File
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
    flown : callable
        The file that is flown in place of the plan, if any.
    share : callable
        Called with the design, the file and the options, for the report.
    """

    run = required(Run)

    def __init__(
        self,
        session: Session,
        flown: Callable[[], File | None],
        share: Callable[[Design, File | None, Manoeuvres], object],
    ) -> None:
        super().__init__(run=session.new_run())
        self._session, self._flown, self._share = session, flown, share
        self._bar = RunBar(self.run, self.begin, "Compare options")
        self._head = html_pane("", margin=(0, 10))
        self._table = SortableTable(self._take, margin=(0, 10))
        self._view = pn.Column(self._bar, self._head, self._table)
        self.run.param.watch(self._show, "result")

    def begin(self) -> asyncio.Task[None]:
        """Compare the options of the design; those under way are dropped."""
        design, file = self._session.design, self._flown()

        async def work(run: Run) -> tuple[Design, File | None, Manoeuvres]:
            answer = await run_alone(
                closing_options, design, file, progress=lambda share, what: run.tell(what, share)
            )
            return design, file, answer

        return self.run.start(work)

    def follow(self) -> None:
        """Mark options of another design."""
        if self.run.result is not None:
            words, stale = options_answer(self.run.result[-1]), ""
            if self._outdated:
                words, stale = (
                    replace(words, tone="open"),
                    stale_mark("Outdated: computed before the last change."),
                )
            self._head.say(stale + html_of(words))

    @property
    def _outdated(self) -> bool:
        design, file, _ = self.run.result
        return bool(design != self._session.design or file != self._flown())

    def _show(self, _: object) -> None:
        design, file, answer = self.run.result
        self._share(design, file, answer)
        self._table.html = html_of(options_table(answer, design)) if answer.options else ""
        self.follow()

    def _take(self, name: str) -> None:
        """Take an option into the design that it was flown from; what is flown there stays where others changed."""
        answer = self.run.result[-1]
        option = next((option for option in answer.options if option.name == name), None)
        if option is None:
            return
        if self._outdated:
            self._bar.message = "Not applied: the design or the flight has changed. Compare the options again."
            return
        problem: InputError | None = self._session.change(option.changes, option.written)
        done = f"{option_label(option)} is in the design now. You can undo."
        self._bar.message = done if problem is None else f"Not applied. {problem}"

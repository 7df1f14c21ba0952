"""The actions of the bar's buttons: undo, files, link, reports, examples."""

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

import panel as pn
import param

from app.dashboard.bar import HeaderBar
from app.dashboard.report_choice import ReportChoice
from app.declared import required
from app.document.display import display_of
from app.document.wording import chapter_key, slug
from app.examples import EXAMPLES, description_of, example
from app.report import report_bytes
from app.report.studies import study_sections
from app.report.supplier import NAMES, supplier_bytes
from app.session import Session
from app.subjects import TABS
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.file import MAX_BYTES, format_design, parse_design
from nav_model.design.other_filters import FILTERS, noise_for
from nav_model.design.parts import labelled
from nav_model.explore.supplier import Unit


class Toolbar(View):
    """Actions on the design as a whole.

    Parameters
    ----------
    say : callable
        Shows a message above the page; its second argument, "error" unless given, is how grave it is.
    """

    session = required(Session)

    def __init__(self, session: Session, say: Callable[..., None]) -> None:
        super().__init__(session=session)
        self._say = say
        self._choice = ReportChoice(session)
        self._report = session.new_run()
        self._view = self.bar = HeaderBar(
            self._do,
            tabs=[[tab.group, tab.title, tab.address] for tab in TABS],
            examples=[[key, example(key).name, example(key).description] for key in EXAMPLES],
            most=MAX_BYTES,
            named=session.design.name,
            description=description_of(session.design),
            can_undo=session.param.can_undo,
            can_redo=session.param.can_redo,
            link=session.short_link,
            display=session.display,
            sizing_mode="stretch_width",
            margin=0,
        )
        self.bar.param.watch(self._written, ["named", "description"])

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        design = budget.design
        if (self.bar.named, self.bar.description) != (design.name, description_of(design)):
            self.bar.param.update(named=design.name, description=description_of(design))

    @param.depends("session.findings", "session.budget", "session.running", watch=True)
    def _offer(self) -> None:
        if self._report.running:
            return
        studies, left_out = self._choice.offered(), self._choice.lacking()
        if (self.bar.studies, self.bar.left_out) != (studies, left_out):
            self.bar.param.update(studies=studies, left_out=left_out)

    def _written(self, *_: Any) -> None:
        design, words = self.session.design, {"name": self.bar.named, "description": self.bar.description}
        if (design.name, description_of(design)) != (words["name"], words["description"]):
            self.session.change(words)

    def _do(self, deed: dict[str, Any]) -> None:
        match deed["do"]:
            case "undo":
                self.session.undo()
            case "redo":
                self.session.redo()
            case "reset":
                self.session.reset()
            case "example" if deed.get("key") in EXAMPLES:
                self._adopt_example(example(deed["key"]))
            case "show":
                self.session.display = display_of(str(deed.get("word", ""))).word
            case "save":
                design = self.session.design
                text = format_design(design.replace({"description": description_of(design)}))
                name = f"{slug(design.name)}.toml"
                self.bar.give(name, text.encode("utf-8"))
                self._say(f"Saved as {name}.", "info")
            case "open":
                self._open(deed.get("data"), str(deed.get("name", "file")))
            case "filter" if deed.get("name") in FILTERS:
                self._give_noise(deed["name"])
            case "tick":
                self._choice.tick(str(deed.get("kind")), bool(deed.get("ticked")))
            case "report" if deed.get("suffix") in {"pdf", "html", "xlsx"}:
                pn.state.execute(partial(self._write, deed["suffix"]))
            case "sheet" if deed.get("unit") in NAMES:
                pn.state.execute(partial(self._write_sheet, deed["unit"]))
            case "stop":
                self._report.cancel()

    def _give_noise(self, name: str) -> None:
        try:
            self.bar.give(FILTERS[name].file_name, noise_for(self.session.design, name).encode("utf-8"))
        except InputError as error:
            self._say(f"No file for {FILTERS[name].label}. {labelled(error)}")

    def _adopt_example(self, design: Design) -> None:
        if problem := self.session.adopt(design):
            self._say(f"Not opened. {problem}")
        else:
            self._say(f"{design.name} is open. Undo brings the last design back.", "info")

    def _open(self, data: Any, name: str) -> None:
        if not isinstance(data, bytes) or len(data) > MAX_BYTES:
            self._say(f"Not opened. {name}: larger than {MAX_BYTES / 1e6:g} MB; a design file is a few kB.")
            return
        problem: InputError | None
        try:
            problem = self.session.adopt(parse_design(data, name))
        except InputError as error:
            problem = error
        self._say(f"Not opened. {problem}" if problem else "")

    async def _write(self, suffix: str) -> None:
        """Write a report in a worker."""

        name = f"{slug(self.session.design.name)}.{suffix}"
        what = "spreadsheet" if suffix == "xlsx" else f"{suffix.upper()} report"

        async def write() -> bytes:
            if self.session.flight_words:
                self.bar.writing = f"{what}, which waits for the flight"
            budget = await self.session.with_flight()
            self.bar.writing = what
            findings, display = self._choice.chosen(), self.session.display
            # Sections are made here, in a thread: findings are large, their sections are small enough to send to the
            # worker.
            study = await asyncio.to_thread(study_sections, findings, budget.design, chapter_key(""))
            return await run_in_pool(report_bytes, [budget], f".{suffix}", None, (), [study], None, display)

        await self._hand_over(name, what, write)

    async def _write_sheet(self, unit: Unit) -> None:
        """Write a sheet for a supplier in a worker."""
        design = self.session.design
        await self._hand_over(
            f"{unit}-required.html", "requirement sheet", lambda: run_in_pool(supplier_bytes, design, unit)
        )

    async def _hand_over(self, name: str, what: str, write: Callable[[], Awaitable[bytes]]) -> None:
        """Say that a file is being written, and hand it to the browser."""
        self.bar.writing = what
        self._report.result = None
        try:
            await self._report.start(lambda _: write())
        finally:
            self.bar.writing = ""
        if self._report.message:
            self._say(f"The file was not written. {self._report.message}")
        elif self._report.result:
            self.bar.give(name, self._report.result)
        self._offer()

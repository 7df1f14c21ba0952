"""The tools above the tabs: undo, files, link, reports, examples, tour."""

from __future__ import annotations

import asyncio
import html
import io
import re
from collections.abc import Awaitable, Callable
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui
import param

from app.dashboard.report_choice import ReportChoice
from app.declared import held
from app.document.wording import chapter_key
from app.report import report_bytes
from app.report.studies import study_sections
from app.session import Session
from app.ui.downloads import run_download
from app.ui.theme import PRINT_NOTHING
from app.ui.tour import Tour
from app.upstream.file_input import LimitedFileInput
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.file import MAX_BYTES, format_design, parse_design
from nav_model.design.link import to_query
from nav_model.errors import InputError

_LOOK: dict[str, Any] = {"variant": "text", "margin": 2}


class Say(Protocol):
    """Tells the person something above the page; ``markup`` is text unless it says otherwise."""

    def __call__(self, text: str, severity: str = "error", *, markup: bool = False) -> None: ...


class Toolbar(pn.viewable.Viewer):
    """Everything that acts on the design as a whole.

    Parameters
    ----------
    say : Say
        Where messages go.
    examples : pn.Column
        Where the examples appear when they are asked for.
    """

    session = held(Session)

    def __init__(self, session: Session, say: Say, examples: pn.Column) -> None:
        super().__init__(session=session)
        self._say, self._examples = say, examples
        self._choice = ReportChoice(session)
        self._file = LimitedFileInput(
            lambda why: say(f"Not opened. {why}"),
            label="Open",
            accept=".toml",
            icon="folder_open",
            max_file_size=MAX_BYTES,
            **_LOOK,
        )
        self._file.param.watch(self._opened, "value")
        self._downloads = {
            suffix: pmui.FileDownload(callback=make, filename=f"design.{suffix}", label=label, icon=icon, **_LOOK)
            for suffix, label, icon, make in (
                ("toml", "Save", "save", self._toml),
                ("html", "HTML report", "description", self._report("html")),
                ("pdf", "PDF report", "picture_as_pdf", self._report("pdf")),
            )
        }
        self.show(session.budget)

    def __panel__(self) -> pn.FlexBox:
        session, downloads = self.session, self._downloads
        return pn.FlexBox(
            _tool("Undo", "undo", session.undo, disabled=session.param.can_undo.rx.not_()),
            _tool("Redo", "redo", session.redo, disabled=session.param.can_redo.rx.not_()),
            _tool("Reset", "restart_alt", session.reset),
            self._file,
            downloads["toml"],
            _tool("Link", "link", self._put_link),
            downloads["html"],
            downloads["pdf"],
            _tool("Examples", "auto_awesome_mosaic", self._show_examples),
            Tour(margin=2),
            self._choice,
            visible=session.param.presenting.rx.not_(),
            margin=(2, 6, 0, 6),
            css_classes=["tools"],
            stylesheets=[PRINT_NOTHING],
        )

    def show(self, budget: Budget) -> None:
        """Name the files after the design in force."""
        stem = _slug(budget.design.name)
        for suffix, download in self._downloads.items():
            download.filename = f"{stem}.{suffix}"

    def _show_examples(self) -> None:
        """Open or close the examples, which are made when first asked for."""
        if not self._examples.objects:
            from app.dashboard.gallery import gallery

            self._examples.objects = [gallery(self._adopt_example)]
        self._examples.visible = not self._examples.visible

    def _adopt_example(self, design: Design) -> None:
        self._examples.visible = False
        if problem := self.session.adopt(design):
            self._say(f"Not opened. {problem}")
        else:
            self._say(f"{design.name} is open. Undo brings the last design back.", "info")

    def _opened(self, event: param.parameterized.Event) -> None:
        if not event.new:
            return
        try:
            problem = self.session.adopt(parse_design(event.new, str(self._file.filename or "file")))
        except InputError as error:
            problem = error
        self._say(f"Not opened. {problem}" if problem else "")

    def _put_link(self) -> None:
        location = pn.state.location
        if location:
            query = to_query(self.session.design)
            location.search = f"?{query}"
            port = f":{location.port}" if location.port else ""
            link = html.escape(f"{location.protocol}//{location.hostname}{port}{location.pathname}?{query}")
            said = f'The link to this design is in the address bar: <a href="{link}">{link}</a>'
            self._say(said, "info", markup=True)

    async def _toml(self) -> io.BytesIO:
        return io.BytesIO(format_design(self.session.design).encode("utf-8"))

    def _report(self, suffix: str) -> Callable[[], Awaitable[io.BytesIO]]:
        async def write() -> bytes:
            budget, findings = self.session.budget, self._choice.chosen()
            # Told here, in a thread: what was found is large, its sections are not, and they travel to the worker.
            study = await asyncio.to_thread(study_sections, findings, budget.design, chapter_key(""))
            return await elsewhere(report_bytes, [budget], f".{suffix}", None, (), [study])

        return run_download(
            self.session.new_run(), write, lambda why: self._say(f"The report was not written. {why}")
        )


def _tool(label: str, icon: str, act: Callable[[], Any], **params: Any) -> pmui.Button:
    return pmui.Button(label=label, icon=icon, on_click=lambda _: act(), **_LOOK, **params)


def _slug(name: str) -> str:
    """A design's name as the stem of a file."""
    return re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower()[:60] or "design"

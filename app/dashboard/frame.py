"""The frame around every page: the design on the left, the tools on top, the pages as tabs."""

from __future__ import annotations

import asyncio
import functools
import html
import importlib
import io
import re
from collections.abc import Awaitable, Callable
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui

from app.dashboard.controls import SECTION_TITLES, Control, section_controls
from app.dashboard.lifeline import THEME_COOKIE, Lifeline
from app.dashboard.report_choice import ReportChoice
from app.document.wording import chapter_key
from app.report import report_of_text
from app.report.studies import study_sections
from app.serving.faults import tell_here
from app.session import Lineage, Session
from app.ui.paper import fit_to_paper
from app.ui.theme import DARK, LIGHT, PRINT_NOTHING, PRINT_PAGE
from app.ui.tour import Tour
from app.upstream.browser import Repairs
from app.upstream.busy_line import follow_own_work
from app.upstream.file_input import LimitedFileInput
from app.upstream.full_height import FULL_HEIGHT
from app.upstream.page_marks import OwnMarkPage
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.file import MAX_BYTES, format_design, parse_design
from nav_model.design.link import from_query, split_link, to_query
from nav_model.design.parts import INPUTS
from nav_model.errors import InputError


class Page(Protocol):
    """What a tab must offer."""

    view: Any

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""


PAGES: tuple[tuple[str, str], ...] = (
    ("Budget", "app.subjects.budget.page:BudgetPage"),
    ("Simulate", "app.subjects.simulation.page:SimulatePage"),
    ("SAR", "app.subjects.sar.page:SarPage"),
    ("Suborbital", "app.subjects.suborbital.page:SuborbitalPage"),
    ("Explore", "app.subjects.explore.page:ExplorePage"),
    ("Sensors", "app.subjects.sensors.page:SensorsPage"),
    ("Review", "app.subjects.review.page:ReviewPage"),
    ("Theory", "app.subjects.theory.page:TheoryPage"),
)
"""The tabs: name (its lower-case form is the address behind #) and the class that makes the page.

A page is imported and built when its tab is first opened, so a tab costs the first screen nothing.
"""


_FIRST_OPEN = (0, 1)  # IMU and GNSS: the question most people come with. The second is below the first screen.


class Frame:
    """The page of one session."""

    def __init__(self, session: Session, notice: str = "") -> None:
        self.session = session
        self._controls: list[Control] = []
        self._pages: dict[int, Page] = {}
        self._loaded = False
        self._addressed = False  # the page is being turned because the address says so
        self._places = [pn.Column(sizing_mode="stretch_width", margin=0, visible=not i) for i in range(len(PAGES))]
        self._examples = pn.Column(sizing_mode="stretch_width", margin=0, visible=False, stylesheets=[PRINT_NOTHING])
        self._notice = pmui.Alert(
            object=notice, severity="error", closeable=True, visible=bool(notice), margin=(8, 10, 0, 10)
        )
        # Material tabs speak to keyboard and screen reader; figures must not stand inside them, so they are only
        # the bar, and the pages below are shown and hidden.
        self._tabs = pmui.Tabs(
            *((name, pn.Spacer(height=0)) for name, _ in PAGES),
            sizing_mode="stretch_width",
            margin=(0, 6),
        )
        self._bar = pn.Column(self._tabs, sizing_mode="stretch_width", margin=0, stylesheets=[PRINT_NOTHING])
        self._lifeline = Lifeline(
            self._come_back, link=session.link, who=str(pn.state.user or ""), margin=0, width=0, height=0
        )
        self._open_page(self._tabs.active)
        self.view = self._shell()
        session.param.watch(self._show, "budget")
        session.param.watch(self._keep, ["lineage", "study_link"])
        session.param.watch(self._present, "presenting")
        self._tabs.param.watch(self._turned, "active")
        if pn.state.curdoc:
            fit_to_paper(pn.state.curdoc)
            tell_here(self._say)
        if pn.state.location:
            # What stands behind # reaches the server from the page only, before the page can be changed.
            location = pn.state.location
            pn.state.onload(lambda: self._go_to(self._first_page(location)))
            location.param.watch(lambda event: self._go_to(event.new) if self._loaded else None, "hash")

    def _show(self, event: Any) -> None:
        budget: Budget = event.new
        with pn.io.hold():
            for control in self._controls:
                if control.differs(event.old.design, budget.design):
                    control.show(budget.design)
            if page := self._pages.get(self._tabs.active):  # None where it could not be made
                page.show(budget)
            self._follow_name(budget)
            self._keep()

    def _keep(self, *_: Any) -> None:
        """Have the browser's tab keep what is in force, should the page be loaded again."""
        base = self.session.lineage.base
        self._lifeline.param.update(link=self.session.link, base=base.key if base else "")

    def _come_back(self, link: str, base: str) -> None:
        """Take up again what the browser's tab kept of this page before it was loaded again."""
        of_design, of_study = split_link(link)
        try:
            problem = self.session.adopt(from_query(of_design))
        except InputError as error:
            problem = error
        if problem:
            self._say(f"The design you had here could not be taken up again. {problem}")
            return
        self.session.study_link = of_study
        if base:
            pn.state.execute(functools.partial(self._come_from, base, self.session.lineage))
        self._say("The design you had on this page is back. Undo leads to the one the page opens with.", "info")

    async def _come_from(self, key: str, lineage: Lineage) -> None:
        from app.library.place import library

        try:
            revision = await asyncio.to_thread(lambda: library().revision(key))
        except InputError as error:
            self._say(f"The design you had on this page is back, but not the revision it was saved as. {error}")
            return
        if self.session.lineage is lineage:
            self.session.came_from(revision)

    def _present(self, event: Any) -> None:
        """Leave the screen to the decision at hand, and come back."""
        with pn.io.hold():
            self.view.sidebar_open = not event.new
            self._tools.visible = self._bar.visible = not event.new

    def _turned(self, event: Any) -> None:
        if leave := getattr(self._pages.get(event.old), "leave", None):
            leave()
        try:
            self._open_page(event.new)
            self._pages[event.new].show(self.session.budget)
        finally:  # a page that could not be made leaves its place empty, not another's page under its name
            for index, place in enumerate(self._places):
                place.visible = index == event.new
        name, location = PAGES[event.new][0].lower(), pn.state.location
        # An address that led here stays as it is: a new one would cut off what Forward leads to.
        if location and not self._addressed and location.hash.lstrip("#").lower().partition("-")[0] != name:
            location.hash = f"#{name}"

    def _first_page(self, location: Any) -> str:
        """The page a link is for: what stands behind # unless the query says more."""
        if is_review_link(location.search):
            return "review"
        return str(location.hash) or ("suborbital" if self.session.study_link else "")

    def _go_to(self, address: str) -> None:
        """Turn to the page an address names, and to the place on it that may stand behind a hyphen."""
        self._loaded = True
        wanted, _, place = (address.lstrip("#") or PAGES[0][0]).partition("-")
        for index, (name, _) in enumerate(PAGES):
            if name.lower() == wanted.lower():
                self._addressed = True
                try:
                    self._tabs.active = index
                finally:
                    self._addressed = False
                go_to = getattr(self._pages.get(index), "go_to", None)
                if place and go_to:
                    go_to(place)

    def _open_page(self, index: int) -> None:
        if index not in self._pages:
            module, _, name = PAGES[index][1].partition(":")
            page: Page = getattr(importlib.import_module(module), name)(self.session)
            self._pages[index] = page
            self._places[index].append(page.view)

    # --- the frame's parts -----------------------------------------------------------------------------

    def _shell(self) -> pmui.Page:
        dark = pn.state.cookies.get(THEME_COOKIE) == "dark"
        mobile = "Mobi" in (pn.state.headers or {}).get("User-Agent", "")
        self._tools = self._toolbar()
        page = OwnMarkPage(
            title="NavBudget",
            sidebar=self._sidebar(),
            main=[
                pn.Column(
                    self._tools,
                    self._notice,
                    self._examples,
                    self._bar,
                    *self._places,
                    Repairs(margin=0, width=0, height=0),
                    self._lifeline,
                    sizing_mode="stretch_width",
                    styles=FULL_HEIGHT,
                )
            ],
            dark_theme=dark,
            sidebar_open=not mobile,
            sidebar_width=340,
            sidebar_resizable=False,
            theme_config={"light": LIGHT, "dark": DARK},
            stylesheets=[PRINT_PAGE],
        )
        follow_own_work(page, self.session.param.running)
        self._lifeline.dark = dark
        page.param.watch(lambda event: setattr(self._lifeline, "dark", event.new), "dark_theme")
        return page

    def _sidebar(self) -> list[Any]:
        self._explained = pmui.Switch(label="Explain every input", description="", margin=(6, 10))
        self._sections = [pn.Column(margin=0, sizing_mode="stretch_width") for _ in INPUTS]
        accordion = pmui.Accordion(
            *zip((SECTION_TITLES[section] for section in INPUTS), self._sections, strict=True),
            active=list(_FIRST_OPEN),
            toggle=False,
            title_variant="subtitle1",
            sizing_mode="stretch_width",
            margin=0,
        )
        self._fill_section(_FIRST_OPEN[0])
        pn.state.onload(lambda: self._fill_section(_FIRST_OPEN[1]))
        accordion.param.watch(lambda event: [self._fill_section(index) for index in event.new], "active")
        self._explained.param.watch(self._explain, "value")
        self._name = pmui.TextInput(
            label="Design", description="", size="small", max_length=200, margin=(14, 10, 0, 10),
            sizing_mode="stretch_width", value=self.session.design.name,
        )  # fmt: skip
        self._name.param.watch(lambda event: self.session.change({"name": event.new}), "value")
        return [self._name, self._explained, accordion]

    def _fill_section(self, index: int) -> None:
        """Build a section's controls when it is first opened: a page of closed sections loads faster."""
        if self._sections[index].objects:
            return
        controls = section_controls(self.session, list(INPUTS)[index])
        for control in controls:
            control.explain(self._explained.value)
        self._controls += controls
        self._sections[index].objects = [control.view for control in controls]

    def _explain(self, event: Any) -> None:
        with pn.io.hold():
            for control in self._controls:
                control.explain(event.new)

    def _follow_name(self, budget: Budget) -> None:
        if self._name.value != budget.design.name:
            self._name.value = budget.design.name

    def _toolbar(self) -> pn.FlexBox:
        session = self.session
        undo = _tool("Undo", "undo", disabled=session.param.can_undo.rx.not_())
        redo = _tool("Redo", "redo", disabled=session.param.can_redo.rx.not_())
        reset, link = _tool("Reset", "restart_alt"), _tool("Link", "link")
        undo.on_click(lambda _: session.undo())
        redo.on_click(lambda _: session.redo())
        reset.on_click(lambda _: session.reset())
        link.on_click(self._put_link)
        examples = _tool("Examples", "auto_awesome_mosaic")
        examples.on_click(self._show_examples)
        self._open = LimitedFileInput(
            lambda why: self._say(f"Not opened. {why}"),
            label="Open",
            accept=".toml",
            icon="folder_open",
            max_file_size=MAX_BYTES,
            **_TOOL_LOOK,
        )
        self._open.param.watch(self._opened, "value")
        self._choice = ReportChoice(session)
        return pn.FlexBox(
            undo,
            redo,
            reset,
            self._open,
            self._download("Save", "save", "toml", self._toml),
            link,
            self._download("HTML report", "description", "html", functools.partial(self._report, "html")),
            self._download("PDF report", "picture_as_pdf", "pdf", functools.partial(self._report, "pdf")),
            examples,
            Tour(margin=2),
            self._choice.view,
            sizing_mode="stretch_width",
            margin=(2, 6, 0, 6),
            css_classes=["tools"],
            stylesheets=[PRINT_NOTHING],
        )

    def _show_examples(self, _: Any) -> None:
        """Open or close the examples, which are made when first asked for."""
        if not self._examples.objects:
            from app.dashboard.gallery import gallery

            self._examples.objects = [gallery(self._adopt_example)]
        self._examples.visible = not self._examples.visible

    def _adopt_example(self, design: Design) -> None:
        self._examples.visible = False
        problem = self.session.adopt(design)
        self._say(f"Not opened. {problem}" if problem else f"{design.name} is open; Undo brings the last one back.",
                  "error" if problem else "info")  # fmt: skip

    def _download(self, label: str, icon: str, suffix: str, make: Callable[[], Awaitable[io.BytesIO]]) -> Any:
        button = pmui.FileDownload(callback=make, filename=f"design.{suffix}", label=label, icon=icon, **_TOOL_LOOK)
        self.session.param.watch(
            lambda event: setattr(button, "filename", f"{_slug(event.new.design.name)}.{suffix}"), "budget"
        )
        button.filename = f"{_slug(self.session.design.name)}.{suffix}"
        return button

    async def _toml(self) -> io.BytesIO:
        return io.BytesIO(format_design(self.session.design).encode("utf-8"))

    async def _report(self, suffix: str) -> io.BytesIO:
        self.session.running = True
        try:
            text, findings = format_design(self.session.design), self._choice.chosen()
            # Told here, in a thread: what was found is large, its sections are not, and they travel to the worker.
            study = await asyncio.to_thread(study_sections, findings, parse_design(text), chapter_key(""))
            return io.BytesIO(await elsewhere(report_of_text, text, f".{suffix}", study))
        finally:
            self.session.running = False

    def _opened(self, event: Any) -> None:
        if not event.new:
            return
        name = str(self._open.filename or "file")
        try:
            problem = self.session.adopt(parse_design(event.new, name))
        except InputError as error:
            problem = error
        self._say(f"Not opened. {problem}" if problem else "")

    def _put_link(self, _: Any) -> None:
        query = to_query(self.session.design)
        location = pn.state.location
        if location:
            location.search = f"?{query}"
            address = f"{location.protocol}//{location.hostname}"
            address += f":{location.port}" if location.port else ""
            link = html.escape(f"{address}{location.pathname}?{query}")
            self._show_notice(f'The link to this design is in the address bar: <a href="{link}">{link}</a>', "info")

    def _say(self, text: str, severity: str = "error") -> None:
        self._show_notice(html.escape(text), severity)

    def _show_notice(self, markup: str, severity: str) -> None:
        self._notice.param.update(object=markup, severity=severity, visible=bool(markup), closed=False)


def is_review_link(query: str) -> bool:
    """Whether a query is for the Review page and not a design's."""
    return query.startswith(("?compare=", "?review="))


_TOOL_LOOK: dict[str, Any] = {"description": "", "variant": "text", "size": "small", "margin": 2}


def _tool(label: str, icon: str, **params: Any) -> pmui.Button:
    return pmui.Button(label=label, icon=icon, **_TOOL_LOOK, **params)


def _slug(name: str) -> str:
    """A design's name as the stem of a file."""
    return re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower()[:60] or "design"

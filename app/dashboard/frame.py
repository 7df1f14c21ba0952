"""The frame of every page: a bar on top with tabs and tools, the design on the left."""

import asyncio
import functools
import html
from pathlib import Path
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui
import param

from app.dashboard.lifeline import Lifeline
from app.dashboard.opening import opening
from app.dashboard.sidebar import Sidebar
from app.dashboard.toolbar import Toolbar
from app.declared import required
from app.document.display import AS_REQUIRED, ONE_SIGMA, display_of
from app.session import Lineage, Session, link_parts
from app.subjects import TABS, tab_index
from app.ui.faults import report_to
from app.ui.html_pane import html_pane
from app.ui.paper import fit_to_paper
from app.ui.remembered import DISPLAY_COOKIE, Remembered
from app.ui.theme import DARK, FULL_HEIGHT, LIGHT, PRINT_PAGE
from app.ui.tour import Tour
from app.ui.turns import debounce, defer, later
from app.upstream.browser import Repairs
from app.upstream.neighbours import follow_session_work
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design.link import from_query

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")
_NARROW = "@media (min-width: 600px) { :host { display: none !important; } }"
"""Sheet of what stands only where the sidebar is a drawer over the page."""
_OF_ITS_OWN = {"allocate", "close", "flight", "simulate", "image", "suborbital"}
_APART = {"theory", "suborbital"}
"""Pages on which the design on the left changes nothing: it is folded there."""
_SAID_OTHERWISE = "This page shows {} in the units of data sheets. Budget and report show {}."
_OVER_THE_PAGE = {
    "position": "fixed", "bottom": "16px", "right": "16px", "z-index": "1250", "width": "auto",
    "max-width": "min(560px, calc(100vw - 32px))", "background": "var(--panel-background-color, Canvas)",
    "box-shadow": "0 4px 18px rgb(0 0 0 / 35%)",
}  # fmt: skip
_SECONDS = 5.0
_SKELETON = '<p class="quiet" role="status">Opening {} …</p>'


class Page(Protocol):
    """The interface of a tab's page."""

    def __panel__(self) -> pn.viewable.Viewable:
        """The page in view."""

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""


class Frame(pn.viewable.Viewer):
    """The page of one session."""

    session = required(Session)

    def __init__(self, session: Session, notice: str = "") -> None:
        super().__init__(session=session)
        self._keep_soon = debounce(self._keep)
        self._opening = opening()
        session.narrow = self._opening.narrow
        self._pages: dict[int, Page] = {}
        self._loaded = False
        self._wanted = ""  # place on the page that the address asked for
        self._addressed = False  # the page is being turned because the address says so
        first = self._opening.page
        self._places = [pn.Column(visible=i == first) for i in range(len(TABS))]
        self._notice = pmui.Alert(
            object=notice, severity="error", closeable=True, visible=bool(notice), margin=0, styles=_OVER_THE_PAGE
        )
        self._said = 0  # messages so far
        self._note = html_pane("", margin=(4, 14, 0, 14))
        self._note.visible = False
        self._lifeline = Lifeline(
            self._come_back, link=session.link, who=str(pn.state.user or ""), margin=0, width=0, height=0
        )
        empty = not (pn.state.location and pn.state.location.search)
        self._sidebar = Sidebar(session, self._lead_to, empty)
        self._toolbar = Toolbar(session, self._say)
        self._toolbar.bar.active = first
        self._open_page(first)
        self._tour = Tour(offers=first == 0, margin=0, sizing_mode="stretch_width")
        self._shell = self._make_shell()
        self._toolbar.bar.param.watch(self._turn, "active")
        if pn.state.curdoc:
            fit_to_paper(pn.state.curdoc)
            report_to(self._say)
            pn.state.on_session_destroyed(lambda _: session.close())
        if pn.state.location:
            # The part of the address after # reaches the server only from the page, before the page can be changed.
            location = pn.state.location
            pn.state.onload(lambda: self._go_to(self._first_page(location)))
            location.param.watch(lambda _: self._go_to(self._first_page(location)) if self._loaded else None, "hash")

    def __panel__(self) -> pmui.Page:
        return self._shell

    @param.depends("session.budget", watch=True)
    def _show(self) -> None:
        page = self._pages.get(self._toolbar.bar.active)  # None where it is not made yet, or could not be
        with pn.io.hold():
            self._clear_message()
            for view in (self._sidebar, page, self._toolbar):
                if view is not None:
                    view.show(self.session.budget)

    @param.depends("session.flown", watch=True)
    def _show_verdict(self) -> None:
        """The flight has ended: what reads the verdict follows, the rest of the page stays."""
        if show := getattr(self._pages.get(self._toolbar.bar.active), "show_verdict", None):
            with pn.io.hold():
                show(self.session.budget)

    @param.depends("session.display", watch=True)
    def _tell_otherwise(self) -> None:
        self._toolbar.bar.display = self.session.display
        self._say_width()
        self._show()
        self._keep_soon()

    @param.depends("session.budget", "session.lineage", "session.study_link", "session.settings", watch=True)
    def _changed(self) -> None:
        self._keep_soon()

    def _keep(self) -> None:
        """Have the browser's tab keep the current design, in case the page is reloaded."""
        base, link = self.session.lineage.base, self.session.link
        key = base.key if base else ""
        with pn.io.hold():
            if self._lifeline.base != key:
                self._lifeline.base = key
            self._lifeline.link = link
            self._toolbar.bar.link = self.session.short_link

    def _come_back(self, link: str, base: str) -> None:
        """Restore what the browser's tab kept before this page was reloaded."""
        of_design, of_study, display = link_parts(link)
        opened = self.session.design
        try:
            self.session.display = display_of(display).word
            problem = self.session.adopt(from_query(of_design))
        except InputError as error:
            problem = error
        if problem:
            self._say(f"The design you had here could not be restored. {problem}")
            return
        self.session.take_studies(of_study)
        if base:
            pn.state.execute(functools.partial(self._come_from, base, self.session.lineage))
        if self.session.design != opened:
            self._say("The design you had on this page is back. Undo restores the one the page opened with.", "info")

    async def _come_from(self, key: str, lineage: Lineage) -> None:
        from app.library.place import library

        try:
            revision = await asyncio.to_thread(lambda: library().revision(key))
        except InputError as error:
            self._say(f"The design you had on this page is back, but its saved revision was not found. {error}")
            return
        if self.session.lineage is lineage:
            self.session.came_from(revision)

    def _say_width(self) -> None:
        """Where figures do not follow the choice of how to show them, say so."""
        design, address = self.session.design, TABS[self._toolbar.bar.active].address
        display = display_of(self.session.display).of(design)
        page = AS_REQUIRED.of(design) if address in ("image", "flight") else ONE_SIGMA
        self._note.visible = display != page and address in _OF_ITS_OWN
        if self._note.visible:
            self._note.object = f'<p class="quiet">{_SAID_OTHERWISE.format(page.spread, display.in_words)}</p>'

    def _turn(self, event: Any) -> None:
        """Show the page's empty place at once and fill it in the next turn of the event loop."""
        if leave := getattr(self._pages.get(event.old), "leave", None):
            leave()
        apart, before = (TABS[index].address in _APART for index in (event.new, event.old))
        with pn.io.hold():
            if apart != before and not self._opening.narrow:
                self._shell.sidebar_open = not apart
            if not self._addressed:  # what was said while the page was loaded stays
                self._clear_message()
            self._say_width()
            self._tour.offers = event.new == 0  # elsewhere it would lie over figures
            for index, place in enumerate(self._places):
                place.visible = index == event.new
            if event.new not in self._pages:
                self._places[event.new].objects = [html_pane(_SKELETON.format(TABS[event.new].title))]
        name, location = TABS[event.new].address, pn.state.location
        # The address that opened this page stays as it is: a new one would clear the browser's Forward history.
        if location and not self._addressed and tab_index(location.hash.lstrip("#").partition("-")[0]) != event.new:
            location.hash = f"#{name}"
        defer(functools.partial(self._fill, event.new))

    def _fill(self, index: int) -> None:
        """Create or update the page that was chosen, and go to the requested place on it."""
        try:
            self._open_page(index)
        finally:  # a page that could not be made leaves its place empty
            if index not in self._pages:
                self._places[index].objects = []
        if index != self._toolbar.bar.active:
            return
        self._pages[index].show(self.session.budget)
        wanted, self._wanted = self._wanted, ""
        go_to = getattr(self._pages[index], "go_to", None)
        if wanted and go_to:
            go_to(wanted)

    def _first_page(self, location: Any) -> str:
        """The first page of a link: the name after #, unless the query decides."""
        if is_review_link(location.search):
            return "review"
        return str(location.hash) or ("suborbital" if self.session.study_link else "")

    def _lead_to(self, address: str) -> None:
        """Show the page of an address, as if it had been opened there."""
        location = pn.state.location
        if location and location.hash != f"#{address}":
            location.hash = f"#{address}"  # which leads there
        else:
            self._go_to(address)

    def _go_to(self, address: str) -> None:
        """Show the page that an address names, and the place on it that may follow a hyphen."""
        self._loaded = True
        name, _, self._wanted = (address.lstrip("#") or TABS[0].address).partition("-")
        index = tab_index(name)
        if index is None:
            return
        if index == self._toolbar.bar.active:
            if self._wanted:
                self._fill(index)
            return
        self._addressed = True
        try:
            self._toolbar.bar.active = index
        finally:
            self._addressed = False

    def _open_page(self, index: int) -> None:
        if index not in self._pages:
            page: Page = TABS[index].load()(self.session)
            self._pages[index] = page
            self._places[index].objects = [page]

    def _make_shell(self) -> pmui.Page:
        dark, narrow = self._opening.dark, self._opening.narrow
        close = pmui.Button(label="Close", icon="close", variant="text", margin=(4, 10), stylesheets=[_NARROW])
        close.on_click(lambda _: page.param.update(sidebar_open=False))
        page: pmui.Page = pmui.Page(
            meta_title="NavBudget",
            header=[self._toolbar],
            sidebar=[*([close] if narrow else []), *self._sidebar.parts],
            main=[
                pn.Column(
                    self._notice,
                    self._note,
                    *self._places,
                    self._tour,
                    Repairs(margin=0, width=0, height=0),
                    self._lifeline,
                    Remembered(DISPLAY_COOKIE, self.session.param.display),
                    styles=FULL_HEIGHT,
                )
            ],
            dark_theme=dark,
            sidebar_open=not narrow and TABS[self._opening.page].address not in _APART,
            sidebar_width=300,
            sidebar_resizable=False,
            theme_config={"light": LIGHT, "dark": DARK},
            stylesheets=[PRINT_PAGE, _SHEET],
        )
        follow_session_work(page, self.session.param.running)
        self._lifeline.dark = dark
        page.param.watch(lambda event: setattr(self._lifeline, "dark", event.new), "dark_theme")
        return page

    def _say(self, text: str, severity: str = "error") -> None:
        """Show a message over the page, one that is no error for some seconds; an empty text removes the last one."""
        self._notice.param.update(object=html.escape(text), severity=severity, visible=bool(text), closed=False)
        self._said += 1
        if severity != "error":
            later(_SECONDS, functools.partial(self._forget, self._said))

    def _forget(self, number: int) -> None:
        """Take back a message, unless another one has followed."""
        if number == self._said:
            self._say("")

    def _clear_message(self) -> None:
        """Take back a message that was of an earlier action."""
        if self._notice.visible:
            self._say("")


def is_review_link(query: str) -> bool:
    """True for a query for the Review page, which is not a design's."""
    return query.startswith(("?compare=", "?review="))

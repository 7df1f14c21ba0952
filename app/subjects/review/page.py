"""The Review page: the library, comparisons, and reviews, which share what was picked."""

from __future__ import annotations

import re
from functools import partial
from urllib.parse import parse_qs

import panel as pn
import panel_material_ui as pmui
import param

from app.library.reviews import MAX_ITEMS
from app.library.store import Library, Revision
from app.session import Session
from app.subjects.review.compare import CompareView
from app.subjects.review.desk import Desk
from app.subjects.review.library_view import LibraryView
from app.subjects.review.room import ReviewRoom
from nav_model.budget import Budget
from nav_model.errors import InputError

_LIBRARY, _COMPARE, _REVIEWS = range(3)


class ReviewPage:
    """Everything below the tab."""

    def __init__(self, session: Session) -> None:
        self._desk = Desk(session)
        self._compared = CompareView(self._desk)
        self._room = ReviewRoom(self._desk)
        self._library = LibraryView(self._desk, self._compare)
        self._views = (self._library.view, self._compared.view, self._room.view)
        # Only the bar is Material, for keyboard and screen reader: figures must not stand inside it.
        self._tabs = pmui.Tabs(
            *((name, pn.Spacer(height=0)) for name in ("Library", "Compare", "Reviews")),
            sizing_mode="stretch_width", margin=(0, 4),
        )  # fmt: skip
        self._place = pn.Column(self._views[_LIBRARY], sizing_mode="stretch_width", margin=0)
        session.param.watch(self._present, "presenting")
        self._tabs.param.watch(self._turned, "active")
        self.view = pn.Column(
            self._desk.author, self._desk.notice, self._tabs, self._place, sizing_mode="stretch_width"
        )
        pn.state.execute(self._library.refresh)
        self._follow_link()

    def show(self, budget: Budget) -> None:
        """The page shows saved designs; the one in force is saved as it stands when asked."""

    def leave(self) -> None:
        """Another page is turned to; what is on this one changes only when that has been drawn."""
        document = pn.state.curdoc
        if document is None:
            self._room.stand_back()
        else:
            document.add_next_tick_callback(self._room.stand_back)

    def _present(self, event: param.parameterized.Event) -> None:
        self._tabs.visible = not event.new

    async def _turned(self, event: object) -> None:
        """A turn brings what others have written meanwhile; what was said about another part goes."""
        self._place.objects = [self._views[self._tabs.active]]
        if self._tabs.active != _COMPARE:
            self._desk.say("")
        if self._tabs.active == _LIBRARY:
            await self._library.refresh()
        elif self._tabs.active == _REVIEWS:
            await self._room.refresh()

    async def _compare(self) -> None:
        if await self._compared.show(self._desk.picked):
            self._tabs.active = _COMPARE

    def _follow_link(self) -> None:
        """Open the comparison or review that the address names."""
        asked = parse_qs((pn.state.location.search if pn.state.location else "").lstrip("?"))
        if "compare" in asked:
            keys = [key for key in asked["compare"][0].split(",") if re.fullmatch(r"[0-9a-f]{16}\.\d{1,9}", key)]
            pn.state.execute(partial(self._compare_linked, keys))
        elif "review" in asked:
            self._tabs.active = _REVIEWS
            pn.state.execute(partial(self._room.open, asked["review"][0]))

    async def _compare_linked(self, keys: list[str]) -> None:
        found = await self._desk.ask(lambda place: _revisions(place, keys), "The link was not used. ")
        if found is not None:
            self._desk.picked = found
            await self._compare()


def _revisions(place: Library, keys: list[str]) -> tuple[Revision, ...]:
    if not 2 <= len(set(keys)) <= MAX_ITEMS:
        raise InputError("link", f"names {len(set(keys))} revisions; a comparison takes 2 to {MAX_ITEMS}")
    return tuple(place.revision(key) for key in dict.fromkeys(keys))

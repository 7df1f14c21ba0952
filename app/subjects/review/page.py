"""The Review page: the library, comparisons, and reviews, which share what was picked."""

import re
from functools import partial
from urllib.parse import parse_qs

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import required
from app.library.reviews import MAX_ITEMS
from app.library.store import Library, Revision
from app.session import Session
from app.subjects.review.compare import CompareView
from app.subjects.review.desk import Desk
from app.subjects.review.library_view import LibraryView
from app.subjects.review.room import ReviewRoom
from app.ui.answer_strip import AnswerStrip
from app.ui.study_settings import StudySettings
from app.ui.theme import PRINT_NOTHING, SWITCH
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.budget import Budget

_LIBRARY, _COMPARE, _REVIEWS = range(3)


class ReviewPage(View):
    """Everything below the tab."""

    session = required(Session)
    opened = param.String(doc="Id of the review in view, so that a reload or a link shows it again.")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        settings = StudySettings(session, "review", self, ("opened",), lambda: self._recall(self.opened))
        self._desk = Desk(session)
        self._compared = CompareView(self._desk)
        self._room = ReviewRoom(self._desk)
        self._library = LibraryView(self._desk, self._compare)
        self._parts = (self._library, self._compared, self._room)
        parts = {"Library": _LIBRARY, "Compare": _COMPARE, "Reviews": _REVIEWS}
        self._switch = pmui.RadioButtonGroup(
            label="Part of the review",
            options=parts,
            value=_LIBRARY,
            margin=(6, 10),
            stylesheets=[PRINT_NOTHING, SWITCH],
        )
        self._place = pn.Column(self._library)
        self._strip = AnswerStrip(self._library.answer, self._desk.name_field)
        for part in self._parts:
            part.param.watch(lambda _: self._tell(), "answer")
        self._switch.param.watch(self._turn, "value")
        self._view = pn.Column(self._strip, self._desk.notice, self._switch, self._place, self._desk.memory)
        pn.state.execute(self._library.refresh)
        self._follow_link()
        if settings.text:
            self._recall(self.opened)

    def show(self, budget: Budget) -> None:
        """The page shows saved designs. The one in force is saved when asked."""
        self._room.follow(wanted=self._at_review)

    @property
    def _at_review(self) -> bool:
        review = self._room.review
        return self._switch.value == _REVIEWS and review is not None and review.signed is None

    def _tell(self) -> None:
        self._strip.show(self._parts[self._switch.value].answer)
        review = self._room.review if self._switch.value == _REVIEWS else None
        self.opened = review.id if review else ""

    def leave(self) -> None:
        """Another page is turned to."""
        self._room.follow(wanted=False)

    async def _turn(self, _: param.parameterized.Event) -> None:
        """On changing tabs, load other people's edits and clear the old message."""
        self._place.objects = [self._parts[self._switch.value]]
        self._tell()
        self._room.follow(wanted=self._at_review)
        if self._switch.value != _COMPARE:
            self._desk.say("")
        if self._switch.value == _LIBRARY:
            await self._library.refresh()
        elif self._switch.value == _REVIEWS:
            await self._room.refresh()

    async def _compare(self) -> None:
        if await self._compared.compare(self._desk.picked):
            self._switch.value = _COMPARE

    def _follow_link(self) -> None:
        """Open the comparison or review that the address names."""
        asked = parse_qs((pn.state.location.search if pn.state.location else "").lstrip("?"))
        if "compare" in asked:
            keys = [key for key in asked["compare"][0].split(",") if re.fullmatch(r"[0-9a-f]{16}\.\d{1,9}", key)]
            pn.state.execute(partial(self._compare_linked, keys))
        elif "review" in asked:
            self._recall(asked["review"][0])

    def _recall(self, review: str) -> None:
        """Turn to a review, or leave what is in view if none is named."""
        if review:
            self._switch.value = _REVIEWS
            pn.state.execute(partial(self._room.open, review))

    async def _compare_linked(self, keys: list[str]) -> None:
        revisions = await self._desk.ask(lambda place: _revisions(place, keys), "The link was not used. ")
        if revisions is not None:
            self._desk.picked = revisions
            await self._compare()


def _revisions(place: Library, keys: list[str]) -> tuple[Revision, ...]:
    if not 2 <= len(set(keys)) <= MAX_ITEMS:
        raise InputError("link", f"names {len(set(keys))} revisions; a comparison takes 2 to {MAX_ITEMS}")
    return tuple(place.revision(key) for key in dict.fromkeys(keys))

"""The reviews' part of the Review page: open, decide in the table, comment, sign, present, report."""

import asyncio
import functools
from collections.abc import Callable, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, optional, required
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.wording import shortened
from app.library.flights import KeptFlight, flights_of
from app.library.place import library
from app.library.reviews import (
    RESULTS,
    Review,
    add_comment,
    decide,
    list_reviews,
    load_review,
    open_review,
    sign,
    version_of,
)
from app.library.store import Library, fly_ahead
from app.library.texts import counted
from app.report import report_bytes
from app.subjects.review import report
from app.subjects.review.desk import LOOK, Desk, button
from app.subjects.review.overview import ending, overview, state_of
from app.subjects.review.rows import decision_row, figure_of, frozen_designs
from app.ui.decision_table import DecisionTable
from app.ui.fields import TextArea, TextInput
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.design.parts import INPUTS

_OPENING = Answer("Reviews", "open", ("Opening the library …",))
_NO_REVIEW = Answer("No review yet", "open", ("Select designs in the library, then start one.",))
_EMPTY = (
    "<p>Select designs in the library, give the review a title, and start it. The review freezes the designs. "
    "The team then comments on each requirement and decides here, until one of them signs the review off.</p>"
)
_NO_FLIGHT = "<p>None yet: the page As flown keeps a flight with the design that it was held against.</p>"
_SUBJECTS = {
    report.subject_label(subject): subject
    for subject in ("", *RESULTS, *(f"{section}.{name}" for section, names in INPUTS.items() for name in names))
}


class ReviewRoom(View):
    """One review at a time, or the list of all."""

    desk = required(Desk)
    review = optional(Review, "The review at hand.")
    answer: Answer = declared(param.ClassSelector(class_=Answer, default=_OPENING, instantiate=False))

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk=desk)
        self._asked: object = None
        self._kept: list[KeptFlight] = []  # of the review at hand
        self._wanted = ""  # id of the review to show
        self._watch: Any = None  # looks for what others add, while a review is in view
        self._design = pmui.Select(label="Design", options={}, width=300, **LOOK)
        self._subject = pmui.Select(label="Comment on", options=_SUBJECTS, value="", width=240, **LOOK)
        self._comment = TextArea(label="Comment", max_length=4000, rows=2, width=330, **LOOK)
        self._all = SortableTable(self._pressed, visible=self.param.review.rx.is_(None), margin=(4, 10))
        self._table = DecisionTable(self._decided, visible=False, sizing_mode="stretch_width", margin=(4, 10))
        self._comments, self._record = html_pane(_EMPTY), html_pane("")
        self._owners, self._flights = html_pane(""), html_pane("")
        self._folded = Folded(
            [
                ("Allocation: owners, and what changed between designs", lambda: self._owners),
                ("As flown: flights held against these designs", lambda: self._flights),
                ("Record: every decision, frozen designs, signature", lambda: self._record),
            ]
        )
        self._title = TextInput(label="Title of a new review", max_length=200, width=200, **LOOK)
        self._begin_button = button("Start review of selected designs", self._begin)
        self._of_review = [
            button("All reviews", self._leave, visible=False),
            *desk.report_buttons("review", "Review report", self._report, visible=False),
        ]
        self._sign_button = button("Sign off", self._ask_to_sign, variant="contained", visible=False)
        self._version = 0  # the version that the person was asked to sign
        self._to_sign, self._yes = html_pane("", margin=(0, 10)), button("", self._sign, variant="contained")
        self._confirm = pn.FlexBox(
            self._to_sign, self._yes, button("Not yet", self._withdraw), align_items="center", visible=False
        )
        self._talk = pn.FlexBox(
            self._design, self._subject, self._comment, button("Add comment", self._say),
            align_items="center", visible=False, margin=(2, 4),
        )  # fmt: skip
        self._details = pn.Column(self._folded, visible=False)
        self._view = pn.Column(
            pn.FlexBox(
                self._of_review[0],
                self._title,
                self._begin_button,
                self._sign_button,
                *self._of_review[1:],
                align_items="center",
                margin=(6, 4),
            ),
            self._confirm,
            self._table,
            self._comments,
            self._talk,
            self._details,
            self._all,
        )

    # --- which review ----------------------------------------------------------------------------------

    async def refresh(self) -> None:
        """Show what others have added meanwhile; where several ask at once, the last one's answer is shown."""
        self._asked = asked = object()
        reviews = await self.desk.ask(list_reviews)
        if reviews is None:
            return
        await fly_ahead(revision for review in reviews for revision in review.revisions)
        table = await asyncio.to_thread(lambda: html_of(overview(reviews)))
        if self._asked is not asked:
            return
        self._all.html = table
        sentence = f"{sum(r.signed is None for r in reviews)} open. Choose one, or start one of selected designs."
        self.review = next((r for r in reviews if r.id == self._wanted), None)
        if self.review is None:
            self.answer = Answer(counted(len(reviews), "review"), "open", (sentence,)) if reviews else _NO_REVIEW
            return
        keys = [item.key for item in self.review.items]
        self._kept = await self.desk.ask(lambda place: flights_of(place, keys)) or []
        if self._asked is asked:
            self._flights.object = html_of(report.flight_table(self.review, self._kept)) if self._kept else _NO_FLIGHT

    async def open(self, review: str) -> None:
        """Show a review by its id; an unknown one is said so."""
        loaded = await self.desk.ask(lambda place: load_review(place, review))
        if loaded is not None:
            self._wanted = loaded.id
            await self.refresh()

    async def _leave(self) -> None:
        self.desk.say("")
        self._wanted = ""
        await self.refresh()

    async def _pressed(self, review: str) -> None:
        self.desk.say("")
        await self.open(review)

    async def _begin(self) -> None:
        keys = [revision.key for revision in self.desk.picked]
        if not keys:
            self.desk.say("Select the designs to review in the library first.", wrong=True)
            return
        title, author = self._title.value or "", self.desk.who
        review = await self.desk.ask(lambda place: open_review(place, title, author, keys))
        if review is not None:
            self._title.value, self._wanted = "", review.id
            await self.refresh()
            self.desk.say(f"Review {review.title} is open with {counted(len(keys), 'frozen design')}.")

    @param.depends("review", watch=True)
    def _show(self) -> None:
        review = self.review
        open_ = review is not None and review.signed is None
        with pn.io.hold():
            self._confirm.visible = False
            for part in self._of_review:
                part.visible = review is not None
            for part in (self._title, self._begin_button):
                part.visible = review is None
            self._table.visible = review is not None
            self._talk.visible = self._sign_button.visible = open_
            self._sign_button.variant = "outlined" if review and review.open_points() else "contained"
            self._details.visible = review is not None
            if review is None:
                self._comments.object = _EMPTY
            else:
                self.answer = state_of(review)
                self._offer(review)
                self._comments.object = html_of(report.comment_table(review)) if review.comments else ""
                self._owners.object = html_of(*report.owner_tables(review))
                self._record.object = html_of(report.decision_table(review), report.audit_table(review))
                self._table.param.update(
                    caption=frozen_designs(review),
                    open=open_,
                    rows=[decision_row(review, *point) for point in review.points()],
                )
        self.follow(open_)

    def follow(self, wanted: bool) -> None:
        """Look every two seconds for what others add to the review in view, or no longer."""
        document = pn.state.curdoc
        if document is None or wanted == (self._watch is not None):
            return
        if wanted:
            self._watch = pn.state.add_periodic_callback(self._look, period=2000)
        else:
            self._watch.stop()
            self._watch = None

    async def _look(self) -> None:
        review = self.review
        if review is None:
            return
        try:
            version = await asyncio.to_thread(lambda: version_of(library(), review.id))
        except InputError:  # the next look, or what the person does, says so
            return
        if self.review is review and version != review.version:
            await self.refresh()

    def _offer(self, review: Review) -> None:
        """Offer the subjects of a comment; the chosen one stays chosen where it can."""
        self._design.options = {
            f"D{item.place}: {shortened(r.name, 30)}": item.place
            for item, r in zip(review.items, review.revisions, strict=True)
        }
        self._design.value = self._design.value or 1

    # --- what people do --------------------------------------------------------------------------------

    async def _change(self, work: Callable[[Library, str, str], Review]) -> bool:
        review, author = self.review, self.desk.who
        if review is None:
            return False
        changed = await self.desk.ask(lambda place: work(place, review.id, author))
        if changed is not None:
            self.desk.say("")
        await self.refresh()  # after a refusal as well: it may be of what somebody else did meanwhile
        return changed is not None

    def _decided(self, form: dict[str, Any]) -> None:
        pn.state.execute(functools.partial(self._judge, form))

    async def _judge(self, form: dict[str, Any]) -> None:
        """Decide as the table says. It says as well which decision was in view: never the one that the server has in
        the meantime, which the person may not have seen."""
        review = self.review
        if review is None:
            return
        known = review.points()
        if form["do"] == "accept":
            points = [tuple(point) for point in form.get("points", ()) if tuple(point) in known]
            work = functools.partial(_decide_all, [(*point, True, "", 0) for point in points], review)
        else:
            point, seen, reason = (form.get("place"), form.get("name")), form.get("seen"), form.get("reason")
            if point not in known or not isinstance(seen, int) or not isinstance(reason, str):
                return
            work = functools.partial(_decide_all, [(*point, bool(form.get("accepted")), reason, seen)], review)
        await self._change(work)

    async def _say(self) -> None:
        design, subject, text = self._design.value, self._subject.value or "", self._comment.value or ""
        if await self._change(
            lambda library, review, author: add_comment(library, review, design, subject, author, text)
        ):
            self._comment.value = ""

    async def _ask_to_sign(self) -> None:
        """Say how the review would end, and which waivers are the signer's, before it is final."""
        review, who = self.review, self.desk.who
        if review is None:
            return
        self._version = review.version
        if not who or review.open_points() or not review.intact:
            await self._sign()  # which says what is missing
            return
        self.desk.say("")
        waived = review.waivers()
        mine = sum(waiver.author == who for waiver in waived)
        warned = (
            f"You wrote {'this waiver' if len(waived) == 1 else f'{mine} of {len(waived)} waivers'}. " if mine else ""
        )
        tone = "warn" if mine or review.rejected() else "open"
        answer = Answer("", tone, (f"{warned}A signed review never changes.",))
        self._to_sign.object = html_of(answer)
        self._yes.label = f"Sign as {who} (outcome: {ending(review)[1]})"
        self._confirm.visible = True

    async def _withdraw(self) -> None:
        self._confirm.visible = False

    async def _sign(self) -> None:
        if await self._change(lambda library, review, author: sign(library, review, author, self._version)):
            self.desk.say("Signed off and sealed; this review never changes again.")

    # --- report -------------------------------------------------------------------------------------

    async def _report(self, suffix: str) -> bytes:
        assert self.review is not None  # its button is hidden without one
        budgets = [revision.budget() for revision in self.review.revisions]
        front, sections = report.front_page(self.review), report.audit_sections(self.review, self._kept)
        return await run_in_pool(report_bytes, budgets, suffix, None, sections, (), front)


def _decide_all(
    wanted: Sequence[tuple[int, str, bool, str, int]], review_seen: Review, place: Library, review: str, author: str
) -> Review:
    """Decisions one by one, of place, requirement, accepted, reason, and the number of the decision seen."""
    changed = review_seen
    for item, name, accepted, reason, seen in wanted:
        figure = figure_of(review_seen, item, name)
        changed = decide(place, review, item, name, accepted, author, reason, figure=figure, seen=seen)
    return changed

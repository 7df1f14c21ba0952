"""The reviews' part of the Review page: open one, comment, decide, sign, present, take away."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Callable

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, held
from app.document.pane import html_of
from app.document.wording import shortened
from app.library.reviews import RESULTS, Review, add_comment, decide, list_reviews, load_review, open_review, sign
from app.library.store import Library
from app.report import report_bytes
from app.subjects.review import report
from app.subjects.review.desk import LOOK, Desk, button
from app.subjects.review.overview import overview, state_of
from app.subjects.review.slide import Point, point_of, slide
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.work.pool import elsewhere
from nav_model.budget.result import Check
from nav_model.design.parts import INPUTS

_NONE = "choose a review"
_EMPTY = (
    "<p>A review freezes the picked revisions with the program's version and their hashes. Tick designs in the "
    "library, give the review a title, and open it; then everybody comments and decides here, requirement by "
    "requirement, until somebody signs it off.</p>"
)
_SUBJECTS = {
    report.subject_label(subject): subject
    for subject in ("", *RESULTS, *(f"{section}.{name}" for section, names in INPUTS.items() for name in names))
}


class ReviewRoom(pn.viewable.Viewer):
    """One review at a time, or the list of all."""

    desk = held(Desk)
    review: Review | None = declared(
        param.ClassSelector(
            class_=Review, default=None, allow_None=True, instantiate=False, doc="The review at hand."
        )
    )

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk=desk)
        presenting = desk.session.param.presenting
        self._asked: object = None
        self._wanted = ""  # id of the review to show
        self._about = pmui.Select(label="Requirement", options={}, width=330, **LOOK)
        self._reason = pmui.TextInput(label="Reason (needed to reject)", max_length=1000, width=300, **LOOK)
        self._design = pmui.Select(label="Design", options={}, width=200, **LOOK)
        self._subject = pmui.Select(label="Comment on", options=_SUBJECTS, value="", width=240, **LOOK)
        self._comment = pmui.TextAreaInput(label="Comment", max_length=4000, rows=2, width=330, **LOOK)
        self._slide = html_pane("")
        self._all = SortableTable(visible=self.param.review.rx.is_(None), sizing_mode="stretch_width", margin=(4, 10))
        self._status = html_pane(_EMPTY)
        self._status.visible = presenting.rx.not_()
        shown = {"visible": presenting.rx.not_()}
        self._choice = pmui.Select(label="Review", options={_NONE: ""}, value="", width=340, **LOOK, **shown)
        self._title = pmui.TextInput(label="Title of a new review", max_length=200, width=240, **LOOK, **shown)
        self._of_review = [
            button("All reviews", self._leave, visible=False),
            *desk.report_buttons("review", "Review report", self._report, visible=False),
        ]
        self._deciding = [
            self._reason,
            button("Accept", functools.partial(self._judge, True), variant="contained"),
            button("Reject", functools.partial(self._judge, False)),
        ]
        self._decide = pn.FlexBox(
            button("Previous", functools.partial(self._turn, -1)),
            button("Next", functools.partial(self._turn, 1)),
            self._about,
            *self._deciding,
            align_items="center",
            visible=False,
            margin=(2, 4),
        )
        self._talk = pn.FlexBox(
            self._design, self._subject, self._comment, button("Add comment", self._say),
            button("Sign off", self._sign), align_items="center", visible=False, margin=(2, 4),
        )  # fmt: skip
        switch = pmui.Switch.from_param(presenting, label="Presenter view", margin=(12, 8))
        self._view = pn.Column(
            pn.FlexBox(
                self._of_review[0],
                self._choice,
                self._title,
                button("Open a review of the picked", self._begin, **shown),
                switch,
                *self._of_review[1:],
                align_items="center",
                margin=(6, 4),
            ),
            self._slide,
            self._decide,
            self._talk,
            self._all,
            self._status,
        )
        self._choice.param.watch(self._chosen, "value")
        self._all.param.watch(self._pressed, "chosen")
        self._about.param.watch(self._draw_slide, "value")

    def __panel__(self) -> pn.Column:
        return self._view

    # --- which review ----------------------------------------------------------------------------------

    async def refresh(self) -> None:
        """Show what others have added meanwhile; where several ask at once, the last one's answer is shown."""
        self._asked = asked = object()
        reviews = await self.desk.ask(list_reviews)
        if reviews is None:
            return
        table = await asyncio.to_thread(lambda: html_of(overview(reviews)))
        if self._asked is not asked:
            return
        options = {_NONE: ""}
        for review in reviews:
            state = "signed off" if review.signed else "open"
            options[f"{shortened(review.title, 60)} ({state}, {review.opened[:10]}, {review.id[:4]})"] = review.id
        if self._choice.options != options:
            self._choice.options = options
        self._all.html = table
        self.review = next((own for own in reviews if own.id == self._wanted), None)

    async def open(self, review: str) -> None:
        """Show a review by its id; an unknown one is said so."""
        found = await self.desk.ask(lambda place: load_review(place, review))
        if found is not None:
            self._wanted = found.id
            await self.refresh()

    async def _chosen(self, _: param.parameterized.Event) -> None:
        chosen = self._choice.value or ""
        if chosen != self._wanted:
            await (self.open(chosen) if chosen else self._leave())

    async def _leave(self) -> None:
        self.desk.say("")
        self._wanted = ""
        await self.refresh()

    async def _pressed(self, event: param.parameterized.Event) -> None:
        if event.new:
            self.desk.say("")
            self._all.chosen = ""
            await self.open(event.new)

    async def _begin(self) -> None:
        keys = [revision.key for revision in self.desk.picked]
        if not keys:
            self.desk.say("Tick the revisions to review in the library first.", wrong=True)
            return
        title, author = self._title.value or "", self.desk.who
        review = await self.desk.ask(lambda place: open_review(place, title, author, keys))
        if review is not None:
            self._title.value, self._wanted = "", review.id
            await self.refresh()
            self.desk.say(f"Review {review.title} is open; {len(keys)} revisions are frozen.")

    @param.depends("desk.session.presenting", watch=True)
    def _present(self) -> None:
        self.desk.say("")
        self._show()

    @param.depends("review", watch=True)
    def _show(self) -> None:
        review, presenting = self.review, self.desk.session.presenting
        open_ = review is not None and review.signed is None
        with pn.io.hold():
            for part in self._of_review:
                part.visible = review is not None and not presenting
            self._decide.visible = review is not None and (open_ or presenting)
            self._talk.visible = open_ and not presenting
            for part in self._deciding:
                part.visible = open_
            self._choice.value = "" if review is None else review.id
            if review is None:
                self._slide.object, self._status.object = "", _EMPTY
                return
            self._offer(review)
            tables = (report.status_table, report.comment_table, report.decision_table, report.audit_table)
            self._status.object = html_of(state_of(review), *(table(review) for table in tables))
            self._draw_slide()

    def _offer(self, review: Review) -> None:
        """What can be decided and commented on; what was chosen stays chosen where it can."""
        points = {
            f"D{item.place}: {check.label}{_mark(review, item.place, check)}": (item.place, check.name)
            for item, revision in zip(review.items, review.revisions, strict=True)
            for check in revision.budget().verdict.checks
        }
        at = self._about.value
        self._about.options = points
        self._about.value = at if at in points.values() else next(iter(points.values()), None)
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

    async def _judge(self, accepted: bool) -> None:
        point, reason = self._point(), self._reason.value or ""
        if point is None or self.review is None:
            self.desk.say("The designs under review state no requirement to decide on.", wrong=True)
            return
        place, check = point.place, point.check
        standing = self.review.standing(place, check.name)
        seen = standing.number if standing else 0
        done = await self._change(
            lambda library, review, author: decide(
                library, review, place, check.name, accepted, author, reason, figure=point.figure, seen=seen
            )
        )
        if done:
            self._reason.value = ""
            await self._turn(1)

    async def _say(self) -> None:
        design, subject, said = self._design.value, self._subject.value or "", self._comment.value or ""
        if await self._change(
            lambda library, review, author: add_comment(library, review, design, subject, author, said)
        ):
            self._comment.value = ""

    async def _sign(self) -> None:
        seen = self.review.version if self.review else 0
        if await self._change(lambda library, review, author: sign(library, review, author, seen)):
            self.desk.say("Signed off and sealed; this review never changes again.")

    async def _turn(self, step: int) -> None:
        points = list(self._about.options.values())
        if points:
            self._about.value = points[(points.index(self._about.value) + step) % len(points)]

    # --- presenter view and report ---------------------------------------------------------------------

    def _point(self) -> Point | None:
        """The requirement at hand."""
        if self.review is None or self._about.value is None:
            return None
        return point_of(self.review, *self._about.value)

    def _draw_slide(self, *_: param.parameterized.Event) -> None:
        point = self._point() if self.desk.session.presenting else None
        if point is None or self.review is None:
            self._slide.object = ""
            return
        points = list(self._about.options.values())
        self._slide.object = slide(self.review, point, points.index(self._about.value) + 1, len(points))

    async def _report(self, suffix: str) -> bytes:
        assert self.review is not None  # its button is hidden without one
        budgets = [revision.budget() for revision in self.review.revisions]
        return await elsewhere(report_bytes, budgets, suffix, None, report.audit_sections(self.review))


def _mark(review: Review, place: int, check: Check) -> str:
    standing = review.standing(place, check.name)
    return "" if standing is None else " ✓" if standing.accepted else " ✗"

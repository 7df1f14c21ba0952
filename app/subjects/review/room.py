"""The reviews' part of the Review page: open one, comment, decide, sign, present, take away."""

from __future__ import annotations

import asyncio
import functools
import io
from collections.abc import Callable
from html import escape

import panel as pn
import panel_material_ui as pmui
import param

from app.document.numbers import signed_percent
from app.document.pane import html_of
from app.document.wording import requirement_quantity, shortened
from app.library.reviews import (
    RESULTS,
    Review,
    add_comment,
    decide,
    list_reviews,
    load_review,
    open_review,
    sign,
)
from app.library.store import Library
from app.library.texts import counted
from app.report import report_bytes
from app.subjects.review.desk import BUTTON, LOOK, Desk, button
from app.subjects.review.overview import overview
from app.subjects.review.report import (
    audit_sections,
    audit_table,
    comment_table,
    decision_table,
    status_table,
    subject_label,
)
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
    subject_label(subject): subject
    for subject in ("", *RESULTS, *(f"{section}.{name}" for section, names in INPUTS.items() for name in names))
}


class ReviewRoom:
    """One review at a time."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._review: Review | None = None
        self._asked: object = None
        self._title = pmui.TextInput(label="Title of a new review", max_length=200, width=240, **LOOK)
        self._choice = pmui.Select(label="Review", options={_NONE: ""}, value="", width=340, **LOOK)
        self._present = pmui.Switch(label="Presenter view", description="", margin=(12, 8))
        self._about = pmui.Select(label="Requirement", options={}, width=330, **LOOK)
        self._reason = pmui.TextInput(label="Reason (needed to reject)", max_length=1000, width=300, **LOOK)
        self._design = pmui.Select(label="Design", options={}, width=200, **LOOK)
        self._subject = pmui.Select(label="Comment on", options=_SUBJECTS, value="", width=240, **LOOK)
        self._comment = pmui.TextAreaInput(label="Comment", max_length=4000, rows=2, width=330, **LOOK)
        self._slide = html_pane("")
        self._all = SortableTable(visible=False, sizing_mode="stretch_width", margin=(4, 10))
        self._status = html_pane(_EMPTY)
        self._reports = [
            pmui.FileDownload(
                callback=functools.partial(self._report, kind), filename=f"review.{kind}",
                label=f"Review report ({kind.upper()})", visible=False, **BUTTON,
            )
            for kind in ("html", "pdf")
        ]  # fmt: skip
        self._open = button("Open a review of the picked", self._begin)
        self._back = button("All reviews", self._leave, visible=False)
        self._decide = pn.FlexBox(
            button("Previous", functools.partial(self._turn, -1)),
            button("Next", functools.partial(self._turn, 1)),
            self._about,
            self._reason,
            button("Accept", functools.partial(self._judge, True), variant="contained"),
            button("Reject", functools.partial(self._judge, False)),
            align_items="center",
            visible=False,
            margin=(2, 4),
        )
        self._talk = pn.FlexBox(
            self._design, self._subject, self._comment, button("Add comment", self._say),
            button("Sign off", self._sign), align_items="center", visible=False, margin=(2, 4),
        )  # fmt: skip
        self.view = pn.Column(
            pn.FlexBox(
                self._back, self._choice, self._title, self._open, self._present,
                *self._reports, align_items="center", margin=(6, 4),
            ),
            self._slide,
            self._decide,
            self._talk,
            self._all,
            self._status,
            sizing_mode="stretch_width",
        )  # fmt: skip
        self._choice.param.watch(self._chosen, "value")
        self._all.param.watch(self._pressed, "chosen")
        self._about.param.watch(lambda _: self._draw_slide(), "value")
        self._present.param.watch(self._presented, "value")

    def stand_back(self) -> None:
        """End the presenter view: somebody turned away from the reviews."""
        self._present.value = False

    def _presented(self, event: param.parameterized.Event) -> None:
        self._desk.say("")
        self._desk.session.presenting = event.new
        self._desk.author.visible = not event.new
        self._show(self._review)

    # --- which review ----------------------------------------------------------------------------------

    async def refresh(self) -> None:
        """Show what others have added meanwhile; where several ask at once, the last one's answer is shown."""
        self._asked = asked = object()
        reviews = await self._desk.ask(list_reviews)
        if reviews is None:
            return
        table = await asyncio.to_thread(overview, reviews)
        if self._asked is not asked:
            return
        options = {_NONE: ""}
        for review in reviews:
            state = "signed off" if review.signed else "open"
            options[f"{shortened(review.title, 60)} ({state}, {review.opened[:10]}, {review.id[:4]})"] = review.id
        if self._choice.options != options:
            self._choice.options = options
        self._all.html = table
        at_hand = next((own for own in reviews if self._review is not None and own.id == self._review.id), None)
        self._show(at_hand)

    async def open(self, review: str) -> None:
        """Show a review by its id; an unknown one is said so."""
        found = await self._desk.ask(lambda place: load_review(place, review))
        if found is not None:
            self._review = found
            await self.refresh()

    async def _chosen(self, event: object) -> None:
        if not self._choice.value and self._review is not None:
            await self._leave()
        elif self._choice.value and (self._review is None or self._choice.value != self._review.id):
            await self.open(self._choice.value)

    async def _leave(self) -> None:
        self._desk.say("")
        self._review = None
        await self.refresh()

    async def _pressed(self, event: param.parameterized.Event) -> None:
        if event.new:
            self._desk.say("")
            self._all.chosen = ""
            await self.open(event.new)

    async def _begin(self) -> None:
        keys = [revision.key for revision in self._desk.picked]
        if not keys:
            self._desk.say("Tick the revisions to review in the library first.", wrong=True)
            return
        title, author = self._title.value or "", self._desk.who
        review = await self._desk.ask(lambda place: open_review(place, title, author, keys))
        if review is not None:
            self._title.value = ""
            self._review = review
            await self.refresh()
            self._desk.say(f"Review {review.title} is open; {len(keys)} revisions are frozen.")

    def _show(self, review: Review | None) -> None:
        self._review = review
        self._all.visible = review is None
        if review is None:
            with pn.io.hold():
                self._slide.object, self._status.object, self._choice.value = "", _EMPTY, ""
                for part in (self._decide, self._talk, self._back, *self._reports):
                    part.visible = False
            return
        points = {
            f"D{item.place}: {check.label}{_mark(review, item.place, check)}": (item.place, check.name)
            for item, revision in zip(review.items, review.revisions, strict=True)
            for check in revision.budget().verdict.checks
        }
        at = self._about.value
        with pn.io.hold():
            self._choice.value = review.id
            self._about.options = points
            self._about.value = at if at in points.values() else next(iter(points.values()), None)
            self._design.options = {
                f"D{item.place}: {shortened(r.name, 30)}": item.place
                for item, r in zip(review.items, review.revisions, strict=True)
            }
            self._design.value = self._design.value or 1
            open_ = review.signed is None
            self._decide.visible = open_ or self._present.value
            self._talk.visible = open_ and not self._present.value
            for part in (self._back, self._choice, self._title, self._open, *self._reports):
                part.visible = not self._present.value
            for part in self._decide[3:]:
                part.visible = open_
            tables = (status_table(review), comment_table(review), decision_table(review), audit_table(review))
            self._status.visible = not self._present.value
            self._status.object = _headline(review) + html_of(*tables)
            self._draw_slide()

    # --- what people do --------------------------------------------------------------------------------

    async def _change(self, work: Callable[[Library, str, str], Review]) -> bool:
        review, author = self._review, self._desk.who
        if review is None:
            return False
        changed = await self._desk.ask(lambda place: work(place, review.id, author))
        if changed is not None:
            self._desk.say("")
            self._review = changed
        await self.refresh()  # after a refusal as well: it may be of what somebody else did meanwhile
        return changed is not None

    async def _judge(self, accepted: bool) -> None:
        point, reason = self._point(), self._reason.value or ""
        if point is None or self._review is None:
            self._desk.say("The designs under review state no requirement to decide on.", wrong=True)
            return
        place, check, figure = point
        standing = self._review.standing(place, check.name)
        seen = standing.number if standing else 0
        done = await self._change(
            lambda library, review, author: decide(
                library, review, place, check.name, accepted, author, reason, figure=figure, seen=seen
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
        seen = self._review.version if self._review else 0
        if await self._change(lambda library, review, author: sign(library, review, author, seen)):
            self._desk.say("Signed off and sealed; this review never changes again.")

    async def _turn(self, step: int) -> None:
        points = list(self._about.options.values())
        if points:
            self._about.value = points[(points.index(self._about.value) + step) % len(points)]

    # --- presenter view and report ---------------------------------------------------------------------

    def _point(self) -> tuple[int, Check, str] | None:
        """The requirement at hand: its place, its check, and value against limit in words."""
        if self._review is None or self._about.value is None:
            return None
        place, name = self._about.value
        budget = self._review.revisions[place - 1].budget()
        check = next(check for check in budget.verdict.checks if check.name == name)
        value, limit = (requirement_quantity(budget.design, name, x) for x in (check.value, check.limit))
        return place, check, f"{value} against {limit} at {budget.verdict.confidence:g}σ"

    def _draw_slide(self) -> None:
        point = self._point() if self._present.value else None
        if point is None or self._review is None:
            self._slide.object = ""
            return
        place, check, figure = point
        standing = self._review.standing(place, check.name)
        decided = (
            "Open"
            if standing is None
            else f"{'✓ Accepted' if standing.accepted else '✗ Rejected'} by {standing.author}"
        )
        names = list(self._about.options.values())
        self._slide.object = (
            f'<section class="slide" aria-live="polite"><p class="quiet">{escape(self._review.title)} · decision '
            f"{names.index(self._about.value) + 1} of {len(names)}</p>"
            f"<p>D{place}: {escape(self._review.revisions[place - 1].name)}</p><h2>{escape(check.label)}</h2>"
            f'<p class="figure num">{escape(figure)}</p>{_gauge(check)}'
            f"<p>{'✓ met' if check.met else '✗ not met'}, margin {signed_percent(check.margin)}; dominated by "
            f"{escape(check.sensor)}</p><p><b>{escape(decided)}</b></p></section>"
        )

    async def _report(self, kind: str) -> io.BytesIO:
        assert self._review is not None
        self._desk.session.running = True
        try:
            budgets = [revision.budget() for revision in self._review.revisions]
            return io.BytesIO(await elsewhere(report_bytes, budgets, f".{kind}", None, audit_sections(self._review)))
        finally:
            self._desk.session.running = False


def _gauge(check: Check) -> str:
    """Value against limit as a bar; the words beside it say the same."""
    full = 1.08 * max(check.value, check.limit)
    value, limit = (100 * x / full for x in (check.value, check.limit))
    return (
        f'<div class="gauge" aria-hidden="true"><div style="width:{value:.1f}%"></div>'
        f'<i style="left:{limit:.1f}%"></i></div>'
    )


def _mark(review: Review, place: int, check: Check) -> str:
    standing = review.standing(place, check.name)
    return "" if standing is None else " ✓" if standing.accepted else " ✗"


def _headline(review: Review) -> str:
    left = len(review.open_points())
    if not review.intact:
        css, mark, word = "bad", "✗", "Changed outside the program: do not rely on it"
    elif review.signed:
        css, mark, word = "good", "✓", f"Signed off by {review.signed_by}"
    else:
        css, mark, word = "open", "–", f"Open, {left} to decide" if left else "Open, all decided: can be signed"
    return (
        f'<div class="strip {css}"><h2>{escape(review.title)}</h2><p><span aria-hidden="true">{mark}</span> '
        f"<b>{escape(word)}</b></p><p>{counted(len(review.items), 'design')}, "
        f"{counted(len(review.rejected()), 'requirement')} rejected, "
        f"{counted(len(review.comments), 'comment')}</p></div>"
    )

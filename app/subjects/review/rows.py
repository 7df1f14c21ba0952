"""Requirements of a review as the rows that are decided on."""

from typing import Any

from app.document.verdict import CheckWords, check_words, judged, met_cell
from app.document.wording import shortened
from app.library.reviews import Review
from app.library.texts import moment
from app.subjects.review.report import decided_word
from nav_model.budget.verdict import Check, Verdict


def figure_of(review: Review, place: int, name: str) -> str:
    """Value against limit, as a decision on the requirement keeps it."""
    verdict, _, words = _judged(review, place, name)
    return f"{words.value} against {words.limit} {judged(verdict)}"


def _judged(review: Review, place: int, name: str) -> tuple[Verdict, Check, CheckWords]:
    """The requirement of this name of the design at `place`, and the verdict that it is a part of."""
    budget = review.revisions[place - 1].budget()
    check = next(check for check in budget.verdict.checks if check.name == name)
    return budget.verdict, check, check_words(budget.design, check)


def _label(review: Review, place: int) -> str:
    """Label of a design before a name; a single one has none."""
    return f"D{place}: " if len(review.items) > 1 else ""


def frozen_designs(review: Review) -> str:
    """A sentence on the designs of the rows of decisions, and on how their figures are judged."""
    return "; ".join(
        f"{_label(review, item.place)}{shortened(rev.name, 40)}, revision {rev.number}, "
        f"{judged(rev.budget().verdict)}"
        for item, rev in zip(review.items, review.revisions, strict=True)
    )


def decision_row(review: Review, place: int, name: str) -> dict[str, Any]:
    """The requirement as a row of `DecisionTable`."""
    verdict, check, words = _judged(review, place, name)
    standing = review.standing(place, name)
    decision = "open" if standing is None else (
        f"{decided_word(standing, met=check.met).text} by {standing.author}, {moment(standing.decided)}"
    )  # fmt: skip
    state = met_cell(check, verdict)
    return {
        "place": place, "name": name, "label": f"{_label(review, place)}{check.label}",
        "value": words.value, "limit": words.limit,
        "met": check.met, "verdict": state.text, "tone": state.tone, "seen": standing.number if standing else 0,
        "decision": decision, "reason": standing.reason if standing else "",
    }  # fmt: skip

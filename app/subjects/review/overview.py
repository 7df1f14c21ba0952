"""Status of reviews: a table of all, and one in a line."""

from collections.abc import Sequence

from app.document.blocks import Answer, Cell, Column, Row, TableBlock, table
from app.library.reviews import Review
from app.library.texts import counted, moment

_HEADS = ("Review", "State", "Designs", "To decide", "Rejected", "Comments", "Opened", "Last change")
_COUNTS = _HEADS[2:6]
_MARKS: dict[str, str] = {"good": "✓", "warn": "⚠", "bad": "✗"}


def overview(reviews: Sequence[Review]) -> TableBlock:
    """All reviews, to sort and to open one from: the value of a row is the review's id."""
    columns = tuple(Column(head, numeric=head in _COUNTS, sortable=True) for head in _HEADS)
    return table("reviews", "All reviews", columns, map(_row, reviews))


def state_of(review: Review) -> Answer:
    """Status of a review: its mark and words, and its contents."""
    undecided = len(review.open_points())
    tone, state = "open", f"Open, {undecided} to decide" if undecided else "Ready to sign"
    if not review.intact:
        tone, state = "bad", f"✗ {review.doubt[0].upper()}{review.doubt[1:]}: do not rely on it"
    elif review.signed:
        tone, ended = ending(review)
        state = f"{_MARKS[tone]} Signed by {review.signed_by}: {ended}"
    counts = (
        counted(len(review.items), "design"),
        f"{counted(len(review.rejected()), 'requirement')} rejected",
        *([counted(len(waived), "waiver")] if (waived := review.waivers()) else ()),
        counted(len(review.comments), "comment"),
    )
    return Answer(review.title, tone, (state, ", ".join(counts)))


def ending(review: Review) -> tuple[str, str]:
    """Ending of a review in which all is decided, by a signature: its colour, and the word."""
    if review.rejected():
        return "bad", "rejected"
    if waived := review.waivers():
        return "warn", f"accepted with {counted(len(waived), 'waiver')}"
    return "good", "accepted"


def last_change(review: Review) -> tuple[str, str]:
    """When something was last added, and by whom."""
    happened = [(review.opened, review.author)]
    happened += [(comment.written, comment.author) for comment in review.comments]
    happened += [(decision.decided, decision.author) for decision in review.decisions]
    if review.signed and review.signed_by:
        happened.append((review.signed, review.signed_by))
    return max(happened)


def _row(review: Review) -> Row:
    counts = (len(review.items), len(review.open_points()), len(review.rejected()), len(review.comments))
    moments = ((review.opened, review.author), last_change(review))
    return (
        Cell(review.title, value=review.id),
        state_of(review).sentences[0],
        *(str(count) for count in counts),
        *(Cell(f"{moment(when)}\n{who}", sort=when) for when, who in moments),
    )

"""All reviews at a glance, as a table to sort and to open one from."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from app.library.reviews import Review
from app.library.texts import moment

_HEADS = ("Review", "State", "Designs", "To decide", "Rejected", "Comments", "Opened", "Last change")
_COUNTS = range(2, 6)


def overview(reviews: Sequence[Review]) -> str:
    """HTML for a `SortableTable`; a review's title is a button with its id."""
    heads = "".join(
        f'<th scope="col"{_number(i)}><button type="button">{name}</button></th>' for i, name in enumerate(_HEADS)
    )
    rows = "".join(_row(review) for review in reviews)
    return (
        '<div class="scroll" tabindex="0" role="region" aria-label="All reviews"><table class="checks">'
        f"<caption>All reviews</caption><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def state_of(review: Review) -> str:
    """Where a review stands, in words with their mark."""
    if not review.intact:
        return "✗ changed outside the program"
    if review.signed:
        return f"✓ signed off by {review.signed_by}"
    return "– open" if review.open_points() else "– all decided, to be signed"


def last_change(review: Review) -> tuple[str, str]:
    """When something was last added, and by whom."""
    happened = [(review.opened, review.author)]
    happened += [(comment.written, comment.author) for comment in review.comments]
    happened += [(decision.decided, decision.author) for decision in review.decisions]
    if review.signed and review.signed_by:
        happened.append((review.signed, review.signed_by))
    return max(happened)


def _row(review: Review) -> str:
    title = escape(review.title)
    counts = (len(review.items), len(review.open_points()), len(review.rejected()), len(review.comments))
    moments = ((review.opened, review.author), last_change(review))
    button = f'<button type="button" value="{escape(review.id)}">{title}</button>'
    cells = [
        f'<th scope="row" data-sort="{title}">{button}</th>',
        f"<td>{escape(state_of(review))}</td>",
        *(f'<td class="num">{count}</td>' for count in counts),
        *(f'<td data-sort="{escape(when)}">{moment(when)}<br>{escape(who)}</td>' for when, who in moments),
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _number(column: int) -> str:
    return ' class="num"' if column in _COUNTS else ""

"""Reviews: a frozen set of revisions, comments, decisions, and a signature.

A review holds revisions (which never change) by key, content hash and the hash of their text, with the version of
the program it was opened with. Comments and decisions are only ever added; the latest decision on a requirement
counts. Signing seals the whole content with a SHA-256 and signs that (`app.library.seal`); after that it cannot be
changed, and a change made directly in the database is found when the review is read.
"""

import hashlib
import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from typing import Any

from sqlalchemy import Connection, RowMapping, text

from app.library.seal import CHANGED, doubt_about, signature_of
from app.library.store import Conflict, Library, Revision, as_revision, find, insert, new_id, now
from app.library.texts import clean, moment
from nav_model.base.errors import InputError
from nav_model.design.figures import REQUIRED, label_of
from nav_model.design.parts import all_keys

MAX_ITEMS = 6
"""The most revisions one review, or one comparison, takes: what fits side by side."""
RESULTS = tuple(REQUIRED)
"""Names of the results that a comment or a decision can be about."""


@dataclass(frozen=True)
class Item:
    """One frozen revision; ``place`` counts from 1."""

    place: int
    key: str
    content_hash: str
    text_hash: str


@dataclass(frozen=True)
class Comment:
    """A comment; ``subject`` is a dotted input, a result's name, or empty for the design as a whole."""

    number: int
    place: int
    subject: str
    author: str
    written: str
    comment: str


@dataclass(frozen=True)
class Decision:
    """Acceptance or rejection of one requirement; ``figure`` is value and limit at that time."""

    number: int
    place: int
    requirement: str
    accepted: bool
    figure: str
    author: str
    decided: str
    reason: str


@dataclass(frozen=True)
class Review:
    """A review. ``version`` counts additions; ``doubt`` says why hashes, seal or signature are not valid, if so."""

    id: str
    title: str
    author: str
    opened: str
    product: str
    version: int
    items: tuple[Item, ...]
    revisions: tuple[Revision, ...]
    comments: tuple[Comment, ...]
    decisions: tuple[Decision, ...]
    signed_by: str | None
    signed: str | None
    seal: str | None
    signature: str | None
    doubt: str

    @property
    def intact(self) -> bool:
        """True if it is unchanged since it was frozen, and its signature, if any, is valid."""
        return not self.doubt

    def standing(self, place: int, requirement: str) -> Decision | None:
        """The latest decision on a requirement of an item."""
        decisions = [d for d in self.decisions if (d.place, d.requirement) == (place, requirement)]
        return decisions[-1] if decisions else None

    def points(self) -> list[tuple[int, str]]:
        """Everything to decide on: an item's place and a requirement's name."""
        return [
            (item.place, name)
            for item, revision in zip(self.items, self.revisions, strict=True)
            for name in revision.checks()
        ]

    def open_points(self) -> list[tuple[int, str]]:
        """The `points` without a decision."""
        return [point for point in self.points() if self.standing(*point) is None]

    def met(self, place: int, requirement: str) -> bool:
        """True if an item meets a requirement it states."""
        checks = self.revisions[place - 1].budget().verdict.checks
        return next(check.met for check in checks if check.name == requirement)

    def waivers(self) -> list[Decision]:
        """The latest decisions that accept an unmet requirement; each has a reason."""
        made = (self.standing(*point) for point in self.points())
        return [d for d in made if d is not None and d.accepted and not self.met(d.place, d.requirement)]

    def rejected(self) -> list[tuple[int, str]]:
        """The `points` whose latest decision is a rejection."""
        return [point for point in self.points() if (made := self.standing(*point)) is not None and not made.accepted]


def open_review(library: Library, title: str, author: str, keys: Sequence[str]) -> Review:
    """Freeze revisions, by key, into a new review.

    Raises
    ------
    InputError
        For no revision or more than `MAX_ITEMS`, an unknown one, or a title or author missing.
    """
    keys = list(dict.fromkeys(keys))
    if not 1 <= len(keys) <= MAX_ITEMS:
        raise InputError("review", f"{len(keys)} revisions are selected. A review takes 1 to {MAX_ITEMS}.")
    review = new_id()
    head = {
        "id": review, "title": clean("title", title, required=True), "author": clean("author", author, required=True),
        "opened": now(), "product": version("navbudget"),
    }  # fmt: skip
    with library.write() as connection:
        insert(connection, "reviews", head)
        for place, key in enumerate(keys, start=1):
            revision = find(connection, key)
            insert(
                connection, "review_items",
                {"review": review, "place": place, "design": revision.design, "number": revision.number,
                 "content_hash": revision.content_hash, "text_hash": _sha256(revision.text)},
            )  # fmt: skip
        return _load(connection, review)


def list_reviews(library: Library) -> tuple[Review, ...]:
    """Every review, latest first."""
    with library.read() as connection:
        return _reviews(connection)


def load_review(library: Library, review: str) -> Review:
    """A review by its id.

    Raises
    ------
    InputError
        If there is none.
    """
    with library.read() as connection:
        return _load(connection, review)


def version_of(library: Library, review: str) -> int:
    """Number of additions to a review so far; 0 for one that does not exist."""
    with library.read() as connection:
        version = connection.execute(
            text("SELECT version FROM reviews WHERE id = :review"), {"review": review}
        ).scalar()
        return int(version or 0)


def add_comment(library: Library, review: str, place: int, subject: str, author: str, comment: str) -> Review:
    """Comment on an input (dotted key), a result (its name) or, with an empty subject, the whole design.

    Raises
    ------
    InputError
        If the review is signed or unknown, or a text is missing or too long.
    """
    if subject not in ("", *RESULTS, *all_keys()):
        raise InputError("subject", f"{subject[:60]!r} is neither an input nor a result")
    row = {
        "place": place, "subject": subject, "author": clean("author", author, required=True), "written": now(),
        "comment": clean("comment", comment, required=True),
    }  # fmt: skip
    return _add(library, review, "review_comments", row)


def decide(
    library: Library, review: str, place: int, requirement: str, accepted: bool, author: str, reason: str = "",
    *, figure: str = "", seen: int | None = None,
) -> Review:  # fmt: skip
    """Accept or reject a requirement of an item. A rejection needs a reason, and so does a waiver, the acceptance of
    an unmet requirement. The latest decision counts.

    `seen` is the number of the latest decision on the user's screen, 0 for none; None accepts any.

    Raises
    ------
    Conflict
        If another decision is in force than the one seen; nothing is decided.
    InputError
        If the review is signed or unknown, the design has no such requirement, or a text is missing or too long.
    """
    row = {
        "place": place, "requirement": requirement, "accepted": int(accepted), "figure": figure,
        "author": clean("author", author, required=True), "decided": now(),
        "reason": clean("reason", reason, required=not accepted),
    }  # fmt: skip
    return _add(library, review, "review_decisions", row, seen)


def sign(library: Library, review: str, author: str, seen: int) -> Review:
    """Sign a review, which closes it. `seen` is the version on the signer's screen.

    Raises
    ------
    Conflict
        If something was added since; nothing is signed.
    InputError
        If it is signed or unknown, damaged, or a requirement is not decided.
    """
    signer = clean("author", author, required=True)
    with library.write() as connection:
        now_there = _locked(connection, review)
        if now_there.version != seen:
            raise Conflict(
                "review", "Somebody added a comment or a decision after you opened it. Look again before you sign."
            )
        undecided = now_there.open_points()
        if undecided:
            place, name = undecided[0]
            first = f"{label_of(name)} (D{place})"
            need = "1 requirement still needs" if len(undecided) == 1 else f"{len(undecided)} requirements still need"
            raise InputError("review", f"{need} a decision. Next: {first}.")
        connection.execute(
            text(
                "UPDATE reviews SET signed_by = :signer, signed = :signed, version = version + 1 WHERE id = :review"
            ),
            {"signer": signer, "signed": now(), "review": review},
        )
        seal = _seal(_load(connection, review))
        connection.execute(
            text("UPDATE reviews SET seal = :seal, signature = :signature WHERE id = :review"),
            {"seal": seal, "signature": signature_of(seal), "review": review},
        )
        return _load(connection, review)


def _add(library: Library, review: str, table: str, row: dict[str, Any], seen: int | None = None) -> Review:
    with library.write() as connection:
        before = _locked(connection, review)
        if row["place"] not in {item.place for item in before.items}:
            raise InputError("review", f"has no design number {row['place']!r}")
        if table == "review_decisions":
            revision = before.revisions[row["place"] - 1]
            if row["requirement"] not in revision.checks():
                raise InputError("requirement", f"{row['requirement'][:60]!r} is not one this design states")
            standing = before.standing(row["place"], row["requirement"])
            if standing is not None and seen is not None and standing.number != seen:
                word = "accepted" if standing.accepted else f"rejected ({standing.reason})"
                raise Conflict("review", f"{standing.author} {word} this after you opened it. Look again and decide.")
            if not row["reason"] and not before.met(row["place"], row["requirement"]):
                raise InputError("reason", "This requirement is not met. Enter why it is accepted: a waiver.")
        entries = before.comments if table == "review_comments" else before.decisions
        insert(connection, table, {**row, "review": review, "number": len(entries) + 1})
        connection.execute(text("UPDATE reviews SET version = version + 1 WHERE id = :review"), {"review": review})
        return _load(connection, review)


def _locked(connection: Connection, review: str) -> Review:
    """The review, which nobody else changes during this transaction; refuses one that is signed or damaged."""
    if "\0" not in review:
        connection.execute(text("UPDATE reviews SET version = version WHERE id = :review"), {"review": review})
    there = _load(connection, review)
    if there.signed:
        raise InputError(
            "review", f"{there.title!r} was signed by {there.signed_by}, {moment(there.signed)}. It never changes."
        )
    if not there.intact:
        raise InputError("review", f"It was {CHANGED}, so nothing can be added. Open a new review.")
    return there


def _load(connection: Connection, review: str) -> Review:
    reviews = () if "\0" in review else _reviews(connection, review)
    if not reviews:
        raise InputError("review", f"{review[:60]!r} is not in the library")
    return reviews[0]


def _reviews(connection: Connection, review: str | None = None) -> tuple[Review, ...]:
    """The review of this id, or all, latest first."""
    only = {} if review is None else {"review": review}

    def rows(query: str, key: str, order: str) -> Sequence[RowMapping]:
        where = "" if review is None else f"WHERE {key} = :review"
        return connection.execute(text(f"{query} {where} ORDER BY {order}"), only).mappings().all()

    def by_review(table: str, order: str) -> dict[str, list[dict[str, Any]]]:
        groups: dict[str, list[dict[str, Any]]] = defaultdict(list)
        for row in rows(f"SELECT * FROM {table}", "review", order):
            groups[row["review"]].append({name: value for name, value in row.items() if name != "review"})
        return groups

    frozen = "SELECT r.* FROM revisions AS r JOIN review_items AS i ON i.design = r.design AND i.number = r.number"
    heads = rows("SELECT * FROM reviews", "id", "opened DESC, id")
    items, comments = by_review("review_items", "place"), by_review("review_comments", "number")
    decisions = by_review("review_decisions", "number")
    revisions = {revision.key: revision for revision in map(as_revision, rows(frozen, "i.review", "i.place"))}
    return tuple(
        _whole_or_in_doubt(dict(head), items[head["id"]], comments[head["id"]], decisions[head["id"]], revisions)
        for head in heads
        if head["id"] is not None  # as SQLite lets a key be: nobody could open it
    )


def _whole_or_in_doubt(head: dict[str, Any], *parts: Any) -> Review:
    """A review from its rows; without what it is about, and in doubt, where they are damaged: one must not take the
    others from everybody."""
    try:
        return _assembled(head, *parts)
    except (KeyError, ValueError):  # a revision is gone, or is no design any more; a place that no item has
        return Review(**head, items=(), revisions=(), comments=(), decisions=(), doubt=CHANGED)


def _assembled(
    head: dict[str, Any], item_rows: Sequence[dict[str, Any]], comment_rows: Sequence[dict[str, Any]],
    decision_rows: Sequence[dict[str, Any]], by_key: Mapping[str, Revision],
) -> Review:  # fmt: skip
    """A review from its rows, in order, and the revisions that its items name."""
    items = tuple(
        Item(row["place"], f"{row['design']}.{row['number']}", row["content_hash"], row["text_hash"])
        for row in item_rows
    )
    loaded = Review(
        **head,
        items=items,
        revisions=tuple(by_key[item.key] for item in items),
        comments=tuple(Comment(**row) for row in comment_rows),
        decisions=tuple(Decision(**{**row, "accepted": bool(row["accepted"])}) for row in decision_rows),
        doubt="",
    )
    loaded.points()  # each revision is a design
    places = list(range(1, len(items) + 1))
    if [item.place for item in items] != places:
        raise ValueError("the items are not numbered from 1")
    return replace(loaded, doubt=_doubt(loaded))


def _doubt(review: Review) -> str:
    frozen = all(
        item.text_hash == _sha256(revision.text) and item.content_hash == revision.content_hash
        for item, revision in zip(review.items, review.revisions, strict=True)
    )
    if not frozen:
        return CHANGED
    if review.signed is None:
        # Each addition counts, and so does the signature: without all that it left, there is one too many.
        added = 1 + len(review.comments) + len(review.decisions)
        signed = review.signed_by or review.seal or review.signature
        return CHANGED if signed or review.version != added else ""
    seal = _seal(review)
    if review.seal == (earlier := _seal(review, _SEALED_AT_FIRST)):  # by a program before the verdict was sealed
        seal = earlier
    return CHANGED if review.signature and review.seal != seal else doubt_about(seal, review.signature)


_NOT_SEALED = ("seal", "signature", "doubt", "revisions")
_SEALED_AT_FIRST = ("name", "author", "note", "saved", "origin")  # the text has its hash among the items
_SEALED_OF_REVISIONS = (*_SEALED_AT_FIRST, "closes", "verdict", "product")


def _seal(review: Review, of_revisions: Sequence[str] = _SEALED_OF_REVISIONS) -> str:
    """SHA-256 over everything that is signed, except the seal itself."""
    content = {name: value for name, value in asdict(review).items() if name not in _NOT_SEALED}
    content["revisions"] = [{name: getattr(revision, name) for name in of_revisions} for revision in review.revisions]
    return _sha256(json.dumps(content, sort_keys=True, ensure_ascii=False))


def _sha256(content: str) -> str:
    return hashlib.sha256(content.encode()).hexdigest()

"""The record of a review, as sections of a report: frozen designs, comments, decisions, signature."""

from collections.abc import Sequence
from importlib.metadata import version

from app.document.allocation import owners_table
from app.document.blocks import Answer, Block, Cell, CellLike, Chapter, Row, Section, TableBlock, Text, numbers, table
from app.document.numbers import NONE
from app.document.verdict import check_words, met_cell
from app.document.wording import printable, shortened
from app.library.flights import KeptFlight
from app.library.reviews import Comment, Decision, Review
from app.library.texts import counted, moment
from app.report.comparison import entry_differences
from nav_model.budget import Budget
from nav_model.budget.verdict import Check
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import label_of
from nav_model.design.parts import INPUTS


def audit_sections(review: Review, flights: Sequence[KeptFlight] = ()) -> tuple[Section, ...]:
    """The sections behind the designs: owners where a design has its own, flown flights, comments, decisions, the
    record."""
    shares = any(revision.budget().design.entries.tables() for revision in review.revisions)
    return (
        *((Section("audit-owners", "Allocation and owners", owner_tables(review)),) if shares else ()),
        *((Section("audit-flown", "As flown", (flight_table(review, flights),)),) if flights else ()),
        Section("audit-log", "Comments and decisions in order", (comment_table(review), decision_table(review))),
        Section("audit-record", "Record of the review", (audit_table(review),)),
    )


def owner_tables(review: Review) -> tuple[Block, ...]:
    """Who answers for which part of each requirement, and what of that is not the same in every design."""
    budgets = [revision.budget() for revision in review.revisions]
    labels = [f"D{item.place}" for item in review.items]
    differing = entry_differences([budget.design for budget in budgets])
    same = Text("Contributors, requirements of your own and allocation are the same in every design.")
    heads = ("Entry", 1), *((label, 1) for label in labels)
    changed = table("review-changed", "What differs between the designs", heads,
                    ((name, *texts) for name, texts in differing.items()))  # fmt: skip
    return owners_table(budgets, labels), changed if differing else same


def flight_table(review: Review, flights: Sequence[KeptFlight]) -> TableBlock:
    """Flights that were held against a design of the review, with their files by hash."""
    places = {item.key: item.place for item in review.items}
    rows = (
        (
            f"D{places[flight.key]}",
            Cell(flight.verdict, tone=_FLOWN.get(flight.verdict, "")),
            flight.sentence,
            "\n".join(f"{name}, SHA-256 {digest[:16]}" for name, digest in flight.files),
            f"{flight.author}, {moment(flight.saved)}",
        )
        for flight in flights
    )
    heads = ("Design", "Verdict", ("In words", 2.4), ("Files", 1.6), ("By", 1.2))
    return table("review-flown", "Flights held against these designs", heads, rows)


def outcome(review: Review) -> Answer:
    """End of the review, or where it is: one word, and what it depends on."""
    undecided, waived, rejected = len(review.open_points()), len(review.waivers()), len(review.rejected())
    signed = f"Signed off by {review.signed_by}, {moment(review.signed)}." if review.signed else "Not signed."
    if not review.intact:
        return Answer("✗ Do not rely on this review", "bad", (f"{review.doubt}.", signed))
    if rejected:
        return Answer(f"✗ Rejected: {counted(rejected, 'requirement')}", "bad", (signed,))
    if undecided:
        return Answer(f"Open: {counted(undecided, 'decision')} to make", "open", (signed,))
    if waived:
        return Answer(f"⚠ Accepted with {counted(waived, 'waiver')}", "warn", (signed,))
    return Answer("✓ Accepted", "good", (signed,))


def front_page(review: Review) -> Chapter:
    """Page 1 of the review's report: its name, the outcome, who signed, and on which conditions."""
    names = "; ".join(
        f"D{item.place}: {revision.name}, revision {revision.number}"
        for item, revision in zip(review.items, review.revisions, strict=True)
    )
    authors = [entry.author for entry in review.decisions] + [entry.author for entry in review.comments]
    reviewers = dict.fromkeys(authors)
    facts = (
        ("Review", review.title),
        ("Designs", names),
        ("Values", "In the units of data sheets, at the confidence of the requirements, whatever the display choice"),
        ("Opened", f"{review.author}, {moment(review.opened)}"),
        ("Reviewers", "; ".join(reviewers) or "none yet"),
        ("Signed off", f"{review.signed_by}, {moment(review.signed)}" if review.signed else "not signed"),
        ("Seal (SHA-256)", review.seal or "none before the signature"),
    )
    return Chapter(
        key="review",
        kind="Design review",
        title=review.title,
        running=f"Review: {shortened(review.title)}",
        verdict=outcome(review),
        facts=tuple((label, printable(text)) for label, text in facts),
        sections=(
            Section("review-conditions", "Conditions", (conditions(review),)),
            Section("review-requirements", "Requirements and decisions", (status_table(review),)),
        ),
    )


def conditions(review: Review) -> Block:
    """Requirements accepted although they are not met, and those rejected, each with its reason."""
    standing = [decision for point in review.rejected() if (decision := review.standing(*point))]
    rows = tuple(_decided(review, decision) for decision in (*review.waivers(), *standing))
    if not rows:
        return Text("None: every requirement decided so far is met and accepted.")
    return table("review-conditions", "Waivers and rejections", _DECIDED, rows)


_FLOWN = {"met": "good", "not met": "bad"}
_DECIDED = (("Requirement", 1.2), "Decision", ("Value", 1.2), ("By", 1.2), ("Reason", 1.4))


def _decided(review: Review, decision: Decision) -> Row:
    """A decision, with the figure it was taken on."""
    return (
        f"D{decision.place}: {subject_label(decision.requirement)}",
        decided_word(decision, met=review.met(decision.place, decision.requirement)),
        decision.figure or NONE,
        f"{decision.author}, {moment(decision.decided)}",
        decision.reason or NONE,
    )


_PROMISE = (
    "The review is as it was when a NavBudget with this key signed it. This does not prove who signed, "
    "nor protect against access to the key file, which is kept outside the database."
)


def audit_table(review: Review) -> TableBlock:
    """Record of the review: what was frozen, by whom, with which program, and whether it is signed and intact."""
    signed = f"{review.signed_by}, {moment(review.signed)}" if review.signed else "not signed"
    intact = Cell("verified", tone="good") if review.intact else Cell(f"BROKEN: {review.doubt}", tone="bad")
    rows: list[Row] = [
        ("Review", review.id),
        ("Opened", f"{review.author}, {moment(review.opened)}"),
        ("Program", _program(review.product)),
        ("Signed off", signed),
        ("Seal (SHA-256)", review.seal or "none before the signature"),
        ("Signature (Ed25519)", review.signature or "none"),
        ("Record", intact),
        ("What the signature promises", _PROMISE),
    ]
    for item, revision in zip(review.items, review.revisions, strict=True):
        origin = ", imported" if revision.origin else ""
        rows.append((f"D{item.place}: {revision.name}, revision {revision.number}", item.content_hash))
        rows.append(("saved", f"{revision.author}, {moment(revision.saved)}{origin}"))
        if revision.note:
            rows.append(("note", revision.note))
    return table("audit-table", "Audit", (("Subject", 1), ("Record", 2)), rows)


def _program(frozen: str) -> CellLike:
    """With which version the review was opened; figures are always computed by the version that shows them."""
    here = version("navbudget")
    if frozen == here:
        return f"NavBudget {frozen}"
    versions = f"NavBudget {frozen}; values here are computed by {here}, values in decisions are as they were"
    return Cell(versions, tone="warn")


def status_table(review: Review) -> TableBlock:
    """Every requirement of every design with the decision in force."""
    rows: list[Row] = []
    for item, revision in zip(review.items, review.revisions, strict=True):
        budget = revision.budget()
        rows.append((f"D{item.place}: {revision.name}, revision {revision.number}",))
        rows += [_status(budget, check, review.standing(item.place, check.name)) for check in budget.verdict.checks]
    return table(
        "audit-status",
        "Requirements and decisions",
        (("Requirement", 1.4), *numbers("Value", "Limit"), "Verdict", "Decision", ("By", 1.2), ("Reason", 1.4)),
        rows,
        f"{undecided} to decide." if (undecided := len(review.open_points())) else "",
    )


def _status(budget: Budget, check: Check, decision: Decision | None) -> Row:
    words = check_words(budget.design, check)
    decided, by, reason = Cell("open", tone="warn"), NONE, NONE
    if decision is not None:
        decided, by = decided_word(decision, met=check.met), f"{decision.author}, {moment(decision.decided)}"
        reason = decision.reason or NONE
    return check.label, words.value, words.limit, met_cell(check, budget.verdict), decided, by, reason


def decided_word(decision: Decision, *, met: bool) -> Cell:
    """A decision in words: what is accepted although it is not ``met`` is waived."""
    if not decision.accepted:
        return Cell("✗ rejected", tone="bad")
    return Cell("✓ accepted", tone="good") if met else Cell("⚠ accepted with a waiver", tone="warn")


def comment_table(review: Review) -> TableBlock:
    """Comments, in order."""
    rows = tuple(
        (str(c.number), f"D{c.place}: {subject_label(c.subject)}", c.comment, _by(c)) for c in review.comments
    )
    return table(
        "audit-comments",
        "Comments",
        ("No.", ("About", 1.2), ("Comment", 2.4), ("By", 1.2)),
        rows,
        "" if rows else "No comment.",
    )


def _by(comment: Comment) -> str:
    return f"{comment.author}, {moment(comment.written)}"


def decision_table(review: Review) -> TableBlock:
    """Every decision ever taken, in order, with the figure it was taken on."""
    rows = tuple((str(decision.number), *_decided(review, decision)) for decision in review.decisions)
    return table("audit-decisions", "Decisions in order", ("No.", *_DECIDED), rows, "" if rows else "No decision.")


def subject_label(subject: str) -> str:
    """Subject of a comment or a decision, in words."""
    section, _, name = subject.partition(".")
    if name in INPUTS.get(section, {}):
        return f"input {in_sentence(INPUTS[section][name].label)}"
    return label_of(subject) if subject else "the design as a whole"

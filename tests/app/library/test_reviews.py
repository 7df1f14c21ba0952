"""Reviews: frozen revisions, comments, decisions, and a valid signature."""

from collections.abc import Callable
from pathlib import Path

import pytest
from behind_its_back import decided, sql
from sqlalchemy import create_engine, text

from app.document.pane import html_of
from app.library.reviews import Review, add_comment, decide, list_reviews, load_review, open_review, sign, version_of
from app.library.store import Conflict, Library
from app.subjects.review.overview import overview, state_of
from nav_model.base.errors import InputError
from nav_model.budget import Budget


@pytest.fixture
def review(library: Library, mems: Budget, tactical: Budget) -> Review:
    keys = [library.save(budget, "Ann").key for budget in (mems, tactical)]
    return open_review(library, "PDR <script>", "Ann", keys)


def test_a_review_freezes_revisions_by_hash(library: Library, review: Review, mems: Budget, tactical: Budget) -> None:
    assert [item.content_hash for item in review.items] == [mems.design.content_hash, tactical.design.content_hash]
    design = review.revisions[0].design
    library.save(tactical, "Eve", design=design, base=1)  # life goes on in the library
    again = load_review(library, review.id)
    assert again == review
    assert again.intact
    assert list_reviews(library) == (review,)
    assert len(review.open_points()) == len(mems.verdict.checks) + len(tactical.verdict.checks) > 0


def test_comments_and_decisions_add_up_and_the_latest_decision_counts(library: Library, review: Review) -> None:
    review = add_comment(library, review.id, 1, "imu.angle_random_walk", "Bob", "<img src=x onerror=alert(1)>")
    review = add_comment(library, review.id, 2, "quadratic_phase", "Eve", "tight")
    assert [(c.number, c.place, c.subject) for c in review.comments] == [
        (1, 1, "imu.angle_random_walk"),
        (2, 2, "quadratic_phase"),
    ]
    name = review.open_points()[0][1]
    decide(library, review.id, 1, name, True, "Bob", "autofocus removes it")
    review = decide(library, review.id, 1, name, False, "Eve", "no margin", figure="9 m / 10 m")
    standing = review.standing(1, name)
    assert (standing.accepted, standing.author, standing.figure) == (False, "Eve", "9 m / 10 m")
    assert len(review.decisions) == 2


def test_a_decision_nobody_has_seen_is_not_overruled(library: Library, review: Review) -> None:
    name = review.open_points()[0][1]
    review = decide(library, review.id, 1, name, False, "Bob", "no margin", seen=0)
    with pytest.raises(Conflict, match=r"Bob rejected \(no margin\) this after you opened it"):
        decide(library, review.id, 1, name, True, "Ann", seen=0)
    assert load_review(library, review.id) == review
    standing = review.standing(1, name)
    review = decide(library, review.id, 1, name, True, "Ann", "autofocus removes it", seen=standing.number)
    assert review.rejected() == []


def test_accepting_what_is_not_met_takes_a_reason_and_is_a_waiver(library: Library, review: Review) -> None:
    over = next(
        name for place, name in review.points() if place == 1 and name == "quadratic_phase"
    )  # 182° against 90°
    met = next(name for place, name in review.points() if place == 1 and name == "horizontal_position")  # 0.4 of 2 m
    with pytest.raises(InputError, match=r"reason: This requirement is not met\. Enter why"):
        decide(library, review.id, 1, over, True, "Ann", "  ")
    assert load_review(library, review.id) == review
    before = version_of(library, review.id)
    review = decide(library, review.id, 1, met, True, "Ann")
    assert review.waivers() == []
    review = decide(library, review.id, 1, over, True, "Ann", "autofocus removes it")
    assert [(waiver.requirement, waiver.reason) for waiver in review.waivers()] == [(over, "autofocus removes it")]
    assert version_of(library, review.id) == review.version == before + 2
    assert decide(library, review.id, 1, over, False, "Bob", "too large").waivers() == []


def test_what_makes_no_sense_is_refused(library: Library, review: Review) -> None:
    name = review.open_points()[0][1]
    with pytest.raises(InputError, match="reason: Enter a reason"):
        decide(library, review.id, 1, name, False, "Eve")
    with pytest.raises(InputError, match="not one this design states"):
        decide(library, review.id, 1, "colour", True, "Eve")
    with pytest.raises(InputError, match="no design number 3"):
        decide(library, review.id, 3, name, True, "Eve")
    with pytest.raises(InputError, match="neither an input nor a result"):
        add_comment(library, review.id, 1, "imu.colour", "Eve", "x")
    with pytest.raises(InputError, match="comment: 4001"):
        add_comment(library, review.id, 1, "", "Eve", "x" * 4001)
    with pytest.raises(InputError, match="author: Enter your name"):
        add_comment(library, review.id, 1, "", "", "x")
    with pytest.raises(InputError, match="takes 1 to 6"):
        open_review(library, "t", "Ann", [])
    with pytest.raises(InputError, match="no revision"):
        open_review(library, "t", "Ann", ["nothing.1"])
    for forged in ("nothing", "\0", "' OR 1=1 --"):
        with pytest.raises(InputError, match="not in the library"):
            add_comment(library, forged, 1, "", "Eve", "x")
    assert load_review(library, review.id) == review
    assert len(list_reviews(library)) == 1


def test_a_signed_review_never_changes(library: Library, review: Review) -> None:
    review = decide(library, review.id, 1, "quadratic_phase", False, "Bob", "too large")
    with pytest.raises(InputError, match=r"still need a decision\. Next: Detrended phase \(D1\)"):
        sign(library, review.id, "Chief", review.version)
    review = decided(library, review)
    with pytest.raises(Conflict, match="after you opened it"):
        sign(library, review.id, "Chief", review.version - 1)
    signed = sign(library, review.id, "Chief", review.version)
    assert (signed.signed_by, signed.intact) == ("Chief", True)
    assert len(signed.seal) == 64
    name = signed.decisions[0].requirement
    for attempt in (
        lambda: add_comment(library, review.id, 1, "", "Eve", "too late"),
        lambda: decide(library, review.id, 1, name, False, "Eve", "too late"),
        lambda: sign(library, review.id, "Eve", signed.version),
    ):
        with pytest.raises(InputError, match=r"signed by Chief, .* never changes"):
            attempt()
    assert load_review(library, review.id) == signed


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE review_decisions SET accepted = 1 - accepted WHERE number = 1",
        "DELETE FROM review_decisions WHERE number = (SELECT max(number) FROM review_decisions)",
        "INSERT INTO review_comments SELECT id, 1, 1, '', 'Eve', '', 'late' FROM reviews",
        "UPDATE reviews SET signed_by = 'Eve'",
        "UPDATE reviews SET seal = NULL",
        "UPDATE reviews SET signed = NULL",
        "UPDATE reviews SET signed = NULL, signed_by = NULL, seal = NULL, signature = NULL",
        "UPDATE revisions SET closes = 1 - closes",
        "UPDATE revisions SET verdict = 'Fine.'",
        "UPDATE revisions SET product = '0'",
        "UPDATE review_items SET content_hash = '0' WHERE place = 1",
        "UPDATE revisions SET text = replace(text, '0', '1')",
    ],
)
def test_a_change_behind_the_librarys_back_is_found(
    library: Library, review: Review, tmp_path: Path, change: str
) -> None:
    review = decided(library, review)
    assert sign(library, review.id, "Chief", review.version).intact
    sql(tmp_path / "library.db", change)
    assert not load_review(library, review.id).intact


def test_two_reviewers_at_once_lose_no_comment(
    library: Library, review: Review, at_once: Callable[..., None]
) -> None:
    def talk(author: str) -> None:
        for i in range(10):
            add_comment(library, review.id, 1, "", author, str(i))

    at_once(talk, "Bob", "Eve")
    comments = load_review(library, review.id).comments
    assert sorted((c.author, c.comment) for c in comments) == sorted(
        (a, str(i)) for a in ("Bob", "Eve") for i in range(10)
    )
    assert [c.number for c in comments] == list(range(1, 21))


def _overview_cells(review: Review) -> list[str]:
    """State, designs, to decide, rejected, comments, opened, last change, as a reader sees them."""
    return [cell.text.replace("\n", " ") for cell in overview([review]).rows[0][1:]]


def test_the_overview_counts_what_is_open_decided_rejected_and_signed(library: Library, review: Review) -> None:
    remaining = len(review.open_points())
    assert _overview_cells(review)[:5] == [f"Open, {remaining} to decide", "2", str(remaining), "0", "0"]
    assert _overview_cells(review)[6].endswith("Ann")
    review = add_comment(library, review.id, 1, "", "Bob", "late")
    review = decided(library, review)  # what is not met is rejected
    failed = sum(not check.met for revision in review.revisions for check in revision.budget().verdict.checks)
    assert failed > 0
    assert _overview_cells(review)[:5] == ["Ready to sign", "2", "0", str(failed), "1"]
    assert _overview_cells(review)[6].endswith("Bob")
    review = sign(library, review.id, "Ann", review.version)
    assert _overview_cells(review)[0] == "✗ Signed by Ann: rejected"
    assert state_of(review).tone == "bad"
    assert _overview_cells(review)[6].endswith("Ann")
    assert "<script>" not in html_of(overview([review]))


def test_the_list_holds_what_each_review_says_of_itself(library: Library, review: Review, mems: Budget) -> None:
    other = open_review(library, "Second", "Bob", [library.save(mems, "Bob").key, review.items[1].key])
    add_comment(library, other.id, 2, "tilt", "Bob", "shared with the first")
    signed = decided(library, review)
    sign(library, review.id, "Ann", signed.version)
    listed = list_reviews(library)
    assert {entry.id for entry in listed} == {review.id, other.id}
    with pytest.raises(InputError):
        load_review(library, "")
    assert all(entry == load_review(library, entry.id) for entry in listed)
    with library.write() as connection:
        connection.execute(text("UPDATE review_comments SET comment = 'fine'"))
        connection.execute(text("UPDATE review_decisions SET reason = 'fine'"))
    assert {entry.id: entry.intact for entry in list_reviews(library)} == {review.id: False, other.id: True}


@pytest.mark.parametrize(
    "damage",
    [
        "DELETE FROM revisions WHERE rowid = (SELECT max(rowid) FROM revisions)",
        "UPDATE revisions SET number = 9 WHERE rowid = (SELECT max(rowid) FROM revisions)",
        "UPDATE revisions SET text = 'no design' WHERE rowid = (SELECT max(rowid) FROM revisions)",
        "UPDATE revisions SET text = CAST(x'ff' AS TEXT) WHERE rowid = (SELECT max(rowid) FROM revisions)",
        "UPDATE review_items SET place = 7 WHERE rowid = (SELECT max(rowid) FROM review_items)",
        "UPDATE reviews SET version = x'ff' WHERE title = 'Damaged'",
    ],
)
def test_one_damaged_row_takes_no_other_review(library: Library, review: Review, mems: Budget, damage: str) -> None:
    damaged = open_review(library, "Damaged", "Bob", [library.save(mems, "Bob").key])
    with create_engine(library.engine.url).begin() as connection:  # without foreign keys
        connection.execute(text(damage))
    listed = {entry.id: entry for entry in list_reviews(library)}
    assert len(overview(listed.values()).rows) == 2
    assert set(listed) == {review.id, damaged.id}
    assert listed[damaged.id].title == "Damaged"
    assert listed[review.id].intact
    assert not listed[damaged.id].intact
    assert not load_review(library, damaged.id).intact
    with pytest.raises(InputError):
        sign(library, damaged.id, "Bob", damaged.version)


def test_a_review_without_an_id_takes_no_other(library: Library, review: Review) -> None:
    open_review(library, "Damaged", "Bob", [review.items[0].key])
    with create_engine(library.engine.url).begin() as connection:  # without foreign keys
        connection.execute(text("UPDATE reviews SET id = NULL WHERE title = 'Damaged'"))
    assert [entry.id for entry in list_reviews(library)] == [review.id]
    assert len(overview(list_reviews(library)).rows) == 1


def test_a_review_that_was_signed_is_not_opened_again(library: Library, review: Review) -> None:
    sign(library, review.id, "Chief", decided(library, review).version)
    with library.write() as connection:
        connection.execute(text("UPDATE reviews SET signed = NULL, signed_by = NULL, seal = NULL, signature = NULL"))
    with pytest.raises(InputError, match="changed outside the program"):
        add_comment(library, review.id, 1, "", "Eve", "late")

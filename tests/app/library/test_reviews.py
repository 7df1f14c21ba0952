"""Reviews: frozen sets, opinions, decisions, and a signature that holds."""

from __future__ import annotations

import sqlite3
import threading
from pathlib import Path

import pytest

from app.library.reviews import (
    Review,
    add_comment,
    decide,
    list_reviews,
    load_review,
    open_review,
    sign,
)
from app.library.store import Conflict, Library
from app.report.audit import overview_table
from nav_model.budget import Budget
from nav_model.inputs import DesignError


@pytest.fixture
def review(library: Library, mems: Budget, tactical: Budget) -> Review:
    keys = [library.save(budget, "Ann").key for budget in (mems, tactical)]
    return open_review(library, "PDR <script>", "Ann", keys)


def _decided(library: Library, review: Review) -> Review:
    for place, check in review.open_points():
        review = decide(library, review.id, place, check.name, check.met, "Bob", "as computed", figure="1 m / 2 m")
    return review


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
    name = review.open_points()[0][1].name
    decide(library, review.id, 1, name, True, "Bob")
    review = decide(library, review.id, 1, name, False, "Eve", "no margin", figure="9 m / 10 m")
    standing = review.standing(1, name)
    assert standing is not None
    assert (standing.accepted, standing.author, standing.figure) == (False, "Eve", "9 m / 10 m")
    assert len(review.decisions) == 2


def test_what_makes_no_sense_is_refused(library: Library, review: Review) -> None:
    name = review.open_points()[0][1].name
    with pytest.raises(DesignError, match="reason: is empty"):
        decide(library, review.id, 1, name, False, "Eve")
    with pytest.raises(DesignError, match="none that"):
        decide(library, review.id, 1, "colour", True, "Eve")
    with pytest.raises(DesignError, match="no design number 3"):
        decide(library, review.id, 3, name, True, "Eve")
    with pytest.raises(DesignError, match="neither an input nor a result"):
        add_comment(library, review.id, 1, "imu.colour", "Eve", "x")
    with pytest.raises(DesignError, match="comment: 4001"):
        add_comment(library, review.id, 1, "", "Eve", "x" * 4001)
    with pytest.raises(DesignError, match="author: is empty"):
        add_comment(library, review.id, 1, "", "", "x")
    with pytest.raises(DesignError, match="takes 1 to 6"):
        open_review(library, "t", "Ann", [])
    with pytest.raises(DesignError, match="no revision"):
        open_review(library, "t", "Ann", ["nothing.1"])
    for forged in ("nothing", "\0", "' OR 1=1 --"):
        with pytest.raises(DesignError, match="not in the library"):
            add_comment(library, forged, 1, "", "Eve", "x")
    assert load_review(library, review.id) == review
    assert len(list_reviews(library)) == 1


def test_a_signed_review_never_changes(library: Library, review: Review) -> None:
    with pytest.raises(DesignError, match="not decided"):
        sign(library, review.id, "Chief", review.version)
    review = _decided(library, review)
    with pytest.raises(Conflict, match="after you opened it"):
        sign(library, review.id, "Chief", review.version - 1)
    signed = sign(library, review.id, "Chief", review.version)
    assert (signed.signed_by, signed.intact) == ("Chief", True)
    assert signed.seal is not None
    assert len(signed.seal) == 64
    name = signed.decisions[0].requirement
    for attempt in (
        lambda: add_comment(library, review.id, 1, "", "Eve", "too late"),
        lambda: decide(library, review.id, 1, name, False, "Eve", "too late"),
        lambda: sign(library, review.id, "Eve", signed.version),
    ):
        with pytest.raises(DesignError, match=r"signed by Chief .* never changes"):
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
        "UPDATE review_items SET content_hash = '0' WHERE place = 1",
        "UPDATE revisions SET text = replace(text, '0', '1')",
    ],
)
def test_a_change_behind_the_librarys_back_is_found(
    library: Library, review: Review, tmp_path: Path, change: str
) -> None:
    review = _decided(library, review)
    assert sign(library, review.id, "Chief", review.version).intact
    raw = sqlite3.connect(tmp_path / "library.db")
    raw.execute(change)
    raw.commit()
    raw.close()
    assert not load_review(library, review.id).intact


def test_two_reviewers_at_once_lose_no_comment(library: Library, review: Review) -> None:
    def talk(author: str) -> None:
        for i in range(10):
            add_comment(library, review.id, 1, "", author, str(i))

    threads = [threading.Thread(target=talk, args=(author,)) for author in ("Bob", "Eve")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    said = load_review(library, review.id).comments
    assert sorted((c.author, c.comment) for c in said) == sorted(
        (a, str(i)) for a in ("Bob", "Eve") for i in range(10)
    )
    assert [c.number for c in said] == list(range(1, 21))


def test_the_overview_counts_what_is_open_decided_rejected_and_signed(library: Library, review: Review) -> None:
    open_points = len(review.open_points())
    (row,) = overview_table([review]).rows
    assert [cell.text for cell in row[1:6]] == ["open", "2", str(open_points), "0", "0"]
    review = add_comment(library, review.id, 1, "", "Bob", "late")
    review = _decided(library, review)  # what is not met is rejected
    failed = sum(not check.met for revision in review.revisions for check in revision.budget().verdict.checks)
    (row,) = overview_table([review]).rows
    assert failed > 0
    assert [cell.text for cell in row[1:6]] == ["open", "2", "0", str(failed), "1"]
    review = sign(library, review.id, "Ann", review.version)
    assert overview_table([review]).rows[0][1].text == "✓ signed off by Ann"

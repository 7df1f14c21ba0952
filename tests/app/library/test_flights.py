"""Flights that the library keeps with a revision."""

import pytest

from app.library.flights import flights_of, keep_flight
from app.library.reviews import open_review
from app.library.store import Library
from app.subjects.review.report import audit_sections
from nav_model.base.errors import InputError
from nav_model.budget import Budget

_FILES = [("flight 7.out", "a" * 64), ("smrmsg_7.out", "b" * 64)]


def test_a_flight_is_kept_with_its_revision_and_stands_in_its_review(library: Library, mems: Budget) -> None:
    first = library.save(mems, "Ann")
    other = library.save(mems, "Ann")
    for verdict in ("not met", "met"):
        keep_flight(library, first.key, "Bob", verdict, f"{verdict.capitalize()} on lines 1 to 4.", _FILES)
    assert flights_of(library, [other.key]) == []
    flights = flights_of(library, [other.key, first.key])
    assert [(one.key, one.verdict, one.author) for one in flights] == [
        (first.key, "not met", "Bob"), (first.key, "met", "Bob"),
    ]  # fmt: skip
    assert flights[0].files == tuple(_FILES)
    review = open_review(library, "Spring", "Ann", [first.key])
    sections = {section.title: section for section in audit_sections(review, flights[1:])}
    shown = str(sections["As flown"].blocks)
    assert "Met on lines 1 to 4." in shown
    assert f"flight 7.out, SHA-256 {'a' * 16}" in shown
    assert "As flown" not in {section.title for section in audit_sections(review)}


def test_what_cannot_be_kept_is_named(library: Library, mems: Budget, monkeypatch: pytest.MonkeyPatch) -> None:
    key = library.save(mems, "Ann").key
    with pytest.raises(InputError, match="Enter your name"):
        keep_flight(library, key, " ", "met", "Met.", _FILES)
    with pytest.raises(InputError, match="has no revision"):
        keep_flight(library, "0123456789abcdef.7", "Ann", "met", "Met.", _FILES)
    monkeypatch.setattr("app.library.flights._MOST", 1)
    keep_flight(library, key, "Ann", "met", "Met.", [("\u202e.out" * 40, "c" * 64)])
    with pytest.raises(InputError, match="1 flights of a revision"):
        keep_flight(library, key, "Ann", "met", "Met.", _FILES)
    (flight,) = flights_of(library, [key])
    assert len(flight.files[0][0]) == 100
    assert "\u202e" not in flight.files[0][0]

"""Reading a visitor's file has an end."""

import itertools

import pytest

from app.work import pool
from nav_model.base.errors import InputError


def _forever() -> None:
    for _ in itertools.count():
        pass


def test_a_reader_that_takes_too_long_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "_LONGEST_READING", 0.01)
    with pytest.raises(InputError, match="Give less of it"):
        pool._within_bounds(_forever)


def test_a_reader_in_time_answers() -> None:
    assert pool._within_bounds(max, 1, 2) == 2

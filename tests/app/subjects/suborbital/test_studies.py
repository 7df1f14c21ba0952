"""Studies that are kept, and flown ahead."""

from typing import Any

import pytest

from app.serving.server import first_design
from app.subjects.suborbital import studies
from app.subjects.suborbital.studies import asked, fly_ahead, fly_study
from app.work.cancellable import RunLost
from app.work.result_cache import cached
from nav_model.suborbital.settings import DEFAULTS, from_design

_USUAL = from_design(DEFAULTS, first_design())


class _Flights:
    """Stands for the process."""

    def __init__(self) -> None:
        self.flown: list[Any] = []
        self.fails = False

    async def __call__(self, _: object, settings: Any, trajectory: object, progress: Any) -> str:
        self.flown.append(settings)
        if self.fails:
            raise RunLost("gone")
        progress(0.9, "gravity models")
        return "the study"


@pytest.fixture
def flights(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> _Flights:
    made = _Flights()
    monkeypatch.setattr(studies, "run_alone", made)
    return made


async def test_the_usual_study_is_there_before_anybody_asks(flights: _Flights) -> None:
    await fly_ahead(first_design())
    assert cached(*asked(_USUAL)) == "the study"
    await fly_ahead(first_design())
    assert len(flights.flown) == 1


async def test_the_study_of_a_file_is_not_kept(flights: _Flights) -> None:
    messages: list[str] = []
    await fly_study(_USUAL, ("mine.csv", b""), lambda _, what: messages.append(what))
    assert messages == ["gravity models"]
    assert cached(*asked(_USUAL)) is None


async def test_a_study_ahead_that_fails_is_flown_again_by_who_asks(flights: _Flights) -> None:
    flights.fails = True
    await fly_ahead(first_design())
    flights.fails = False
    assert await fly_study(_USUAL, None, lambda *_: None) == "the study"
    assert cached(*asked(_USUAL)) == "the study"

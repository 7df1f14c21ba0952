"""Studies that are kept, shared and flown ahead."""

import asyncio
from typing import Any

import pytest

from app.serving.server import first_design
from app.subjects.suborbital import studies
from app.subjects.suborbital.studies import fly_ahead, fly_study, kept_study
from app.work.alone import RunLost
from nav_model.suborbital.settings import DEFAULTS, from_design

_USUAL = from_design(DEFAULTS, first_design())


class _Flights:
    """Stands for the process: a flight ends when it is told to."""

    def __init__(self) -> None:
        self.flown: list[Any] = []
        self.ended = 0
        self.end = asyncio.Event()
        self.fails = False

    async def __call__(self, _: object, settings: Any, trajectory: object, progress: Any) -> str:
        self.flown.append(settings)
        try:
            await self.end.wait()
        finally:
            self.ended += 1
        if self.fails:
            raise RunLost("gone")
        progress(0.9, "gravity models")
        return "the study"


@pytest.fixture
def flights(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> _Flights:
    made = _Flights()
    monkeypatch.setattr(studies, "run_alone", made)
    return made


async def _begun() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


async def test_who_asks_for_the_study_under_way_waits_for_it_and_hears_of_it(flights: _Flights) -> None:
    said: list[str] = []
    ahead = asyncio.create_task(fly_ahead(first_design()))
    await _begun()
    asked = asyncio.create_task(fly_study(_USUAL, None, lambda _, what: said.append(what)))
    file = asyncio.create_task(fly_study(_USUAL, ("mine.csv", b""), lambda *_: None))
    await _begun()
    assert len(flights.flown) == 2  # a file's is another study
    flights.end.set()
    await asyncio.gather(ahead, file)
    assert await asked == "the study"
    assert said == ["gravity models"]
    assert kept_study(_USUAL) == "the study"
    await fly_ahead(first_design())
    assert len(flights.flown) == 2
    assert not studies._begun


@pytest.mark.parametrize("waits", [False, True])
async def test_a_study_ahead_ends_with_the_server_unless_somebody_waits(flights: _Flights, waits: bool) -> None:
    ahead = asyncio.create_task(fly_ahead(first_design()))
    await _begun()
    asked = [asyncio.create_task(fly_study(_USUAL, None, lambda *_: None)) for _ in range(waits)]
    await _begun()
    ahead.cancel()
    with pytest.raises(asyncio.CancelledError):
        await ahead
    await _begun()
    assert flights.ended == (not waits)
    flights.end.set()
    assert await asyncio.gather(*asked) == ["the study"] * waits


async def test_a_study_ahead_that_fails_is_flown_again_by_who_asks(flights: _Flights) -> None:
    flights.fails = True
    flights.end.set()
    await fly_ahead(first_design())
    flights.fails = False
    assert await fly_study(_USUAL, None, lambda *_: None) == "the study"

"""Parts of all pages of studies: settings in the link, the strip's answer through a run, and screen parts."""

import asyncio
import re
from dataclasses import replace
from typing import Any, ClassVar
from urllib.parse import parse_qsl

import panel as pn
import param
import pytest
from hypothesis import given
from hypothesis import strategies as st
from waiting import soon

from app.document.blocks import Answer
from app.serving.server import first_design
from app.session import Session
from app.ui.fields import number, whole_number
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.study_page import StudyPage
from app.ui.study_settings import StudySettings
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.contributors import Contributor


class Settings(param.Parameterized):
    runs = param.String(default="100")
    engine = param.Selector(default="quick", objects=["quick", "full"])


@pytest.fixture
def session() -> Session:
    return Session(first_design())


def of(session: Session) -> tuple[Settings, list[int]]:
    settings, calls = Settings(), []
    StudySettings(session, "sar", settings, ("runs", "engine"), lambda: calls.append(1))
    return settings, calls


def test_settings_that_differ_are_in_the_link_and_come_back_from_it(session: Session) -> None:
    settings, calls = of(session)
    assert session.settings.get("sar", "") == ""
    settings.runs = "7 & more"
    assert dict(parse_qsl(session.settings["sar"])) == {"sar.runs": "7 & more"}
    settings.engine = "full"
    assert dict(parse_qsl(session.settings["sar"])) == {"sar.runs": "7 & more", "sar.engine": "full"}
    assert calls == []  # nobody but the person has changed them
    again, calls = of(session)
    assert (again.runs, again.engine) == ("7 & more", "full")
    session.settings = {**session.settings, "sar": "sar.runs=9"}
    assert (again.runs, again.engine, settings.runs, calls) == ("9", "quick", "9", [1])


def test_a_link_that_asks_for_what_is_no_option_gets_the_usual_one(session: Session) -> None:
    session.settings = {"sar": "sar.engine=<script>&sar.other=1&map.runs=5"}
    settings, _ = of(session)
    assert (settings.engine, settings.runs) == ("quick", "100")


class Page(StudyPage[float]):
    """A study of one number, which waits to be let go."""

    kind: ClassVar[str] = "sar"
    moving: ClassVar[tuple[str, ...]] = ("current",)
    waiting: ClassVar[Answer] = Answer("Not run yet", "open", ())
    current = param.Number(default=1.0, label="Number")

    def __init__(self, session: Session) -> None:
        self.go = asyncio.Event()
        super().__init__(session)
        self._settings = StudySettings(session, "sar", self, (), lambda: None)

    async def _study(self, run: Run) -> float:
        run.tell("10 of 20 runs")
        await self.go.wait()
        if self.current < 0:
            raise InputError("runs", "Give more than none.", self.current)
        return self.current

    def _verdict(self, result: float) -> Answer:
        return Answer(f"✓ {result:g} m", "good", ())

    def _subject(self, design: Design) -> object:
        return {key: value for key, value in design.items() if key.startswith("imu.")}, design.contributors

    def answer(self) -> tuple[str, str, str]:
        answer, note = self._answer()
        return answer.word, answer.tone, " ".join((*answer.sentences, note)).strip()


@pytest.mark.usefixtures("nothing_kept")
async def test_the_strip_never_gives_a_verdict_of_other_inputs_as_that_of_these(session: Session) -> None:
    page = Page(session)
    assert page.answer() == ("Not run yet", "open", "")

    async def flown(value: float) -> None:
        page.current = value
        page.go.set()
        await task
        page.go.clear()

    task = page.begin()
    await soon(lambda: page.run.progress, "progress")
    assert page.answer()[:2] == ("Running: 10 of 20 runs", "open")
    await flown(1.0)
    assert page.answer() == ("✓ 1 m", "good", "")
    assert session.findings["sar"] == 1.0

    page.current = 2.0  # an input changes: no longer green, and no ✓
    assert page.answer() == ("1 m", "open", "The runs are older than number. Run again.")
    task = page.begin()
    await soon(lambda: page.run.progress, "progress")
    assert page.answer()[:2] == ("1 m", "open")
    assert "Showing the previous result." in page.answer()[2]
    await flown(-1.0)  # refused: the reason, and what the charts still show
    word, tone, text = page.answer()
    assert (word, tone) == ("Not run", "open")
    assert "Give more than none." in text
    assert "previous result: 1 m" in text

    page.current = 1.0
    task = page.begin()
    await soon(lambda: page.run.progress, "progress")
    page.run.cancel()
    await asyncio.gather(task, return_exceptions=True)
    assert page.answer() == ("✓ 1 m", "good", "The last run was cancelled. Showing the previous result.")


@pytest.mark.usefixtures("nothing_kept")
async def test_a_result_says_which_inputs_have_moved_since(session: Session) -> None:
    page = Page(session)
    page.go.set()
    await page.begin()

    def moved(changes: dict[str, Any], *contributors: Contributor) -> str:
        entries = replace(session.design.entries, contributors=contributors)
        assert session.change(changes, entries=entries) is None
        _, tone, text = page.answer()
        assert (tone == "good") == (not text)
        return text.removeprefix("The runs are older than ").removesuffix(". Run again.")

    assert moved({"name": "B", "gnss.interval": 0.5}) == ""
    arm = Contributor("lever arm", 1e-3, "detrended_phase", "length")
    assert moved({}, arm) == 'contributor "lever arm"'
    assert moved({}, replace(arm, value=2e-3)) == 'contributor "lever arm"'
    assert moved({"imu.rate": 321.0}) == "sample rate"
    assert moved({"imu.gyro_bias": 1e-9}, arm) == "residual gyro bias, sample rate and others"
    session.undo()
    session.undo()
    session.undo()
    session.undo()
    assert page.answer()[1] == "good"


@pytest.mark.usefixtures("nothing_kept")
async def test_a_result_that_the_server_has_is_shown_at_once(session: Session) -> None:
    page = Page(session)
    page.go.set()
    await page.begin()
    other = Page(Session(first_design()))
    assert other._recall()
    assert other.answer() == ("✓ 1 m", "good", "")
    other._session.change({"imu.angle_random_walk": 2 * first_design()["imu.angle_random_walk"]})
    assert not Page(other._session)._recall()


@given(st.text(max_size=12), st.integers(-5, 50), st.integers(1, 50))
def test_a_whole_number_is_taken_within_its_bounds_alone(text: str, low: int, span: int) -> None:
    low, high = max(low, 0), max(low, 0) + span
    for entry in (text, str(low), f" {high} ", str(high + 1), str(low - 1), f"{low}.0"):
        inside = re.fullmatch(r"\s*\d+\s*", entry) is not None and low <= int(entry) <= high
        if inside:
            assert whole_number("Runs", entry, low, high) == int(entry)
        else:
            with pytest.raises(InputError, match="Runs"):
                whole_number("Runs", entry, low, high)


@pytest.mark.parametrize("entry", ["nan", "inf", "-inf", "", "1,5", "1e9", "-0.1", "١٢٣x", "0x10"])
def test_no_number_beyond_its_bounds_and_no_word_is_taken(entry: str) -> None:
    assert number("Length", " 2.5e0 ", 0.0, 10.0) == 2.5
    with pytest.raises(InputError, match="Length"):
        number("Length", entry, 0.0, 10.0)


def test_a_folded_part_is_made_when_it_is_first_opened_and_once() -> None:
    made: list[str] = []

    def part(name: str) -> Any:
        return lambda: made.append(name) or pn.pane.Str(name)

    folded = Folded([("A", part("a")), ("B", part("b"))])
    assert made == []
    folded._view.active = [1]
    folded._view.active = []
    folded._view.active = [0, 1]
    assert made == ["b", "a"]


@pytest.mark.parametrize(("left", "right"), [(1, 0), (2, 0), (1, 1), (2, 1), (1, 2), (2, 2)])
def test_no_two_parts_of_a_screen_have_the_same_place(left: int, right: int) -> None:
    """By the areas of the grid: each place is taken once, and none is left empty."""
    screen = first_screen("top", left=["l"] * left, right=["r"] * right, bottom="bottom")
    places: list[tuple[int, int]] = []
    for part in screen.objects:
        row, column, down, across = (text.strip() for text in part.styles["grid-area"].split("/"))
        rows = int(down.removeprefix("span ")) if down != "auto" else 1
        columns = int(across.removeprefix("span ")) if across != "auto" else 1
        places += [(int(row) + r, int(column) + c) for r in range(rows) for c in range(columns)]
    assert len(places) == len(set(places))
    assert set(places) >= {(row, column) for row in (1, 2, 4) for column in (1, 2)}

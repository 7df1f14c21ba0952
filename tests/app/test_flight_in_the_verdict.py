"""The flight in a session's verdict: open while it is computed, then one answer on every page."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pages import at_once
from waiting import soon

import app.work.flight as engine
from app.dashboard.report_choice import ReportChoice
from app.dashboard.toolbar import Toolbar
from app.document.blocks import Answer
from app.document.tiles import tiles_html
from app.document.verdict import verdict_strip, verdicts_in_short
from app.examples import example
from app.session import Session
from app.subjects.budget.allocate import AllocatePage
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.page import BudgetPage
from app.subjects.budget.tables import requirement_table
from app.subjects.explore.page import ExplorePage
from app.subjects.sar.page import SarPage
from app.subjects.sar.tables import answer as image_answer
from app.subjects.trajectory.charts import map_chart
from app.subjects.trajectory.page import TrajectoryPage
from app.subjects.trajectory.tables import line_list, line_table, verdict
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.sar.design_study import closed_forms
from nav_model.trajectory.verdict import with_flight

pytestmark = pytest.mark.long
_PLAN = {"trajectory.flight": "lines", "trajectory.lines": 2.0, "trajectory.length": 2000.0}
_HEADING = math.radians(0.05)
_GPX = """<gpx><rte><rtept lat="45" lon="11"><ele>3000</ele><name>one</name></rtept>
<rtept lat="45.03" lon="11"><ele>3000</ele><name>two</name></rtept>
<rtept lat="45.03" lon="11.05"><ele>3000</ele></rtept></rte></gpx>"""


def _tactical(**changes: Any) -> Design:
    """A design that closes on a straight leg, with a plan of two short lines."""
    whole = {**_PLAN, **{key.replace("__", "."): value for key, value in changes.items()}}
    return example("tactical_x_band").replace(whole)


@pytest.fixture
def flights(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> list[Design]:
    """The designs that are flown, each in this process; nothing waits for inputs to rest."""
    known: list[Design] = []

    async def here(function: Any, *arguments: Any) -> Any:
        if function is engine.follow_if_short:
            known.append(arguments[0])
        return await at_once(function, *arguments)

    monkeypatch.setattr(engine, "run_in_pool", here)
    monkeypatch.setattr(engine, "_REST", 0.0)
    return known


def _tones(session: Session) -> set[str]:
    """Texts in green or red about the design: by the strip, the tiles, the table, the switch and two pages."""
    figures = key_figures(session.budget, last=session.last_flown)
    table = requirement_table(session.budget)
    close = ExplorePage(session)
    tones = {
        verdict_strip(session.budget).tone,
        next(iter(close._strip._view.css_classes)),
        image_answer(session.budget, closed_forms(session.budget), None).tone,
        *(mark for mark in ("✓", "✗") if any(mark in word for word in verdicts_in_short(session.budget))),
        *(f"tile {figure.state}" for figure in figures.items if figure.label == "Heading"),
        *(f"row {row[4].text}" for row in table.rows if row[0].text == "Heading"),
    }
    return tones


async def test_heading_is_open_until_it_is_flown_and_then_fails_everywhere(flights: list[Design]) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    assert analyse(example("tactical_x_band")).verdict.closes
    assert _tones(session) == {"open", "tile open", "row open"}
    assert "being computed" in session.flight_words
    budget = await session.with_flight()
    assert session.flight_words == ""
    assert with_flight(analyse(session.design)).verdict.state == "fails"
    assert budget.verdict.failing == ("heading",)
    assert _tones(session) - {"✓"} == {"bad", "✗", "tile not met", "row ✗ not met", "open"}  # ✓: post-processed
    (tile,) = (figure for figure in key_figures(budget).items if figure.label == "Heading")
    check = next(check for check in budget.verdict.checks if check.name == "heading")
    assert tile.limit == f"0.05° on {check.judged}"
    assert math.degrees(check.value) == pytest.approx(float(tile.value.removesuffix("°")), rel=5e-3)
    detrended = next(figure for figure in key_figures(budget).items if figure.label == "Detrended phase")
    straight = budget.straight_leg().checks
    leg = next(math.degrees(check.value) for check in straight if check.name == "detrended_phase")
    assert detrended.beside.startswith("straight leg ")
    assert leg == pytest.approx(float(detrended.beside.split()[-1].removesuffix("°")), rel=5e-3)
    assert f'<dd class="fine quiet">{detrended.beside}</dd>' in tiles_html(key_figures(budget))
    assert len(flights) == 1


async def test_a_step_opens_the_verdict_with_the_last_values_faint_and_undo_knows_its_flight(
    flights: list[Design],
) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    page = BudgetPage(session)
    await session.with_flight()
    page.show_verdict(session.budget)
    assert "✗" in page._strip._text.object
    session.change({"imu.angle_random_walk": 1.1 * session.design.imu.angle_random_walk})
    page.show(session.budget)
    assert page._strip._view.css_classes == ["open"]
    assert 'class="big num last"' in page._tiles.object
    assert "tile good" not in page._tiles.object
    session.undo()
    assert session.budget.verdict.state == "fails"  # the flight of that design was the last one
    session.redo()
    await session.with_flight()
    assert session.budget.verdict.state == "fails"
    session.undo()
    await session.with_flight()  # the server has it
    assert len(flights) == 2


async def test_verdict_and_page_share_one_flight_and_a_design_that_has_gone_gives_none(flights: list[Design]) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    changed: list[str] = []
    session.param.watch(lambda event: changed.append(event.name), ["budget", "flown"])
    page = TrajectoryPage(session)
    page.begin()
    await soon(lambda: page.run.result is not None, "the flight of the page")
    assert page.run.result is session.flight.run.result
    assert (len(flights), changed) == (1, ["flown"])  # what follows the budget has nothing to do
    session.change({"requirements.heading": 1.0})
    session.flight.begin(session.design)
    session.change({"requirements.heading": 2.0})  # while the first is flown
    budget = await session.with_flight()
    assert budget.verdict.closes
    assert session.findings["trajectory"].design == session.design
    session.close()


async def test_the_page_image_has_the_verdict_and_says_whose_phase_its_advice_has(flights: list[Design]) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    page = SarPage(session)
    text, tones = page._strip._text, page._strip._view
    assert tones.css_classes == ["open"]
    assert "The flight is being computed." in text.object
    await session.with_flight()
    page.show_verdict(session.budget)
    (phase,) = (check for check in session.budget.verdict.checks if check.name == "detrended_phase")
    assert tones.css_classes == ["bad"]
    assert "Heading on line 1: " in text.object
    value = f"{math.degrees(phase.value):.3g}°"
    assert f"Detrended phase on {phase.judged} {value}, limit 20°." in text.object.replace("\xa0", " ")
    assert "On a straight leg: " in text.object


async def test_a_plan_that_cannot_be_flown_stays_open_and_says_why(flights: list[Design]) -> None:
    session = Session(_tactical(requirements__heading=_HEADING, trajectory__ground=50000.0))
    budget = await session.with_flight()
    assert budget.verdict.state == "open"
    assert "is not above the ground" in session.flight_words
    assert verdict_strip(budget).tone == "open"


@pytest.mark.parametrize(
    "changes",
    [
        {"requirements.detrended_phase": math.radians(17.0)},
        {"requirements.confidence": 2.0},
        {"processing.mode": "post-processed"},
        {"requirements.heading": _HEADING},
        {"imu.accelerometer_bias": 9.81e-3},
        {**_PLAN, "requirements.heading": _HEADING},
        {**_PLAN, "requirements.confidence": 2.0},
        {**_PLAN, "processing.mode": "post-processed"},
    ],
    ids=lambda changes: " ".join(changes),
)
async def test_no_page_is_green_beside_a_red_one(flights: list[Design], changes: dict[str, Any]) -> None:
    session = Session(example("mems_x_band").replace({"imu.preset": "HG4930"} | changes))
    page = TrajectoryPage(session)
    page.begin()
    await soon(lambda: page.run.result is not None, "the flight of the page")
    budget = await session.with_flight()
    answers = {
        "budget": verdict_strip(budget),
        "flight": verdict(page.run.result),
        "image": image_answer(budget, closed_forms(budget), None),
        "command": verdict_strip(with_flight(analyse(session.design))),
    }
    assert len({(answer.word, answer.tone) for answer in answers.values()}) == 1, answers
    assert page._strip._view.css_classes == [verdict_strip(budget).tone]
    close = ExplorePage(session)
    assert next(iter(close._strip._view.css_classes)) in {verdict_strip(budget).tone, "open"}


async def test_a_flight_is_told_at_the_confidence_of_the_design(flights: list[Design]) -> None:
    session = Session(_tactical(requirements__confidence=2.0))
    await session.with_flight()
    followed = session.flight.run.result
    table = line_table(followed, "detrended_phase")
    assert table.caption.endswith("at 2σ")
    row = next(row for row in table.rows if row[0].text == "Detrended phase")
    worst = 2 * math.degrees(followed.result.lines[0].worst["detrended_phase"])
    assert float(row[3].text.removesuffix("°")) == pytest.approx(worst, rel=5e-3)
    assert row[4].text == "20°"  # as it was typed
    heading = 2 * np.degrees(followed.result.real_time.attitude[:, 2])
    assert (
        f"{heading.min():.3g}° at best, {heading[-1]:.3g}° at the end." in line_list(followed, "detrended_phase").note
    )


async def test_a_study_is_not_the_verdict(flights: list[Design], tmp_path: Path) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    page = TrajectoryPage(session)
    await session.with_flight()
    path = tmp_path / "plan.gpx"
    path.write_text(_GPX, encoding="utf-8")
    study, design = engine.follow(session.design, engine.File("plan.gpx", path)), session.flight.run.result
    page.run.take(study)
    text = page._strip._text.object
    assert "Study: " in text
    assert "The flight of plan.gpx is not the design" in text
    assert page._strip._view.css_classes == ["open"]
    assert session.budget.verdict.state == "fails"
    for followed, judged in ((study, False), (design, True)):
        tables = line_list(followed, "heading"), line_table(followed, "heading")
        tones = {cell.tone for table in tables for row in table.rows for cell in row} & {"good", "bad"}
        drawn = {line.style for line in map_chart(followed).lines if np.isfinite(line.y).any()}
        assert (tones == {"good", "bad"}, "does not close" in drawn) == (judged, judged)


async def test_a_report_waits_for_the_flight(flights: list[Design], monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(_tactical(requirements__heading=_HEADING))
    toolbar = Toolbar(session, lambda *_: None)
    written: list[Any] = []
    said: list[str] = []
    toolbar.bar.param.watch(lambda event: said.append(event.new), "writing")

    async def report(_: Any, budgets: Any, *others: Any) -> bytes:
        written.extend((budgets[0], others))
        return b"report"

    monkeypatch.setattr("app.dashboard.toolbar.run_in_pool", report)
    monkeypatch.setattr(type(toolbar.bar), "give", lambda *_: None)
    assert ReportChoice(session).lacking() == "The flight is being computed."
    await toolbar._write("html")
    assert said[:3] == ["HTML report", "HTML report, which waits for the flight", "HTML report"]
    budget, (_, _, _, (sections,), *_) = written
    assert budget.verdict.state == "fails"
    assert sections[0].title == "Flight: the lines and their limits"
    assert isinstance(sections[0].blocks[0], Answer)
    assert sections[0].blocks[0].tone == "bad"


def test_a_limit_with_a_time_is_one_on_the_outage_and_a_refused_one_greys_the_strip() -> None:
    session = Session(example("tactical_x_band"))
    page = AllocatePage(session)
    row = {"name": "tilt after 30 s", "on": "tilt", "limit": "0.015°"}
    page._limits.put([row])
    page._limits.put([row | {"at": "30 s"}])
    (limit,) = session.design.limits
    assert (limit.on, limit.at, page._limits.refused) == ("coast_tilt", 30.0, "")
    assert page._strip._view.css_classes != ["open"]
    page._limits.put([row | {"on": "detrended_phase", "limit": "3°", "at": "30 s"}])
    assert "has no time after the last fix" in page._limits.refused
    budget, image = BudgetPage(session), SarPage(session)
    for each in (budget, image):
        each.show(session.budget)
    for strip in (page._strip, budget._strip, image._strip):
        assert strip._view.css_classes == ["open"]
        assert "1 limit is invalid: last valid values used." in strip._text.object
    session.undo()
    page.show(session.budget)
    assert "invalid" not in page._strip._text.object

"""Options that would close a flight, on the page and in the report: options with a button, taken and undone."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from pages import at_once, when_done

from app.document.pane import html_of
from app.session import Session
from app.subjects.trajectory import manoeuvres as block
from app.subjects.trajectory.manoeuvres import ManoeuvreBlock
from app.subjects.trajectory.options import options_answer, options_table
from app.subjects.trajectory.report import sections, study
from app.work.flight import File, follow
from nav_model.base.constants import DEGREE
from nav_model.design import Design
from nav_model.explore.manoeuvre import Limited, Manoeuvres, Option

pytestmark = pytest.mark.long


def failing() -> Design:
    """One line that the heading at the start of the flight is too large for."""
    return Design(
        {
            "imu.velocity_random_walk": 1e-3,
            "imu.angle_random_walk": 4e-5,
            "gnss.position_noise": 1.0,
            "flight.speed": 90.0,
            "radar.aperture_time": 5.0,
            "requirements.heading": 0.08 * DEGREE,
            "trajectory.flight": "waypoints",
            "trajectory.waypoints": ((0.8, 0.1, 3000.0, "<b>line</b>", None), (0.8012, 0.1, 3000.0, "", None)),
        }
    )


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Session:
    monkeypatch.setattr(block, "run_alone", at_once)
    return Session(failing())


def test_an_option_that_is_pressed_turns_the_verdict_and_is_undone(session: Session) -> None:
    shared: list[tuple[Design, File | None, Manoeuvres]] = []
    page = ManoeuvreBlock(session, lambda: None, lambda *options: shared.append(options))
    when_done(page.begin, page.run)
    assert not page.run.message
    (design, file, answer), planned = shared[0], session.design
    assert (design, file) == (planned, None)
    assert "&lt;b&gt;line&lt;/b&gt;" in page._table.html
    assert "<b>line" not in page._table.html
    first = answer.options[0]
    assert f'value="{first.name}"' in page._table.html
    assert "not more than" in page._head.object
    page._take(first.name)
    assert session.design == planned.replace(first.changes, first.written)
    assert session.design.trajectory.flight == "waypoints"
    assert follow(session.design).budget.verdict.closes
    assert "You can undo" in page._bar.message
    page.follow()
    assert "before the last change" in page._head.object
    page._take(answer.options[1].name)  # of a plan that is no longer there
    assert "Compare the options again" in page._bar.message
    session.undo()
    page.follow()
    assert session.design == planned
    assert "before the last change" not in page._head.object


def test_the_options_of_a_file_are_of_what_is_flown_there(session: Session, tmp_path: Path) -> None:
    """A track that was recorded on the plan's line: at no time would a turn have been in front of it."""
    track = "time,latitude,longitude,height\n" + "".join(
        f"{t},{math.degrees(0.8) + t * math.degrees(90.0 / 6.37e6)!r},5.7,3000\n" for t in range(120)
    )
    (tmp_path / "a.csv").write_text(track)
    flown = [File("a.csv", tmp_path / "a.csv")]
    page = ManoeuvreBlock(session, lambda: flown[-1], lambda *_: None)
    when_done(page.begin, page.run)
    assert not page.run.message
    assert "no waypoints" in page._head.object
    answer = page.run.result[-1]
    assert {option.kind for option in answer.options} == {"aid", "imu"}
    flown.append(None)  # the plan is flown again
    page.follow()
    assert "before the last change" in page._head.object
    page._take(answer.options[0].name)
    assert session.design == failing()
    flown.pop()
    page._take(answer.options[0].name)
    assert session.design != failing()


def test_a_flight_without_a_limit_says_so(session: Session) -> None:
    session.change({"requirements.heading": None})
    page = ManoeuvreBlock(session, lambda: None, lambda *_: None)
    when_done(page.begin, page.run)
    assert "none limits a figure of the flight" in page.run.message


def test_the_report_of_a_flight_that_fails_has_what_would_close_it() -> None:
    followed = study(failing(), None)  # type: ignore[arg-type]
    blocks = sections(followed, "d1")[0].blocks
    assert followed.options is not None
    assert options_answer(followed.options) in blocks
    assert options_table(followed.options, followed.design, "d1-options") in blocks
    taken = failing().replace(followed.options.options[0].changes)
    assert study(taken, None).options is None  # type: ignore[arg-type]


def test_the_words_of_an_answer() -> None:
    fig = {"heading": Limited(1e-3, 1e-3, 2e-3)}

    def option(name: str, **changes: object) -> Option:
        usual = {
            "kind": "manoeuvre", "lines": ("line 3",), "where": "before line 3", "before_s": 480.0, "costs_s": 61.0,
            "closes": True, "useless": False, "lost_s": 0.0, "figures": fig, "changes": {}, "written": {},
        }  # fmt: skip
        return Option(name, **(usual | changes))  # type: ignore[arg-type]

    antennas = option("Two antennas, 1 m apart", kind="aid", lines=(), where="", before_s=0.0, costs_s=0.0)
    steep = option("S-turn", closes=False, useless=True, lost_s=40.0, figures={"heading": Limited(4e-3, 1e-3, 2e-3)})
    answer = Manoeuvres("line 3", ("line 3",), False, {"heading": Limited(3e-3, 1e-3, 2e-3)},
                        (option("90° turn"), antennas, steep))  # fmt: skip
    assert options_answer(answer).sentences == (
        "90° turn before line 3, over not more than 8 min before the line ends (1 min 1 s longer); "
        "or two antennas, 1 m apart.",
    )
    rows = [[cell.text for cell in row] for row in options_table(answer, failing()).rows]
    assert rows[0] == [
        "90° turn before line 3",
        "✓ closes",
        "Heading",
        "0.0573°",
        "0.115°",
        "67 % less",
        "1 min 1 s longer",
        "",
    ]
    assert rows[2][5:] == [
        "33 % more",
        "1 min 1 s longer",
        "Its bank loses fixes for 40 s, and no gain",
    ]
    same = replace(steep, useless=False, lost_s=0.0, figures={"heading": Limited(2.999e-3, 1e-3, 2e-3)})
    (row,) = options_table(replace(answer, options=(same,)), failing()).rows
    assert [cell.text for cell in row][5:] == ["no change", "1 min 1 s longer", "No gain"]
    none = Manoeuvres("line 3", ("line 3",), False, answer.figures, (steep,))
    assert options_answer(none).word == "✗ No single option is enough for line 3"
    assert options_answer(Manoeuvres("line 3", (), True, fig)).word == "✓ Every line keeps its limits"
    assert "aria-label" in html_of(options_table(answer, failing()))

"""The page As flown without a browser: files, refusals, figures against numpy, and the receiver into the design."""

import asyncio
import json
import math
import pickle
import re
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pages import at_once, when_done

import app.subjects.flown.page as flown_page
from app.document.flown import answer, sentence
from app.library.flights import flights_of
from app.library.store import Library
from app.report.studies import study_sections
from app.session import Session
from app.subjects.flown.charts import map_chart, timelines
from app.subjects.flown.page import FlownPage, SolutionFiles
from app.subjects.flown.run import hold
from app.subjects.flown.tables import as_csv, flight_blocks, jump_block, main_figure
from app.ui.upload import UploadedFile
from app.work.flight import File
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.flown.result import to_json

pytestmark = pytest.mark.long
DESIGN = """
[gnss]
position_noise = "1 m"
[requirements]
confidence = 1.0
horizontal_position = "2 m"
"""
SIGMA = 0.5  # m, of the fixes that are made
COUNT = 600


def error_of_fixes() -> np.ndarray:
    return SIGMA * np.random.default_rng(4).standard_normal((COUNT, 3))


def table(time: np.ndarray, error: np.ndarray) -> bytes:
    """A flight northwards at 60 m/s with a weave that no lag repeats, as a table of places with these errors [m]."""
    north, east = 60.0 * time + error[:, 0], 400.0 * np.sin((time / 150.0) ** 2) + error[:, 1]
    latitude = 47.0 + north / 111_170.0
    longitude = 8.0 + east / (111_320.0 * math.cos(math.radians(47.0)))
    rows = zip(time, latitude, longitude, 1000.0 - error[:, 2], strict=True)
    lines = ["time [s],latitude [deg],longitude [deg],height [m]"]
    return "\n".join([*lines, *(f"{t:.2f},{a:.10f},{o:.10f},{h:.5f}" for t, a, o, h in rows)]).encode()


FIXES = table(np.arange(COUNT, dtype=float), error_of_fixes())
REFERENCE = table(np.arange(0.0, COUNT - 1, 0.5), np.zeros((2 * COUNT - 2, 3)))


@pytest.fixture(autouse=True)
def _nothing_stays_on_the_disk(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    made: list[UploadedFile] = []

    def noted() -> UploadedFile:
        made.append(UploadedFile())
        return made[-1]

    monkeypatch.setattr(flown_page, "UploadedFile", noted)
    yield
    for file in made:
        file.delete()


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> Session:
    monkeypatch.setattr(flown_page, "run_alone", at_once)
    return Session(parse_design(DESIGN))


@pytest.fixture(scope="module")
def design() -> Design:
    return parse_design(DESIGN)


def files(folder: Path, **contents: bytes) -> dict[str, tuple[File]]:
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return {name: (File(f"{name}.csv", folder / name),) for name in contents}


def after(page: FlownPage, do: Any) -> str:
    when_done(do, page.run)
    return str(page._strip._text.object)


def brought(page: FlownPage) -> FlownPage:
    when_done(lambda: page._take(page._solution, "fixes.csv", FIXES))
    when_done(lambda: page._take(page._reference, "truth.csv", REFERENCE))
    return page


def test_the_page_waits_for_files_and_says_what_is_missing(session: Session) -> None:
    page = FlownPage(session)
    assert "No flight yet" in str(page._strip._text.object)
    text = after(page, page.begin)
    assert "Not run" in text
    assert "choose the file of a solution first" in text


def test_a_flight_is_held_against_the_budget_as_numpy_does(session: Session) -> None:
    page = brought(FlownPage(session))
    assert page._bar.message == "Solution fixes.csv; reference truth.csv. Press Start."
    text = after(page, page.begin)
    result = page.run.result
    error = error_of_fixes()[:, :2]
    (line,) = [line for line in result.result.lines if line.name != "all lines"][:1]
    on = (np.arange(COUNT) >= line.start_s) & (np.arange(COUNT) <= line.stop_s)
    rms = math.sqrt(float(np.mean(error[on] ** 2)))  # of two axes alike
    assert line.figures["horizontal_position"].flown == pytest.approx(rms, rel=0.01)
    assert f"{sentence(result.result).partition(' (')[0]}</h2>" in text
    assert "Horizontal position of 2 m: met" in text.replace("\u00a0", " ")
    assert session.findings["flown"] is result
    shown = "".join(str(block) for block in flight_blocks(result))
    assert "Horizontal position" in shown
    _, north, *_ = timelines(result, main_figure(result))
    drawn = north.lines[0].y[np.isfinite(north.lines[0].y)]
    assert np.std(drawn) == pytest.approx(SIGMA, rel=0.1)
    assert json.loads(json.dumps(result.data, allow_nan=False))["lines"][0]["name"] == line.name
    assert as_csv(result).count("horizontal_position") == len(result.result.lines)


def test_a_refused_file_keeps_the_last_good_result(session: Session) -> None:
    page = brought(FlownPage(session))
    after(page, page.begin)
    good = page.run.result
    when_done(lambda: page._take(page._solution, "photo.csv", b"\x89PNG\r\n\x1a\n\xff\xfe"))
    text = after(page, page.begin)
    assert page.run.result is good
    assert "photo.csv" in text
    assert "The charts show the previous result" in text
    when_done(lambda: page._take(page._solution, "fixes.csv", FIXES))
    after(page, page.begin)
    page.relation = "reverse"
    assert "Computed before the change of relation. Press Start again." in str(page._strip._text.object)


def test_the_receiver_goes_into_the_design_with_its_origin(session: Session) -> None:
    page = brought(FlownPage(session))
    after(page, page.begin)
    part = page._receiver()
    tables, use, _ = part
    assert "White noise, horizontal" in tables.object
    assert not use.disabled
    page._adopt()
    page.show(session.budget)  # as the frame does
    assert session.design.gnss.position_noise == pytest.approx(SIGMA, rel=0.06)
    assert session.design.origins["gnss.position_noise"].startswith("from the fixes of fixes.csv, ")
    assert "Press Start again" in str(page._strip._text.object)


def test_without_a_second_solution_there_are_claims_alone(design: Design, tmp_path: Path) -> None:
    flight = hold(design, files(tmp_path, fixes=FIXES)["fixes"])
    assert flight.result.verdict == "cannot be told"
    assert "no second solution" in sentence(flight.result)
    assert answer(flight.result).sentences[-1] == "No second solution: only what the file claims."
    assert "claims no accuracy" in str(flight_blocks(flight))
    assert "second solution" in str(jump_block(flight))
    assert np.isnan(timelines(flight, main_figure(flight))[1].lines[0].y).all()


def test_what_goes_to_the_page_is_small_and_a_report_has_it(design: Design, tmp_path: Path) -> None:
    time = np.arange(0.0, 400.0, 0.02)
    fine = table(time, np.zeros((len(time), 3)))
    given = files(tmp_path, fixes=FIXES, fine=fine)
    flight = hold(design, given["fine"], given["fixes"], relation="independent")
    assert len(flight.result.solution.time_s) <= 2000 < len(time)
    assert flight.data["solution"]["rate_hz"] == pytest.approx(50.0)  # of the whole
    assert len(pickle.dumps(flight)) < 3_000_000
    assert len(map_chart(flight).lines[0].x) == len(flight.result.solution.time_s)
    sections = study_sections({"flown": flight}, design, "a")
    assert [section.title.partition(":")[0] for section in sections] == ["As flown", "As flown"]
    (left_out,) = study_sections({"flown": flight}, design.replace({"gnss.position_noise": 2.0}), "a")
    assert "another design" in str(left_out)


def sbet(seconds: int) -> bytes:
    """Northwards at 60 m/s, 200 records a second."""
    return b"".join(
        struct.pack("<17d", t / 200.0, 0.8 + t * 4.7e-8, 0.2, 500.0, 60.0, *([0.0] * 12))
        for t in range(200 * seconds)
    )


def accuracies(start: float) -> bytes:
    return b"".join(struct.pack("<10d", start + t, *([0.02] * 9)) for t in range(10))


def test_an_sbet_takes_its_accuracies_by_the_same_button() -> None:
    both = SolutionFiles()
    with pytest.raises(InputError, match=r"Choose the SBET file first"):
        when_done(lambda: both.take("smrmsg.out", accuracies(0.0)))
    when_done(lambda: both.take("sbet.out", sbet(10)))
    when_done(lambda: both.take("smrmsg.out", accuracies(0.0)))
    assert both.names == "sbet.out with smrmsg.out"
    when_done(lambda: both.take("sbet.out", sbet(10)))
    assert both.names == "sbet.out"


def test_a_refusal_names_the_file_to_blame_as_the_person_does(design: Design, tmp_path: Path) -> None:
    given = files(tmp_path, sbet=sbet(10), smrmsg=accuracies(5000.0))
    with pytest.raises(InputError, match=r"^sbet\.csv: has no time in common with smrmsg\.csv "):
        hold(design, given["sbet"] + given["smrmsg"])
    with pytest.raises(InputError, match=r"lasts 10\.0 s; a flight needs 20\."):
        hold(design, given["sbet"])
    assert {file.name for file in tmp_path.iterdir()} == {"sbet", "smrmsg"}  # nothing else is left there


def test_what_is_not_known_or_endless_is_null_in_json(design: Design, tmp_path: Path) -> None:
    given = files(tmp_path, fixes=FIXES, truth=REFERENCE)
    result = hold(design, given["fixes"], given["truth"]).result
    line = result.lines[0]
    figures = {name: replace(one, high_95=math.inf, ratio=math.nan) for name, one in line.figures.items()}
    receiver = {"velocity": {"value": 0.1, "declared": math.nan}}
    data = to_json(replace(result, lines=(replace(line, figures=figures),), receiver=receiver))
    plain = json.loads(json.dumps(data, allow_nan=False))
    assert plain["lines"][0]["figures"]["horizontal_position"]["high_95"] is None
    assert plain["receiver"]["velocity"] == {"value": 0.1, "declared": None}


def test_a_flight_is_kept_with_the_saved_design_alone(
    session: Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shelf = Library(tmp_path / "library.db")
    monkeypatch.setattr(flown_page, "library", lambda: shelf)
    page = brought(FlownPage(session))
    after(page, page.begin)
    page._ending()
    session.author = "Ann"
    assert "kept with a saved design" in asyncio.run(page._keep())
    assert session.change({"name": "Alpha"}) is None  # as it is saved, which no figure follows from
    revision = shelf.save(session.budget, "Ann")
    session.came_from(revision)
    assert not page._outdated
    assert asyncio.run(page._keep()) == "The flight is kept with revision 1 of Alpha."
    (flight,) = flights_of(shelf, [revision.key])
    assert (flight.author, flight.verdict) == ("Ann", page.run.result.result.verdict)
    assert [name for name, _ in flight.files] == ["fixes.csv", "truth.csv"]
    assert flight.sentence == sentence(page.run.result.result)
    assert session.change({"imu.angle_random_walk": 2e-5}) is None
    assert "Computed before the change of angle random walk" in page._outdated
    assert "against other inputs" in asyncio.run(page._keep())
    shelf.close()


def test_each_sentence_of_a_verdict_begins_with_a_capital(design: Design, tmp_path: Path) -> None:
    given = files(tmp_path, fixes=FIXES, truth=REFERENCE)
    result = hold(design.replace({"requirements.vertical_position": 3.0}), given["fixes"], given["truth"]).result
    words = sentence(result)
    assert re.match(
        r"Met \(the reference .*\)\. Horizontal position of 2\sm: met on .*; vertical position of 3\sm: ", words
    )
    assert all(one[0].isupper() and one[-1] == "." for one in answer(result).sentences)


def test_claims_of_attitude_alone_do_not_swell_what_goes_to_the_page(design: Design, tmp_path: Path) -> None:
    time = np.arange(0.0, 400.0, 0.02)
    names, *rows = table(time, np.zeros((len(time), 3))).decode().splitlines()
    beside = ",sd_roll [deg],sd_pitch [deg],sd_heading [deg]", ",0.010123,0.010234,0.050345"
    content = "\n".join([names + beside[0], *(row + beside[1] for row in rows)]).encode()
    flight = hold(design, files(tmp_path, fine=content)["fine"])
    assert flight.data["claims"]["stretch 1"]["heading"]["claimed"] == pytest.approx(math.radians(0.050345))
    assert len(pickle.dumps(flight)) < 500_000

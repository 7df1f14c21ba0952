"""The Suborbital page without a browser: what is put in force, what is shown, what is taken away."""

import asyncio
import json
import math

import numpy as np
import pytest
from bokeh.document import Document
from flight_files import format_flight
from pages import when_done
from panel.io.state import set_curdoc

from app.document.numbers import show
from app.serving.server import first_design
from app.session import Session
from app.subjects.suborbital import studies
from app.subjects.suborbital.answer import answer
from app.subjects.suborbital.camera import CameraNoisePanel
from app.subjects.suborbital.charts import attitude, errors
from app.subjects.suborbital.charts.camera_noise import camera_noise_answer
from app.subjects.suborbital.charts.content import Content
from app.subjects.suborbital.page import SuborbitalPage
from app.subjects.suborbital.tables import PAPER_NOTE, gap_table, paper_tables, source_table
from app.subjects.suborbital.views import VIEWS
from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.camera_noise import CameraNoise
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, follows_design
from nav_model.suborbital.study_file import format_study, from_link, to_link
from nav_model.suborbital.survey import Survey, run_survey

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def survey() -> Survey:
    return run_survey(DEFAULTS)


@pytest.fixture
def here(survey: Survey) -> SuborbitalPage:
    """The page with the reference case, whose values are printed."""
    session = Session(first_design())
    session.study_link = to_link(DEFAULTS)
    here = SuborbitalPage(session)
    here.run.result = survey
    return here


def flown(page: SuborbitalPage, trajectory: tuple[str, bytes] | None) -> None:
    """Fly a file, up to its answer or its refusal."""
    when_done(lambda: setattr(page.inputs, "trajectory", trajectory), page.run)


def test_an_input_moves_every_curve_and_says_so(here: SuborbitalPage) -> None:
    before = here.study.page
    assert before.exact
    assert here.inputs.put("gyros.bias", INPUTS["gyros.bias"].read("6, 8, 4 °/h")) is None
    after = here.study.page
    assert not after.exact
    k = after.study.case("gyro total")
    change = after.study.pure.position_m[k, -1] - before.study.pure.position_m[k, -1]
    assert np.linalg.norm(change) > 10_000
    assert "Linearised from the last full simulation" in here._strip._text.object
    # and back: the exact answer again
    here.inputs.put("gyros.bias", DEFAULTS["gyros.bias"])
    assert here.study.page.exact


def test_a_refusal_stands_at_the_field_and_changes_nothing(here: SuborbitalPage) -> None:
    before, sheet = here.inputs.settings, here.inputs.sheet
    sheet.enter("gyros.bias", "5 kg")
    assert "not a unit of angular rate" in sheet.news["gyros.bias"]["error"]
    assert here.inputs.settings is before
    sheet.enter("gyros.bias", "2 °/h")
    assert sheet.news["gyros.bias"]["error"] == ""
    assert sheet.news["gyros.bias"]["text"] == "2, 2, 2 °/h"
    assert sheet.news["gyros.bias"]["mark"] == "≠"


def test_a_slider_keeps_the_ratio_of_the_axes(here: SuborbitalPage) -> None:
    sheet = here.inputs.sheet
    sheet._handle_msg(
        {"key": "gyros.bias", "place": float(np.log10(INPUTS["gyros.bias"].read("8 °/h")[0])), "number": 1}
    )
    assert here.inputs.settings["gyros.bias"] == pytest.approx([2 * x for x in DEFAULTS["gyros.bias"]], rel=1e-3)
    sheet._handle_msg({"key": "gyros.bias", "place": -20.0, "number": 1})
    assert here.inputs.settings["gyros.bias"] == (0.0, 0.0, 0.0)


def test_tables_hold_the_study_and_name_the_papers_values_as_comparison(here: SuborbitalPage) -> None:
    page = here.study.page
    tables = paper_tables(page)
    assert len(tables) == 4
    bias = next(row for row in tables[0].rows if row[0].text == "accelerometer bias")
    assert [cell.text for cell in bias[1:4]] == ["−125", "−11200", "20300"]
    # Sorted by size, not by sign.
    assert [cell.sort for cell in bias[1:4]] == pytest.approx([125.14, 11226.05, 20252.26], abs=5.0)
    assert [cell.sort for cell in bias[-3:]] == [10500.0, 8000.0, 20000.0]
    assert all(PAPER_NOTE in table.note for table in tables)
    assert len(source_table(page).rows) == len(page.study.names) + 1


def test_decoupled_channel_is_shown_failing_where_it_does(survey: Survey) -> None:
    """star_tracker.md: gyro total in height 36.8 km by the channel, 13.6 km by the INS."""
    chart = errors.growth_chart(Content(survey, survey.study, survey.settings, case="gyro total"))
    lines = {line.key: line for line in chart.lines}
    assert lines["fails"].y[-1] == pytest.approx(36.8e3, rel=0.01)
    assert lines["ins"].y[-1] == pytest.approx(13.6e3, rel=0.01)
    assert np.isnan(lines["holds"].y[-1])
    assert "36.8 km where the INS has 13.6 km" in chart.knowledge
    # the slope line grows by e in one e-folding time at its height
    x, slope = lines["slope"].x, np.log(lines["slope"].y)
    at = 200
    rate = (slope[at + 1] - slope[at - 1]) / (x[at + 1] - x[at - 1])
    height = float(np.interp(x[at], survey.study.flight.time_s, survey.study.flight.height_m))
    assert 1 / rate == pytest.approx(np.sqrt((6371e3 + height) ** 3 / 3.986004418e14 / 2), rel=1e-4)


def test_star_chart_shows_the_stars_inside_the_square(survey: Survey) -> None:
    for index in (50, 250, 500):
        chart = attitude.star_chart(Content(survey, survey.study, survey.settings, star_index=index))
        places, measured = chart.points
        assert len(places.x) >= 3
        assert np.all((places.x > -0.5) & (places.x < 1023.5) & (places.y > -0.5) & (places.y < 1023.5))
        assert np.hypot(places.x - measured.x, places.y - measured.y).max() < 5  # 10 arcsec is a third of a pixel
        assert all(name.startswith("HIP ") for name in places.names)


def test_every_view_is_built_and_fed(here: SuborbitalPage) -> None:
    for view in VIEWS:
        here.study.views.chosen = view.name
        here.study.param.trigger("page")  # fed a second time
    contents = [here.study.views._places[view.name][0][0] for view in VIEWS]
    assert len({id(content) for content in contents}) == len(VIEWS)
    # what is opened after the curves have moved shows the moved ones
    here.study.views.chosen = VIEWS[0].name
    here.inputs.put("gyros.bias", (0.0, 0.0, 0.0))
    here.study.views.chosen = VIEWS[1].name
    assert not here.study.page.exact


def test_the_inertial_unit_is_the_designs(survey: Survey) -> None:
    session = Session(first_design())
    page = SuborbitalPage(session)
    page.run.result = survey
    session.param.watch(lambda event: page.show(event.new), "budget")
    imu = session.design.imu
    assert page.inputs.settings["gyros.white_noise"] == imu.angle_random_walk * imu.vibration_factor
    assert session.study_link == ""  # nothing to say beside the design
    session.change({"imu.angle_random_walk": 2e-5, "imu.gyro_bias": 1e-6})
    assert page.inputs.settings["gyros.white_noise"] == 2e-5
    assert np.abs(page.inputs.settings["gyros.bias"]).tolist() == [1e-6] * 3


def test_what_a_person_set_stays_while_the_design_moves(here: SuborbitalPage) -> None:
    here.inputs._take_design()
    here.inputs.put("gyros.bias", (1e-6, 1e-6, 1e-6))
    here.inputs.follow(first_design().replace({"imu.angle_random_walk": 2e-5, "imu.gyro_bias": 5e-6}))
    assert here.inputs.settings["gyros.bias"] == (1e-6, 1e-6, 1e-6)
    assert here.inputs.settings["gyros.white_noise"] == 2e-5
    linked = from_link(to_link(here.inputs.settings), first_design().replace({"imu.angle_random_walk": 3e-5}))
    assert linked["gyros.bias"] == (1e-6, 1e-6, 1e-6)
    assert linked["gyros.white_noise"] == 3e-5  # the design's that the link is opened beside


def test_exact_run_in_a_process_shows_progress(here: SuborbitalPage) -> None:
    here.inputs.put("gyros.bias", INPUTS["gyros.bias"].read("6, 8, 4 °/h"))
    progress: list[tuple[bool, str]] = []
    here.run.param.watch(
        lambda event: progress.append((here._session.running, event.new.words)) if event.new else None, "progress"
    )
    when_done(here.begin, here.run)
    assert any(running and "error sources" in words for running, words in progress)
    assert here.study.page.exact
    assert "From the full simulation" in here._strip._text.object
    assert not here._session.running


def test_who_asks_the_same_study_has_it_at_once(
    here: SuborbitalPage, nothing_kept: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def flies(*_: object, **__: object) -> Survey | None:
        return here._result

    async def opened(link: str) -> tuple[SuborbitalPage, bool]:
        session = Session(first_design())
        session.study_link = link
        with set_curdoc(Document()):
            other = SuborbitalPage(session)
        running = other.run.running
        other.run.cancel()
        return other, running

    monkeypatch.setattr(studies, "run_alone", flies)
    flown(here, ("mine.csv", b""))
    assert asyncio.run(opened(to_link(DEFAULTS)))[1]  # what was flown from a file is another study
    flown(here, None)
    other, running = asyncio.run(opened(to_link(DEFAULTS)))
    assert not running
    assert other._result is here._result
    assert other.study.page.exact
    assert other._strip._text.object == here._strip._text.object
    assert asyncio.run(opened("study.gyros.bias=6,8,4deg/h"))[1]


def test_a_bad_trajectory_is_said_by_name(here: SuborbitalPage) -> None:
    before = here.study.page
    flown(here, ("mine.csv", b"a,b\n1,2\n"))
    assert "mine.csv: columns time_s" in here.inputs.notice.object
    assert here.inputs.trajectory is None
    assert here._result is before.survey


def test_a_study_is_saved_opened_and_linked_without_loss(here: SuborbitalPage, survey: Survey) -> None:
    here.inputs.put("gyros.bias", INPUTS["gyros.bias"].read("6.1, 8, -4 °/h"))
    trajectory = ("flown.csv", format_flight(survey.study.flight, every=10))
    text = format_study(here.inputs.settings, trajectory).encode()
    session = Session(first_design())
    session.study_link = to_link(here.inputs.settings)
    linked = SuborbitalPage(session)
    assert dict(linked.inputs.settings.values) == dict(here.inputs.settings.values)
    other = SuborbitalPage(Session(first_design()))

    async def opened() -> bool:
        await other.inputs.open("mine.toml", text)
        running = other.run.running
        other.run.cancel()
        return running

    assert asyncio.run(opened())
    assert dict(other.inputs.settings.values) == dict(here.inputs.settings.values)
    assert other.inputs.trajectory == trajectory
    assert "mine.toml" in other.inputs.settings.origin["gyros.bias"]


def test_a_wrong_study_is_refused_by_name_and_changes_nothing(here: SuborbitalPage) -> None:
    before = here.inputs.settings
    for content, message in (
        (b'study = "suborbital"\n[gyros]\nbias = "5 kg"\n', "gyros.bias: &#x27;kg&#x27; is not a unit"),
        (b'[imu]\npreset = "LN-200"\n', "study: is missing"),
    ):
        asyncio.run(here.inputs.open("mine.toml", content))
        assert message in here.inputs.notice.object
        assert here.inputs.notice.visible
        assert here.inputs.settings is before
    session = Session(first_design())
    session.study_link = "study.gyros.bias=5kg"
    linked = SuborbitalPage(session)
    assert "The link&#x27;s study was not used. gyros.bias" in linked.inputs.notice.object
    assert follows_design(linked.inputs.settings)


def test_a_frame_interval_between_steps_is_refused_and_its_slider_keeps_to_the_steps(here: SuborbitalPage) -> None:
    assert "whole number of steps" in str(here.inputs.put("tracker.frame_interval", 0.15))

    def slid() -> None:
        here.inputs.sheet._handle_msg({"key": "tracker.frame_interval", "place": float(np.log10(0.34)), "number": 1})
        assert here.study.page.exact  # other frames need other matrices first

    when_done(slid, here.renewal)
    assert here.inputs.settings["tracker.frame_interval"] == pytest.approx(0.3)
    assert here.renewal.message == ""
    assert not here.study.page.exact
    assert here.study.page.study.used.sum() < here._result.study.used.sum()


def test_white_noise_follows_the_inputs_and_the_study_is_taken_away(here: SuborbitalPage) -> None:
    page = here.study.page
    before = [line.y[-1] for line in errors.noise_chart(page, 2).lines]
    document = json.loads(here._json())
    assert document["exact"]
    assert document["final_m"]["all"]["up"] == pytest.approx(27319.33, abs=5.0)  # as the command has it
    for key in ("gyros.white_noise", "accelerometers.white_noise"):
        here.inputs.put(key, 2 * page.settings[key])
    after = [line.y[-1] for line in errors.noise_chart(here.study.page, 2).lines]
    assert after == pytest.approx([2 * sigma for sigma in before], rel=1e-9)


def test_horizontal_errors_are_also_shown_along_and_across_the_track(survey: Survey) -> None:
    study = survey.study
    k = study.case("all")
    along, across = (
        errors.aided_chart(Content(survey, study, DEFAULTS, "all", along_track=True), c).lines[0].y[-1]
        for c in (0, 1)
    )
    assert (along, across) == pytest.approx(
        (study.pure.down_range_m[k, -1] / 1e3, study.pure.cross_range_m[k, -1] / 1e3)
    )
    assert np.hypot(along, across) == pytest.approx(np.hypot(*study.pure.position_m[k, -1, :2]) / 1e3)
    named = errors.source_chart(Content(survey, study, DEFAULTS, along_track=True), 1)
    assert named.title == "Cross-range error by source, INS alone"


def test_everything_has_white_noise_and_says_that_signed_errors_cancel(survey: Survey) -> None:
    study = survey.study
    word, figures = answer(Content(survey, study, DEFAULTS))
    first, noise = figures.items[0], figures.items[-1]
    assert (first.label, noise.label) == ("Everything", "White noise, 1σ")
    k = study.names.index("all")
    for systematic, spread, text in zip(
        (study.pure, study.aided), (study.pure_noise, study.aided_noise), first.value.split(" → "), strict=True
    ):
        whole = math.sqrt(sum(systematic.position_m[k, -1] ** 2) + sum(spread.position_sigma_m[-1] ** 2))
        assert text.replace("\u00a0", " ") == show(whole, "length")
    assert "partly cancel" in first.detail
    assert first.value.partition(" → ")[2] in word.word
    accelerometers = np.linalg.norm(study.aided.position_m[study.names.index("accelerometer total"), -1])
    everything = math.hypot(
        np.linalg.norm(study.aided.position_m[k, -1]), np.linalg.norm(study.aided_noise.position_sigma_m[-1])
    )
    assert (accelerometers > everything) == ("signed errors partly cancel" in word.sentences[0])


def test_linear_gap_names_the_row_that_is_beyond_the_promise(survey: Survey) -> None:
    table = gap_table(Content(survey, survey.study, survey.settings))
    assert "sum of signed errors is off by 0.6 %" in table.note
    assert len(table.rows) == len(survey.study.names) - 1


def test_why_a_sweep_of_camera_noise_ended_is_text() -> None:
    panel = CameraNoisePanel(Session(first_design()))
    panel._settings = DEFAULTS
    panel.run.param.update(running=True)
    panel.run.param.update(running=False, message="<b>no & such</b>")
    assert panel._message.object == "<p role='alert'>&lt;b&gt;no &amp; such&lt;/b&gt;</p>"


def test_camera_noise_exceeds_that_of_the_imu_where_the_curves_cross() -> None:
    """A camera of 5 m an arcsecond beside an IMU of 20 m: 4 arcsec, between two points of the grid."""
    arcsec = np.array([1.0, 3.0, 9.0, 27.0])
    camera = 5.0 * arcsec
    swept = CameraNoise(
        centroid_rad=arcsec * ARCSECOND,
        total_m=np.hypot(camera, 20.0),
        camera_m=camera,
        alone_m=4000.0,
    )
    assert camera_noise_answer(swept, 3 * ARCSECOND).word == "Camera noise exceeds IMU noise above about 4.0 arcsec"

"""The SAR page and the command without a browser: what follows the sliders, what goes stale, what is refused."""

import asyncio
import io
import json
import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from commanded import reply
from known_designs import MEMS
from pages import at_once, when_done

from app.charts.kinds import PictureChart, to_csv
from app.charts.print.svg import to_svg
from app.charts.screen.pictures import picture_gallery
from app.cli import main
from app.document.pane import html_of
from app.serving.server import first_design
from app.session import Session
from app.subjects.sar import run as sar_run
from app.subjects.sar import upload as sar_upload
from app.subjects.sar.charts import residual_chart, winner_chart
from app.subjects.sar.page import SarPage
from app.subjects.sar.report import sections
from app.subjects.sar.run import SarResult, run_strategies
from app.subjects.sar.tables import answer, error_table
from app.work.run import Run
from nav_model.budget import analyse
from nav_model.design.contributors import Contributor
from nav_model.design.link import split_link
from nav_model.sar.design_study import closed_forms
from nav_model.sar.strategies import NAMES

pytestmark = pytest.mark.long


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> Session:
    for part in (sar_run, sar_upload):
        monkeypatch.setattr(part, "run_in_pool", at_once)
    return Session(first_design())


@pytest.fixture
def sar(session: Session) -> SarPage:
    page = SarPage(session)
    session.param.watch(lambda event: page.show(event.new), "budget")
    return page


def run(sar: SarPage) -> None:
    when_done(sar.begin, sar.run)


def strip(sar: SarPage) -> str:
    """Text of the answer strip."""
    return sar._strip._text.object.replace("\xa0", " ")


def part(sar: SarPage, title: str) -> Any:
    """The part that unfolds under a title."""
    folded = sar._details
    index = [name for name, _ in folded._parts].index(title)
    folded._view.active = sorted({*folded._view.active, index})
    return folded._places[index][0]


def names(sar: SarPage) -> list[str]:
    """The strategies in their order."""
    return re.findall(r'<th scope="row">([^<]+)<small>', sar._ranks.object)


def test_formulas_are_there_before_any_run_and_nothing_folded_is_made(sar: SarPage) -> None:
    assert "✗ Does not close" in strip(sar)
    assert "Detrended phase 54.7°, limit 20° at 1σ" in strip(sar)
    assert "No strategy meets 20° in real time. Closest: INS from filter, in use, 54.7°." in strip(sar)
    assert "Formulas only so far." in sar._bar.state.object
    formulas = ["Whole-leg smoother", "INS from filter", "Quadratic fit, noise-weighted", "Quadratic fit"]
    assert names(sar)[:4] == formulas
    assert sar._ranks.object.count("…") == 4
    assert "reconstruction" in sar._ranks.object
    assert sar._images.object.count('class="blank"') == 9
    assert not any(place.objects for place in sar._details._places)
    assert (
        "Appears when the strategies have been run"
        in part(sar, "Parts of the error, impulse response in numbers").object
    )
    assert len(part(sar, "Error histories and impulse responses")) == 1  # no figure without data


def test_ins_after_outage_is_shown_where_there_is_an_outage(sar: SarPage, session: Session) -> None:
    """Without one it is INS from filter a second time."""
    assert "INS after outage" not in sar._ranks.object
    session.change({"coast.before_aperture": 5.0})
    sar.show(session.budget)
    assert "INS after outage" in names(sar)
    assert "INS after outage" in html_of(error_table(session.budget, sar._closed, None, "page"))


def test_a_requirement_at_two_sigma_is_at_two_sigma_in_strip_and_rows(session: Session) -> None:
    session.change({"requirements.confidence": 2.0})
    budget = session.budget
    check = next(check for check in budget.verdict.checks if check.name == "detrended_phase")
    chart = residual_chart(budget, closed_forms(budget), None)
    assert chart.x_label == "detrended phase, rms at 2σ [°]"
    row = next(dot for dot in chart.dots if dot.label == "INS from filter")
    assert math.radians(row.closed) == pytest.approx(check.value)
    assert math.radians(chart.limit) == pytest.approx(check.limit)
    block = answer(budget, closed_forms(budget), None)
    assert (block.word, block.tone) == ("✗ Does not close", "bad")
    assert block.sentences[0].startswith("Detrended phase 109°, limit 20° at 2σ; ")
    closest = "No strategy meets 20° at 2σ in real time. Closest: INS from filter, in use, 109°."
    assert block.sentences[1:] == (closest,)


def test_a_run_fills_the_page_and_a_change_marks_it_stale(sar: SarPage, session: Session) -> None:
    run(sar)
    assert not session.running
    assert "The runs match the design. 50 runs of the error model, seed 0." in sar._bar.state.object
    study = sar._result.study
    assert "✗ Does not close" in strip(sar)
    assert "Detrended phase 54.7°, limit 20°" in strip(sar)
    named = re.search(r"No strategy meets 20° in real time. Closest: ([^,]+), ([\d.]+)°\.", strip(sar))
    ranked = sorted((key for key in NAMES if key not in "13"), key=study.residual)
    assert names(sar) == [NAMES[key] for key in ranked]
    # What the strip names is marked in the table, has its value there, and nothing better can be used.
    best = re.search(r'<tr class="best"><th scope="row">([^<]+).*?<td class="num">([\d.]+)<', sar._ranks.object)
    assert best.groups() == named.groups()
    assert best[1] == next(name for name in names(sar) if name != "Whole-leg smoother")
    shown, _, weak = sar._images.object.partition("No point to see: ")
    assert shown.count("<figure") + weak.count("peak") == 9
    tables = part(sar, "Parts of the error, impulse response in numbers")
    assert tables.object.count("<table") == 3
    reasons = part(sar, "Why, and what would change it")
    marked = (sar._rank_head, sar._image_head, tables)
    assert not any("stale" in pane.object for pane in marked)
    before = strip(sar)
    session.change({"name": "B", "requirements.horizontal_position": 0.1})
    assert "stale" not in tables.object  # the runs know no requirement on a position
    session.change({"gnss.position_noise": 0.001})
    assert all("stale" in pane.object for pane in marked)
    assert "The runs are older than position noise. Run again." in sar._bar.state.object
    assert "The runs are older than position noise. Run again." in strip(sar)
    # Of the formulas again, as the runs no longer count.
    assert re.search(r"Quadratic fit meets 20° in real time: [\d.]+°\.", strip(sar))
    assert "yours is 1\xa0mm" in reasons.object
    session.undo()
    session.undo()
    assert "stale" not in tables.object
    assert strip(sar) == before


def test_runs_without_an_input_that_moves_their_phases_are_old(sar: SarPage, session: Session) -> None:
    """A contributor, a confidence, a limit or the processing is in the rows and images that are shown: runs made
    without it are marked, and it is named."""
    run(sar)
    arm = Contributor("lever arm", 0.7e-3, "detrended_phase", "length")
    entries = replace(session.design.entries, contributors=(arm,))
    for changes, given, name in (
        ({}, entries, 'contributor "lever arm"'),
        ({"requirements.confidence": 2.0}, None, "confidence"),
        ({"requirements.detrended_phase": 0.3}, None, "limit on detrended phase"),
        ({"processing.mode": "post-processed"}, None, "processing"),
        ({"gnss.correlated": True}, None, "slow error"),
    ):
        assert "The runs match the design." in sar._bar.state.object
        assert session.change(changes, entries=given) is None
        assert f"The runs are older than {name}. Run again." in strip(sar).replace("&quot;", '"')
        assert "The runs match the design." not in sar._bar.state.object
        session.undo()
    session.change({}, entries=entries)
    run(sar)
    assert "The runs match the design." in sar._bar.state.object


def test_a_run_is_told_step_by_step_and_cancelled_at_once(session: Session) -> None:
    progress: list[str] = []

    async def work(run: Run) -> SarResult:
        return await run_strategies(run, session.budget, 1000, 0)

    def stop(event: Any) -> None:
        if event.new is not None:
            progress.append(event.new.what)
            if event.new.share:
                runner.cancel()

    runner = Run()
    runner.param.watch(stop, "progress")
    when_done(lambda: runner.start(work))
    assert progress == ["0 of 1000 runs", "50 of 1000 runs"]
    assert runner.message == "Cancelled: 50 of 1000 runs."
    assert runner.result is None


def test_settings_travel_in_the_link_and_the_server_still_has_the_result(sar: SarPage, session: Session) -> None:
    sar.param.update(runs=100, seed="7")
    assert session.link.endswith("sar.runs=100&sar.seed=7")
    run(sar)
    again = Session(first_design())
    again.take_studies(split_link(session.link)[1])
    page = SarPage(again)
    assert (page.runs, page.seed, page.engine) == (100, "7", "fast")
    assert page._result is sar._result
    assert "The runs match the design. 100 runs" in page._bar.state.object
    other = SarPage(Session(first_design()))  # with the usual settings
    assert other._result is None
    wrong = Session(first_design())
    wrong.take_studies("sar.runs=7&sar.engine=banana&sar.nothing=1")
    assert (SarPage(wrong).runs, SarPage(wrong).engine) == (50, "fast")


def test_what_cannot_be_run_is_said(sar: SarPage, session: Session) -> None:
    sar.seed = "-1"
    run(sar)
    assert "Seed" in sar._bar.state.object
    assert "whole number from 0" in sar._bar.state.object
    sar.seed = "0"
    session.change({"radar.grazing_angle": np.pi / 2})
    run(sar)
    assert "Grazing angle" in sar._bar.state.object
    assert not session.running


def test_the_map_has_the_design_the_catalogue_and_the_limit(session: Session) -> None:
    chart = winner_chart(session.budget)
    assert chart.points[1].x[0] == session.budget.sar.aperture_time
    assert "F-SAR X" in chart.points[0].names
    assert np.isfinite(chart.contour.x).any()
    limit = session.design.requirements.detrended_phase
    # On the contour the phase is the limit: the map's own values about it agree.
    point = np.flatnonzero(np.isfinite(chart.contour.x))[3]
    row = np.abs(np.log(chart.y / chart.contour.y[point])).argmin()
    column = np.abs(np.log(chart.x / chart.contour.x[point])).argmin()
    assert chart.values[row, column] == pytest.approx(np.degrees(limit), rel=0.3)
    assert to_csv(chart).count("\n") == 1 + chart.winner.size + len(chart.points[0].names) + 1
    session.change({"requirements.detrended_phase": None})
    assert np.isnan(winner_chart(session.budget).contour.x).all()


def test_on_a_post_processed_map_the_contour_is_where_the_smoother_meets_the_limit(session: Session) -> None:
    design = session.design.replace(
        {"processing.mode": "post-processed", "radar.slant_range": 2e4}
    )  # it hardly turns
    chart = winner_chart(analyse(design))
    drawn = np.flatnonzero(np.isfinite(chart.contour.x))
    for place in drawn[[5, len(drawn) // 2, -5]]:
        noise = float(chart.contour.y[place])
        there = {"radar.aperture_time": float(chart.contour.x[place]), "gnss.position_noise": noise}
        sigma = analyse(design.replace(there))["detrended_phase", "post-processed"].sigma
        assert sigma == pytest.approx(design.requirements.detrended_phase, rel=0.04)


def test_an_upload_is_refused_by_name_formed_when_it_is_good_and_told_in_the_report(
    sar: SarPage, session: Session
) -> None:
    upload = sar._upload

    def form(**changes: Any) -> str:
        when_done(lambda: upload.param.update(**changes), upload.run)
        return upload._bar.state.object

    def opened(name: str, content: bytes) -> str:
        when_done(lambda: upload._opened(name, content), upload.run)
        return upload._bar.state.object

    assert "run the strategies first" in opened("mine.npz", b"junk")
    upload.file = None
    run(sar)
    assert "&lt;b&gt;.npz: not a readable NPZ" in opened("<b>.npz", b"junk")
    assert opened("<b>.npz", _point_file()) == ""
    assert opened("point.npz", _point_file()) == ""
    images = upload._images
    assert upload._pictures.object.count("<figure") == 2
    assert "without navigation error" in upload._pictures.object
    assert images.visible
    finding = session.findings["sar"]
    (section,) = (part for part in sections(finding, "d") if part.title == "SAR: images")
    assert [block.chart.key for block in section.blocks] == ["sar-point", "sar-phase-history"]
    assert "point.npz" in to_svg(section.blocks[-1].chart)
    assert "wide&#x27; is not a number from 1 to 5000" in form(half_width="wide")
    assert not images.visible
    form(half_width="60")
    assert images.visible
    when_done(sar.begin, sar.run, upload.run)
    assert images.visible  # formed with the new study's error
    assert session.findings["sar"].uploaded is upload.run.result
    upload._refused("larger than 34 MB")
    assert "Not formed. larger than 34 MB" in upload._bar.state.object
    upload._on_disk.delete()


def _point_file() -> bytes:
    """A point at the scene centre, seen over one degree at X band."""
    angle = np.radians(np.linspace(-0.5, 0.5, 64))
    data = io.BytesIO()
    ones = np.full(64, 7000.0)
    np.savez(
        data, fp=np.ones((64, 64), complex), freq=9.6e9 + np.linspace(-7e7, 7e7, 64), r0=ones,
        x=7000 * np.sin(angle), y=-7000 * np.cos(angle), z=0 * ones,
    )  # fmt: skip
    return data.getvalue()


def test_pictures_say_what_they_show_and_escape_it() -> None:
    html = picture_gallery(
        PictureChart(
            "k", "t", "x [m]", "y [m]", np.arange(4.0), np.arange(4.0), np.zeros((1, 4, 4)), ("<i>",), ('a "b"',), "r"
        )
    )
    assert "<i>" not in html
    assert 'alt="&lt;i&gt;: a &quot;b&quot;; x 0 to 3 m across, y 0 to 3 m upwards"' in html


def test_a_row_of_pictures_has_room_for_what_shows_a_point_and_names_the_others() -> None:
    power = np.stack([np.zeros((4, 4)), np.full((4, 4), -20.1)])
    chart = PictureChart(
        "k", "t", "x [m]", "y [m]", np.arange(4.0), np.arange(4.0), power, ("a", "b & c"), ("peak", "−20.1"), "r"
    )
    assert picture_gallery(chart).count("<figure") == 2
    row = picture_gallery(chart, row=True)
    assert row.count("<figure") == 1
    assert "No point to see: b &amp; c, −20.1." in row


def test_sar_command_writes_the_study(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "o.json"
    assert main(["sar", MEMS, "--runs", "20", "--seed", "3", "-o", str(out)]) == 0
    data = json.loads(out.read_text(encoding="utf-8"))
    assert (data["runs"], data["seed"], len(data["strategies"])) == (20, 3, 10)
    assert data["aperture_time_s"] == analyse(first_design()).sar.aperture_time
    assert reply(capsys, "sar", MEMS, "--runs", "20", "--seed", "3") == data


def test_the_simulator_is_a_second_engine_and_stands_beside_the_first(sar: SarPage, session: Session) -> None:
    session.change({"radar.aperture_time": 3.0})
    sar.engine = "simulator"
    run(sar)
    assert "50 flights of the simulator" in sar._bar.state.object
    tables = part(sar, "Parts of the error, impulse response in numbers")
    assert "Simulator and error model compared" in tables.object
    assert "WGS 84" in part(sar, "Why, and what would change it").object
    result = sar._result
    assert (result.study.engine, result.beside.engine) == ("simulator", "fast")
    # The two are different programs, so only their statistics agree.
    ratio = result.study.rms[1:] / result.beside.rms[1:]
    assert np.all(np.abs(ratio - 1) < 0.5)
    assert not np.allclose(ratio, 1, atol=1e-3)
    session.change({"imu.rate": 200.0})  # flown at the instrument's rate; the error model knows none
    assert "stale" in tables.object


def test_pictures_and_study_are_taken_away(sar: SarPage) -> None:
    run(sar)
    points = sar._result.points
    rows = [row for row, key in enumerate(NAMES) if key != "3"]
    with np.load(io.BytesIO(sar._npz())) as packed:
        assert packed["power_db"].shape == (9, 61, 121)
        np.testing.assert_array_equal(packed["power_db"], points.power_db[rows])
        assert packed["names"][0] == "Ideal"
    drawn = to_svg(sar._points)
    assert drawn.count("<image") >= 9
    assert "RTS smoother of the aperture" in drawn
    assert "azimuth [m]" in drawn
    document = json.loads(asyncio.run(sar._json()))
    assert document["engine"] == "fast"
    assert document["strategies"][1]["residual_rms_over_runs_m"] == sar._result.study.rms[1]

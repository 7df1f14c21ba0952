"""The SAR page and the command without a browser: what follows the sliders, what goes stale, what is refused."""

from __future__ import annotations

import asyncio
import io
import json
from typing import Any

import numpy as np
import pytest
from waiting import soon

import app.subjects.sar.run as sar_run
import app.subjects.sar.upload as sar_upload
from app.charts.kinds import to_csv
from app.charts.print.svg import to_svg
from app.charts.screen.pictures import gallery
from app.cli import main
from app.serving.server import first_design
from app.session import Session
from app.subjects.sar.charts import gnss_winner_chart
from app.subjects.sar.page import SarPage
from app.subjects.sar.report import sections
from app.subjects.sar.run import Progress, SarResult, SarRun
from nav_model.budget import analyse
from nav_model.design.file import format_design

# A button of panel-material-ui passes its own look on in the old words too.
pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")


async def here(function: Any, *arguments: Any) -> Any:
    """Instead of a worker process."""
    await asyncio.sleep(0)
    return function(*arguments)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Session:
    monkeypatch.setattr(sar_run, "elsewhere", here)
    monkeypatch.setattr(sar_upload, "elsewhere", here)
    return Session(first_design())


@pytest.fixture
def sar(session: Session) -> SarPage:
    page = SarPage(session)
    session.param.watch(lambda event: page.show(event.new), "budget")
    return page


def run(sar: SarPage) -> None:
    async def until_done() -> None:
        await sar._begin()
        await soon(lambda: not sar._run.running, "the end of the run")

    asyncio.run(until_done())


def test_closed_forms_stand_before_any_run(sar: SarPage) -> None:
    assert "Use strategy 2" in sar._answer.object
    assert "misses the limit" in sar._answer.object
    assert "have not been run" in sar._state.object
    assert "6 tracking filter ⁽ʳ⁾" in sar._tables.object
    assert "reconstruction" in sar._tables.object


def test_a_run_fills_the_page_and_a_change_marks_it_stale(sar: SarPage, session: Session) -> None:
    run(sar)
    assert not session.running
    assert "The runs match the design" in sar._state.object
    assert "In 100 runs" in sar._answer.object
    assert [pane.object.count("<figure") for pane in sar._pictures] == [9, 9]
    assert "stale" not in sar._tables.object + sar._headings[0].object
    before = sar._answer.object
    session.change({"requirements.quadratic_phase": 0.1})
    assert "stale" not in sar._tables.object  # the ensemble knows no requirement
    session.change({"gnss.position_noise": 0.001})
    for pane in (sar._answer, sar._tables, sar._state, *sar._headings):
        assert "stale" in pane.object
    assert sar._answer.object != before
    assert "these have 1 mm" in sar._answer.object
    session.undo()
    assert "stale" not in sar._tables.object


def test_a_run_is_told_step_by_step_and_cancelled_at_once(session: Session) -> None:
    told: list[Progress | SarResult | str] = []
    runner = SarRun(told.append)

    async def begin_and_cancel() -> None:
        runner.start(session.budget, 1000, 0)
        await soon(lambda: len(told) >= 2, "the first chunk")
        runner.cancel()
        await soon(lambda: not runner.running, "the end of the run")

    asyncio.run(begin_and_cancel())
    assert told[0] == Progress(0, 1000, None)
    assert isinstance(told[1], Progress)
    assert told[1].done == 50
    assert told[1].left is not None
    assert told[-1] == "Cancelled."
    assert not runner.running
    assert not any(isinstance(news, SarResult) for news in told)


def test_what_cannot_be_run_is_said(sar: SarPage, session: Session) -> None:
    sar._seed.value = "-1"
    run(sar)
    assert "Seed" in sar._state.object
    assert "whole number from 0" in sar._state.object
    sar._seed.value = "0"
    session.change({"radar.grazing_angle": np.pi / 2})
    run(sar)
    assert "radar.grazing_angle" in sar._state.object
    assert not session.running


def test_the_map_has_the_design_the_catalogue_and_the_limit(session: Session) -> None:
    chart = gnss_winner_chart(session.budget)
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
    assert np.isnan(gnss_winner_chart(session.budget).contour.x).all()


def test_an_upload_is_refused_by_name_formed_when_it_is_good_and_told_in_the_report(
    sar: SarPage, session: Session
) -> None:
    upload = sar._upload
    asyncio.run(upload._opened(_event(upload, "mine.npz", b"junk")))
    assert "Run the strategies first" in upload._picture.object
    run(sar)
    asyncio.run(upload._opened(_event(upload, "<b>.npz", b"junk")))
    assert "&lt;b&gt;.npz: not a readable npz" in upload._picture.object
    asyncio.run(upload._opened(_event(upload, "big.npz", bytes(sar_upload.MOST_BYTES + 1))))
    assert "big.npz: 32 MiB; at most" in upload._picture.object
    asyncio.run(upload._opened(_event(upload, "point.npz", _point_file())))
    assert upload._picture.object.count("<figure") == 2
    assert "without navigation error" in upload._picture.object
    assert upload._take.view.visible
    kept = session.findings["sar"]
    (images,) = (part for part in sections(kept, "d") if part.title == "SAR: images")
    assert [block.chart.key for block in images.blocks] == ["sar-point", "sar-scene", "sar-phase-history"]
    assert "point.npz" in to_svg(images.blocks[-1].chart)

    async def widen() -> None:  # inside a loop: outside, the framework would make one of its own and leave it
        upload._half.value = "wide"
        await upload._form()

    asyncio.run(widen())
    assert "wide&#x27; is not a number from 1 to 5000" in upload._picture.object
    assert not upload._take.view.visible


def _event(upload: Any, name: str, data: bytes) -> Any:
    upload._input.filename = name
    return type("Event", (), {"new": data})


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
    html = gallery(np.zeros((1, 4, 4)), ["<i>"], ['a "b"'], "azimuth", "reference")
    assert "<i>" not in html
    assert 'alt="&lt;i&gt;: a &quot;b&quot;; azimuth"' in html


def test_sar_command_writes_the_study(
    tmp_path: Any, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, out = tmp_path / "d.toml", tmp_path / "o.json"
    path.write_text(format_design(first_design()), encoding="utf-8")
    assert main(["sar", str(path), "--runs", "20", "--seed", "3", "-o", str(out)]) == 0
    data = json.loads(out.read_text(encoding="utf-8"))
    assert (data["runs"], data["seed"], len(data["strategies"])) == (20, 3, 9)
    assert data["aperture_time_s"] == analyse(first_design()).sar.aperture_time
    assert main(["sar", str(path), "--runs", "20", "--seed", "3"]) == 0
    assert json.loads(capsys.readouterr().out) == data


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--runs", "5"], "runs: 5"),
        (["--seed", "-1"], "--seed"),
        (["--set", "radar.squint_angle=70°"], "radar.squint_angle"),
        (["--set", "radar.grazing_angle=90°"], "radar.grazing_angle"),
        (["-o", "/nonexistent/x.json", "--runs", "20"], "/nonexistent"),
    ],
)
def test_sar_command_refuses_in_one_line(
    tmp_path: Any, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    path = tmp_path / "d.toml"
    path.write_text(format_design(first_design()), encoding="utf-8")
    assert main(["sar", str(path), *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_the_simulator_is_a_second_engine_and_stands_beside_the_first(sar: SarPage, session: Session) -> None:
    session.change({"radar.aperture_time": 3.0})
    sar._engine.value = "simulator"
    run(sar)
    assert "100 flights of the simulator" in sar._state.object
    assert "The two engines beside each other" in sar._tables.object
    assert "WGS 84" in sar._tables.object
    result = sar._result
    assert result is not None
    assert (result.study.engine, result.beside.engine) == ("simulator", "fast")
    # The two are different programs, so only their statistics agree.
    ratio = result.study.rms[1:] / result.beside.rms[1:]
    assert np.all(np.abs(ratio - 1) < 0.5)
    assert not np.allclose(ratio, 1, atol=1e-3)
    session.change({"imu.rate": 200.0})  # flown at the instrument's rate; the error model knows none
    assert "stale" in sar._tables.object


def test_pictures_and_study_are_taken_away(sar: SarPage, monkeypatch: pytest.MonkeyPatch) -> None:
    import app.subjects.sar.picture_downloads as downloads

    monkeypatch.setattr(downloads, "elsewhere", here)
    point, scene = sar._downloads
    assert not point.view.visible
    assert not sar._whole.visible
    run(sar)
    assert point.view.visible
    shown = sar._result.points
    with np.load(point._npz()) as packed:
        assert packed["power_db"].shape == (9, 61, 121)
        np.testing.assert_array_equal(packed["power_db"], shown.power_db)
        assert packed["names"][0] == "1 ideal"
    table = np.loadtxt(asyncio.run(point._csv()), delimiter=",", skiprows=1)
    assert table.shape == (61 * 121, 2 + 9)
    row = 17 * 121 + 40
    assert table[row, :2] == pytest.approx([shown.x[40], shown.y[17]], rel=1e-4)
    assert table[row, 4] == pytest.approx(shown.power_db[2, 17, 40], rel=1e-4)
    drawn = asyncio.run(scene._svg()).getvalue().decode("utf-8")
    assert drawn.count("<image") >= 9
    assert "8 RTS smoother" in drawn
    assert "azimuth [m]" in drawn
    document = json.load(asyncio.run(sar._json()))
    assert document["engine"] == "fast"
    assert document["strategies"][1]["residual_rms_over_runs_m"] == sar._result.study.rms[1]


def test_sar_command_flies_the_simulator(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "d.toml"
    path.write_text(format_design(first_design()), encoding="utf-8")
    options = ["sar", str(path), "--engine", "simulator", "--runs", "20", "--set", "radar.aperture_time=2 s"]
    assert main([*options, "--workers", "1"]) == 0
    told = capsys.readouterr()
    data = json.loads(told.out)
    assert data["engine"] == "simulator"
    assert len(data["agreement"]["strategies"]) == 8
    assert "20 of 20 runs" in told.err
    assert main([*options, "--workers", "0"]) == 2
    assert "--workers" in capsys.readouterr().err

"""The Trajectory page without a browser: what it follows, what it says, what it refuses."""

import asyncio
import csv
import io
import json
import math
import multiprocessing
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from bokeh.events import DoubleTap
from pages import at_once, when_done
from waiting import soon

import app.subjects.trajectory.page as trajectory_page
from app import cli
from app.dashboard.report_choice import ReportChoice
from app.document.blocks import ChartBlock
from app.document.pane import html_of
from app.report.studies import study_sections
from app.serving.server import first_design
from app.session import Session
from app.subjects.trajectory.charts import map_chart, shares_chart, timelines
from app.subjects.trajectory.figures import FIGURES, main_figure
from app.subjects.trajectory.kml import NAMESPACE, as_kml
from app.subjects.trajectory.page import TrajectoryPage, as_csv, as_json
from app.subjects.trajectory.plan_file import as_plan
from app.subjects.trajectory.run import closing_options
from app.subjects.trajectory.tables import line_list, line_table, verdict
from app.work import flight as engine
from app.work.flight import File, Followed, follow
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design
from nav_model.design.trajectory import LIMITED
from nav_model.simulation.monte_carlo import simulate
from nav_model.trajectory import line_length
from nav_model.trajectory.files.reader import parse_file

pytestmark = pytest.mark.long
TWO_LINES = {
    "trajectory.flight": "lines", "trajectory.lines": 2.0, "trajectory.length": 3000.0,
    "trajectory.outages": ((100.0, 130.0),),
}  # fmt: skip
_PLAN = """<gpx><rte><rtept lat="47" lon="8"><ele>3900</ele><name>first</name></rtept>
<rtept lat="47.08" lon="8"></rtept><rtept lat="47.08" lon="8.1"></rtept></rte></gpx>"""


def _places(*rows: tuple[float, float]) -> tuple[tuple[float, float, float, str], ...]:
    return tuple((math.radians(latitude), math.radians(longitude), 3000.0, "", None) for latitude, longitude in rows)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> Session:
    for module, name, value in (
        (trajectory_page, "run_in_pool", at_once),
        (engine, "run_in_pool", at_once),
        (engine, "run_alone", at_once),
        (engine, "_REST", 0.0),
        (trajectory_page, "_SETTLE_SECONDS", 0.0),
    ):
        monkeypatch.setattr(module, name, value)
    return Session(first_design())


@pytest.fixture(scope="module")
def followed() -> Followed:
    return follow(first_design().replace(TWO_LINES))


def after(page: TrajectoryPage, do: Any) -> str:
    """Text of the strip once the change has been followed."""
    when_done(do, page.run)
    return str(page._strip._text.object)


def lines_after(page: TrajectoryPage, do: Any) -> int:
    """Number of lines with a verdict once the change has been followed; the whole flight is none."""
    text = after(page, do)
    assert page._result is not None
    assert any(word in text for word in ("Does not close", "Closes", "Study")), text
    return len(page._result.result.spec.lines)


def test_the_strip_counts_the_lines_that_keep_every_limit(followed: Followed) -> None:
    answer = verdict(followed)
    limit = dict(followed.result.spec.most)["detrended_phase"]
    values, time = followed.result.real_time.figures["detrended_phase"], followed.result.time_s
    for line in followed.result.spec.lines:
        half = followed.result.spec.inputs.aperture / 2
        assert (values[(time >= line.start + half) & (time <= line.stop - half)] > limit).all()
    assert answer.word == "✗ Does not close"
    worst = max(followed.result.lines, key=lambda line: line.worst["detrended_phase"])
    most = math.degrees(worst.worst["detrended_phase"])
    assert f"detrended phase fails on {worst.name} ({most:.3g}°, limit 20°)" in answer.sentences[0]
    assert answer.sentences[1].startswith(f"{worst.name.capitalize()}: ")
    assert f"; worst {most:.3g}°, " in answer.sentences[1]
    listed = line_list(followed, "detrended_phase")
    for row, line in zip(listed.rows, followed.result.lines, strict=True):
        assert [cell.text for cell in row][:2] == [line.name, "✗\u00a0fails"]
        assert row[2].text.startswith("Detrended phase all along the line, ")
    assert listed.note == followed.result.heading.in_words()
    assert listed.columns[4].title == "Post-processed"
    smoothed = followed.result.post_processed.figures["detrended_phase"]
    for row, line in zip(listed.rows, followed.result.spec.lines, strict=True):
        worst = math.degrees(smoothed[(time >= line.start + half) & (time <= line.stop - half)].max())
        assert float(row[4].text.removesuffix("°")) == pytest.approx(worst, rel=5e-3)


def test_the_page_solves_how_long_lines_may_be_when_asked_and_forgets_it_with_the_next_design(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = TrajectoryPage(session)
    session.change(TWO_LINES)
    after(page, page.begin)
    assert page._bar.start.visible
    assert [column.title for column in line_list(page.run.result, page._shown).columns][-1] == "Limit"
    after(page, lambda: page.begin(by_itself=False, lengths=True))
    assert not page._bar.start.visible
    assert [row[-1].text for row in line_list(page.run.result, page._shown).rows] == ["no line is short enough"] * 2
    assert "no line is short enough" in html_of(line_table(page.run.result, page._shown))
    assert page._bar.message == ""
    session.change({"trajectory.length": 3100.0})
    after(page, page.begin)
    assert page._bar.start.visible
    monkeypatch.setattr(line_length, "MOST_FIXES", 1000)
    after(page, lambda: page.begin(by_itself=False, lengths=True))
    assert page._bar.message.startswith("Not solved: ")
    assert page._bar.start.visible
    after(page, page.begin)
    assert page._bar.message == ""


def test_a_design_that_is_good_enough_says_so_and_one_without_limits_too() -> None:
    strict = first_design()
    given = [f"requirements.{name}" for name in LIMITED if strict[f"requirements.{name}"] is not None]
    loose = strict.replace(dict.fromkeys(given, 30.0))
    passing = verdict(follow(loose.replace(TWO_LINES)))
    assert (passing.word, passing.tone) == ("✓ Closes", "good")
    free = Design({"flight.speed": 60.0})
    answer = verdict(follow(free.replace(TWO_LINES)))
    assert (answer.word, answer.tone) == ("Not checked", "open")


def test_shares_are_stacked_up_to_one_hundred_percent(followed: Followed) -> None:
    bands = shares_chart(followed, "detrended_phase").bands
    top = bands[-1].high
    assert np.isfinite(top).sum() > 100
    np.testing.assert_allclose(top[np.isfinite(top)], 100.0, atol=1e-6)
    assert all(np.array_equal(low.high, high.low, equal_nan=True) for low, high in pairwise(bands))


def test_the_map_numbers_the_lines_and_colours_them_by_their_verdict(followed: Followed) -> None:
    chart, result = map_chart(followed), followed.result
    drawn = {line.style: np.isfinite(line.y) for line in chart.lines}
    on = np.zeros(len(result.time_s), bool)
    for line in result.lines:
        on |= (result.time_s > line.start_s - 1e-6) & (result.time_s < line.stop_s + 1e-6)
    assert not any(line.closes for line in result.lines)
    np.testing.assert_array_equal(drawn["does not close"], on)
    assert drawn["turn"].all()
    assert not drawn["closes"].any()
    assert [point.names for point in chart.points] == [("1", "2")]
    # The second number lies 1 km to the right of the first line, whatever the heading, and half a line farther on.
    first, second = (np.array([chart.points[0].x[i], chart.points[0].y[i]]) for i in (0, 1))
    apart = second - first
    ahead = np.array(
        [np.interp(result.lines[0].stop_s, result.time_s, way) for way in (followed.east, followed.north)]
    )
    ahead = ahead / 1000 - first
    along = apart @ ahead / math.hypot(*ahead)
    assert along == pytest.approx(1.5, rel=0.02)
    assert apart[0] * ahead[1] - apart[1] * ahead[0] == pytest.approx(math.hypot(*ahead), rel=0.02)
    spans = [span for span in timelines(followed, "tilt")[0].spans if span.faint]
    assert [(span.label, span.style) for span in spans] == [(f"line {n}", "does not close") for n in (1, 2)]
    assert [(span.start, span.stop) for span in spans] == [(line.start_s, line.stop_s) for line in result.lines]


def test_the_quantity_that_decides_is_shown_first(followed: Followed) -> None:
    over = {
        name: max(line.worst[name] / level for line in followed.result.lines if (level := line.limits.get(name)))
        for name in followed.result.lines[0].limits
    }
    assert main_figure(followed) == max(over, key=lambda name: over[name]) != "horizontal_position"


def test_a_limit_is_drawn_wherever_its_quantity_is_with_the_moment_at_which_it_is_passed(followed: Followed) -> None:
    time, level = followed.result.time_s, math.radians(0.01)
    rises = 2 * level * time / time[-1]  # passes its limit half way
    real_time = replace(followed.result.real_time, figures={**followed.result.real_time.figures, "tilt": rises})
    limited = followed.design.replace({"requirements.tilt": level})
    charts = timelines(
        replace(followed, design=limited, result=replace(followed.result, real_time=real_time)), "tilt"
    )
    for chart in (charts[0], charts[3]):
        assert [limit.level for limit in chart.limits] == pytest.approx([0.01])
    assert [limit.level for limit in charts[1].limits] == [followed.design.requirements.horizontal_position]
    beyond = [span for span in charts[2].spans if span.style == "limit"]
    step = time[-1] / len(time) * 2
    assert [(span.start, span.stop) for span in beyond] == [(pytest.approx(time[-1] / 2, abs=step), time[-1])]
    minutes, seconds = divmod(round(beyond[0].start), 60)
    assert [points.names for points in charts[0].points] == [(f"{minutes}:{seconds:02d}",)]


def test_every_figure_can_be_chosen_and_exported(followed: Followed) -> None:
    for name in FIGURES:
        charts = timelines(followed, name)
        assert all(line.x is charts[0].lines[0].x for chart in charts for line in chart.lines)
        assert FIGURES[name].label in html_of(line_table(followed, name))
    rows = list(csv.reader(io.StringIO(as_csv(followed))))
    assert float(rows[50][1 + list(FIGURES).index("tilt")]) == followed.result.real_time.figures["tilt"][49]
    assert json.loads(as_json(followed))["lines"][1]["name"] == "line 2"


def test_the_page_follows_design_flight_and_file(session: Session, tmp_path: Path) -> None:
    flight, not_one = tmp_path / "a", tmp_path / "b"
    flight.write_text(_PLAN, encoding="utf-8")
    not_one.write_text("<gpx>", encoding="utf-8")
    session.change({"trajectory.flight": "wandering"})
    page = TrajectoryPage(session)
    assert "Working" in page._strip._text.object
    assert lines_after(page, page.begin) == 0
    assert lines_after(page, lambda: setattr(page, "flight", "lines")) == 4
    assert session.design.trajectory.flight == "lines"
    session.change({"requirements.detrended_phase": 1e3, "requirements.quadratic_phase": 1e3})
    assert lines_after(page, lambda: page.show(session.budget)) == 4
    assert page._result.design == session.design
    page._file = File("plan.gpx", flight)
    assert lines_after(page, lambda: setattr(page, "flight", "file")) == 1
    assert session.design.trajectory.flight == "lines"
    page._file = File("plan.gpx", not_one)
    assert "plan.gpx: is not XML" in after(page, page.begin)
    assert "<h2>Plan not flown</h2>" in page._strip._text.object
    assert "The charts show the previous result: Study: " in page._strip._text.object
    assert page._strip._view.css_classes == ["open"]
    session.change({"trajectory.flight": "straight", "trajectory.duration": 60.0})
    assert lines_after(page, lambda: setattr(page, "flight", "straight")) == 0
    assert page._result.result.spec.study.duration == 60.0


def test_what_is_typed_goes_into_the_design_and_what_is_refused_stays(session: Session) -> None:
    page = TrajectoryPage(session)
    boxes, tables = page._plan._boxes, page._plan._tables
    after(page, lambda: setattr(page, "flight", "lines"))
    after(page, lambda: setattr(boxes["length"], "value", "3"))
    assert session.design["trajectory.length"] == 3000.0
    assert boxes["length"].value == "3 km"
    assert "Lines: " in after(page, lambda: setattr(boxes["lines"], "value", "many"))
    assert (boxes["lines"].value, session.design["trajectory.lines"]) == ("many", 4.0)
    assert (boxes["lines"].error_state, page.run.message) == (True, "")  # said in the strip, not in the bar as well
    assert lines_after(page, lambda: setattr(boxes["lines"], "value", "4")) == 4
    assert "Outages, row 1, stop: Enter the stop" in after(page, lambda: setattr(boxes["outages"], "value", "60"))
    after(page, lambda: setattr(boxes["outages"], "value", "60, 90"))
    assert session.design["trajectory.outages"] == ((60.0, 90.0),)
    # The lines as waypoints, at the places where they were.
    assert lines_after(page, lambda: setattr(page, "flight", "waypoints")) == 4
    after(page, lambda: page.show(session.budget))
    rows, before = tables["waypoints"].rows, session.design
    assert [row["line"] for row in rows if row["line"]] == [f"line {n}" for n in range(1, 5)]
    assert list(rows[0].values()) == ["48", "0", "4000", "line 1", ""]
    assert max(len(cell) for row in rows for cell in row.values()) <= len("-0.05159620")
    north = math.radians(float(rows[1]["latitude"]) - float(rows[0]["latitude"])) * 6.37e6
    assert north * math.cos(0) == pytest.approx(3000.0, rel=0.01)
    wrong = [
        dict(zip(rows[0], row, strict=True)) for row in (("48", "0", "3000", "a", ""), ("98", "0", "3000", "", ""))
    ]
    assert "Waypoints, row 2, latitude: " in after(page, lambda: tables["waypoints"]._handle_msg({"rows": wrong}))
    assert "at most 85°" in tables["waypoints"].refused
    assert page.run.message == ""
    assert session.design == before
    wrong[1]["latitude"] = "48.3°"
    assert lines_after(page, lambda: tables["waypoints"]._handle_msg({"rows": wrong})) == 1
    assert tables["waypoints"].refused == ""
    assert list(tables["waypoints"].rows[1].values()) == ["48.3", "0", "3000", "", ""]
    session.undo()
    after(page, lambda: page.show(session.budget))
    assert tables["waypoints"].rows == rows
    session.change({"trajectory.ground": 5000.0})
    assert "is not above the ground" in after(page, lambda: page.show(session.budget))
    session.undo()
    assert lines_after(page, lambda: page.show(session.budget)) == 4
    assert "above the ground" not in page._strip._text.object


def test_a_double_click_on_the_map_adds_a_waypoint_there(session: Session) -> None:
    session.change({"trajectory.flight": "waypoints", "trajectory.waypoints": _places((48, 0), (48.2, 0))})
    page = TrajectoryPage(session)
    after(page, page.begin)
    after(page, lambda: setattr(page, "flight", "lines"))
    page._placed(DoubleTap(None, x=5.0, y=22.0))
    assert page._bar.message.startswith("A double click adds a waypoint where the flight is one of waypoints")
    assert len(session.design["trajectory.waypoints"]) == 2
    after(page, lambda: setattr(page, "flight", "waypoints"))
    assert page._bar.message == ""
    after(page, lambda: page._placed(DoubleTap(None, x=5.0, y=22.0)))
    added = session.design["trajectory.waypoints"][-1]
    assert math.degrees(added[0]) == pytest.approx(48 + 22.0 / 111.2, abs=2e-3)
    assert math.degrees(added[1]) == pytest.approx(5.0 / (111.4 * math.cos(math.radians(48))), rel=5e-3)
    assert added[2:] == (3000.0, "", None)


def test_a_file_of_waypoints_goes_into_the_design_and_others_are_refused_by_name(session: Session) -> None:
    page = TrajectoryPage(session)

    def opened(name: str, content: bytes) -> None:
        when_done(lambda: page._uploaded(name, content), page.run)

    opened("song.mp3", b"abc")
    assert "This is not a table. Give a KML, KMZ, GPX" in page._bar.message
    opened("plan.gpx", b"<gpx/>")
    assert "Not used. plan.gpx: holds no path" in page._bar.message
    assert (page._file, session.design.trajectory.waypoints) == (None, ())
    opened("plan.gpx", _PLAN.encode())
    assert session.design["trajectory.flight"] == page.flight == "waypoints"
    first, second = session.design["trajectory.waypoints"][:2]
    assert (first[3], first[2], second[2]) == ("first", 3900.0, session.design.flight.altitude)
    with pytest.raises(InputError, match=r"Flight: .* too long for this page"):
        follow(first_design().replace({"trajectory.duration": 1e5}))
    dense = {"trajectory.duration": 7000.0, "radar.aperture_time": 1.0}
    with pytest.raises(InputError, match=r"Flight: 2900 s have too many fixes for an aperture of 80 s: too long"):
        follow(
            first_design().replace({"trajectory.duration": 2900.0, "gnss.interval": 0.1, "radar.aperture_time": 80.0})
        )
    with pytest.raises(InputError, match=r"Flight: .* more than 15000 fixes: too long"):
        closing_options(first_design().replace({"trajectory.duration": 2e4}), progress=lambda *_: None)
    with pytest.raises(InputError, match=r"the flight takes 35\d+ steps, at most 30000"):
        follow(first_design().replace(dense))


def test_simulated_runs_of_the_same_flight_are_laid_over_the_curves(session: Session, followed: Followed) -> None:
    spec = replace(followed.result.spec.study, runs=60, every=5.0)
    flown = SimpleNamespace(result=simulate(spec, workers=1))
    lines = {line.key: line for chart in timelines(followed, "tilt", flown.result) for line in chart.lines}
    for of in ("horizontal", "vertical", "tilt", "yaw"):
        ratio = lines[f"{of} runs"].y[100:] / lines[f"{of} real time"].y[100:]
        assert np.abs(np.median(ratio) - 1.0) < 0.15  # one of 60 runs: 9 %, and the axes differ
    short = timelines(followed, "tilt", simulate(replace(spec, runs=2, duration=spec.duration / 2), workers=1))
    runs = next(line.y for line in short[1].lines if line.key == "vertical runs")
    later = followed.result.time_s > spec.duration / 2
    assert np.isfinite(runs[~later]).all()
    assert np.isnan(runs[later]).all()
    other = timelines(followed, "tilt", simulate(replace(spec, runs=2, outages=()), workers=1))
    assert np.isnan(next(line.y for line in other[1].lines if line.key == "vertical runs")).all()
    session.change(TWO_LINES)
    page = TrajectoryPage(session)
    after(page, page.begin)
    assert "simulated on this flight" not in page._head.object
    session.keep("simulation", flown)
    assert "simulated on this flight" in page._head.object


def test_a_kml_file_has_every_line_with_its_verdict_and_escapes_its_name() -> None:
    high = {"detrended_phase", "quadratic_phase", "horizontal_position", "ce90"}
    plan = {
        "trajectory.flight": "waypoints",
        "trajectory.waypoints": (
            (0.82, 0.14, 3000.0, "out & <b>in</b>", 95.0), (0.8215, 0.14, 3000.0, "", None),
            (0.823, 0.14, 3000.0, "wide", 110.0), (0.8245, 0.14, 3000.0, "", None),
        ),
        "trajectory.limits": (("wide", *(1e3 if name in high else None for name in LIMITED)),),
    }  # fmt: skip
    followed = follow(first_design().replace(plan))
    text = as_kml(followed)
    assert b"<b>" not in text
    marks = ElementTree.fromstring(text).iter(f"{{{NAMESPACE}}}Placemark")
    flight, out, wide = [{part.tag.partition("}")[2]: part for part in mark} for mark in marks]
    assert [mark["name"].text for mark in (flight, out, wide)] == ["flight", "out & ‹b›in‹/b›", "wide"]
    assert [mark["styleUrl"].text for mark in (out, wide)] == ["#fails", "#closes"]
    assert str(out["description"].text).startswith(
        "out &amp; &lt;b&gt;in&lt;/b&gt;: detrended phase over "
    )  # HTML to viewers
    assert wide["description"].text == "wide keeps its limits."
    assert flight["description"].text == "Flight: waypoints, 2 lines, 5 min 1 s; outages: none; filter of 9 states."
    mission = parse_file(as_plan(followed), "again.plan")
    rows = plan["trajectory.waypoints"]
    assert [point.line for point in mission.waypoints] == ["out & in", "", "wide", ""]
    usual = followed.design.flight.speed
    assert [point.speed for point in mission.waypoints] == [95.0, usual, 110.0, usual]
    np.testing.assert_allclose(
        [(p.latitude, p.longitude, p.height) for p in mission.waypoints], [r[:3] for r in rows]
    )
    items = json.loads(as_plan(followed))["mission"]["items"]
    assert next(item for item in items if item.get("line") == "wide")["verdict"] == "wide keeps its limits."
    with pytest.raises(InputError, match="Export this flight as KML"):
        as_plan(replace(followed, file="other.csv"))
    (again,) = [point for point in parse_file(text, "again.kml").waypoints if point.line == "wide"][:1]
    assert (again.latitude, again.longitude) == pytest.approx((0.823, 0.14), abs=2e-5)  # an output


def test_a_report_has_the_lines_of_the_design_that_it_is_of(
    session: Session, followed: Followed, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = TrajectoryPage(session)
    after(page, page.begin)
    chosen = ReportChoice(session)
    assert chosen.offered() == [{"kind": "trajectory", "label": "Trajectory in the report", "ticked": True}]
    session.change({"coast.duration": 50.0})  # which has no flight to wait for
    assert "belong to another design: Trajectory" in chosen.lacking()
    section, drawn = study_sections({"trajectory": followed}, followed.design, "d1")
    assert section.blocks[0].word == "✗ Does not close"
    assert [block.chart.title for block in drawn.blocks if isinstance(block, ChartBlock)][:2] == [
        "Map", FIGURES[main_figure(followed)].label,
    ]  # fmt: skip
    design, target = tmp_path / "two.toml", tmp_path / "r.html"
    biased = followed.design.replace({"imu.gyro_bias": 1e-7})
    design.write_text(format_design(biased), encoding="utf-8")
    assert cli.main(["report", str(design), "--with", "trajectory", "-o", str(target)]) == 0
    html = target.read_text(encoding="utf-8")
    assert "detrended phase fails on line" in html
    assert "Flight: parallel lines, 2 lines, " in html
    assert "outages: 1:40 to 2:10\xa0min" in html
    assert "filter of 9 states" in html  # as page and command fly it
    assert "wrote" in capsys.readouterr().err


def _for_an_hour(*_: object, progress: Any) -> None:
    progress(0.0, "begun")
    time.sleep(3600)


def test_a_flight_ends_with_the_page_that_asked_for_it(monkeypatch: pytest.MonkeyPatch, nothing_kept: None) -> None:
    monkeypatch.setattr(engine, "follow", _for_an_hour)
    monkeypatch.setattr(engine, "run_in_pool", at_once)
    monkeypatch.setattr(engine, "follow_if_short", lambda *_: None)  # as a long one
    session = Session(first_design())
    page = TrajectoryPage(session)
    others = set(multiprocessing.active_children())

    async def leave() -> None:
        task = page.begin()
        await soon(lambda: page.run.progress is not None and page.run.progress.what == "begun", "the flight")
        session.close()
        await asyncio.wait([task])
        await soon(lambda: set(multiprocessing.active_children()) <= others, "the end of its process")

    asyncio.run(leave())

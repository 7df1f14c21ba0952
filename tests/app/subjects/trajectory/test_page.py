"""The Trajectory page without a browser: what it follows, what it says, what it refuses."""

from __future__ import annotations

import asyncio
import csv
import io
import json
import math
from collections import OrderedDict
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from waiting import soon

import app.subjects.trajectory.page as trajectory_page
from app.charts.kinds import to_csv
from app.document.pane import html_of
from app.serving.server import first_design
from app.session import Session
from app.subjects.trajectory.charts import map_chart, shares_chart, timelines
from app.subjects.trajectory.figures import FIGURES
from app.subjects.trajectory.page import TrajectoryPage, as_csv, as_json
from app.subjects.trajectory.run import Asked, File, Followed, Strip, follow
from app.subjects.trajectory.tables import line_table, verdict
from app.work import kept
from nav_model.base.errors import InputError
from nav_model.design import Design

# A button of panel-material-ui passes its own look on in the old words too.
pytestmark = [
    pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning"),
    pytest.mark.long,
]
TWO_LINES = Asked(Strip(2, 3000.0, 1000.0, math.radians(25)), 500.0, ((100.0, 130.0),), 9)
_PLAN = """<gpx><rte><rtept lat="47" lon="8"><ele>3000</ele><name>first</name></rtept>
<rtept lat="47.08" lon="8"></rtept><rtept lat="47.08" lon="8.1"></rtept></rte></gpx>"""


async def here(function: Any, *arguments: Any) -> Any:
    """Instead of a worker process."""
    await asyncio.sleep(0)
    return function(*arguments)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Session:
    monkeypatch.setattr(trajectory_page, "elsewhere", here)
    monkeypatch.setattr(trajectory_page, "_SETTLE_SECONDS", 0.0)
    monkeypatch.setattr(kept, "_kept", OrderedDict())
    return Session(first_design())


@pytest.fixture(scope="module")
def followed() -> Followed:
    return follow(first_design(), TWO_LINES)


def after(page: TrajectoryPage, do: Any) -> str:
    """What the strip says once what was done has been followed."""

    async def until_done() -> None:
        do()
        await soon(lambda: not page.run.running, "the end of the run")

    asyncio.run(until_done())
    return str(page._strip._text.object)


def test_the_strip_counts_the_lines_that_keep_every_limit(followed: Followed) -> None:
    said = verdict(followed, "detrended_phase")
    limit = dict(followed.result.spec.limits.most)["detrended_phase"]
    values, time = followed.result.real_time.image["detrended_phase"], followed.result.time_s
    good = 0
    for line in followed.result.spec.lines:
        assert followed.result.spec.aperture is not None
        half = followed.result.spec.aperture.duration / 2
        good += bool((values[(time >= line.start + half) & (time <= line.stop - half)] <= limit).all())
    assert good == 0
    assert said.word == "✗ 0 of 2 lines within the limits"
    assert said.sentences[0].startswith("Line 1 fails ")
    assert "most of it from" in said.sentences[0]
    assert followed.result.heading.text in said.sentences


def test_a_design_that_is_good_enough_says_so_and_one_without_limits_too() -> None:
    strict = first_design()
    given = [f"requirements.{name}" for name in FIGURES if strict[f"requirements.{name}"] is not None]
    loose = strict.replace(dict.fromkeys(given, 30.0))
    assert verdict(follow(loose, TWO_LINES), "ce90").word == "✓ 2 of 2 lines within the limits"
    free = Design({"flight.speed": 60.0})
    said = verdict(follow(free, TWO_LINES), "ce90")
    assert (said.word, said.tone) == ("No limit", "open")
    assert said.sentences[0].startswith("CE90 is at most ")


def test_shares_are_stacked_up_to_one_hundred_percent(followed: Followed) -> None:
    bands = shares_chart(followed, "detrended_phase").bands
    top = bands[-1].high
    assert np.isfinite(top).sum() > 100
    np.testing.assert_allclose(top[np.isfinite(top)], 100.0, atol=1e-6)
    assert all(np.array_equal(low.high, high.low, equal_nan=True) for low, high in pairwise(bands))


def test_the_map_colours_every_place_by_the_limit(followed: Followed) -> None:
    chart = map_chart(followed, "detrended_phase")
    values, limit = followed.result.real_time.image["detrended_phase"], dict(followed.result.spec.limits.most)
    beyond = next(line for line in chart.lines if line.key == "high")
    assert np.isfinite(beyond.y[values > limit["detrended_phase"]]).all()
    assert [point.names for point in chart.points] == [("line 1", "line 2")]
    # The second line lies 1 km to the right of the first, whatever the heading.
    first, second = (np.array([chart.points[0].x[i], chart.points[0].y[i]]) for i in (0, 1))
    assert math.hypot(*(second - first)) == pytest.approx(math.hypot(1.0, 3.0), rel=0.02)


def test_every_figure_can_be_chosen_and_exported(followed: Followed) -> None:
    for name in FIGURES:
        charts = timelines(followed, name)
        assert all(line.x is charts[0].lines[0].x for chart in charts for line in chart.lines)
        assert FIGURES[name].label in html_of(line_table(followed, name))
        assert "no aperture here" in to_csv(map_chart(followed, name)) or name not in followed.result.chosen.image
    rows = list(csv.reader(io.StringIO(as_csv(followed))))
    assert float(rows[50][1 + list(FIGURES).index("tilt")]) == followed.result.real_time.figure("tilt")[49]
    assert json.loads(as_json(followed))["lines"][1]["name"] == "line 2"


def test_the_page_follows_design_flight_and_file(session: Session) -> None:
    page = TrajectoryPage(session)
    assert "Working" in page._strip._text.object
    assert "of 4 lines within" in after(page, page.start)
    session.change({"requirements.detrended_phase": 1e3, "requirements.quadratic_phase": 1e3})
    assert "of 4 lines within" in after(page, lambda: page.show(session.budget))
    assert page._result is not None
    assert page._result.design == session.design
    page.run.result = None

    def straight() -> None:
        page.flight, page.duration, page.outages = "straight", "120", "60,90"

    assert "of the flight within" in after(page, straight)
    assert page._result.result.spec.study.outages == ((60.0, 90.0),)
    page._file = File("plan.gpx", _PLAN.encode())
    said = after(page, lambda: setattr(page, "flight", "file"))
    assert "of 1 line within" in said
    assert "lines" not in page._settings.text
    page._file = File("plan.gpx", b"<gpx>")
    assert "plan.gpx: is not XML" in after(page, page.start)
    assert "This is the result before it." in page._strip._text.object


def test_bad_fields_and_other_files_are_refused_by_name(session: Session) -> None:
    page = TrajectoryPage(session)
    assert "Lines: " in after(page, lambda: setattr(page, "count", "many"))
    assert "outages: " in after(page, lambda: page.param.update(count="2", outages="soon"))
    page._upload.filename = "song.mp3"
    page._upload.value = b"abc"
    assert "song.mp3 is not a GPX, KML, CSV or SBET" in page._bar.message
    assert page._file is None
    with pytest.raises(InputError, match=r"Length: .* too long for this page"):
        follow(first_design(), Asked("straight", 1e6, (), 9))

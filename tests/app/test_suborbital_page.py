"""The Suborbital page without a browser: what is put in force, what is shown, what is taken away."""

from __future__ import annotations

import asyncio
import csv
import io
import json
import time

import numpy as np
import pytest

from app.charts import suborbital as charts
from app.charts.suborbital import Shown
from app.long_run import run_alone
from app.pages.suborbital import SuborbitalPage
from app.server import first_design
from app.state import Session
from app.suborbital.tables import PAPER_NOTE, paper_tables, source_table
from nav_model.suborbital.input_table import SETTINGS
from nav_model.suborbital.settings import DEFAULTS
from nav_model.suborbital.survey import Survey, run_survey

# Panel Material UI warns of its own widgets.
pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")


@pytest.fixture(scope="module")
def survey() -> Survey:
    return run_survey(DEFAULTS)


@pytest.fixture
def here(survey: Survey) -> SuborbitalPage:
    here = SuborbitalPage(Session(first_design()))
    here.survey = survey
    here._follow()
    return here


def test_an_input_moves_every_curve_and_says_so(here: SuborbitalPage) -> None:
    before = here.shown
    assert before is not None
    assert before.exact
    assert here.put("gyros.bias", SETTINGS["gyros.bias"].read("6, 8, 4 °/h")) is None
    after = here.shown
    assert after is not None
    assert not after.exact
    k = after.study.case("gyro total")
    change = after.study.pure.position_m[k, -1] - before.study.pure.position_m[k, -1]
    assert np.linalg.norm(change) > 10_000
    assert "Moved by the linear sensitivity matrix" in here._answer.object
    # and back: the exact answer again
    here.put("gyros.bias", DEFAULTS["gyros.bias"])
    assert here.shown is not None
    assert here.shown.exact


def test_a_refusal_stands_at_the_field_and_changes_nothing(here: SuborbitalPage) -> None:
    control = next(c for c in here._controls if c.setting.key == "gyros.bias")
    before = here.settings
    control.box.value = "5 kg"
    assert control.box.error_state
    assert "not a unit of angular rate" in control.box.helper_text
    assert here.settings is before
    control.box.value = "2 °/h"
    assert not control.box.error_state
    assert control.box.value == "2, 2, 2 °/h"


def test_a_slider_keeps_the_ratio_of_the_axes(here: SuborbitalPage) -> None:
    control = next(c for c in here._controls if c.setting.key == "gyros.bias")
    assert control.slider is not None
    control.slider.value = np.log10(SETTINGS["gyros.bias"].read("8 °/h")[0])  # type: ignore[index]
    assert here.settings["gyros.bias"] == pytest.approx([2 * x for x in DEFAULTS["gyros.bias"]], rel=1e-3)
    control.slider.value = control.slider.start
    assert here.settings["gyros.bias"] == (0.0, 0.0, 0.0)


def test_moving_every_curve_is_fast(here: SuborbitalPage) -> None:
    """Issue 5 asks for 100 ms; the best of five, so that a busy machine does not decide."""
    spent = []
    for k in range(5):
        start = time.perf_counter()
        here.put("initial.velocity", (0.1 + 0.01 * k, 0.1, -0.1))
        spent.append(time.perf_counter() - start)
    assert min(spent) < 0.1


def test_tables_hold_the_study_and_name_the_papers_values_as_comparison(here: SuborbitalPage) -> None:
    shown = here._current()
    tables = paper_tables(shown)
    assert len(tables) == 4
    bias = next(row for row in tables[0].rows if row[0] == "accelerometer bias")
    assert bias[1:4] == pytest.approx((-125.14, -11226.05, 20252.26), abs=5.0)
    assert bias[-3:] == (10500.0, 8000.0, 20000.0)
    assert all(PAPER_NOTE in table.knowledge for table in tables)
    assert f"data-sort='{abs(bias[1])!r}'" in tables[0].html  # type: ignore[arg-type]
    assert len(source_table(shown).rows) == len(shown.study.names) + 1
    rows = list(csv.reader(io.StringIO(tables[1].csv())))
    assert float(rows[1][1]) == shown.study.pure.position_m[shown.study.case("gyro bias"), -1, 0]


def test_decoupled_channel_is_shown_failing_where_it_does(survey: Survey) -> None:
    """star_tracker.md: gyro total in height 36.8 km by the channel, 13.6 km by the INS."""
    chart = charts.growth_chart(Shown(survey, survey.study, case="gyro total"))
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
        chart = charts.star_chart(Shown(survey, survey.study, star_index=index))
        places, measured = chart.points
        assert len(places.x) >= 3
        assert np.all((places.x > -0.5) & (places.x < 1023.5) & (places.y > -0.5) & (places.y < 1023.5))
        assert np.hypot(places.x - measured.x, places.y - measured.y).max() < 5  # 10 arcsec is a third of a pixel
        assert all(name.startswith("HIP ") for name in places.names)


def test_json_of_the_page_is_the_command_s(here: SuborbitalPage) -> None:
    answer = json.loads(here._json().getvalue())
    assert answer["final_m"]["all"]["up"] == pytest.approx(27319.33, abs=5.0)
    assert answer["exact"] is True


def test_every_tab_is_built_and_fed(here: SuborbitalPage) -> None:
    for index in range(len(here._tabs)):
        here._tabs.active = index
        here._draw()
        assert here._places[index].objects


def test_exact_run_in_a_process_shows_progress_and_the_gap(here: SuborbitalPage) -> None:
    here.put("gyros.bias", SETTINGS["gyros.bias"].read("6, 8, 4 °/h"))
    asyncio.run(here.run_exactly())
    assert here.shown is not None
    assert here.shown.exact
    assert here.gap is not None
    share = here.gap.pure_share[here.gap.names.index("all")]
    assert 0 < share < 0.05
    assert "the linear answer was off by" in here._answer.object
    assert not here._session.running


def test_a_bad_trajectory_is_said_by_name(here: SuborbitalPage) -> None:
    here.trajectory = ("mine.csv", b"a,b\n1,2\n")
    asyncio.run(here.run_exactly())
    assert "mine.csv: columns time_s" in here._state.object
    assert here.shown is not None


def _sleep(seconds: float, *, progress: object) -> None:
    time.sleep(seconds)


def test_cancelling_a_run_ends_it_at_once() -> None:
    async def cancelled() -> float:
        task = asyncio.create_task(run_alone(_sleep, 60, progress=lambda share, what: None))
        await asyncio.sleep(0.5)
        start = time.perf_counter()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        return time.perf_counter() - start

    assert asyncio.run(cancelled()) < 5

"""The run behind the Simulate page, and the page's own logic, without a browser."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
import pytest
from waiting import soon

from app.charts.kinds import to_csv
from app.charts.legend import legend_html
from app.charts.print.svg import to_svg
from app.charts.screen.figures import to_bokeh
from app.charts.styles import STYLES
from app.session import Session
from app.subjects.simulation import charts
from app.subjects.simulation import run as simulation_run
from app.subjects.simulation.page import SimulatePage
from app.subjects.simulation.run import Compiling, News, Progress, Result, SimulationRun, outages_of, same_subject
from app.subjects.simulation.tables import answer, under_way
from nav_model.design import Design
from nav_model.errors import InputError
from nav_model.simulation.design_study import SimulationStudy, closed_form, specification, study_of
from nav_model.simulation.monte_carlo import simulate

DESIGN = Design({"name": "<b>paper</b>", "flight.speed": 50.0})
CHARTS = (
    charts.horizontal_position_chart,
    charts.vertical_position_chart,
    charts.horizontal_velocity_chart,
    charts.vertical_velocity_chart,
    charts.tilt_chart,
    charts.yaw_chart,
    charts.outage_chart,
    charts.ensemble_chart,
    charts.nees_chart,
    charts.path_chart,
    charts.designed_attitude_chart,
)


@cache
def _study(outages: tuple[tuple[float, float], ...] = (), runs: int = 12, states: int = 9) -> SimulationStudy:
    spec = specification(DESIGN, runs=runs, duration=60.0, every=2.0, outages=outages, states=states)
    return study_of(DESIGN, simulate(spec, closed_form=closed_form(DESIGN, spec)))


@pytest.fixture(scope="module")
def study() -> SimulationStudy:
    return _study(((40, 60),))


def _fly(spec_options: dict[str, object], during: Callable[[SimulationRun, News], None]) -> list[News]:
    """Run to the end in a loop of its own; `during` sees every piece of news as it comes."""
    heard: list[News] = []

    async def main() -> None:
        def told(news: News) -> None:
            heard.append(news)
            during(run, news)

        run = SimulationRun(told)
        run.start(DESIGN, specification(DESIGN, **spec_options))  # type: ignore[arg-type]
        await soon(lambda: not run.running, "the end of the run")

    with ThreadPoolExecutor(1) as thread:  # browser tests leave a loop running in the main one
        thread.submit(asyncio.run, main()).result()
    return heard


def test_a_run_tells_progress_and_ends_with_the_commands_numbers() -> None:
    options: dict[str, object] = {"runs": 80, "duration": 60.0, "every": 2.0, "outages": ((40, 60),)}
    heard = _fly(options, lambda run, news: None)
    done = [news.done for news in heard if isinstance(news, Progress)]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0, 80)
    last = heard[-1]
    assert isinstance(last, Result)
    assert not last.partial
    assert np.array_equal(last.study.result.rms, _study(((40, 60),), runs=80).result.rms)


def _slow_start() -> None:
    time.sleep(2.5)


@pytest.mark.slow
def test_a_compilation_is_told_as_it_goes_and_can_be_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_run, "warm_up", _slow_start)
    heard = _fly({"runs": 2, "duration": 10.0}, lambda run, news: None)
    waits = [news.seconds for news in heard if isinstance(news, Compiling)]
    assert len(waits) >= 2
    assert waits == sorted(waits)
    assert isinstance(heard[-1], Result)
    heard = _fly({"runs": 2, "duration": 10.0}, lambda run, news: run.cancel())
    assert heard[-1] == "Cancelled after 0 of 2 runs."


def test_cancel_ends_at_once_and_says_how_far_it_was() -> None:
    done: list[int] = []

    def stop(run: SimulationRun, news: News) -> None:
        if isinstance(news, Progress) and news.done and not done:
            done.append(news.done)
            run.cancel()

    heard = _fly({"runs": 5000, "duration": 300.0}, stop)
    assert heard[-1] == f"Cancelled after {done[0]} of 5000 runs."  # not one chunk was waited for


def test_a_flight_that_cannot_be_flown_is_said_in_words() -> None:
    heard = _fly({"runs": 2, "duration": 60.0, "trajectory": "turns"}, lambda run, news: None)
    assert isinstance(heard[-1], str)
    assert heard[-1].startswith("Not flown. duration: 60.0 cannot be simulated; the turns take")


@pytest.mark.parametrize(
    ("text", "outages"),
    [("", ()), (" ", ()), ("200,300", ((200, 300),)), ("50, 80; 200,300;", ((50, 80), (200, 300)))],
)
def test_outages_as_people_write_them(text: str, outages: tuple[tuple[float, float], ...]) -> None:
    assert outages_of(text) == outages


@pytest.mark.parametrize("text", ["200", "a,b", "1,2,3", "200-300", "<b>"])
def test_other_outages_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"^outages: "):
        outages_of(text)


def test_only_instruments_and_flight_make_a_study_stale() -> None:
    for key, value in (
        ("name", "b"),
        ("radar.slant_range", 9e3),
        ("requirements.tilt", 0.1),
        ("coast.duration", 9.0),
    ):
        assert same_subject(DESIGN, DESIGN.replace({key: value}))
    for key, value in (("imu.rate", 200.0), ("gnss.interval", 0.5), ("flight.gravity", 9.79)):
        assert not same_subject(DESIGN, DESIGN.replace({key: value}))


@pytest.mark.parametrize("describe", CHARTS)
def test_a_figure_is_made_once_and_fed_with_and_without_outages(study: SimulationStudy, describe) -> None:
    chart = describe(study)
    figure = to_bokeh(chart, 300)
    assert len(chart.lines) <= 7
    assert all(line.style in STYLES for line in chart.lines)
    assert len({line.label for line in chart.lines}) == len(chart.lines)
    assert "[" in chart.y_label
    assert "[" in chart.x_label
    for other in (_study(((10, 20), (30, 35)), runs=3), _study(runs=2, states=15)):
        fed = describe(other)
        figure.feed(fed)
        nothing = chart.key == "sim-outage" and not other.result.spec.outages
        assert (to_csv(fed).count("\n") == 1) == nothing
        assert legend_html(fed)
        assert "<svg" in to_svg(fed)
        for drawn, line in zip(figure._lines, fed.lines, strict=True):
            assert np.array_equal(drawn.data_source.data[drawn.glyph.y.field], line.y, equal_nan=True)
        shown = [box.visible for box, _ in figure._spans.values()]
        assert sum(shown) == (len(other.result.spec.outages) if chart.spans else 0)


def test_the_charts_carry_the_studys_numbers(study: SimulationStudy) -> None:
    result = study.result
    lines = {line.key: line.y for line in charts.tilt_chart(study).lines}
    assert np.radians(lines["rms 1"]) == pytest.approx(result.rms[1, :, 6], rel=1e-12)
    assert np.radians(lines["closed"]) == pytest.approx(result.closed_form_sigma[:, 6], rel=1e-12)
    growth = charts.outage_chart(study)
    assert list(growth.lines[0].x) == pytest.approx(list(range(2, 21, 2)))
    assert growth.lines[0].y == pytest.approx(result.rms[1, -10:, 0])
    down = charts.ensemble_chart(study, "down")
    assert down.bands[0].high == pytest.approx(result.percentiles[95.0][:, 2])


def test_the_verdict_comes_first_in_words_and_what_people_write_is_inert(study: SimulationStudy) -> None:
    result = Result(DESIGN, study, partial=False)
    fresh, stale = answer(result, stale=False), answer(result, stale=True)
    assert study.result.verdict.partition(": ")[0].capitalize() in fresh[:200]
    assert study.result.verdict.partition(": ")[2] in fresh
    assert "stale" not in fresh
    assert "stale" in stale
    assert "<b>paper" not in fresh
    assert "more are flying" in answer(Result(DESIGN, study, partial=True), stale=False)
    assert "Where closed form and simulation part" in fresh
    assert "40 of 200 runs, 3 s left" in under_way(Progress(40, 200, 3.2))
    assert "Preparing" in under_way(Progress(0, 200, None))
    assert "Preparing" in under_way(Compiling(1.0))  # a worker is starting: nothing worth a word
    assert "once for this installation" in under_way(Compiling(9.0))


# The widget library sets both of its own button parameters.
@pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")
def test_the_page_refuses_at_its_own_fields_and_marks_a_stale_result(study: SimulationStudy) -> None:
    session = Session(DESIGN)
    page = SimulatePage(session)
    for change, said in (
        ({"_runs": "5000"}, "Runs: "),
        ({"_runs": "many"}, "Runs: "),
        ({"_seed": "-1"}, "Seed: "),
        ({"_length": "nan"}, "Length: "),
        ({"_length": ""}, "Length: "),
        ({"_outages": "later"}, "outages: "),
        ({"_flight": "file"}, "Trajectory file: none given yet"),
        ({"_runs": "2000", "_length": "10000"}, "Length: "),
    ):
        before = {name: getattr(page, name).value for name in change}
        for name, value in change.items():
            getattr(page, name).value = value
        with pytest.raises(InputError, match=f"^{said}"):
            page._specification()
        for name, value in before.items():
            getattr(page, name).value = value
    assert page._specification().outages == ((200.0, 300.0),)
    boxes = page._more.boxes
    boxes["gyro.bias_instability"].value = "25 °/h"
    assert page._specification().imu.gyro.bias_instability == pytest.approx(25 * np.pi / 648_000)
    boxes["gyro.bias_instability"].value = "25 mg"
    assert boxes["gyro.bias_instability"].error_state
    assert "not a unit of angular rate" in boxes["gyro.bias_instability"].helper_text
    assert "still 25 °/h" in boxes["gyro.bias_instability"].helper_text
    assert page._specification().imu.gyro.bias_instability > 0.0  # the last good value holds
    assert "gyros: bias instability 25 °/h" in page._more.given.object
    boxes["gyro.bias_instability"].value = ""
    assert not boxes["gyro.bias_instability"].error_state
    assert page._specification().imu.gyro.bias_instability == 0.0
    assert page._more.given.object == ""
    page._told(Result(DESIGN, study, partial=False))
    figures = [chart.figure.plot for chart in page._charts]
    assert len(figures) == len(CHARTS)
    assert "stale" not in page._answer.object
    session.change({"imu.angle_random_walk": 1e-4})
    page.show(session.budget)
    assert "stale" in page._answer.object
    session.undo()
    page._told(Result(session.design, study, partial=False))
    assert [chart.figure.plot for chart in page._charts] == figures
    assert "stale" not in page._answer.object
    assert page._npz().getbuffer()[:2] == b"PK"
    assert page._csv().getvalue().startswith(b"time_s,nees")
    assert b'"consistent"' in page._json().getvalue()

"""The run behind the Simulate page, and the page's own logic, without a browser."""

import asyncio
import multiprocessing
import re
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import panel as pn
import param
import pytest
from pages import when_done

from app.charts.kinds import to_csv
from app.charts.legend import legend_html
from app.charts.print.svg import to_svg
from app.charts.screen.figures import to_bokeh
from app.charts.styles import STYLES
from app.document.blocks import TableBlock
from app.document.pane import html_of
from app.session import Session
from app.subjects.simulation import charts
from app.subjects.simulation import run as simulation_run
from app.subjects.simulation.charts import CHARTS
from app.subjects.simulation.files import FILES
from app.subjects.simulation.page import SimulatePage
from app.subjects.simulation.report import sections
from app.subjects.simulation.run import Flown, fly, subject
from app.subjects.simulation.tables import verdict
from app.work import simulator
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.link import split_link
from nav_model.design.parts import INPUTS
from nav_model.simulation.design_study import SimulationStudy, closed_form, conclude, specification, study_of
from nav_model.simulation.monte_carlo import simulate
from nav_model.trajectory import design_study as trajectory_study

pytestmark = pytest.mark.long

DESIGN = Design({"name": "<b>paper</b>", "flight.speed": 50.0})


@cache
def _study(outages: tuple[tuple[float, float], ...] = (), runs: int = 12, states: int = 9) -> SimulationStudy:
    design = DESIGN.replace({"filter.states": states})
    spec = specification(design, runs=runs, duration=60.0, every=2.0, outages=outages)
    return study_of(DESIGN, simulate(spec, closed_form=closed_form(DESIGN, spec)))


@pytest.fixture(scope="module")
def study() -> SimulationStudy:
    return _study(((40, 60),))


def _fly(spec_options: dict[str, object], during: Callable[[Run], None] = lambda run: None) -> tuple[Run, list[str]]:
    """Run to the end; `during` sees the run at every piece of progress, whose words are kept."""
    messages: list[str] = []
    run = Run()

    def record(event: param.parameterized.Event) -> None:
        if event.new is not None:
            messages.append(event.new.what)
            during(run)

    async def work(run: Run) -> Flown:
        return await fly(run, DESIGN, specification(DESIGN, **spec_options))

    run.param.watch(record, "progress")
    when_done(lambda: run.start(work))
    return run, messages


def test_a_run_tells_progress_and_ends_with_the_commands_numbers() -> None:
    options: dict[str, object] = {"runs": 80, "duration": 60.0, "every": 2.0, "outages": ((40, 60),)}
    run, messages = _fly(options)
    assert messages[0] == simulator.PREPARING
    done = [int(words.split()[0]) for words in messages if words.endswith("of 80 runs")]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0, 80)
    assert not run.result.partial
    assert run.message == ""
    assert np.array_equal(run.result.study.result.rms, _study(((40, 60),), runs=80).result.rms)


def test_what_is_found_so_far_is_shown_and_stays_partial_when_the_run_is_cancelled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(simulation_run, "_LOOK_SECONDS", 0.0)

    def stop(run: Run) -> None:
        if run.result is not None:
            run.cancel()

    run, _ = _fly({"runs": 5000, "duration": 60.0}, stop)
    assert run.result.partial
    assert 0 < run.result.study.result.spec.runs < run.result.wanted == 5000
    match = re.fullmatch(r"Cancelled: ([1-9]\d*) of 5000 runs\.", run.message)
    assert int(match[1]) == run.result.study.result.spec.runs  # none is thrown away


async def test_what_is_found_as_the_page_goes_is_not_shown_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_run, "_LOOK_SECONDS", 0.0)
    results: list[Flown] = []

    async def until_it_goes(function: Callable[..., Any], *arguments: Any) -> Any:
        await asyncio.sleep(0)
        if function is conclude:
            run.drop()
        return function(*arguments)

    monkeypatch.setattr(simulation_run, "run_in_pool", until_it_goes)
    run = Run()
    run.param.watch(lambda event: results.append(event.new), "result")
    spec = specification(DESIGN, runs=5000, duration=60.0)
    await run.start(lambda run: fly(run, DESIGN, spec))
    assert not results


def test_a_compilation_is_told_and_can_be_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = multiprocessing.get_context("spawn").Event()  # the compilation lasts until it is told
    monkeypatch.setattr(simulator, "warm_up", compiled.wait)

    def go_on(run: Run) -> None:
        if run.progress.what == simulator.PREPARING:
            compiled.set()

    run, messages = _fly({"runs": 2, "duration": 10.0}, go_on)
    assert messages[0] == simulator.PREPARING
    assert run.result.wanted == 2

    def stop(run: Run) -> None:
        if run.progress.what == simulator.PREPARING:
            run.cancel()
            compiled.set()

    compiled.clear()
    run, _ = _fly({"runs": 2, "duration": 10.0}, stop)
    assert run.message == f"Cancelled: {simulator.PREPARING}."
    assert run.result is None


def test_a_flight_that_cannot_be_flown_is_said_in_words() -> None:
    page = SimulatePage(Session(DESIGN))
    page.param.update(trajectory="turns", runs="2", length="60", outages="")
    when_done(page.begin, page.run)
    assert page.run.message.startswith("Length: 60.0 cannot be simulated; the turns take")
    page.param.update(trajectory="straight", outages="20, 40; 60, 70")
    when_done(page.begin, page.run)
    assert page.run.message == "Outages: 60 s is after the flight, which ends at 60 s."


def _stepped(declaration: Any, value: Any) -> Any:
    """Another value of a number or a switch; None of a choice, a table or what is not given."""
    if isinstance(value, bool):
        return not value
    if not isinstance(declaration, BaseQuantity):
        return None
    return value + 1 if value and float(value).is_integer() else 1.01 * (value or 1e-3)


@pytest.mark.parametrize("plan", [False, True])
def test_each_input_that_moves_runs_or_formulas_makes_a_study_old(plan: bool) -> None:
    """By the flights themselves: an input makes the study old if it changes what is flown or the curves of the
    formulas, wherever it is in the design."""
    name = "lines" if plan else "wandering"
    design = DESIGN.replace({"trajectory.flight": name, "gnss.correlated": True, "gnss.correlated_noise": 0.3})
    times = np.array([0.0, 0.0, 20.0])

    def flown(design: Design) -> Any:
        flight = trajectory_study.planned(design) if plan else None
        spec = specification(design, trajectory=flight.trajectory if flight else "wandering")
        return (
            spec,
            flight and flight.duration,
            closed_form(design, spec)(times, np.array([1.0, 9.0, 30.0])).tobytes(),
        )

    known, moved = flown(design), 0
    for section, names in INPUTS.items():
        for name, declaration in names.items():
            value = _stepped(declaration, design[f"{section}.{name}"])
            try:
                other = design.replace({f"{section}.{name}": value}) if value is not None else None
            except InputError:
                continue
            if other is not None and flown(other) != known:
                moved += 1
                assert subject(other, plan=plan) != subject(design, plan=plan), f"{section}.{name}"
    assert moved > (25 if plan else 20)


def test_what_no_run_follows_from_leaves_a_study_as_it_is() -> None:
    others = {"name": "b", "radar.slant_range": 9e3, "requirements.tilt": 0.1, "coast.duration": 9.0}
    assert subject(DESIGN, plan=False) == subject(DESIGN.replace(others), plan=False)
    banked = DESIGN.replace({"trajectory.bank": 0.2})
    assert subject(DESIGN, plan=False) == subject(banked, plan=False)
    assert subject(DESIGN, plan=True) != subject(banked, plan=True)


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
        visible = [box.visible for box, _ in figure._spans.values()]
        assert sum(visible) == (len(other.result.spec.outages) if chart.spans else 0)


def test_the_charts_carry_the_studys_numbers(study: SimulationStudy) -> None:
    result = study.result
    lines = {line.key: line.y for line in charts.attitude_chart(study).lines}
    tilt = np.sqrt((result.rms[1, :, 6] ** 2 + result.rms[1, :, 7] ** 2) / 2)
    assert np.radians(lines["rms 1"]) == pytest.approx(tilt, rel=1e-12)
    assert np.radians(lines["rms 2"]) == pytest.approx(result.rms[1, :, 8], rel=1e-12)
    assert np.radians(lines["closed 1"]) == pytest.approx(result.closed_form_sigma[:, 6], rel=1e-12)
    ratios = {line.key: line.y for line in charts.consistency_chart(study).lines}
    assert ratios["heading"] == pytest.approx(result.rms[1, :, 8] / result.filter_sigma[1, :, 8])
    growth = charts.outage_chart(study)
    assert list(growth.lines[0].x) == pytest.approx(list(range(2, 21, 2)))
    assert growth.lines[0].y == pytest.approx(result.rms[1, -10:, 0])
    down = charts.ensemble_chart(study, "down")
    assert down.bands[0].high == pytest.approx(result.percentiles[95.0][:, 2])


def test_the_verdict_and_its_tables_are_the_studys(study: SimulationStudy) -> None:
    answer = verdict(study)
    assert study.result.verdict.partition(":")[0].partition(",")[0] in answer.word.lower()
    nees = study.result.nees
    figures = [float(text) for text in re.findall(r"\d+\.\d+", answer.sentences[0])]
    assert figures == pytest.approx([nees.mean, nees.low, nees.high], rel=5e-3)
    first, *blocks = sections(study, "page")[0].blocks
    titles = [block.caption for block in blocks if isinstance(block, TableBlock)]
    assert first == answer
    assert titles[0] == "Simulation set-up"
    assert titles[-1] == "Where formula and simulation differ, and why"
    assert html_of(answer, *blocks).count("<table") == len(titles) == 3


def said_by(page: SimulatePage) -> str:
    """Text of the answer strip."""
    return page._strip._text.object


def test_settings_travel_in_the_link_and_the_server_still_has_the_result(
    study: SimulationStudy, nothing_kept: None
) -> None:
    session = Session(DESIGN)
    page = SimulatePage(session)
    page.param.update(runs="12", outages="40,60")
    page._asked = page._settings.asked
    page.run.result = Flown(study, 20)
    again = Session(DESIGN)
    again.take_studies(split_link(session.link)[1])
    restored = SimulatePage(again)
    assert (restored.runs, restored.outages, restored.length) == ("12", "40,60", "300")
    assert restored.run.result.study is study
    assert "Partial: 12 of 20 runs" in said_by(restored)
    assert SimulatePage(Session(DESIGN))._result is None


def test_the_page_keeps_no_flight_of_more_than_its_share_of_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every page that is open may keep one, which none of them is told of."""
    rows = "\n".join(f"{t},45,{t * 1e-5},3000,0,0,90" for t in range(60))
    names = "time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg"
    content = f"{names}\n{rows}".encode()

    async def here(work: Callable[..., Any], *arguments: Any) -> Any:
        return work(*arguments)

    monkeypatch.setattr("app.subjects.simulation.page.run_in_pool", here)
    page = SimulatePage(Session(DESIGN))
    asyncio.run(page._uploaded("flight.csv", content))
    file = page._file
    assert file is not None
    monkeypatch.setattr("app.subjects.simulation.page._MOST_KEPT", len(file.samples) - 1)
    other = SimulatePage(Session(DESIGN))
    asyncio.run(other._uploaded("flight.csv", content))
    assert other._file is None
    assert "Give fewer rows, or use the command" in other._bar.message


def test_everything_folded_opens_and_shows_the_result_that_comes_later(study: SimulationStudy) -> None:
    page = SimulatePage(Session(DESIGN))
    folded = page.__panel__().objects[-1]
    seen = len(folded.select(pn.pane.Bokeh))
    folded.active = list(range(len(folded)))
    assert all(place.objects for place in folded)
    assert len(folded.select(pn.pane.Bokeh)) == seen
    page.run.result = Flown(study, 12)
    assert len(folded.select(pn.pane.Bokeh)) == seen + 4  # path and attitude, outage and spread


async def test_the_page_refuses_at_its_own_fields_and_marks_a_stale_result(study: SimulationStudy) -> None:
    session = Session(DESIGN)
    page = SimulatePage(session)
    for change, message in (
        ({"runs": "5000"}, "Runs: "),
        ({"runs": "many"}, "Runs: "),
        ({"seed": "-1"}, "Seed: "),
        ({"length": "nan"}, "Length: "),
        ({"length": ""}, "Length: "),
        ({"outages": "later"}, r"trajectory.outages\[1\].start: "),
        ({"trajectory": "file"}, "Trajectory file: open a file first"),
        ({"runs": "2000", "length": "10000"}, "Length: "),
    ):
        before = {name: getattr(page, name) for name in change}
        for name, value in change.items():
            setattr(page, name, value)
        with pytest.raises(InputError, match=f"^{message}"):
            await page._specification()
        for name, value in before.items():
            setattr(page, name, value)
    assert (await page._specification()).outages == ((200.0, 300.0),)
    plan = {"trajectory.flight": "lines", "trajectory.outages": ((30.0, 40.0),)}
    planned = SimulatePage(Session(DESIGN.replace(plan)))
    planned.trajectory = "plan"
    spec, flight = await planned._specification(), trajectory_study.planned(DESIGN.replace(plan))
    assert (spec.trajectory, spec.duration, spec.outages) == (flight.trajectory, flight.duration, ((30.0, 40.0),))
    assert session.enter("gyro.bias_instability", "25 °/h") is None
    assert (await page._specification()).imu.gyro.bias_instability == pytest.approx(25 * np.pi / 648_000)
    session.undo()
    assert not page._bar.state.object
    page.run.result = Flown(study, 12)
    assert session.findings["simulation"] is study
    assert "Consistent" in said_by(page)
    assert "older than" not in said_by(page)
    assert "Partial" not in said_by(page)
    assert "</svg> tilt</li>" in page._heads[1].object  # the curves of the second stack have no names beside them
    drawn = page._stacks[0]._sources["timelines"].data
    assert drawn["sim-position closed 1"] == pytest.approx(study.result.closed_form_sigma[:, 0])
    assert page._stacks[1].plots[0].x_range is page._stacks[0].plots[0].x_range
    session.change({"imu.angle_random_walk": 1e-4})
    page.show(session.budget)
    assert "The runs are older than angle random walk. Run again." in said_by(page)
    session.undo()
    other = _study(runs=7)
    page.run.result = Flown(other, 200)
    assert "older than" not in said_by(page)
    assert "Partial: 7 of 200 runs" in said_by(page)
    assert "✓" not in said_by(page)  # a part is no verdict
    assert session.findings["simulation"] is study  # of all its runs
    page.run.result = page._earlier = Flown(study, 12)
    page.run.message = "Cancelled: 3 of 2000 runs."
    assert "The last run was cancelled. Showing the previous result." in said_by(page)
    down = np.abs(other.result.worst.error[1, :, 2])
    page.axis = "down"
    assert charts.ensemble_chart(other, "down").lines[2].y == pytest.approx(down)
    assert FILES[".npz"](other).startswith(b"PK")
    assert FILES[".csv"](other).startswith(b"time_s,nees")
    assert b'"consistent"' in FILES[".json"](other)


def test_what_the_fields_refuse_is_said_in_the_strip() -> None:
    page = SimulatePage(Session(DESIGN))
    page.outages = "later"
    when_done(page.begin, page.run)
    assert "Outages, row 1, start: &#x27;later&#x27; is not a time" in said_by(page)
    assert page._bar.state.object == ""  # once is enough
    assert page.run.result is None

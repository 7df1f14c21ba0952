"""Manoeuvres that would close a flight: each offer is flown again, as the page flies it, and in runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.trajectory import LIMITED
from nav_model.explore.manoeuvre import Manoeuvres, Option, manoeuvres
from nav_model.simulation.single_run import POSTERIOR
from nav_model.simulation.single_run import fly as simulate
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import along_flight, lines_of, planned, rows_of
from nav_model.trajectory.plan import before_line, fly, in_parts
from nav_model.trajectory.result import TrajectoryResult
from nav_model.trajectory.waypoints import Plan, Waypoint

PLAN = Design(
    {
        "imu.preset": "STIM300",
        "imu.velocity_random_walk": 1e-3,
        "imu.angle_random_walk": 4.4e-5,
        "gnss.position_noise": 1.0,
        "gnss.interval": 1.0,
        "flight.speed": 90.0,
        "flight.latitude": 48 * DEGREE,
        "radar.aperture_time": 5.0,
        "requirements.heading": 0.08 * DEGREE,
        "trajectory.flight": "lines",
        "trajectory.lines": 2.0,
        "trajectory.length": 12_000.0,
        "trajectory.spacing": 3000.0,
    }
)


def flown(design: Design) -> TrajectoryResult:
    """As the page Flight follows it, both processings."""
    return covariance(along_flight(design, planned(design)))


def excess(result: TrajectoryResult, names: tuple[str, ...]) -> float:
    return max(
        line.worst.get(figure, math.inf) / limit
        for line in result.lines
        if line.name in names
        for figure, limit in line.limits.items()
    )


def taken(design: Design, option: Option) -> Design:
    return design.replace(option.changes, option.written)


def drawn(seed: int) -> Design:
    """A design with a plan that fails on some line, most of them by heading."""
    rng = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    speed = between(40.0, 150.0)
    changes: dict[str, object] = {
        "imu.angle_random_walk": between(5e-6, 1e-4),
        "imu.velocity_random_walk": between(1e-4, 1e-3),
        "imu.gyro_bias": rng.choice([0.0, between(0.1, 5.0) * DEGREE / 3600]),
        "gnss.position_noise": between(0.02, 2.0),
        "gnss.velocity_noise": rng.choice([None, between(0.01, 0.1)]),
        "flight.speed": speed,
        "flight.heading": rng.uniform(0.0, math.tau),
        "trajectory.lines": float(rng.integers(1, 4)),
        "trajectory.length": speed * rng.uniform(60.0, 240.0),
        "trajectory.spacing": float(rng.choice([-1.0, 1.0])) * speed * rng.uniform(5.0, 40.0),
        "trajectory.bank": rng.uniform(12.0, 30.0) * DEGREE,
        "trajectory.bank_limit": rng.choice([None, rng.uniform(10.0, 30.0) * DEGREE]),
        "trajectory.outages": ((100.0, 115.0),) if rng.random() < 0.3 else (),
        "processing.mode": str(rng.choice(["real time", "real time", "post-processed"])),
    }
    design = PLAN.replace(
        {key: value.item() if isinstance(value, np.generic) else value for key, value in changes.items()}
    )
    figure = str(rng.choice(["heading", "heading", "heading", "tilt", "horizontal_velocity"]))
    free = design.replace({"requirements.heading": None, f"requirements.{figure}": 1.0})
    worst = max(line.worst[figure] for line in flown(free).lines)
    return free.replace({f"requirements.{figure}": worst * rng.uniform(0.5, 0.98)})


@pytest.mark.parametrize(
    "seed",
    [pytest.param(n, marks=pytest.mark.long if n == 1 else pytest.mark.slow) for n in range(100)],
)
def test_what_is_offered_keeps_the_limits_when_it_is_put_into_the_plan_and_flown(seed: int) -> None:
    design = drawn(seed)
    answer = manoeuvres(design)
    assert not answer.closes
    base = flown(design)
    assert set(answer.lines) == {line.name for line in base.lines if not line.closes}
    assert excess(base, answer.lines) == pytest.approx(
        max(f.worst / f.limit for f in answer.figures.values()), rel=1e-9
    )
    names = {line.name for line in base.lines if line.closes} | set(answer.lines)
    assert [option.closes for option in answer.options] == sorted((o.closes for o in answer.options), reverse=True)
    for option in answer.options:
        again = flown(taken(design, option))
        closes = all(line.closes for line in again.lines if line.name in names)
        assert closes == option.closes, option.name
        assert again.spec.study.duration - base.spec.study.duration == pytest.approx(option.costs_s, abs=1e-6)
        gain = excess(again, answer.lines) / excess(base, answer.lines)
        assert option.useless == (not option.closes and not gain <= 0.98), option.name
        if option.kind == "manoeuvre":
            ends = [places(each) for each in (design, taken(design, option))]
            for (name, begin, end), parts in ((line, [p for p in ends[1] if p[0] == line[0]]) for line in ends[0]):
                assert np.abs(parts[0][1] - begin).max() < 3e-6, (option.name, name)  # 20 m
                assert np.abs(parts[-1][2] - end).max() < 3e-6, (option.name, name)


def places(design: Design) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Where each line begins and ends, latitude and longitude [rad]."""
    flight = planned(design)
    samples = np.frombuffer(flight.trajectory.samples).reshape(-1, 7)

    def at(time: float) -> np.ndarray:
        return np.array([np.interp(time, samples[:, 0], samples[:, axis]) for axis in (1, 2)])

    return [(line.name, at(line.start), at(line.stop)) for line in flight.lines]


@pytest.fixture(scope="module")
def answer() -> Manoeuvres:
    return manoeuvres(PLAN)


def named(answer: Manoeuvres, name: str) -> Option:
    return next(option for option in answer.options if option.name == name)


def test_a_turn_in_front_of_the_first_line_shows_the_heading_and_so_do_two_antennas(answer: Manoeuvres) -> None:
    assert (answer.line, answer.lines, answer.closes) == ("line 1", ("line 1",), False)
    assert answer.options[0].name in {"S-turn", "90° turn"}
    assert all(option.closes for option in answer.options[:3])
    costs = [option.costs_s for option in answer.options if option.closes and option.kind == "manoeuvre"]
    assert costs == sorted(costs)
    assert min(costs) > 0.0
    assert named(answer, "Two antennas, 1 m apart").costs_s == 0.0
    # A straight run-in shows no heading: the gyro's noise goes on growing.
    assert named(answer, "Run-in of 2 min").useless
    assert not named(answer, "Velocity fixes of 3 cm/s, Doppler").closes


def test_the_shortest_turn_is_over_as_long_before_the_end_of_a_line_as_the_limit_lets_it_be() -> None:
    design = PLAN.replace({"requirements.heading": 0.05 * DEGREE, "trajectory.lines": 1.0})
    option = manoeuvres(design).options[0]
    assert option.where == "before line 1"
    assert 200.0 < option.before_s < 700.0
    for share, closes in ((0.98, True), (1.02, False)):
        longer = taken(design, option).trajectory.waypoints
        first, last = np.array(longer[-2][:2]), np.array(longer[-1][:2])
        line = planned(taken(design, option)).lines[0]
        last = first + (last - first) * share * option.before_s / (line.stop - line.start)
        rows = (*longer[:-1], (*last.tolist(), *longer[-1][2:]))
        again = flown(taken(design, option).replace({"trajectory.waypoints": rows}))
        assert all(line.closes for line in again.lines) == closes


def test_a_plan_that_closes_needs_nothing_and_a_line_can_be_asked_for_alone() -> None:
    assert manoeuvres(PLAN, "line 2") == replace(manoeuvres(PLAN, "line 2"), closes=True, options=())
    for changes, line, key in (({}, "line 9", "line"), ({"requirements.heading": None}, "", "requirements")):
        with pytest.raises(InputError) as refused:
            manoeuvres(PLAN.replace(changes), line)
        assert refused.value.key == key


def test_an_acceleration_shows_the_heading_where_velocity_fixes_do() -> None:
    """By sigma_v/dV: 0.01 m/s over a change of 9 m/s is 0.06 degrees for one fix, and less for several."""
    changes = {"gnss.velocity_noise": 0.01, "requirements.heading": 0.08 * DEGREE, "trajectory.lines": 1.0}
    design = PLAN.replace(changes)
    fine = manoeuvres(design)
    option = named(fine, "Speed up by 10% and back")
    assert (option.closes, option.where) == (True, "before line 1")
    # Both changes at 1 m/s² and the time between take the place of the usual run-in of 15 s.
    assert 2 * 1.875 * 9.0 < option.costs_s + 15.0 < 2 * 1.875 * 9.0 + 15.0
    assert option.costs_s < 0.5 * named(fine, "90° turn").costs_s
    after = taken(design, option)
    assert [row[4] for row in after.trajectory.waypoints] == [None, pytest.approx(99.0), None, None]
    assert all(line.closes for line in flown(after).lines)
    coarse = manoeuvres(design.replace({"gnss.velocity_noise": 0.5, "requirements.heading": 0.06 * DEGREE}))
    assert not named(coarse, "Speed up by 40% and back").closes


def test_a_recorded_flight_is_answered_with_aids_and_imus_along_it_and_why_not_with_a_manoeuvre(
    answer: Manoeuvres,
) -> None:
    recorded = manoeuvres(PLAN.replace({"trajectory.flight": "straight"}), flight=planned(PLAN))
    assert (answer.note, recorded.note[:40]) == ("", "No manoeuvre is among the options, as th")
    assert recorded.lines == answer.lines
    assert {option.kind for option in recorded.options} == {"aid", "imu"}
    for option in recorded.options:
        assert option.figures == named(answer, option.name).figures
        assert "trajectory.waypoints" not in option.changes
    alone = manoeuvres(PLAN.replace({"trajectory.flight": "straight"}))
    assert (alone.line, alone.note) == ("flight", recorded.note)


def test_a_line_without_a_limit_needs_nothing() -> None:
    """Too short for an aperture, beside a line that has the only limit and keeps it."""
    rows = [list(row) for row in rows_of(lines_of(PLAN).waypoints)]
    rows[3][:2] = [rows[2][axis] + 0.02 * (rows[3][axis] - rows[2][axis]) for axis in (0, 1)]
    limit = tuple(1.0 if name == "heading" else None for name in LIMITED)
    design = PLAN.replace(
        {
            "requirements.heading": None, "trajectory.flight": "waypoints",
            "trajectory.waypoints": tuple(map(tuple, rows)), "trajectory.limits": (("line 1", *limit),),
        }
    )  # fmt: skip
    assert [(line.closes, bool(line.limits)) for line in flown(design).lines] == [(True, True), (True, False)]
    assert (manoeuvres(design).closes, manoeuvres(design).options) == (True, ())


def test_an_outage_stays_where_it_is_on_the_line() -> None:
    start = planned(PLAN).lines[1].start
    design = PLAN.replace({"trajectory.outages": ((10.0, 12.0), (start + 20.0, start + 40.0))})
    for option in manoeuvres(design).options:
        if option.kind != "manoeuvre":
            continue
        changed = taken(design, option)
        later = next(line.start for line in planned(changed).lines if line.name == "line 2")
        assert changed.trajectory.outages[1] == pytest.approx((later + 20.0, later + 40.0), abs=0.01), option.name


def test_a_turn_that_loses_fixes_says_so_and_a_gentler_one_is_offered() -> None:
    answer = manoeuvres(PLAN.replace({"trajectory.bank_limit": 20 * DEGREE}))
    turn, gentle = named(answer, "S-turn"), named(answer, "S-turn at 19° bank")
    assert turn.lost_s > 20.0 > 0.0 >= gentle.lost_s
    assert gentle.changes["trajectory.bank"] == pytest.approx(19 * DEGREE)
    assert gentle.costs_s > turn.costs_s
    # With all turns gentler, no fix is lost: it saves what the plan loses between its lines.
    plan = planned(PLAN)
    assert named(answer, "All turns at 19° bank").lost_s == pytest.approx(-plan.banked(20 * DEGREE))
    assert plan.banked(20 * DEGREE) > 20.0


@pytest.mark.parametrize("bank", [10.0, 25.0])
@pytest.mark.parametrize("arcs", [(90.0, -90.0), (45.0, -90.0, 45.0), (360.0, -360.0), ()])
def test_turns_in_front_of_a_line_leave_it_and_what_comes_before_as_they_were(
    arcs: tuple[float, ...], bank: float
) -> None:
    corners = ((47.0, 8.0, "a"), (47.1, 8.0, ""), (47.1, 8.05, "b"), (47.0, 8.05, "c"), (46.95, 8.2, ""))
    points = tuple(Waypoint(lat * DEGREE, lon * DEGREE, 3000.0, line) for lat, lon, line in corners)
    plan = Plan(points, 70.0, bank * DEGREE)
    for number in (0, 2, 3):
        changed = before_line(plan, number, [arc * DEGREE for arc in arcs], 60.0)
        flight = fly(changed)
        assert [line.name for line in flight.lines] == ["a", "b", "c"]
        assert [point for point in changed.waypoints if point.line] == [point for point in points if point.line]
        before = fly(plan)
        for line, original in zip(flight.lines, before.lines, strict=True):
            assert line.stop - line.start >= original.stop - original.start - 1e-6  # none is cut short
        samples = np.frombuffer(flight.trajectory.samples).reshape(-1, 7)
        time, course = samples[:, 0], np.unwrap(samples[:, 6])
        start = flight.lines[{0: 0, 2: 1, 3: 2}[number]].start
        on = (time > start - 58.0) & (time < start)
        assert np.ptp(course[on]) < 1e-3  # straight for a minute before the line


def test_a_line_in_parts_is_covered_whole() -> None:
    points = (Waypoint(0.8, 0.1, 3000.0, "a"), Waypoint(0.81, 0.11, 3100.0))
    changed = in_parts(Plan(points, 70.0), 0, 3, 500.0 / 70.0)
    assert [point.line for point in changed.waypoints] == ["a", "", "a", "", "a", ""]
    assert fly(changed).duration > fly(Plan(points, 70.0)).duration
    along = [(point.latitude - 0.8) / 0.01 for point in changed.waypoints]
    assert along[0] == 0.0
    assert along[-1] == pytest.approx(1.0)
    assert all(begin < end for begin, end in zip(along[2::2], along[1:-1:2], strict=True))  # they overlap
    heights = [point.height for point in changed.waypoints]
    np.testing.assert_allclose(heights, 3000.0 + 100.0 * np.array(along), atol=0.5)
    with pytest.raises(InputError, match="too short"):
        in_parts(Plan(points, 70.0), 0, 3, 900.0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_simulated_flights_with_the_manoeuvre_have_the_heading_that_it_promises(seed: int) -> None:
    bias = [0.0, 0.5, 0.0, 0.0][seed - 1] * DEGREE / 3600
    length = [12_000.0, 9000.0, 18_000.0, 12_000.0][seed - 1]
    design = PLAN.replace({"imu.gyro_bias": bias, "trajectory.length": length})
    if seed == 4:
        design = design.replace({"gnss.velocity_noise": 0.01})
    option = next(o for o in manoeuvres(design).options if o.closes and o.kind == "manoeuvre")
    assert option.name.startswith("Speed up") == (seed == 4)
    changed, runs = taken(design, option), 200
    spec = along_flight(changed, planned(changed))
    result = covariance(replace(spec, settled=False))  # begins as the runs do
    # A residual bias acts in the runs while no fix comes only; along a flight it turns the heading all the time.
    gyro = spec.study.imu.gyro
    gyro = replace(gyro, turn_on_bias=gyro.residual_bias, residual_bias=0.0)
    study = replace(spec.study, imu=replace(spec.study.imu, gyro=gyro))
    squares = np.mean([simulate(study, run).error[POSTERIOR][:, 8] ** 2 for run in range(runs)], axis=0)
    ratio = np.sqrt(squares) / result.real_time.attitude[:, 2]
    low, high = np.sqrt(chi2.ppf([0.0005, 0.9995], runs) / runs)
    settled = flown(changed)
    for line in result.lines:
        on = (result.time_s >= line.start_s) & (result.time_s <= line.stop_s)
        assert low < ratio[on].min() <= ratio[on].max() < high, (option.name, line.name)
        # What was offered is of a filter that has settled before; after the manoeuvre that is the same.
        offered = settled.real_time.attitude[on, 2]
        np.testing.assert_allclose(offered, result.real_time.attitude[on, 2], rtol=0.03)


@pytest.mark.long
def test_where_nothing_closes_alone_two_options_are_flown_together() -> None:
    least = min(option.figures["heading"].worst for option in manoeuvres(PLAN).options)
    design = PLAN.replace({"requirements.heading": 0.5 * least})
    answer = manoeuvres(design)
    names = {option.name for option in answer.options if option.kind != "manoeuvre"}
    (pair,) = [each for each in answer.options if any(each.name.endswith(f" and {in_sentence(n)}") for n in names)]
    again = flown(taken(design, pair))
    assert pair.closes == all(line.closes for line in again.lines)
    alone = [option.figures["heading"].ratio for option in answer.options if option is not pair]
    assert min(alone) > 1.0
    assert excess(again, answer.lines) == pytest.approx(pair.figures["heading"].ratio, rel=1e-9)
    assert pair.figures["heading"].ratio < min(alone)

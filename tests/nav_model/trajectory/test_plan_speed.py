"""Speeds of single legs: what is flown, and what a change of speed shows of the heading, worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.simulation.design_study import specification
from nav_model.simulation.single_run import POSTERIOR
from nav_model.simulation.single_run import fly as simulate
from nav_model.simulation.specification import InitialSigma
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification, plan_of, planned
from nav_model.trajectory.files.reader import parse_file
from nav_model.trajectory.plan import PlannedFlight, fly
from nav_model.trajectory.waypoints import Plan, Waypoint, lengthened

METRE = 1 / 6.37e6
NORTH = 80 * DEGREE  # where the Earth's rotation shows little of a heading


def speeds(flight: PlannedFlight, step: float = 0.25) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the ground speed there."""
    time = np.arange(0.0, flight.duration, step)
    return time, np.linalg.norm(plan_trajectory(flight.trajectory, flight.duration).velocity(time)[:, :2], axis=1)


@pytest.mark.parametrize("seed", range(12))
def test_every_line_is_flown_at_its_speed_from_end_to_end(seed: int) -> None:
    random = np.random.default_rng([43, seed])
    usual, most = random.uniform(50.0, 120.0), random.uniform(0.5, 2.0)
    place, points = np.zeros(2), []
    course = random.uniform(-math.pi, math.pi)
    for number in range(3):  # a line, and the way to the next
        for line, length in ((f"line {number}", 9000.0), ("", random.uniform(8000.0, 12_000.0))):
            speed = random.choice([None, usual * random.uniform(0.8, 1.25)])
            points.append(Waypoint(*(place * METRE).tolist(), 3000.0, line, speed))
            place = place + length * np.array([math.cos(course), math.sin(course)])
            course += random.uniform(-1.6, 1.6)
    plan = Plan((*points, Waypoint(*(place * METRE).tolist(), 3000.0)), usual, acceleration=most)
    flight = fly(plan)
    time, speed = speeds(flight)
    path = plan_trajectory(flight.trajectory, flight.duration)
    along = np.gradient(speed, time)
    assert np.abs(along).max() < 1.01 * most
    for line, first, last in zip(flight.lines, points[::2], points[1::2], strict=True):
        on = (time >= line.start) & (time <= line.stop)
        np.testing.assert_allclose(speed[on], first.speed or usual, rtol=2e-4)
        ends = path.evaluate(np.array([line.start, line.stop]))[:, :2] / METRE
        np.testing.assert_allclose(ends[0], np.array([first.latitude, first.longitude]) / METRE, atol=2.0)
        if line is not flight.lines[-1]:  # after which it turns on the inside
            np.testing.assert_allclose(ends[1], np.array([last.latitude, last.longitude]) / METRE, atol=2.0)
    longer = fly(lengthened(plan, 1, 20.0)).lines[1]
    assert longer.stop - longer.start == pytest.approx(flight.lines[1].stop - flight.lines[1].start + 20.0, abs=0.1)


def test_a_leg_without_room_for_its_change_of_speed_is_refused_by_name() -> None:
    start, line = Waypoint(0.0, 0.0, 3000.0), Waypoint(2000 * METRE, 0.0, 3000.0, "a", 120.0)
    points = (start, line, Waypoint(0.002, 0.0, 3000.0))
    assert fly(Plan(points, 119.0)).lines[0].name == "a"
    with pytest.raises(InputError, match=r"waypoint 1 is .* m long, .* change of speed 10125 m"):
        fly(Plan(points, 60.0))


PLAN = Design(
    {
        "imu.angle_random_walk": 1e-9,
        "imu.velocity_random_walk": 1e-9,
        "gnss.position_noise": 300.0,
        "gnss.velocity_noise": 0.02,
        "flight.speed": 60.0,
        "radar.aperture_time": 5.0,
        "trajectory.flight": "waypoints",
        "trajectory.acceleration": 1.5,
        "trajectory.waypoints": (
            (NORTH, 0.1, 3000.0, "", None),
            (NORTH + 2e3 * METRE, 0.1, 3000.0, "", 90.0),
            (NORTH + 8e3 * METRE, 0.1, 3000.0, "line", None),
            (NORTH + 12e3 * METRE, 0.1, 3000.0, "", None),
        ),
    }
)


def test_speeds_are_part_of_the_file_the_link_the_hash_and_a_ground_stations_plan() -> None:
    rows = PLAN.trajectory.waypoints
    for again in (parse_design(format_design(PLAN)), from_query(to_query(PLAN))):
        assert again == PLAN
        assert again.content_hash == PLAN.content_hash
    plain = PLAN.replace({"trajectory.waypoints": tuple((*row[:4], None) for row in rows)})
    assert plain.content_hash != PLAN.content_hash
    with pytest.raises(InputError, match=r"waypoints\[1\].speed: '?0.5 m/s'? is not allowed"):
        PLAN.replace({"trajectory.waypoints": ((*rows[0][:4], 0.5), *rows[1:])})
    assert [point.speed for point in plan_of(PLAN).waypoints] == [None, 90.0, None, None]


def test_what_a_change_of_speed_shows_of_the_heading_is_least_squares_by_hand() -> None:
    """With a heading error psi and specific force along the track, the error of the velocity across is psi dV: so
    velocity fixes of sigma_v give the heading as the slope of a line through them, on the speed flown."""
    flight = planned(PLAN)
    study = specification(PLAN, trajectory=flight.trajectory, runs=1, duration=flight.duration)
    study = replace(study, initial=InitialSigma(velocity=5.0, tilt=1e-8, yaw=2 * DEGREE))
    result = covariance(replace(covariance_specification(PLAN, study, flight.lines), settled=False))
    time, speed = speeds(flight, 1.0)
    flown = np.interp(result.time_s, time, speed)
    prior, sigma = 2 * DEGREE, 0.02
    for until in (60, 90, len(flown) - 1):
        rows = np.column_stack([flown[1 : until + 1] - flown[0], np.ones(until)]) / sigma
        information = rows.T @ rows + np.diag([1 / prior**2, 1 / 5.0**2])
        expected = math.sqrt(np.linalg.inv(information)[0, 0])
        assert result.real_time.attitude[until, 2] == pytest.approx(expected, rel=0.02)
    assert result.real_time.attitude[-1, 2] < 0.1 * prior


def test_a_simulated_flight_turns_its_heading_error_into_velocity_across() -> None:
    flight = planned(PLAN)
    outage = ((0.5, flight.duration),)
    study = specification(PLAN, trajectory=flight.trajectory, runs=1, duration=flight.duration, outages=outage)
    study = replace(study, initial=InitialSigma(1e-6, 1e-9, 1e-11, 0.5 * DEGREE))
    error = simulate(study, 0).error[POSTERIOR]
    speed = speeds(flight, 1.0)[1]
    fastest = int(speed.argmax())
    gained = speed[fastest] - speed[0]
    assert gained == pytest.approx(30.0, rel=1e-3)
    assert error[fastest, 4] - error[0, 4] == pytest.approx(error[0, 8] * gained, rel=0.03)


def test_an_exported_plan_keeps_its_speeds() -> None:
    text = b"""QGC WPL 110
0 1 0 16 0 0 0 0 47 8 400 1
1 0 0 16 0 0 0 0 47 8 3000 1
2 0 2 178 1 80 -1 0 0 0 0 1
3 0 0 16 0 0 0 0 47.1 8 3000 1
4 0 2 178 0 -1 50 0 0 0 0 1
5 0 0 16 0 0 0 0 47.1 8.1 3000 1
6 0 2 178 1 -2 -1 0 0 0 0 1
7 0 0 16 0 0 0 0 47 8.1 3000 1
"""
    file = parse_file(text, "a.waypoints")
    assert [point.speed for point in file.waypoints] == [80.0, 80.0, None, None]
    assert "its changes of speed are flown" in file.note

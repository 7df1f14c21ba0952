"""Flights are what they say they are, and files that cannot be flown are refused by name and line."""

import math

import numpy as np
import pytest

from nav_model.base.constants import EARTH_RATE
from nav_model.base.errors import InputError
from nav_model.earth.trajectory_file import COLUMNS
from nav_model.earth.wgs84 import normal_gravity
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import specific_force_and_rate
from nav_model.trajectory.files.reader import parse_file

SECONDS = np.arange(0.0, 600.0, 0.25)


def test_a_resting_imu_feels_gravity_and_the_earth():
    spec = TrajectorySpec("straight", speed=0.0, latitude=0.6, height=120.0)
    felt = specific_force_and_rate(plan_trajectory(spec, 100.0), np.array([0.0, 50.0, 100.0]))
    gravity = normal_gravity(np.sin(0.6), 120.0)
    expected = [0, 0, -gravity, EARTH_RATE * np.cos(0.6), 0, -EARTH_RATE * np.sin(0.6)]
    assert felt == pytest.approx(np.tile(expected, (3, 1)), abs=1e-12)


def test_the_straight_flight_keeps_speed_height_and_heading():
    trajectory = plan_trajectory(TrajectorySpec("straight", speed=80.0, heading=1.1), 600.0)
    velocity = trajectory.velocity(SECONDS)
    assert velocity[:, 0] == pytest.approx(80.0 * np.cos(1.1), abs=1e-6)
    assert velocity[:, 1] == pytest.approx(80.0 * np.sin(1.1), abs=1e-6)
    assert velocity[:, 2] == pytest.approx(0.0, abs=1e-9)
    assert trajectory.evaluate(SECONDS)[:, 5] == pytest.approx(1.1, abs=1e-12)


def test_the_wandering_flight_wanders_by_the_metres_and_degrees_asked_for():
    spec = TrajectorySpec("wandering", wander=3.0, attitude_wander=math.radians(1.5))
    trajectory = plan_trajectory(spec, 3600.0)
    times = np.arange(0.0, 3600.0, 0.5)
    path = trajectory.evaluate(times)
    east = (path[:, 1] - path[0, 1]) * 6.38e6 * np.cos(path[:, 0])
    assert np.std(east) == pytest.approx(3.0, rel=0.15)
    assert np.std(path[:, 2]) == pytest.approx(3.0, rel=0.15)
    assert np.degrees(np.std(path[:, 3:], axis=0)) == pytest.approx(1.5, rel=0.1)
    assert np.mean(trajectory.velocity(times)[:, 0]) == pytest.approx(spec.speed, rel=1e-3)


def test_turns_are_coordinated_and_end_on_the_first_heading():
    spec = TrajectorySpec("turns", speed=100.0, wander=0.0, attitude_wander=0.0)
    trajectory = plan_trajectory(spec, 600.0)
    path = trajectory.evaluate(SECONDS)
    assert np.max(path[:, 5]) == pytest.approx(math.pi / 2, abs=1e-3)
    assert np.min(path[:, 5]) == pytest.approx(-math.pi / 2, abs=1e-3)
    assert path[-1, 5] == pytest.approx(0.0, abs=1e-6)
    # Coordinated: the sideways specific force vanishes in the body.
    sideways = specific_force_and_rate(trajectory, SECONDS)[:, 1]
    assert np.max(np.abs(sideways)) < 0.05
    assert np.degrees(np.max(path[:, 3])) == pytest.approx(28.1, abs=0.2)
    assert np.hypot(*trajectory.velocity(SECONDS)[:, :2].T) == pytest.approx(100.0, rel=2e-3)


def test_the_climb_gains_its_height():
    spec = TrajectorySpec("climb", wander=0.0, climb_height=400.0, climb_rate=4.0)
    trajectory = plan_trajectory(spec, 600.0)
    path = trajectory.evaluate(SECONDS)
    assert path[-1, 2] - path[0, 2] == pytest.approx(400.0, abs=0.01)
    assert -np.min(trajectory.velocity(SECONDS)[:, 2]) == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"kind": "spiral"}, "kind"),
        ({"latitude": math.radians(86)}, "flight.latitude"),
        ({"speed": -1.0}, "flight.speed"),
        ({"height": math.nan}, "flight.altitude"),
        ({"kind": "climb", "climb_rate": 60.0}, "flight.speed"),
        ({"kind": "file"}, "samples"),
    ],
)
def test_flights_that_cannot_be_are_refused(settings, named):
    with pytest.raises(InputError, match="cannot be simulated; must be") as caught:
        TrajectorySpec(**settings)
    assert caught.value.key == named


def test_flights_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="duration"):
        plan_trajectory(TrajectorySpec("turns"), 60.0)
    with pytest.raises(ValueError, match="duration"):
        plan_trajectory(TrajectorySpec("climb"), 60.0)
    with pytest.raises(ValueError, match="latitude reaches"):
        plan_trajectory(TrajectorySpec("straight", latitude=math.radians(84.9), speed=300.0), 600.0)


def flown(content: bytes):
    return parse_file(content, "flown.csv").flight.trajectory


def csv_text(rows: list[list[float]]) -> str:
    return ",".join(COLUMNS) + "\n" + "\n".join(",".join(repr(cell) for cell in row) for row in rows)


def gentle_rows(count: int = 40) -> list[list[float]]:
    return [
        [10.0 + k, 45.0 + 4e-4 * k, 179.99 + 1e-3 * k, 500.0 + k, 1.0, 2.0, 345.0 + 0.3 * k] for k in range(count)
    ]


def test_a_file_is_flown_through_its_points(tmp_path):
    rows = gentle_rows()
    wrapped = [[*row[:2], (row[2] + 180) % 360 - 180, *row[3:6], row[6] % 360] for row in rows]
    path = tmp_path / "flight.csv"
    path.write_text(csv_text(wrapped))
    spec = flown(path.read_bytes())
    trajectory = plan_trajectory(spec, 39.0)
    result = trajectory.evaluate(np.arange(40.0))
    table = np.array(rows)
    assert np.degrees(result[:, 0]) == pytest.approx(table[:, 1], abs=1e-9)
    assert np.degrees(result[:, 1]) == pytest.approx(table[:, 2], abs=1e-9)
    assert result[:, 2] == pytest.approx(table[:, 3], abs=1e-9)
    assert np.degrees(result[:, 5]) == pytest.approx(table[:, 6], abs=1e-9)
    with pytest.raises(ValueError, match=r"at most the trajectory file's 39 s"):
        plan_trajectory(spec, 40.0)


def spoil(row: int, column: int, value: float) -> str:
    rows = gentle_rows()
    rows[row][column] = value
    return csv_text(rows)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (csv_text(gentle_rows(7)), "7 rows; at least 8"),
        (spoil(5, 1, 95.0), r"line 7: latitude_deg = 95: must be between"),
        (spoil(20, 3, 9000.0), "needs an acceleration of"),
        (spoil(20, 4, 359.0), None),
    ],
)
def test_files_that_cannot_be_flown_are_refused(text, message):
    if message is None:
        flown(text.encode())
        return
    with pytest.raises(ValueError, match=message):
        flown(text.encode())

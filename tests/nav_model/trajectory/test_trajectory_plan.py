"""Plans and files of flights: geometry by hand, both ways of writing a heading, and refusals by name."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory.files.reader import parse_file
from nav_model.trajectory.plan import fly
from nav_model.trajectory.turns import dubins
from nav_model.trajectory.waypoints import Plan, Waypoint, strip

DEGREE = math.pi / 180
METRE = 1 / 6.37e6


def places(*rows: tuple[float, float, float]) -> tuple[Waypoint, ...]:
    """Waypoints by metres north and east of the equator, and height."""
    return tuple(Waypoint(north * METRE, east * METRE, height) for north, east, height in rows)


@pytest.mark.parametrize("spacing", [5000.0, 500.0, -500.0])
def test_a_strip_flies_its_lines_parallel_to_each_other_at_their_spacing(spacing: float) -> None:
    flight = fly(strip(Plan((), 90.0), Waypoint(50 * DEGREE, 8 * DEGREE, 3000.0), 30 * DEGREE, 10e3, spacing, 3))
    path = plan_trajectory(flight.trajectory, flight.duration)
    assert [line.name for line in flight.lines] == ["line 1", "line 2", "line 3"]
    for number, line in enumerate(flight.lines):
        now = true_states(path, np.linspace(line.start + 1.0, line.stop - 1.0, 20))
        yaw = (now.euler[:, 2] / DEGREE + 180.0) % 360.0 - 180.0
        np.testing.assert_allclose(yaw, 30.0 if number % 2 == 0 else -150.0, atol=0.2)
        north = (now.position[:, 0] - 50 * DEGREE) * 6.37e6
        east = (now.position[:, 1] - 8 * DEGREE) * 6.39e6 * math.cos(50 * DEGREE)
        np.testing.assert_allclose(-north * 0.5 + east * math.cos(30 * DEGREE), number * spacing, atol=25.0)
        assert (line.stop - line.start) * 90.0 == pytest.approx(10e3, rel=0.01)


def distances(place: np.ndarray) -> np.ndarray:
    """Metres between places in turn, from coordinates about the Earth's centre (WGS 84)."""
    latitude, longitude, height = place.T
    a, squared = 6378137.0, (2.0 - 1.0 / 298.257223563) / 298.257223563
    n = a / np.sqrt(1.0 - squared * np.sin(latitude) ** 2)
    level = (n + height) * np.cos(latitude)
    axis = (n * (1.0 - squared) + height) * np.sin(latitude)
    centred = np.column_stack([level * np.cos(longitude), level * np.sin(longitude), axis])
    return np.linalg.norm(np.diff(centred, axis=0), axis=1)


@pytest.mark.parametrize("latitude", [60.0, -75.0])
def test_lines_far_apart_in_latitude_have_their_length_and_are_flown_at_their_speed(latitude: float) -> None:
    """Across the antimeridian, where a degree of longitude is much shorter at the last line than at the first."""
    plan = strip(Plan((), 90.0), Waypoint(latitude * DEGREE, 179.9 * DEGREE, 3000.0), 80 * DEGREE, 20e3, 40e3, 4)
    flight = fly(plan)
    path = plan_trajectory(flight.trajectory, flight.duration)
    places = np.array([(point.latitude, point.longitude, point.height) for point in plan.waypoints])
    for number, line in enumerate(flight.lines):
        now = path.evaluate(np.arange(line.start, line.stop, 1.0))[:, :3]
        np.testing.assert_allclose(distances(now), 90.0, rtol=1e-4)
        start = next(n for n, point in enumerate(plan.waypoints) if point.line == line.name)
        np.testing.assert_allclose(distances(places[start : start + 2]), 20e3, rtol=1e-4)
        yaw = path.evaluate(np.array([0.5 * (line.start + line.stop)]))[0, 5] / DEGREE
        assert (yaw - 80.0 - 180.0 * (number % 2) + 1.0) % 360.0 == pytest.approx(1.0, abs=1e-3)
    end = path.evaluate(np.array([flight.duration]))[:, :3]
    assert distances(np.vstack([end, places[-1]]))[0] < 2.0


R = 90.0**2 / (9.80665 * math.tan(25 * DEGREE))


@pytest.mark.parametrize(
    ("rows", "run_in"),
    [
        ([(0, 0), (8e3, 0), (8e3, 2200), (0, 2200)], 15.0),  # back beside it, nearer than two radii
        ([(0, 0), (8e3, 0), (8e3, 300), (0, 300)], 15.0),
        ([(0, 0), (8e3, 0), (0, 2200), (8e3, 2200)], 15.0),  # again in the same direction
        ([(0, 0), (8e3, 0), (12e3, 60), (20e3, 60)], 15.0),  # nearly straight on
        ([(0, 0), (8e3, 0), (4e3, 500), (4e3, -8e3)], 15.0),  # across
    ],
)
def test_two_lines_are_flown_whole_with_a_run_in_wherever_the_second_is(rows: list[tuple], run_in: float) -> None:
    plan = Plan(places(*((*row, 1000.0) for row in rows)), 90.0)
    first, _, second, _ = points = plan.waypoints
    names = {first: "a", second: "b"}
    flight = fly(replace(plan, waypoints=tuple(replace(point, line=names.get(point, "")) for point in points)))
    path = plan_trajectory(flight.trajectory, flight.duration)
    times = [time for line in flight.lines for time in (line.start, line.stop)]
    ends = path.evaluate(np.array(times))[:, :2]
    np.testing.assert_allclose(ends / METRE, np.array([(p.latitude, p.longitude) for p in points]) / METRE, atol=1.0)
    now = true_states(path, np.arange(0.0, flight.duration, 0.25))
    assert np.max(np.abs(now.euler[:, 0])) < 25.3 * DEGREE
    for line in flight.lines:
        before = true_states(path, np.arange(line.start - run_in + 0.5, line.stop, 0.5)).euler[:, 0]
        assert np.max(np.abs(before)) < 0.05 * DEGREE


def test_the_shortest_way_between_two_directions_is_that_ofdubins() -> None:
    """Back on the same line takes 7/3 pi radii, back three radii beside it pi + 1; every way arrives as asked."""
    lengths = [
        min(sum(map(abs, arcs)) * R + straight for arcs, straight in dubins(way, 1.0 + 0j, -1.0 + 0j, R) if arcs)
        for way in (0j, 3j * R)
    ]
    assert lengths == pytest.approx([7 / 3 * math.pi * R, (math.pi + 1) * R])
    random = np.random.default_rng(1)
    for north, east, start, stop in random.uniform(-1.0, 1.0, (200, 4)):
        way, ahead, onward = 5 * R * complex(north, east), np.exp(3j * start), np.exp(3j * stop)
        for arcs, straight in dubins(way, ahead, onward, R):
            # Flown in small steps of the Euler method, with the heading of the middle of each.
            heading, place = float(np.angle(ahead)), 0j
            for arc, after in zip(arcs, (straight, 0.0, 0.0), strict=False):
                steps = heading + arc * (np.arange(2000) + 0.5) / 2000
                place += np.exp(1j * steps).sum() * abs(arc) * R / 2000 + after * np.exp(1j * (heading + arc))
                heading += arc
            assert not arcs or abs(place - way) < 0.01 * R
            assert not arcs or abs(np.exp(1j * heading) - onward) < 1e-9


def test_a_turn_is_flown_at_its_bank_and_without_slip() -> None:
    flight = fly(Plan(places((0, 0, 1000), (20e3, 0, 1000), (20e3, 20e3, 1500)), 100.0, 20 * DEGREE))
    path = plan_trajectory(flight.trajectory, flight.duration)
    now = true_states(path, np.arange(0.0, flight.duration, 0.5))
    assert np.max(now.euler[:, 0]) == pytest.approx(20 * DEGREE, rel=0.01)
    np.testing.assert_allclose(np.arctan2(now.velocity[:, 1], now.velocity[:, 0]), now.euler[:, 2], atol=0.01)
    assert now.position[-1, 2] == pytest.approx(1500.0, abs=1.0)


def test_after_a_climb_the_next_waypoints_are_where_they_were_planned() -> None:
    plan = Plan(places((0, 0, 1000), (10e3, 0, 2900), (10e3, 10e3, 2900)), 50.0, climb_rate=12.0)
    flight = fly(plan)
    now = plan_trajectory(flight.trajectory, flight.duration).evaluate(np.array([flight.duration]))
    end = plan.waypoints[-1]
    np.testing.assert_allclose(now[0, :2] / METRE, np.array([end.latitude, end.longitude]) / METRE, atol=1.0)
    assert now[0, 2] == pytest.approx(2900.0, abs=0.1)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(0, 0, 1000), (5e3, 0, 1000), (5e3, 500, 1000)], "turns need .* at a bank of 25°"),
        ([(0, 0, 1000), (0, 0, 1000), (5e3, 500, 1000)], "waypoint 1 and the next are at one place"),
        ([(0, 0, 1000), (5e3, 0, -10)], "waypoint 2 is not above the ground"),
        ([(0, 0, 1000), (5e3, 0, 2000)], "at most 5 m/s"),
        ([(0, 0, 1000), (5e3, 0, 50e3)], "at most 90 m/s"),
        ([(0, 0, 1000), (5e3, 0, 1000), (0, 1, 1000)], "needs a 180° turn"),
        ([(0, 0, 1000)], "two waypoints"),
    ],
)
def test_a_plan_that_cannot_be_flown_is_refused_by_the_waypoint(
    rows: list[tuple[float, float, float]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        fly(Plan(places(*rows), 90.0, climb_rate=500.0 if rows[-1][2] > 3000 else 5.0))


KML = (
    '<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark>'
    "<name><![CDATA[<b>North &amp; back</b><br>]]></name><LineString><altitudeMode>absolute</altitudeMode>"
    "<coordinates>8,50,3000 8,50.2,3000</coordinates></LineString></Placemark></Document></kml>"
)
GPX = (
    '<?xml version="1.0"?><gpx xmlns="http://www.topografix.com/GPX/1/1" version="1.1"><rte>'
    '<rtept lat="50" lon="8"><ele>3000</ele><name>North &amp; back</name></rtept>'
    '<rtept lat="50.2" lon="8"><ele>3000</ele></rtept></rte></gpx>'
)


def test_the_same_leg_in_gpx_and_kml_is_the_same_flight() -> None:
    files = {"a.kml": KML, "a.gpx": GPX}
    kml, gpx = (parse_file(text.encode(), name).flown(Plan((), 90.0)) for name, text in files.items())
    assert kml.trajectory == gpx.trajectory
    assert [line.name for line in kml.lines] == [line.name for line in gpx.lines] == ["North & back"]


@pytest.mark.parametrize(
    ("kind", "text", "message"),
    [
        (".gpx", GPX.replace("<ele>3000</ele>", "", 1), "route, place 1 has no height"),
        (".gpx", GPX.replace('"50.2"', '"north"'), "'north' must be a finite number"),
        (".gpx", "<gpx>", "is not XML"),
        (".gpx", "<gpx/>", "holds no path, route"),
        (".kml", KML.replace("8,50.2,3000", "8;50.2"), "is not longitude,latitude,height"),
        (".kml", KML.replace("<kml", '<!DOCTYPE a [<!ENTITY b "c">]><kml', 1), "declares entities"),
        (".kml", KML.replace("8,50,", "8,95,"), "not a place on the Earth"),
    ],
)
def test_a_file_that_is_no_plan_is_refused_with_the_place(kind: str, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_file(text.encode(), "flight" + kind)


def test_places_without_height_take_the_one_that_is_given() -> None:
    assert parse_file(GPX.replace("<ele>3000</ele>", "").encode(), "a.gpx", 500.0).waypoints[0].height == 500.0


def flown(content: bytes) -> TrajectorySpec:
    """A file's flight as it was flown."""
    flight = parse_file(content, "flown").flight
    assert flight is not None
    return flight.trajectory


HEADINGS = {
    "0 to 360": lambda yaw: yaw % 360.0,
    "-180 to 180": lambda yaw: (yaw + 180.0) % 360.0 - 180.0,
    "unwrapped": lambda yaw: yaw,
}


def turning(write: object) -> np.ndarray:
    """Time, place and heading of a full turn and a half; degrees."""
    t = np.arange(0.0, 200.0, 1.0)
    yaw = 3.0 * t + 10.0
    course = np.radians(yaw)
    north, east = np.sin(course), -np.cos(course)
    radius = 90.0 / np.radians(3.0) / 6.37e6 * 180 / np.pi
    heading = write(yaw)
    return np.column_stack([t, radius * north, radius * east, 1000.0 + 0 * t, 0 * t, 0 * t, heading])


def test_headings_are_read_however_they_are_written() -> None:
    header = "time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg\n"
    flights = []
    for write in HEADINGS.values():
        rows = turning(write)
        text = header + "\n".join(",".join(map(repr, row)) for row in rows.tolist())
        flights.append(plan_trajectory(flown(text.encode()), 150.0))
        records = np.zeros((len(rows), 17))
        records[:, [0, 1, 2, 3, 7, 8, 9]] = rows
        records[:, [1, 2, 9]] = np.radians(records[:, [1, 2, 9]])
        records[:, 9] += 0.3
        records[:, 10] = 0.3
        flights.append(plan_trajectory(flown(records.tobytes()), 150.0))
    times = np.linspace(0.0, 150.0, 50)
    for flight in flights[1:]:
        np.testing.assert_allclose(flight.evaluate(times), flights[0].evaluate(times), atol=1e-9)


def test_time_that_runs_backwards_in_an_sbet_file_is_refused_by_the_record() -> None:
    records = np.zeros((20, 17))
    records[:, 0] = [*range(10), 3, *range(11, 20)]
    with pytest.raises(InputError, match=r"record 11: time_s = 3\.0 must be later than 9\.0"):
        parse_file(records.tobytes(), "a.out")

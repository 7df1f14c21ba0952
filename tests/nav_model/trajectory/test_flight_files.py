"""Files of flights as other programs write them: each kind with a value that is known, or told what it is."""

import io
import json
import math
import tracemalloc
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.trajectory.files import markup
from nav_model.trajectory.files.reader import FlightFile, parse_file
from nav_model.trajectory.plan import PlannedFlight
from nav_model.trajectory.waypoints import Plan

BROUGHT = Path("/work/shared/data/brought")
METRE = 180 / math.pi / 6_371_000
NAMED = ["week", "seconds", "latitude", "longitude", "height", "vn", "ve", "vd", "roll", "pitch", "heading"]
LIKE = Plan((), 100.0)


def kml(*marks: str) -> bytes:
    head = '<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"><Document>'
    return f"{head}{''.join(f'<Placemark>{mark}</Placemark>' for mark in marks)}</Document></kml>".encode()


def path(mode: str = "<altitudeMode>absolute</altitudeMode>", up: str = ",3000", kind: str = "LineString") -> str:
    places = f"8,47{up} 8,47.1{up} 8.1,47.1{up}"
    return f"<name>out</name><{kind}>{mode}<coordinates>{places}</coordinates></{kind}>"


def states(flight: PlannedFlight | None) -> np.ndarray:
    """Time, latitude, longitude [°], height, roll, pitch, yaw [°] of a flight."""
    assert flight is not None
    rows = np.frombuffer(flight.trajectory.samples).reshape(-1, 7).copy()
    rows[:, [1, 2, 4, 5, 6]] = np.degrees(rows[:, [1, 2, 4, 5, 6]])
    return rows


def heights(file: FlightFile) -> list[float]:
    return [point.height for point in file.waypoints]


# --- KML -----------------------------------------------------------------------------------------------------


def test_a_path_is_flown_and_what_else_there_is_is_named() -> None:
    home = "<name>home</name><Point><coordinates>9,46,430</coordinates></Point>"
    area = (
        path(kind="Polygon")
        .replace("<coordinates>", "<outerBoundaryIs><LinearRing><coordinates>")
        .replace("</coordinates>", "</coordinates></LinearRing></outerBoundaryIs>")
    )
    file = parse_file(kml(home, area, path()), "a.kml")
    assert [(round(math.degrees(p.latitude), 6), p.line) for p in file.waypoints] == [
        (47.0, "out"), (47.1, "out"), (47.1, ""),
    ]  # fmt: skip
    assert "not used: 1 point, 1 area" in file.note
    with pytest.raises(InputError, match="holds an area and no path"):
        parse_file(kml(home, area), "a.kml")
    points = parse_file(kml(home, home.replace("46", "46.1")), "a.kml", 500.0)
    assert "no path, so single points in their order" in points.note
    assert len(points.waypoints) == 2


def test_heights_are_above_what_the_altitude_mode_says() -> None:
    clamped, relative = kml(path("")), kml(path("<altitudeMode>relativeToGround</altitudeMode>", ",120"))
    with pytest.raises(InputError, match=r"has no height .*3000 m is clamped.*--height"):
        parse_file(clamped, "a.kml")
    with pytest.raises(InputError, match=r"is 120 m above the ground.*--ground"):
        parse_file(relative, "a.kml", height=3000.0)
    assert heights(parse_file(clamped, "a.kml", height=2500.0)) == [2500.0] * 3
    assert heights(parse_file(relative, "a.kml", ground=430.0)) == [550.0] * 3
    assert heights(parse_file(kml(path()), "a.kml", height=1.0, ground=2.0)) == [3000.0] * 3


def test_a_track_in_kml_is_flown_in_its_own_time() -> None:
    rows = [
        (f"2026-05-01T08:00:{k:02}Z", f"{8 + 60 * k * METRE / math.cos(math.radians(47))} 47 900") for k in range(40)
    ]
    track = "".join(f"<when>{time}</when><gx:coord>{place}</gx:coord>" for time, place in rows)
    content = kml(f"<name>run</name><gx:Track><altitudeMode>absolute</altitudeMode>{track}</gx:Track>", path())
    file = parse_file(content, "a.kml")
    assert file.flight is not None
    assert (file.flight.duration, [line.name for line in file.flight.lines]) == (39.0, ["run"])
    now = states(file.flight)
    np.testing.assert_allclose(now[:, 6], 90.0, atol=0.1)
    assert "not used: 1 path" in file.note


def test_an_archive_is_read_and_a_bomb_in_it_is_not_expanded() -> None:
    def archive(name: str, content: bytes) -> bytes:
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as file:
            file.writestr(name, content)
        return packed.getvalue()

    assert parse_file(archive("doc.kml", kml(path())), "a.kmz").waypoints == parse_file(kml(path()), "a").waypoints
    with pytest.raises(InputError, match="holds more than 5 MB of XML"):
        parse_file(archive("doc.kml", b" " * 60_000_000), "a.kmz")
    with pytest.raises(InputError, match="is a ZIP archive without a flight"):
        parse_file(archive("notes.txt", b"none"), "a.zip")
    with pytest.raises(InputError, match="cannot be read"):
        parse_file(archive("doc.kml", kml(path()) * 100)[:-30], "a.kmz")
    mission = (
        b'<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.2"><Document><Folder>'
        b"<wpml:executeHeightMode>relativeToStartPoint</wpml:executeHeightMode>%s</Folder></Document></kml>"
    )
    place = (
        b"<Placemark><Point><coordinates>8,%g</coordinates></Point><wpml:executeHeight>80</wpml:executeHeight>"
        b"</Placemark>"
    )
    content = mission % b"".join(place % (47 + 0.01 * k) for k in range(4))
    file = parse_file(archive("wpmz/waylines.wpml", content), "a.kmz", ground=400.0)
    assert heights(file) == [480.0] * 4
    assert [point.line for point in file.waypoints] == ["line 1", "line 2", "line 3", ""]
    assert "speed" not in file.note
    swift = content.replace(b"<Placemark>", b"<wpml:autoFlightSpeed>14</wpml:autoFlightSpeed><Placemark>", 1)
    note = parse_file(archive("wpmz/waylines.wpml", swift), "a.kmz", ground=400.0).note
    assert "flown at the design's speed, not the mission's" in note
    folder = content[content.index(b"<Folder>") : content.index(b"</Document>")]
    two = parse_file(archive("wpmz/waylines.wpml", content.replace(folder, 2 * folder)), "a.kmz", ground=400.0)
    assert [point.line for point in two.waypoints][3:5] == ["", "line 2.1"]


def test_paths_that_go_on_are_flown_through_and_a_tour_is_told() -> None:
    places = "<altitudeMode>absolute</altitudeMode><coordinates>8.1,47.1,3000 8.1,47,3000</coordinates>"
    file = parse_file(kml(path(), f"<LineString>{places}</LineString>"), "a.kml")
    assert [point.line for point in file.waypoints] == ["out", "out", "line 2", ""]
    with pytest.raises(InputError, match="a tour of the camera"):
        parse_file(b"<kml><Tour><Playlist/></Tour></kml>", "a.kml")


# --- what was recorded ---------------------------------------------------------------------------------------


def recorded(noise: float = 1.1, rate: float = 1.0) -> np.ndarray:
    """Time, north, east [m] of 60 s north, half a turn of 3 °/s to the right and 60 s south, at 60 m/s."""
    t = np.arange(0.0, 180.0, 1.0 / rate)
    course = np.radians(np.clip(3.0 * (t - 60.0), 0.0, 180.0))
    fine = np.linspace(0.0, 180.0, 180_001)
    track = np.radians(np.clip(3.0 * (fine - 60.0), 0.0, 180.0))
    north, east = (np.interp(t, fine, np.cumsum(60.0 * wave(track)) * 1e-3) for wave in (np.cos, np.sin))
    rng = np.random.default_rng(5)
    return np.column_stack(
        [t, north + noise * rng.standard_normal(len(t)), east + noise * rng.standard_normal(len(t)), course]
    )


def gpx(rows: np.ndarray, start: float = 0.0) -> str:
    def point(time: float, north: float, east: float) -> str:
        stamp = np.datetime64("2026-05-01T08:00:00.000") + np.timedelta64(round(1000 * (start + time)), "ms")
        return (
            f'<trkpt lat="{north * METRE:.8f}" lon="{east * METRE:.8f}"><ele>1500</ele><time>{stamp}Z</time></trkpt>'
        )

    return f"<trkseg>{''.join(point(*row[:3]) for row in rows)}</trkseg>"


def test_a_recorded_track_is_smoothed_and_banks_as_its_turn_needs() -> None:
    rows = recorded()
    file = parse_file(f"<gpx><trk>{gpx(rows)}</trk></gpx>".encode(), "a.gpx")
    now = states(file.flight)
    turn, straight = (now[:, 0] > 70) & (now[:, 0] < 110), now[:, 0] < 50
    bank = math.degrees(math.atan(60.0 * math.radians(3.0) / 9.80665))
    assert np.mean(now[turn, 4]) == pytest.approx(bank, abs=0.5)
    assert np.std(now[straight, 2] / METRE) < 0.75  # of 1.1 m
    assert np.std(now[straight, 6]) < 0.5
    assert np.polyfit(now[turn, 0], now[turn, 6], 1)[0] == pytest.approx(3.0, abs=0.05)
    assert file.flight is not None
    assert [line.stop - line.start for line in file.flight.lines] == [179.0]


def test_a_pause_is_cut_and_each_segment_is_a_line() -> None:
    rows = recorded(0.0)[:60]
    later = rows + np.array([0.0, 0.0, 9000.0, 0.0])
    text = f"<gpx><trk><name>day</name>{gpx(rows)}{gpx(later, 7200.0)}</trk></gpx>"
    file = parse_file(text.encode(), "a.gpx")
    assert file.flight is not None
    first, second = file.flight.lines
    assert (first.start, first.stop, second.stop - second.start) == pytest.approx((0.0, 59.0, 59.0))
    assert 60.0 < second.start < 600.0
    assert (first.name, second.name) == ("day 1", "day 2")
    assert "1 pause cut" in file.note
    at = plan_trajectory(file.flight.trajectory, file.flight.duration).evaluate(np.array([second.start]))[0]
    assert np.degrees(at[1]) / METRE == pytest.approx(9000.0, abs=0.5)


def test_time_that_runs_backwards_is_named() -> None:
    rows = recorded(0.0)[:60]
    rows[30, 0] = 12.0
    with pytest.raises(InputError, match="place 31: time runs backwards by 17 s"):
        parse_file(f"<gpx><trk>{gpx(rows)}</trk></gpx>".encode(), "a.gpx")


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([(30.0 * (k // 2) + k % 2, 1.0 * k) for k in range(2000)], "more than 500 segments"),
        ([(k + 1e8 * (k > 9), 1.0 * k + 5e6 * (k > 9)) for k in range(20)], "too long to be flown"),
        ([(1.0 * k, 9.6e6 + k) for k in range(20)], "of latitude; must stay within 85°"),
    ],
)
def test_a_recording_that_would_take_long_is_refused(rows: list[tuple[float, float]], message: str) -> None:
    text = "time_s,lat,lon,alt\n" + "\n".join(f"{t},{north * METRE},8,900" for t, north in rows)
    with pytest.raises(InputError, match=message):
        parse_file(text.encode(), "a.csv")


def test_rows_before_the_first_fix_are_left_out_and_named() -> None:
    places = [("0", "0")] * 3 + [("", "")] * 2 + [(f"{47 + 20 * t * METRE}", "8") for t in range(5, 40)]
    rows = [f"{t},{north},{east},900" for t, (north, east) in enumerate(places)]
    file = parse_file("\n".join(["time_s,lat,lon,alt", *rows]).encode(), "a.csv")
    assert states(file.flight)[-1, 0] == 34.0
    assert "2 rows with empty fields left out" in file.note
    assert "3 rows at latitude and longitude 0 left out" in file.note


@pytest.mark.parametrize("rate", [1.0, 10.0])
def test_columns_of_a_drone_are_read_by_their_names_and_units(rate: float) -> None:
    rows = recorded(0.0, rate)
    head = "sep=,\nCUSTOM.date [local],OSD.flyTime,OSD.flyTime [s],OSD.latitude,OSD.longitude,OSD.height [ft],"
    text = head + "OSD.altitude [ft],OSD.pitch,OSD.roll,OSD.yaw [360]\n"
    for t, north, east, _ in rows:
        text += f"5/1/2026,0m {t}s,{t},{47 + north * METRE},{8 + east * METRE},393.7,1804.5,-3,1,77\n"
    file = parse_file(text.encode(), "a.csv")
    now = states(file.flight)
    np.testing.assert_allclose(now[:, 3], 550.01, atol=0.01)
    assert now[-1, 0] == rows[-1, 0]
    if rate < 5.0:  # attitude once a second cannot be flown
        assert "attitude from coordinated turns, not as recorded" in file.note
    else:
        np.testing.assert_allclose(now[:, 4:], [[1.0, -3.0, 77.0]] * len(now), atol=1e-6)
    relative = text.replace("OSD.altitude [ft]", "OSD.x")
    with pytest.raises(InputError, match="above the ground"):
        parse_file(relative.encode(), "a.csv")
    np.testing.assert_allclose(
        states(parse_file(relative.encode(), "a.csv", ground=100.0).flight)[:, 3], 220.0, atol=0.01
    )


@pytest.mark.parametrize(
    ("head", "row", "message"),
    [
        ("time_s;lat;lon;alt [fathom]", "{t};47.{t};8;9", "column alt .fathom.*"),
        ("time,lat,alt", "{t},47.{t},9", "latitude and longitude are missing"),
        ("lat,lon,alt", "47.{t},8,9", "no column with the time"),
        ("t,lat,lon,alt", "{t},0.0{t},0.2,900", "may be degrees or radians"),
        ("t,lat,lon,alt", "{t},97,0.2,900", "line 2: 97, 0.2 is not a place"),
        ("t,lat,lon,alt", "{t},4700{t}0000,80000000,900", "height may be metres or millimetres"),
        ("t,lat,lon,alt", "{t}00,47.01{t},8,900", "time goes up by 100 a row"),
    ],
)
def test_columns_that_are_missing_or_have_two_meanings_are_asked_for(head: str, row: str, message: str) -> None:
    text = "\n".join([head, *(row.format(t=t) for t in range(10, 40))])
    with pytest.raises(InputError, match=message):
        parse_file(text.encode(), "a.csv")


@pytest.mark.parametrize(
    ("head", "row"),
    [
        (
            "%  GPST  latitude(deg) longitude(deg)  height(m)  Q",
            "2024/05/01 08:{m}:{s}.000 {lat} {lon} 900.0 1",
        ),
        ("iTOW,fixType,lon,lat,height,hMSL", "{ms},3,{lon7},{lat7},900000,852000"),
        ("timestamp,lat,lon,alt,alt_ellipsoid", "{us},{lat7},{lon7},852000,900000"),
        ("TOW [0.001 s],Latitude [rad],Longitude [rad],Height [m]", "{ms},{rlat},{rlon},900"),
        ("Time,Latitude,Longitude,Height", "{t} sec,{lat},{lon},900"),
        ("Zeit (s);Breite (°);Länge (°);Höhe (m)", "{t};{lat};{lon};900"),
        ("  UTCTime  Latitude  Longitude  H-Ell\n  (sec)  (deg)  (deg)  (ft)", "{t} {lat} {lon} 2952.755906"),
        ("UTCTime,Latitude,Longitude,H-Ell\nsec,deg,deg,ft", "{t},{lat},{lon},2952.755906"),
        ("time,icao24,lat,lon,baroaltitude,geoaltitude", "{t},4b1815,{lat},{lon},880,900"),
        ("Timestamp,UTC,Callsign,Position,Altitude,Speed", '{t},none,SWR1,"{lat},{lon}",2952.755906,117'),
    ],
)
def test_columns_of_receivers_and_autopilots(head: str, row: str) -> None:
    text = head + "\n"
    for t in range(90):
        lat, lon = 47 + 60 * t * METRE, 8.0
        values = {
            "t": t, "ms": 300_000_000 + 1000 * t, "us": 5_000_000 + 1_000_000 * t, "m": f"{t // 60:02}",
            "s": f"{t % 60:02}", "lat": f"{lat:.9f}", "lon": lon, "lat7": round(1e7 * lat), "lon7": round(1e7 * lon),
            "rlat": f"{math.radians(lat):.12f}", "rlon": f"{math.radians(lon):.12f}",
        }  # fmt: skip
        text += row.format(**values) + "\n"
    file = parse_file(text.encode(), "a.txt")
    now = states(file.flight)
    assert now[-1, 0] == pytest.approx(89.0)
    if "Callsign" in head:
        assert "altitude taken as feet, as Flightradar24 writes it" in file.note
        assert "not used: UTC, Callsign, Speed" in file.note
    np.testing.assert_allclose(now[:, 1], 47 + 60 * now[:, 0] * METRE, atol=0.1 * METRE)
    np.testing.assert_allclose(now[:, 3], 900.0, atol=1e-6)


# --- ground stations -----------------------------------------------------------------------------------------


def item(command: int, *place: float | None, frame: int = 3, first: float = 0.0) -> dict[str, object]:
    return {"type": "SimpleItem", "command": command, "frame": frame, "params": [first, 0, 0, None, *place]}


def plan(*items: object, home: float | None = 430.0) -> bytes:
    mission = {"items": items, "plannedHomePosition": [47.0, 8.0, home], "cruiseSpeed": 15}
    return json.dumps({"fileType": "Plan", "mission": mission}).encode()


def test_a_plan_of_a_ground_station_is_flown_above_its_home() -> None:
    content = plan(
        item(22, 47, 8, 50), item(16, 47, 8, 120), item(16, 47.1, 8, 120), item(16, 47.1, 8.1, 900, frame=0)
    )
    file = parse_file(content, "a.plan")
    assert heights(file) == [550.0, 550.0, 900.0]
    assert "not used: 1 take-off" in file.note
    assert heights(parse_file(content, "a.plan", ground=100.0)) == [220.0, 220.0, 900.0]
    with pytest.raises(InputError, match="above the ground"):
        parse_file(plan(item(16, 47, 8, 120), item(16, 47.1, 8, 120), home=None), "a.plan")
    landing = {"type": "ComplexItem", "complexItemType": "fwLandingPattern", "landCoordinate": [47, 8, 0]}
    old = {"type": "SimpleItem", "command": 16, "frame": 3, "coordinate": [47.1, 8, 120], "params": [0, 0, 0, 0]}
    file = parse_file(plan(item(16, 47, 8, 120), old, landing), "a.plan")
    assert heights(file) == [550.0, 550.0]
    assert "not used: 1 landing" in file.note


def test_lines_of_a_survey_are_where_its_camera_is_triggered() -> None:
    legs = [(47.0, 8.0), (47.1, 8.0), (47.1, 8.01), (47.0, 8.01)]
    parts = []
    for number, place in enumerate(legs):
        parts += [item(16, *place, 120), item(206, None, None, None, first=25.0 if number % 2 == 0 else 0.0)]
    survey = {"type": "ComplexItem", "complexItemType": "survey", "TransectStyleComplexItem": {"Items": parts}}
    file = parse_file(plan(survey), "a.plan")
    assert [point.line for point in file.waypoints] == ["line 1", "", "line 2", ""]
    with pytest.raises(InputError, match=r"survey.*holds no lines"):
        parse_file(plan({"type": "ComplexItem", "complexItemType": "survey"}), "a.plan")


def test_a_waypoint_list_has_its_home_in_the_first_line() -> None:
    rows = ["0 1 0 16 0 0 0 0 47 8 430 1", "1 0 3 16 0 0 0 0 47 8 120 1", "2 0 3 16 0 0 0 0 47.1 8 120 1"]
    content = "\n".join(["QGC WPL 110", *("\t".join(row.split()) for row in rows)]).encode()
    assert heights(parse_file(content, "a.waypoints")) == [550.0, 550.0]
    with pytest.raises(InputError, match="line 3: 11 columns"):
        parse_file(content.replace(b"\t1\n2", b"\n2"), "a.waypoints")


# --- SBET ----------------------------------------------------------------------------------------------------


def sbet(latitude: float = 47.0, start: float = 1000.0, in_degrees: bool = False, count: int = 400) -> np.ndarray:
    """Records of a flight north-east at 100 m/s, 20 Hz."""
    t = np.arange(count) / 20.0
    rows = np.zeros((count, 17))
    rows[:, 0] = (start + t) % 604_800.0
    north = 100.0 * math.cos(0.5) * t / 6.36e6
    rows[:, 1] = math.radians(latitude) + north
    rows[:, 2] = 0.1 + 100.0 * math.sin(0.5) * t / (6.38e6 * math.cos(math.radians(latitude)))
    rows[:, 3], rows[:, 4], rows[:, 5], rows[:, 9], rows[:, 10] = (
        1500.0,
        100 * math.cos(0.5),
        -100 * math.sin(0.5),
        0.6,
        0.1,
    )
    if in_degrees:
        rows[:, [1, 2, 7, 8, 9, 10]] = np.degrees(rows[:, [1, 2, 7, 8, 9, 10]])
    return rows


@pytest.mark.parametrize("latitude", [0.0, 47.0])
def test_sbet_is_known_by_its_content_and_so_are_degrees(latitude: float) -> None:
    plain, degrees = (
        states(parse_file(sbet(latitude, in_degrees=way).tobytes(), "a.bin").flight) for way in (False, True)
    )
    np.testing.assert_allclose(degrees, plain, atol=1e-9)
    np.testing.assert_allclose(plain[:, 6], math.degrees(0.5), atol=1e-9)
    assert "degrees" in parse_file(sbet(latitude, in_degrees=True).tobytes(), "a.bin").note


def test_a_week_that_ends_in_flight_goes_on() -> None:
    file = parse_file(sbet(start=604_790.0).tobytes(), "a.out")
    assert states(file.flight)[-1, 0] == pytest.approx(399 / 20.0)
    assert "end of the week" in file.note


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        (3, -7e6, "record 1: height_m = -7000000: must be between"),
        (7, 1e301, "record 1: roll_deg = .*: must be between"),
        (0, 0.0, "record 2: time"),
    ],
)
def test_sbet_is_held_to_the_bounds_of_columns(column: int, value: float, message: str) -> None:
    with pytest.raises(InputError, match=r"record 1: latitude_deg = 89\.9: must be between"):
        parse_file(sbet(89.9).tobytes(), "a.out")
    rows = sbet()
    rows[:, column] = (
        value if column else np.where(np.arange(len(rows)) < 2, 5e-324 * np.arange(len(rows)), rows[:, 0])
    )
    with pytest.raises(InputError, match=message):
        parse_file(rows.tobytes(), "a.out")


# --- everything else -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"%PDF-1.7 ...", "is a PDF document. Give a KML"),
        (b"AXXX001 FLIGHT\r\nHFDTE160701\r\nB110135", "is an IGC file of a flight recorder"),
        (b'{"type": "FeatureCollection"}', "is JSON, but not a plan"),
        (b"<svg/>", "is XML of the kind 'svg'"),
        (
            np.hstack([np.arange(1e5, 1e5 + 50)[:, None], np.full((50, 9), 0.02)]).tobytes(),
            "is smrmsg, the accuracies",
        ),
        (b"", "the file is empty"),
        (b"\x01\x02\x03" * 100, "is no text and no SBET"),
        (b"hello", "No numbers found"),
    ],
)
def test_any_other_file_is_told_what_it_is(content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_file(content, "a.kml")


def test_text_of_sixteen_bits_is_read() -> None:
    text = "time_s,lat,lon,alt\n" + "\n".join(f"{t},{47 + t * 60 * METRE},8,900" for t in range(30))
    assert states(parse_file(text.encode("utf-16"), "a.csv").flight)[0, 3] == pytest.approx(900.0)
    wide = kml(path()).decode().encode("utf-16")
    assert parse_file(wide, "a.kml").waypoints == parse_file(kml(path()), "a.kml").waypoints


# --- bounds --------------------------------------------------------------------------------------------------


def test_each_name_of_a_file_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def name(element: Element) -> str:
        asked.append(element.tag)
        return ""

    monkeypatch.setattr(markup, "_name", name)
    with pytest.raises(InputError, match="a point without a place"):
        parse_file(kml("<Point/>" * 50), "a.kml")
    assert len(asked) == 1
    parse_file(b"<gpx><trk>" + b"<trkseg><trkpt lat='1' lon='1'/></trkseg>" * 50 + b"</trk></gpx>", "a.gpx", 1.0)
    assert asked[1:].count("trk") == 1


@pytest.mark.parametrize(
    "shape", ["<LineString/>", "<Folder><Placemark><executeHeight>1</executeHeight></Placemark></Folder>"]
)
def test_a_file_without_a_place_is_refused(shape: str) -> None:
    with pytest.raises(InputError, match="without a place"):
        parse_file(kml(shape), "a.kml", 1.0)


@pytest.mark.parametrize(("step", "message"), [(1e-300, "no two recorded places"), (1e-9, "no two recorded places")])
def test_places_closer_than_anything_flies_are_left_out(step: float, message: str) -> None:
    head = "time_s,latitude_deg,longitude_deg,height_m\n"
    with pytest.raises(InputError, match=message):
        parse_file((head + "".join(f"{k * step},{1 + k * 1e-6},2,100\n" for k in range(30))).encode(), "a.csv")
    rows = [(k + off, 1 + 1e-4 * k) for k in range(30) for off in (0.0, step)]
    file = parse_file((head + "".join(f"{t!r},{north},2,100\n" for t, north in rows)).encode(), "a.csv")
    assert file.flight is not None
    assert file.flight.duration == 29.0


@pytest.mark.parametrize("row", ["{0}e300,1,2,100\n", "{0},1.{0},2,{0}e300\n"])
def test_times_and_heights_beyond_any_flight_are_refused(row: str) -> None:
    rows = "".join(map(row.format, range(1, 30)))
    with pytest.raises(InputError, match="times or heights beyond those of any flight"):
        parse_file(f"time_s,latitude_deg,longitude_deg,height_m\n{rows}".encode(), "a.csv")


def test_what_a_plan_holds_beside_waypoints_is_listed_in_short() -> None:
    items = [item(16, 47 + k, 8, 120) for k in range(2)] + [item(1000 + k, 0, 0, 0) for k in range(3000)]
    assert len(parse_file(plan(*items), "a.plan", ground=1.0).note) < 1000


def kmz_of_two_names() -> bytes:
    """An archive whose list calls its long-named file by another name than the file's own head."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("n" * 5000 + ".kml", b"<kml/>")
    whole = packed.getvalue()
    at = whole.index(b"PK\x01\x02") + 46
    return whole[:at] + b"m" + whole[at + 1 :]


@pytest.mark.parametrize(
    ("content", "begins"),
    [
        (b"<?xml version='1.0' encoding='" + b"e" * 700 + b"'?><kml/>", "a.kml: is not XML: unknown encoding: eee"),
        (
            b"<?xml version='1.0' encoding='" + b"e" * 60_000 + b"'?><kml/>",
            "a.kml: is not XML: unknown encoding: eee",
        ),
        (kmz_of_two_names(), "a.kml: is a ZIP archive that cannot be read: File name in directory"),
        (
            b'{"mission":{"items":[{"command":16,"frame":' + b"3" * 300 + b',"params":[0,0,0,0,0,0,0]}]}}',
            "a.kml: item 1: frame 333",
        ),
    ],
)
def test_what_a_file_makes_others_say_is_told_in_short(content: bytes, begins: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_file(content, "a.kml")
    assert str(refused.value).startswith(begins)
    assert len(str(refused.value)) < 240


def gpx_segments(count: int) -> bytes:
    """Recordings of two places ten seconds apart."""
    place = "<trkpt lat='1' lon='{0}'><ele>1</ele><time>2026-05-01T08:00:{0}Z</time></trkpt>"
    return (
        f"<gpx><trk>{('<trkseg>' + place.format(10) + place.format(20) + '</trkseg>') * count}</trk></gpx>".encode()
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (kml("<Placemark>" * 30 + path() + "</Placemark>" * 30), "placemark within a placemark"),
        (b"<kml>" + b"<a>" * 190_000 + b"</a>" * 190_000 + b"</kml>", "nested more than 40 deep"),
        (b"<kml>" + b"<LineString>" * 41 + b"</LineString>" * 41 + b"</kml>", "nested more than 40 deep"),
        (b'<kml xmlns="' + b"x" * 201 + b'"><a/></kml>', "namespace of more than 200 characters"),
        (b'<kml><a xmlns:b="' + b"x" * 201 + b'"/></kml>', "namespace of more than 200 characters"),
        (kml("<Point/>" * 15_000), "a point without a place"),
        (kml("<Point/>" * 150_000), "more than 20000 paths and points"),
        (kml("<LineString>" * 30 + "<a/>" * 380_000 + "</LineString>" * 30), "a path without a place"),
        (
            b"<kml>"
            + b"<Folder>" * 37
            + b"<actionGroup/>" * 300_000
            + b"<executeHeight/>"
            + b"</Folder>" * 37
            + b"</kml>",
            "a DJI mission without a place",
        ),
        (
            b"<gpx><trk>"
            + b"<trkseg><trkpt lat='1' lon='1'><ele>1</ele></trkpt></trkseg>" * 15_000
            + b"</trk></gpx>",
            "than 2000 points",
        ),
        (gpx_segments(20_000), "more than 500 segments"),
        (b"<kml>" + b"<a/>" * 500_000, "more than 400000 tags"),
        (b"<kml>" + b" " * 5_000_000 + b"</kml>", "more than 5 MB of XML"),
        (kml(f"<LineString><coordinates>{'8,47,1 ' * 600_000}</coordinates></LineString>"), "more than 2000 points"),
        (b"<gpx>" + b"<wpt lat='1' lon='1'><ele>1</ele></wpt>" * 15_000 + b"</gpx>", "more than 2000 points"),
        (b"QGC WPL 110\n" + b"1 0 0 16 0 0 0 0 47 8 120 1\n" * 150_000, "more than 2000 points"),
        (plan(*[item(16, 47, 8, 120)] * 3000), "more than 2000 points"),
        (b'{"a": ' + b"[" * 100_000, "is JSON that cannot be read"),
        (b"PK\x01\x02" * 3000, "more than 2000 files"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><kml>&b;</kml>', "declares entities"),
    ],
    ids=range(20),
)
@pytest.mark.long
def test_a_file_without_bounds_is_refused_while_it_is_read(content: bytes, message: str) -> None:
    if not content.startswith((b"{", b"<kml><", b"PK")):
        content = content.replace(b"<LineString>", b"<LineString><altitudeMode>absolute</altitudeMode>")
    tracemalloc.start()
    with pytest.raises(InputError, match=message):
        parse_file(content, "a.kml")
    assert tracemalloc.get_traced_memory()[1] < 250_000_000
    tracemalloc.stop()


# --- what was brought ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "given", "count", "height", "message"),
    [
        ("20_drawn_path_height_0.kml", {"height": 3000.0}, 6, 3000.0, "without a height are at 3000 m"),
        ("24_relative_to_ground.kml", {"ground": 430.0}, 6, 550.0, "ground, which is at 430 m"),
        ("25_area_home_path.kml", {}, 6, 3000.0, "not used: 1 point, 1 area"),
        ("27_gap_between_segments.gpx", {}, 0, 3000.0, "1 pause cut"),
        ("28_recorded_1hz.gpx", {}, 0, 1500.0, "attitude from coordinated turns"),
        ("29_mission.plan", {}, 6, 550.0, "heights above home"),
        ("30_path.kmz", {}, 6, 3000.0, "doc.kml"),
        ("50b_rtk_dms.pos", {}, 0, 1200.0, "301 recorded rows"),
        ("53_gis_waypoints.csv", {}, 6, 630.0, "6 waypoints of ycoord, xcoord, Alt. ASL [m]"),
        ("57_gins_result.nav", {"columns": NAMED}, 0, 1200.0, "301 recorded rows"),
        ("76_single_among_fixed.pos", {}, 0, 1200.0, "rows with Q 1 alone; those with 5 left out"),
        ("31_drone_record.csv", {}, 0, 550.0, "OSD.altitude [ft]"),
    ],
)
def test_files_that_people_brought_are_flown(
    name: str, given: dict[str, Any], count: int, height: float, message: str
) -> None:
    if not BROUGHT.is_dir():
        pytest.skip("the shared files are not here")
    content = (BROUGHT / name).read_bytes()
    file = parse_file(content, name, **given)
    assert len(file.waypoints) == count
    assert message in file.note
    flight = file.flown(LIKE)
    assert np.mean(states(flight)[:, 3]) == pytest.approx(height, abs=2.0)
    assert all(a.stop <= b.start for a, b in pairwise(flight.lines))

"""Tables of flights as receivers, avionics, radios, planners and autopilots write them: one flight in all of them."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.trajectory.files.reader import FlightFile, parse_file
from nav_model.trajectory.waypoints import Plan

COUNT, HEIGHT = 61, 1200.0


class Fix(NamedTuple):
    """One second of a flight to the north-west, south of the equator and west of Greenwich."""

    second: int
    latitude: float
    longitude: float


FIXES = [Fix(k, -27.51 + 0.0004 * k, -8.21 - 0.0003 * k) for k in range(COUNT)]


def clock(fix: Fix) -> str:
    return f"10:{fix.second // 60:02}:{fix.second % 60:02}"


def dms(angle: float, apart: str = " ") -> str:
    total = round(abs(angle) * 3600, 5)
    sign = "-" if angle < 0 else ""
    return apart.join((f"{sign}{int(total // 3600):02}", f"{int(total % 3600 // 60):02}", f"{total % 60:08.5f}"))


def letters(angle: float, positive: str, negative: str) -> str:
    degrees, minutes, seconds = dms(abs(angle)).split()
    return f"{degrees}°{minutes}'{seconds}\"{positive if angle > 0 else negative}"


def table(head: str, row: Callable[[Fix], str]) -> bytes:
    return "\n".join([head, *map(row, FIXES), ""]).encode()


def ecef(fix: Fix) -> list[str]:
    """WGS 84's own formula, from its axes."""
    north, east, a, b = math.radians(fix.latitude), math.radians(fix.longitude), 6378137.0, 6356752.314245
    prime = a**2 / math.hypot(a * math.cos(north), b * math.sin(north))
    level = (prime + HEIGHT) * math.cos(north)
    up = (prime * (b / a) ** 2 + HEIGHT) * math.sin(north)
    return [f"{x:.4f}" for x in (level * math.cos(east), level * math.sin(east), up)]


AVIONICS = (
    '#airframe_info, log_version="1.00", airframe_name="Test"\n'
    "#yyy-mm-dd, hh:mm:ss,   hh:mm,  ident,      degrees,    degrees, ft Baro,  ft msl, kt, deg, deg, enum,  ft wgs\n"
    "  Lcl Date, Lcl Time, UTCOfst, AtvWpt,     Latitude,    Longitude,    AltB,  AltMSL, IAS, HDG, TRK, HSIS, AltGPS"
)
DUMP = (
    "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    "FMT, 131, 31, POS, QLLfff, TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt\n"
    "FMT, 130, 53, GPS, QBBIHBcLLeffffB, TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U\n"
    "PARM, 91200000, SCHED_LOOP_RATE, 400, 0"
)
FILES: dict[str, bytes] = {
    "degrees, minutes, seconds in three fields": table(
        "%  GPST   latitude(d'\")   longitude(d'\")  height(m)   Q  ns",
        lambda f: f"2026/05/04 {clock(f)}.000  {dms(f.latitude)}  {dms(f.longitude)}  {HEIGHT}  1  14",
    ),
    "three fields named D M S": table(
        "% UTC  Latitude (D,M,S)  Longitude (D,M,S)  Height(m)",
        lambda f: f"2026/05/04 {clock(f)}.000  {dms(f.latitude)}  {dms(f.longitude)}  {HEIGHT}",
    ),
    "degrees, minutes, seconds with letters": table(
        "time_s;Latitude (dms);Longitude (dms);height_m",
        lambda f: f"{f.second};{letters(f.latitude, 'N', 'S')};{letters(f.longitude, 'E', 'W')};{HEIGHT}",
    ),
    "degrees, minutes, seconds with colons": table(
        "time_s,latitude,longitude,height_m",
        lambda f: f"{f.second},{dms(f.latitude, ':')},{dms(f.longitude, ':')},{HEIGHT}",
    ),
    "degrees and minutes behind a letter": table(
        "time_s\tLat\tLon\theight_m",
        lambda f: f"{f.second}\tS27 {-60 * (f.latitude + 27):.6f}\tW8 {-60 * (f.longitude + 8):.6f}\t{HEIGHT}",
    ),
    "from the Earth's centre, between blanks": table(
        "%  GPST    x-ecef(m)   y-ecef(m)   z-ecef(m)   Q",
        lambda f: f"2026/05/04 {clock(f)}.000  {'  '.join(ecef(f))}  1",
    ),
    "from the Earth's centre, in brackets": table(
        "Time [s],X-ECEF [m],Y-ECEF [m],Z-ECEF [m]", lambda f: f"{f.second},{','.join(ecef(f))}"
    ),
    "from the Earth's centre, with a prefix": table(
        "tow_s;pos_ecef_x_m;pos_ecef_y_m;pos_ecef_z_m", lambda f: f"{f.second};{';'.join(ecef(f))}"
    ),
    "avionics, units above the names": table(
        AVIONICS,
        lambda f: (
            f"2026-05-04, {clock(f)}, +00:00, WPT1, {f.latitude:.7f}, {f.longitude:.7f}, 3900.0, 3900.0, 117, 12, "
            f"13, GPS, {HEIGHT / 0.3048:.2f}"
        ),
    ),
    "units below the names": table(
        "time,lat,lon,alt,speed\ns,deg,deg,ft,kt",
        lambda f: f"{f.second},{f.latitude:.7f},{f.longitude:.7f},{HEIGHT / 0.3048:.3f},117",
    ),
    "a radio's places in one field": table(
        "Date,Time,GPS,GSpd(kmh),Hdg(@),Alt(m),RSSI(dB)",
        lambda f: f"2026-05-04,{clock(f)}.000,{f.latitude:.6f} {f.longitude:.6f},210,312,{HEIGHT},78",
    ),
    "a radio without a place at first": table(
        "Date,Time,GPS,Alt(m)\n2026-05-04,09:59:58.000,,0\n2026-05-04,09:59:59.000,,0",
        lambda f: f"2026-05-04,{clock(f)}.000,{f.latitude:.6f} {f.longitude:.6f},{HEIGHT}",
    ),
    "places in one quoted field": table(
        "time_s,lat lon,height_m", lambda f: f'{f.second},"{f.latitude:.6f}, {f.longitude:.6f}",{HEIGHT}'
    ),
    "a heading in a unit that nobody knows": table(
        "time_s;lat;lon;height_m;roll;pitch;heading [compass points]",
        lambda f: f"{f.second};{f.latitude:.7f};{f.longitude:.7f};{HEIGHT};0;0;28",
    ),
    "text beside": table(
        "time_s,latitude,longitude,height_m,mode", lambda f: f"{f.second},{f.latitude},{f.longitude},{HEIGHT},auto"
    ),
    "dump with places": table(
        DUMP,
        lambda f: (
            f"POS, {91_000_000 + 1_000_000 * f.second}, {f.latitude:.7f}, {f.longitude:.7f}, {HEIGHT}, 5, 5\n"
            f"ATT, {91_000_000 + 1_000_000 * f.second}, 0.1, 0.2, 0.0, 0.3, 12.0, 11.9"
        ),
    ),
    "dump with fixes": table(
        DUMP,
        lambda f: (
            f"GPS, {91_000_000 + 1_000_000 * f.second}, 0, 6, {1000 * f.second}, 2417, 14, 0.6, {f.latitude:.7f}, "
            f"{f.longitude:.7f}, {HEIGHT}, 60, 300, 0, 0, 1"
        ),
    ),
    "a few rows of another quality": table(
        "time_s,latitude,longitude,height_m,fix type",
        lambda f: f"{f.second},{f.latitude + 5e-4 * (20 < f.second < 25)},{f.longitude},{HEIGHT},"
        + ("SINGLE" if 20 < f.second < 25 else "FIX"),
    ),
}  # fmt: skip
NOTES = {
    "from the Earth's centre, between blanks": "Earth's centre (ECEF)",
    "a radio's places in one field": "GPS taken as latitude, longitude; column Hdg(@)",
    "a heading in a unit that nobody knows": "column heading [compass points]: 'compass points' is not a unit",
    "dump with places": "61 POS messages of",
    "a few rows of another quality": "rows with fix type FIX alone; those with SINGLE left out",
}


def ends(file: FlightFile) -> Iterator[tuple[float, float, float]]:
    assert file.flight is not None
    samples = np.frombuffer(file.flight.trajectory.samples).reshape(-1, 7)
    for sample in samples[[0, len(samples) // 2, -1]]:
        yield math.degrees(sample[1]), math.degrees(sample[2]), sample[3]


@pytest.mark.parametrize("name", FILES)
def test_a_flight_is_the_same_in_every_table(name: str) -> None:
    file = parse_file(FILES[name], "a.txt")
    assert file.flight is not None
    assert file.flight.duration == pytest.approx(COUNT - 1)
    for (north, east, up), k in zip(ends(file), (0, (COUNT - 1) // 2, COUNT - 1), strict=True):
        assert north == pytest.approx(FIXES[k].latitude, abs=4e-6)
        assert east == pytest.approx(FIXES[k].longitude, abs=4e-6)
        assert up == pytest.approx(HEIGHT, abs=0.05)
    for part in NOTES.get(name, "").split("; "):
        assert part in file.note


def test_the_sign_of_no_degrees_counts() -> None:
    head = "%  GPST   latitude(d'\")   longitude(d'\")  height(m)"
    rows = [f"2026/05/04 10:00:{k:02}  -00 30 {k:02}.0  -00 12 {k:02}.0  900" for k in range(40)]
    file = parse_file("\n".join([head, *rows]).encode(), "a.pos")
    assert next(ends(file)) == pytest.approx((-0.5, -0.2, 900.0), abs=1e-5)


@pytest.mark.parametrize("mark", [" ", ",", "\t"])
def test_a_table_without_names_takes_them_as_given_or_asks(mark: str) -> None:
    rows = "\n".join(mark.join(map(str, (2417, f.second, f.latitude, f.longitude, HEIGHT))) for f in FIXES).encode()
    with pytest.raises(InputError, match=r"has no names of its 5 columns; its first row is '2417.*give --columns"):
        parse_file(rows, "a.nav")
    with pytest.raises(InputError, match="4 column names are given, but the file has 5"):
        parse_file(rows, "a.nav", columns=["time", "latitude", "longitude", "height"])
    file = parse_file(rows, "a.nav", columns=["-", "time_s", "latitude", "longitude", "height_m"])
    assert next(ends(file)) == pytest.approx((FIXES[0].latitude, FIXES[0].longitude, HEIGHT), abs=1e-5)


PLANNED = [(8.6, 47.2), (8.6, 47.25), (8.612, 47.25), (8.612, 47.2)]


@pytest.mark.parametrize(
    ("head", "row", "given", "height"),
    [
        ("Waypoint Number,X [m],Y [m],Alt. ASL [m],xcoord,ycoord", "{k},1,2,630,{0},{1}", {}, 630.0),
        ("wp;latitude;longitude;alt agl (ft)", "{k};{1};{0};300", {"ground": 400.0}, 400.0 + 300 * 0.3048),
        ("WAYPOINT,LAT,LON", "{k},{1},{0}", {"height": 500.0}, 500.0),
    ],
)
def test_a_table_of_waypoints_is_a_plan(head: str, row: str, given: dict[str, float], height: float) -> None:
    text = "\n".join([head, *(row.format(*place, k=k) for k, place in enumerate(PLANNED, 1))])
    file = parse_file(text.encode(), "a.csv", **given)
    assert [(math.degrees(p.longitude), math.degrees(p.latitude)) for p in file.waypoints] == [
        pytest.approx(place) for place in PLANNED
    ]
    assert [point.line for point in file.waypoints] == ["line 1", "", "line 2", ""]
    assert [point.height for point in file.waypoints] == pytest.approx([height] * 4)
    assert file.flown(Plan((), 60.0)).duration > 2 * 5550 / 60


@pytest.mark.parametrize(
    ("head", "row", "message"),
    [
        ("time_s,east_m,north_m,up_m", "{k},{k},{k},9", "need their origin"),
        ("latitude,longitude,height_m", "47.{k},8,9", "Name a column waypoint if these are places to be flown"),
        ("point [unit],latitude [bananas],longitude", "{k},47.{k},8", "'bananas' is not a unit of angle"),
        ("2026-05-04 10:00:00.00: GPS {{TimeUS : {k}}}", "", "is a text dump of a flight log"),
        (DUMP, "ATT, {k}, 0.1, 0.2, 0.0, 0.3, 12.0", "without POS or GPS or AHR2 messages; it has ATT"),
        ("Model;ARW [deg/sqrt(hr)]", "{k};0.15", "latitude and longitude are missing"),
    ],
)
def test_what_is_no_flight_is_told_what_to_do(head: str, row: str, message: str) -> None:
    text = "\n".join([head.format(k=1) if "{{" in head else head, *(row.format(k=k) for k in range(10, 40))])
    with pytest.raises(InputError, match=message):
        parse_file(text.encode(), "a.csv")

"""Solutions from real files of post-processors: values that others read from them, and motion that agrees."""

from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.files.reader import read_solution
from nav_model.flown.solution import Solution

DATA = Path(__file__).parents[4] / "shared/data"
SBET, PDAL = DATA / "flight/sbet/leeward_sbet_rec0-99.out", DATA / "flight/sbet/pdal_2-points.sbet"
SMRMSG = DATA / "flight/sbet/smrmsg_pdal_rec0-10950.out"
POS = DATA / "flight/rtklib/demo5_b34f_f.pos"
real = pytest.mark.skipif(not DATA.exists(), reason="../shared/data (real flights) is absent")


UAV = DATA / "flight/uav_nav/InertialNav_InputFilesPX4_search.zip"


def moved(solution: Solution) -> np.ndarray:
    """Velocity north, east, down of the places alone."""
    place = solution.place
    scale = np.column_stack([*metres_per_radian(place[:-1, 0], place[:-1, 2]), -np.ones(len(place) - 1)])
    return np.diff(place, axis=0) * scale / np.diff(solution.time_s)[:, None]


def sbet(rows: int = 400, **columns: np.ndarray | float) -> np.ndarray:
    """An SBET of a flight at 60 m/s to the north-east, level, 200 Hz, with wander zero."""
    records = np.zeros((rows, 17))
    records[:, 0] = 400_000.0 + 0.005 * np.arange(rows)
    north, east = metres_per_radian(0.82, 1000.0)
    way = 60.0 * np.sqrt(0.5) * 0.005 * np.arange(rows)
    records[:, 1:4] = np.column_stack([0.82 + way / north, 0.15 + way / east, np.full(rows, 1000.0)])
    records[:, 4], records[:, 5], records[:, 9] = 60.0 * np.sqrt(0.5), -60.0 * np.sqrt(0.5), np.pi / 4
    for name, value in columns.items():
        records[:, int(name[1:])] = value
    return records


@real
def test_velocities_of_an_sbet_are_those_of_its_places() -> None:
    flight = read_solution(SBET)
    assert (flight.format, flight.kind, flight.clock, len(flight.time_s)) == (
        "sbet", "post-processed", "gps week seconds", 100,
    )  # fmt: skip
    assert flight.rate_hz == pytest.approx(200.0, abs=0.01)
    assert flight.velocity is not None
    middle = 0.5 * (flight.velocity[1:] + flight.velocity[:-1])
    assert np.abs((middle - moved(flight)).mean(axis=0)).max() < 0.02  # of 110 m/s; places are to 1e-9 of a radian
    assert np.linalg.norm(middle, axis=1).mean() == pytest.approx(110.0, abs=1.0)


@real
def test_two_records_have_the_values_that_pdal_expects() -> None:
    two = read_solution(PDAL)
    assert two.time_s == pytest.approx([151631.0028360710, 151631.0078318641], abs=1e-9)
    assert two.place[:, 0] == pytest.approx([0.5680211852972264, 0.5680211834722869], abs=1e-15)
    assert two.attitude is not None
    assert two.velocity is not None
    assert two.attitude[0, 0] == pytest.approx(-0.02813407149321339, abs=1e-15)
    # Turned by the wander angle by complex numbers, x to the north, y to the west.
    rotated = complex(-2.332420866600025, -0.3335067504871401) * np.exp(-0.02198414736922658j)
    assert two.velocity[0] == pytest.approx([rotated.real, -rotated.imag, 0.03093961631767838], abs=1e-12)
    assert "no flight" in two.notes[0]


@real
def test_accuracies_come_to_the_times_of_the_sbet_from_arc_minutes() -> None:
    printed = np.loadtxt(SMRMSG.with_suffix(".txt"), skiprows=1, delimiter=",", max_rows=20)
    records = sbet(rows=2001)
    records[:, 0] = printed[0, 0] + 0.005 * np.arange(2001)
    for order in ((records.tobytes(), SMRMSG), (SMRMSG, records.tobytes())):
        flight = read_solution(order[0], [order[1]])
        assert flight.claims is not None
        claims = [flight.claims.position, flight.claims.velocity, np.degrees(flight.claims.attitude) * 60.0]
        assert np.hstack(claims)[::200] == pytest.approx(printed[:11, 1:], abs=1e-6)
        assert (flight.claims.kind, flight.smoothing) == ("sigma", "combined")
    with pytest.raises(InputError, match=r"solution: has no time in common with smrmsg_pdal.*of one flight"):
        read_solution(sbet().tobytes(), [SMRMSG])
    with pytest.raises(InputError, match="is smrmsg, the accuracies that belong to an SBET"):
        read_solution(SMRMSG)
    with pytest.raises(InputError, match="does not belong to"):
        read_solution(SBET, [POS])
    live = np.zeros((20, 10))
    live[:, 0], live[:, 1:7], live[:, 7:] = 399_999.0 + np.arange(20), 0.05, 0.02
    claims = read_solution(sbet().tobytes(), [live.tobytes() + b"cut off"]).claims
    assert claims is not None
    assert np.degrees(claims.attitude) == pytest.approx(0.02)


@real
def test_a_solution_of_rtklib_has_its_fixes_and_sigmas() -> None:
    flight = read_solution(POS)
    lines = [line.split() for line in POS.read_text().splitlines() if line[0] != "%"]
    assert (flight.format, flight.kind, flight.clock, flight.smoothing) == (
        "rtklib",
        "post-processed",
        "gps",
        "forward",
    )
    # The header has the week and the seconds of the first and the last epoch.
    assert flight.time_s[[0, -1]] == pytest.approx([2137 * 604800 + 422922.0, 2137 * 604800 + 427442.0], abs=1e-6)
    degrees = np.degrees(flight.place[:, :2])
    assert np.abs(degrees - [[float(line[2]), float(line[3])] for line in lines]).max() < 1e-12
    assert flight.claims is not None
    assert flight.claims.position == pytest.approx(np.array([[float(x) for x in line[7:10]] for line in lines]))
    assert flight.fix is not None
    assert [flight.fix_names[code] for code in flight.fix] == [{"1": "fixed", "2": "float"}[x[5]] for x in lines]


@real
def test_columns_without_names_are_those_that_are_given() -> None:
    with ZipFile(UAV) as archive:
        raw, onboard = (archive.read(f"{name}.txt") for name in ("GPSraw", "GPOSonboard"))
    names = ["time_ms", "latitude", "longitude", "height_m", "vn", "ve", "vd"]
    fixes, flown = (read_solution(content, columns=names) for content in (raw, onboard))
    assert (fixes.rate_hz, flown.rate_hz) == (pytest.approx(5.0, abs=0.5), pytest.approx(50.0, abs=5.0))
    assert fixes.velocity is not None
    # Places in steps of 1e-6 of a degree (0.1 m) every 0.2 s, so over a second.
    place, time = fixes.place, fixes.time_s
    north, east = metres_per_radian(place[0, 0], place[0, 2])
    over = np.column_stack([(place[5:, 0] - place[:-5, 0]) * north, (place[5:, 1] - place[:-5, 1]) * east])
    over /= (time[5:] - time[:-5])[:, None]
    mean = np.column_stack([np.convolve(v, np.ones(5) / 5.0, "valid")[1:] for v in fixes.velocity[:, :2].T])
    assert min(np.corrcoef(over[:, k], mean[:, k])[0, 1] for k in (0, 1)) > 0.99
    # The fixes are 40 ms before the autopilot's clock; then half a metre is between the two.
    at = time - time[0] + 0.040
    between = [np.interp(at, flown.time_s - flown.time_s[0], flown.place[:, k]) for k in (0, 1)]
    spread = np.std((place[:, :2].T - between) * [[north], [east]], axis=1)
    assert spread == pytest.approx([0.5, 0.5], abs=0.15)


@real
def test_a_recorded_track_and_a_dump_of_messages_are_solutions() -> None:
    track = read_solution(DATA / "brought/28_recorded_1hz.gpx")
    assert (track.format, track.clock, track.rate_hz) == ("gpx", "utc", pytest.approx(1.0))
    assert track.time_s[0] > 1e9
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    head += "FMT, 7, 9, POS, QLLff, TimeUS,Lat,Lng,Alt,RelHomeAlt\n"
    lines = [f"POS, {1000000 + 100000 * k}, 47.{1000 + k}, 8.5, 500.5, 10.0\nATT, 1, 2\n" for k in range(20)]
    dump = read_solution((head + "".join(lines)).encode())
    assert (dump.format, dump.rate_hz, dump.duration_s) == ("table", pytest.approx(10.0), pytest.approx(1.9))
    with pytest.raises(InputError, match="places without times, which are a plan"):
        read_solution(DATA / "brought/24_relative_to_ground.kml", heights=(None, 400.0))


def test_longitudes_go_on_over_greenwich_and_over_the_date_line() -> None:
    """Of the first place they are within half a turn, so that a flight along them is one on the Earth."""
    for east in (359.99, 179.99, 200.0):
        longitude = (east + 1e-3 * np.arange(40.0)) % 360.0
        rows = "\n".join(f"{n},46.0,{degrees:.6f},900" for n, degrees in enumerate(longitude))
        place = read_solution(f"time [s],latitude [deg],longitude [deg],height [m]\n{rows}\n".encode()).place
        first = (east + 180.0) % 360.0 - 180.0
        assert np.degrees(place[:, 1]) == pytest.approx(first + 1e-3 * np.arange(40.0), abs=1e-6)

"""Logs of receivers and autopilots: lines of public documents and real logs, and checksums worked out bit by bit."""

import math
import sys
from functools import reduce
from operator import xor
from pathlib import Path

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.flown.files.reader import read_solution
from nav_model.trajectory.files.reader import parse_file, read_file

DATA = Path(__file__).parents[4] / "shared/data"
real = pytest.mark.skipif(not DATA.exists(), reason="../shared/data (real flights) is absent")
WEEK = 604_800


def novatel(head: str, body: str) -> str:
    """A line with its CRC-32, by the loop over bits of the receiver's manual."""
    text, crc = f"{head};{body}", 0
    for byte in text.encode():
        part = (crc ^ byte) & 0xFF
        for _ in range(8):
            part = (part >> 1) ^ (0xEDB88320 if part & 1 else 0)
        crc = (crc >> 8) ^ part
    return f"#{text}*{crc:08x}\r\n"


def nmea(text: str) -> str:
    return f"${text}*{reduce(xor, text.encode()):02X}\r\n"


def inspvax(second: float, status: str = "INS_SOLUTION_GOOD", kind: str = "INS_RTKFIXED") -> str:
    north = 47.0 + 1e-5 * second
    body = f"{status},{kind},{north:.11f},8.5,1000.0,48.5,11.1,0.2,0.3,1.0,2.0,-1.0,1,2,3,.1,.2,.3,.01,.02,.03,0,0"
    return novatel(f"INSPVAXA,COM1,0,50.0,FINESTEERING,2300,{second:.3f},02000000,9dc5,1", body)


@real
def test_lines_of_a_receiver_count_by_their_checksum() -> None:
    lines = DATA / "flight/novatel/inspvaxa_2good_1badcrc.txt"
    two = read_solution(lines)
    assert (two.format, two.kind, two.clock) == ("novatel", "real-time", "gps")
    assert two.time_s.tolist() == [1695 * WEEK + 309428.0, 2107 * WEEK + 35489.0]
    assert np.degrees(two.place[:, :2]) % 360.0 == pytest.approx(
        np.array([[51.11637873403, 360.0 - 114.03825114994], [28.23316396165, 112.87713086609]]), abs=1e-11
    )
    assert two.place[:, 2] == pytest.approx([1063.6093 - 16.9000, 82.7966 - 17.0382])  # above the sea and undulation
    assert two.velocity is not None
    assert two.velocity[0] == pytest.approx([-0.0845, -0.0464, 0.0127])  # up in the file
    assert two.attitude is not None
    assert np.degrees(two.attitude[0]) == pytest.approx([0.138023492, 0.069459386, 90.000923268])
    assert two.claims is not None
    assert two.claims.position is not None
    assert two.claims.position[0] == pytest.approx([0.9428, 0.6688, 1.4746])
    assert np.degrees(two.claims.attitude)[0] == pytest.approx([0.944295466, 0.944567084, 1.000131845])
    assert two.fix is not None
    assert [two.fix_names[code] for code in two.fix] == ["single", "fixed"]
    assert "1 line with a wrong checksum" in two.notes[0]


def test_sigmas_of_a_receiver_count_from_the_good_solution_on() -> None:
    early = inspvax(99.0, "INS_ALIGNING") + inspvax(100.0, "INS_ALIGNMENT_COMPLETE") + inspvax(101.0)
    flight = read_solution((early + inspvax(102.0, "INS_SOLUTION_FREE", "INS_PSRSP")).encode())
    assert flight.time_s.tolist() == [2300 * WEEK + s for s in (100.0, 101.0, 102.0)]
    assert flight.claims is not None
    assert flight.claims.velocity is not None
    assert flight.claims.velocity == pytest.approx(
        np.array([[np.nan] * 3, [0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]), nan_ok=True
    )
    never = read_solution((inspvax(100.0, "INS_HIGH_VARIANCE") + inspvax(101.0, "INS_HIGH_VARIANCE")).encode())
    assert never.claims is None
    with pytest.raises(InputError, match="holds 1 INSPVAX message, none of an INS that is aligned"):
        read_solution(inspvax(99.0, "INS_ALIGNING").encode())
    # Fast INSPVA beside slow INSPVAX: heights above the ellipsoid, sigmas between those of INSPVAX.
    fast = "".join(
        novatel(
            f"INSPVAA,COM1,0,50.0,FINESTEERING,2300,{t:.3f},02000000,9dc5,1",
            f"2300,{t:.3f},{47.0 + 1e-5 * t:.11f},8.5,1048.5,11.1,0.2,0.3,1.0,2.0,359.0,INS_SOLUTION_GOOD",
        )
        for t in np.arange(101.0, 102.01, 0.1)
    )
    both = read_solution((fast + inspvax(101.0) + inspvax(102.0)).encode())
    assert len(both.time_s) == 11
    assert both.place[:, 2] == pytest.approx(1048.5)
    assert both.claims is not None
    assert both.claims.position is not None
    assert both.claims.position[5] == pytest.approx([1.0, 2.0, 3.0])


def test_a_velocity_of_a_receiver_is_older_than_its_stamp() -> None:
    # A line of the maker's own tests, with its checksum; then a turn at 0.1 rad/s, with velocities 0.25 s late.
    maker = (
        "#BESTPOSA,COM1,0,83.5,FINESTEERING,2163,329760.000,02400000,b1f6,65535;SOL_COMPUTED,SINGLE,51.15043874397,"
        '-114.03066788586,1097.6822,-17.0000,WGS84,1.3648,1.1806,3.1112,"",0.000,0.000,18,18,18,0,00,02,11,01*c3194e35\r\n'
    )
    text = maker
    for k in range(1, 100):
        t = 329760.0 + 0.1 * k
        body = f'SOL_COMPUTED,NARROW_INT,{51.15 + 1e-6 * k:.9f},-114.03,1097.7,-17.0,WGS84,.01,.02,.03,"",0,0,18'
        text += novatel(f"BESTPOSA,COM1,0,83.5,FINESTEERING,2163,{t:.3f},02400000,b1f6,65535", body)
        course = math.degrees(0.1 * (t - 329760.25))
        body = f"SOL_COMPUTED,NARROW_INT,0.250,0.000,10.0,{course % 360.0:.6f},0.5,0.0"
        text += novatel(f"BESTVELA,COM1,0,61.0,FINESTEERING,2163,{t:.3f},00000000,827b,1984", body)
    flight = read_solution(text.encode())
    assert flight.velocity is not None
    angle = 0.1 * (flight.time_s - 2163 * WEEK - 329760.0)
    expected = np.column_stack([10.0 * np.cos(angle), 10.0 * np.sin(angle), np.full(len(angle), -0.5)])
    assert np.abs(flight.velocity - expected).max() < 1e-3
    assert set(flight.fix_names) == {"single", "fixed"}
    assert flight.place[0, 2] == pytest.approx(1097.6822 - 17.0)


def test_sentences_have_the_geoid_the_date_and_the_sigmas_of_their_time() -> None:
    # Sentences of two well-known descriptions of NMEA, with their checksums.
    known = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\n"
    dated = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\n"
    second = nmea("GPGGA,123520,4807.138,N,01131.000,E,4,08,0.9,545.4,M,46.9,M,,")
    sigmas = nmea("GPGST,123520,0.006,0.023,0.020,273.6,0.023,0.020,0.031")
    late = nmea("GPGST,123521,0.006,0.5,0.5,273.6,0.5,0.5,0.5")
    unfixed = nmea("GPGGA,123518,,,,,0,00,,,M,,M,,")
    wrong = "$GPGGA,123522,4807.238,N,01131.000,E,4,08,0.9,545.4,M,46.9,M,,*00\n"
    flight = read_solution((unfixed + known + dated + second + sigmas + late + wrong).encode())
    assert (flight.format, flight.clock) == ("nmea", "utc")
    assert flight.time_s.tolist() == [764_426_119.0, 764_426_120.0]  # 1994-03-23 12:35:19 UTC
    assert np.degrees(flight.place[0]) == pytest.approx([48 + 7.038 / 60, 11 + 31 / 60, math.degrees(545.4 + 46.9)])
    assert flight.claims is not None
    assert flight.claims.position == pytest.approx(np.array([[np.nan] * 3, [0.023, 0.020, 0.031]]), nan_ok=True)
    assert flight.fix is not None
    assert [flight.fix_names[code] for code in flight.fix] == ["single", "fixed"]
    assert "1 sentence with a wrong checksum" in " ".join(flight.notes)
    assert "1 GGA sentence without a fix left out" in flight.notes
    night = [
        nmea(f"GNGGA,{t},4807.0{k},S,01131.000,W,1,08,0.9,545.4,M,46.9,M,,")
        for k, t in enumerate(("235959", "000000"))
    ]
    over = read_solution("".join(night).encode())
    assert over.clock == "day seconds"
    assert over.time_s.tolist() == [86_399.0, 86_400.0]
    assert (over.place[:, :2] < 0.0).all()
    with pytest.raises(InputError, match=r"holds no GGA sentence .*RMC alone has no heights"):
        read_solution(dated.encode())


@real
def test_logs_of_an_autopilot_that_hold_no_flight_are_told() -> None:
    pytest.importorskip("pyulog", reason="pyulog (the extra ulog) is not installed")
    with pytest.raises(InputError, match="holds no flight: no fix of a receiver"):
        read_solution(DATA / "flight/ulog/pyulog_sample.ulg")
    still = read_solution(DATA / "flight/ulog/pyulog_sample_log_small.ulg")
    assert "this is no flight" in still.notes[0]
    assert (still.format, still.clock, len(still.time_s)) == ("ulog", "utc", 32)
    assert still.rate_hz == pytest.approx(5.0, abs=0.01)
    assert np.degrees(still.place[0, :2]) == pytest.approx([63.4170622, 10.4082151], abs=1e-9)
    assert still.place[0, 2] == pytest.approx(106.766)
    assert still.velocity is not None
    assert still.velocity[0] == pytest.approx([0.047, -0.059, 0.242], abs=1e-6)
    content = (DATA / "flight/ulog/pyulog_sample_log_small.ulg").read_bytes()
    with pytest.raises(InputError, match=r"PX4 log \(ULog\)"):
        read_solution(content[:40])


def test_a_log_of_an_autopilot_names_the_extra_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(InputError, match=r"pyulog is needed. Install it: pip install navbudget\[ulog\]"):
        read_solution(b"ULog\x01\x12\x35\x01" + bytes(100))


def test_estimated_places_of_an_autopilot_lie_on_its_sphere() -> None:
    pytest.importorskip("pyulog", reason="pyulog (the extra ulog) is not installed")
    from nav_model.trajectory.files.heights import Heights
    from nav_model.trajectory.files.ulog import _estimated

    # Great circles of 30 km from the origin, by the haversine formula and the bearing of navigators.
    north, east = np.array([0.0, 30e3, 0.0, -20e3]), np.array([0.0, 0.0, 30e3, 20e3])
    one = np.ones(4)
    local = {
        "x": north,
        "y": east,
        "z": -100.0 * one,
        "ref_lat": 47.0 * one,
        "ref_lon": 8.0 * one,
        "ref_alt": 500.0 * one,
    }
    local |= {
        "vx": one,
        "vy": one,
        "vz": one,
        "timestamp": 1e6 * np.arange(4),
        "eph": math.sqrt(2.0) * one,
        "epv": one,
    }
    epochs = _estimated(local, {}, Heights("log"))
    lat, lon, up = epochs.place.T
    start = math.radians(47.0)
    turn = lon - math.radians(8.0)
    way = np.sin(0.5 * (lat - start)) ** 2 + math.cos(start) * np.cos(lat) * np.sin(0.5 * turn) ** 2
    assert 2.0 * 6_371_000.0 * np.arcsin(np.sqrt(way)) == pytest.approx(np.hypot(north, east), abs=1e-3)
    y, x = np.sin(turn) * np.cos(lat), math.cos(start) * np.sin(lat) - math.sin(start) * np.cos(lat) * np.cos(turn)
    assert np.arctan2(y, x)[1:] == pytest.approx(np.arctan2(east, north)[1:], abs=1e-9)
    assert up == pytest.approx(600.0)
    assert epochs.sigma_position == pytest.approx(1.0)


@real
def test_logs_of_a_receiver_are_flown() -> None:
    file = read_file(DATA / "brought/51_inspvaxa.txt")
    assert file.flight is not None
    assert file.flight.duration == pytest.approx(300.0, abs=0.5)
    assert "301 INSPVAX messages" in file.note
    places = [nmea(f"GPGGA,1200{k:02},{4700 + 0.03 * k:.4f},N,00830.000,E,4,9,1,900,M,48,M,,") for k in range(60)]
    places[30] = nmea("GPGGA,120030,4701.5,N,00830.000,E,1,9,1,900,M,48,M,,")
    track = parse_file("".join(places).encode(), "log.nmea")
    assert track.flight is not None
    assert track.flight.duration == pytest.approx(59.0, abs=0.1)
    assert "fixed fixes alone; those with single left out" in track.note
    first = np.frombuffer(track.flight.trajectory.samples).reshape(-1, 7)[0]
    assert first[3] == pytest.approx(948.0, abs=0.1)


@pytest.mark.parametrize("week", ["9" * 400, "9" * 5000, "nan", ""])
def test_a_week_that_is_no_number_of_weeks_is_left_out(week: str) -> None:
    line = novatel(f"BESTPOSA,COM1,0,50,FINE,{week},1,0,0,0", f"SOL_COMPUTED,SINGLE,46,7,100,1,W,1,1,1{',1' * 9}")
    with pytest.raises(InputError, match="holds no INSPVAXA, INSPVAA or BESTPOSA message with the right checksum"):
        read_solution((line * 3).encode(), name="a.txt")


def test_a_log_with_flags_of_a_later_format_is_refused() -> None:
    pytest.importorskip("pyulog", reason="pyulog (the extra ulog) is not installed")
    flags = bytes(8) + b"\x80" + bytes(31)
    with pytest.raises(InputError, match=r"a.ulg: is a PX4 log \(ULog\) that is damaged: 'Unknown incompatible flag"):
        read_solution(b"ULog\x01\x12\x35\x01" + bytes(8) + b"\x28\x00B" + flags, name="a.ulg")

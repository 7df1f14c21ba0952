"""Solutions in all forms that RTKLIB writes, and tables: places, frames and rotations by another program (pyins)."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest
from pyins.transform import lla_to_ecef, mat_en_from_ll

from nav_model.base.errors import InputError
from nav_model.flown.files.reader import read_solution
from nav_model.flown.solution import Solution

NOON = datetime(2024, 5, 18, 12, tzinfo=UTC)
STATED = "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)"
END = "Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"
DEGREES = f"latitude(deg) longitude(deg)  height(m)   {END}"
LLA = np.column_stack([47.0 + 1e-4 * np.arange(20), -0.5 + 2e-4 * np.arange(20), 500.0 + np.arange(20)])
SIGMAS = "1  14   0.0061   0.0052   0.0130  -0.0011   0.0007  -0.0020   0.00   23.4"


def pos(names: str, rows: list[str], *head: str) -> bytes:
    return "\n".join([*head, STATED, f"%  {names}", *rows, ""]).encode()


def clock(k: float) -> str:
    return f"2024/05/18 12:{int(k) // 60:02}:{k % 60:06.3f}"


def rows(numbers: np.ndarray, rest: str = SIGMAS, digits: int = 9) -> list[str]:
    return [
        f"{clock(k)}  " + "  ".join(f"{x:.{digits}f}" for x in row) + f"  {rest}" for k, row in enumerate(numbers)
    ]


def is_the_track(solution: Solution, tolerance: float = 1e-9) -> None:
    assert np.degrees(solution.place[:, :2]) == pytest.approx(LLA[:, :2], abs=tolerance)
    assert solution.place[:, 2] == pytest.approx(LLA[:, 2], abs=2e-4)


def test_clocks_of_the_header() -> None:
    gps = (NOON - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds()
    for name, system, start in (
        ("GPST", "gps", gps), ("UTC ", "utc", NOON.timestamp()), ("JST ", "utc", NOON.timestamp() - 9 * 3600),
    ):  # fmt: skip
        read = read_solution(pos(f"{name} {DEGREES}", rows(LLA)))
        assert (read.clock, read.time_s.tolist()) == (system, [start + k for k in range(20)])
        is_the_track(read)
    weeks, seconds = divmod(gps, 604_800.0)
    in_weeks = [f"{weeks:.0f} {seconds + k:.3f} " + line[23:] for k, line in enumerate(rows(LLA))]
    assert read_solution(pos(f"GPST {DEGREES}", in_weeks)).time_s[0] == gps
    assert read_solution(pos(f"UTC  {DEGREES}", in_weeks)).time_s[0] == NOON.timestamp()
    commas = [line.replace("  ", ",") for line in (" ".join(x.split()).replace(" ", "  ") for x in rows(LLA))]
    commas = [line.replace(",", " ", 1) for line in commas]  # date and time are one field
    read = read_solution(pos(",".join(f"GPST {DEGREES}".split()), commas))
    assert (read.time_s[0], read.time_s[-1]) == (gps, gps + 19.0)
    is_the_track(read)


def test_a_gap_over_midnight_is_a_gap() -> None:
    late = [f"2024/05/18 23:50:{k:02}.000  47.1 8.5 500.0 {SIGMAS}" for k in range(10)]
    early = [f"2024/05/19 00:20:{k:02}.000  47.1 8.5 500.0 {SIGMAS}" for k in range(10)]
    read = read_solution(pos(f"GPST {DEGREES}", late + early))
    assert len(read.time_s) == 20
    assert [stop - start for start, stop in read.gaps] == [pytest.approx(30 * 60 - 9)]


def test_degrees_minutes_and_seconds_beside_the_equator() -> None:
    def parts(degrees: float) -> str:
        whole = int(abs(degrees))
        minutes = int(60 * (abs(degrees) - whole))
        seconds = 3600 * (abs(degrees) - whole) - 60 * minutes
        return f"{'-' if degrees < 0 else ''}{whole} {minutes:02} {seconds:08.5f}"

    lines = [f"{clock(k)} {parts(lat)} {parts(lon)} {up:.4f} {SIGMAS}" for k, (lat, lon, up) in enumerate(LLA)]
    read = read_solution(pos(f"GPST latitude(d'\") longitude(d'\")  height(m)   {END}", lines))
    is_the_track(read, 2e-9)
    assert (read.place[:, 1] < 0.0).all()
    assert read.claims is not None
    assert read.claims.position is not None
    assert read.claims.position[3] == pytest.approx([0.0061, 0.0052, 0.0130])


def test_covariances_and_velocities_from_the_centre_of_the_earth() -> None:
    square = np.array([[1.0, 0.3, -0.4], [0.3, 4.0, 0.6], [-0.4, 0.6, 9.0]]) * 1e-4
    motion = np.array([30.0, -20.0, 2.0])  # north, east, down
    lines = []
    for k, (lla, centre) in enumerate(zip(LLA, lla_to_ecef(LLA), strict=True)):
        axes = mat_en_from_ll(*lla[:2])
        p = axes @ square @ axes.T
        roots = [
            np.sign(p[i, j]) * math.sqrt(abs(p[i, j])) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
        ]
        sigmas = " ".join(f"{root:.8f}" for root in roots)
        speed = " ".join(f"{v:.6f}" for v in axes @ motion)
        lines.append(f"{clock(k)} {' '.join(f'{x:.4f}' for x in centre)} 2 9 {sigmas} 0.0 1.2 {speed} {sigmas}")
    names = "x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) age(s) ratio"
    speeds = "vx(m/s) vy(m/s) vz(m/s) sdvx sdvy sdvz sdvxy sdvyz sdvzx"
    read = read_solution(pos(f"GPST {names} {speeds}", lines, "% solution  : Combined", "% inp file  : a.obs"))
    is_the_track(read, 2e-9)
    assert read.velocity == pytest.approx(np.tile(motion, (20, 1)), abs=2e-6)
    assert read.claims is not None
    for claim in (read.claims.position, read.claims.velocity):
        assert claim == pytest.approx(np.tile([0.01, 0.02, 0.03], (20, 1)), rel=1e-5)
    assert (read.smoothing, read.kind, read.fix_names) == ("combined", "post-processed", ("float",))


def test_velocities_north_east_and_up() -> None:
    names = f"GPST {DEGREES} vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu sdvne sdveu sdvun"
    rest = f"{SIGMAS} 30.0 -20.0 -2.0 0.1 0.2 0.3 0 0 0"
    read = read_solution(pos(names, rows(LLA, rest), "% program   : RTKNAVI ver.2.4.3", "% solution  : Backward"))
    assert read.velocity == pytest.approx(np.tile([30.0, -20.0, 2.0], (20, 1)))
    assert read.claims is not None
    assert read.claims.velocity == pytest.approx(np.tile([0.1, 0.2, 0.3], (20, 1)))
    assert (read.smoothing, read.kind) == ("backward", "real-time")


def test_base_lines_need_the_place_of_their_base() -> None:
    base = np.array([46.99, -0.51, 450.0])
    along = (lla_to_ecef(LLA) - lla_to_ecef(base)) @ mat_en_from_ll(*base[:2])  # north, east, down
    lines = rows(along[:, [1, 0, 2]] * (1, 1, -1), "1 9 0.02 0.01 0.03 0 0 0 0.0 9.9", 5)
    axes = "e-baseline(m) n-baseline(m) u-baseline(m)"
    names = f"GPST {axes} Q ns sde(m) sdn(m) sdu(m) sden(m) sdnu(m) sdue(m) age(s) ratio"
    read = read_solution(pos(names, lines, "% ref pos   :  46.990000000  -0.510000000   450.0000"))
    is_the_track(read, 1e-9)
    assert read.fix_names == ("fixed",)
    assert read.claims is not None
    assert read.claims.position == pytest.approx(np.tile([0.01, 0.02, 0.03], (20, 1)))
    parts = read_solution(pos(names, lines, "% ref pos   :   46 59 24.00000    -0 30 36.00000   450.0000"))
    is_the_track(parts, 1e-9)
    with pytest.raises(InputError, match=r"of a base that the header has not. Write latitude and longitude"):
        read_solution(pos(names, lines))


def test_a_datum_a_geoid_and_a_receiver_are_told() -> None:
    content = pos(f"GPST {DEGREES}", rows(LLA, "5 9 1.2 1.2 2.0 0 0 0 0.0 0.0"))
    notes = " ".join(read_solution(content.replace(b"/ellipsoidal", b"/geodetic")).notes)
    assert "heights above sea level (geodetic) taken as above the ellipsoid" in notes
    assert "sigmas north and east are always the same" in notes
    with pytest.raises(InputError, match="Tokyo datum"):
        read_solution(content.replace(b"=WGS84", b"=Tokyo"))


@pytest.mark.parametrize(
    ("names", "values", "kind", "position", "velocity", "attitude"),
    [
        # Text that Inertial Explorer and POSPac write, and what loggers of u-blox receivers call theirs.
        ("SDNorth (m),SDEast (m),SDHeight (m),RollSD (deg),PitchSD (deg),HdngSD (deg)", "0.01,0.02,0.03,0.1,0.2,0.3",
         "sigma", (0.01, 0.02, 0.03), None, (0.1, 0.2, 0.3)),
        ("North SD (m),East SD (m),Height SD (cm),sd_vn,sd_ve,sd_vd", "0.01,0.02,3,0.4,0.5,0.6",
         "sigma", (0.01, 0.02, 0.03), (0.4, 0.5, 0.6), None),
        ("hAcc [mm],vAcc [mm]", "1414.2136,2000", "drms", (1.0, 1.0, 2.0), None, None),
        ("CEP (m),sigma_up [m]", "1.1774,2.0", "cep", (1.0, 1.0, 2.0), None, None),
        ("horizontal [m 2DRMS],up_std", "2.8284,3.0", "drms", (1.0, 1.0, 3.0), None, None),
        ("lat_std,lon_std,alt_std", "0,0,0", None, None, None, None),
        ("North,East,hdop", "1,2,3", None, None, None, None),
    ],
)  # fmt: skip
def test_accuracies_of_a_table_are_told_by_the_words_for_them(
    names: str,
    values: str,
    kind: str | None,
    position: tuple[float, ...] | None,
    velocity: tuple[float, ...] | None,
    attitude: tuple[float, ...] | None,
) -> None:
    lines = [f"{100 + 0.1 * k:.1f},{47 + 1e-5 * k:.6f},8.5,500,{values}" for k in range(20)]
    read = read_solution("\n".join([f"tow,lat,lon,height_m,{names}", *lines]).encode())
    assert read.clock == "gps week seconds"
    if kind is None:
        assert read.claims is None
        return
    assert read.claims is not None
    assert read.claims.kind == kind
    for claim, expected in ((read.claims.position, position), (read.claims.velocity, velocity)):
        assert (claim is None) == (expected is None)
        assert claim is None or claim[7] == pytest.approx(expected, rel=1e-4)
    assert (read.claims.attitude is None) == (attitude is None)
    if attitude:
        assert np.degrees(read.claims.attitude)[7] == pytest.approx(attitude)


def test_a_table_of_named_columns_has_velocities_attitude_and_the_week() -> None:
    lines = [
        f"2300 {100 + 0.1 * k:.1f} {47 + 1e-5 * k:.6f} 8.5 500 11.1 0.1 -0.2 1 2 {359 + 0.1 * k:.1f}"
        for k in range(20)
    ]
    names = ["week", "time", "latitude", "longitude", "height_m", "vn", "ve", "vd", "roll", "pitch", "heading"]
    read = read_solution("\n".join(lines).encode(), columns=names)
    assert read.time_s[[0, -1]] == pytest.approx(2300 * 604_800 + np.array([100.0, 101.9]))
    assert (read.clock, read.format, read.claims, read.fix) == ("gps", "table", None, None)
    assert read.velocity == pytest.approx(np.tile([11.1, 0.1, -0.2], (20, 1)))
    assert read.attitude is not None
    assert np.degrees(read.attitude[-1]) == pytest.approx([1.0, 2.0, 360.9])
    with pytest.raises(InputError, match="has no names of its 11 columns"):
        read_solution("\n".join(lines).encode())
    fixes = "\n".join(
        ["time_s,lat,lon,height_m,fix_type"]
        + [f"{k},47.{k:03},8.5,500,{'FIX' if k % 3 else 'Single'}" for k in range(9)]
    )
    marked = read_solution(fixes.encode())
    assert marked.fix is not None
    assert [marked.fix_names[code] for code in marked.fix] == ["fix" if k % 3 else "single" for k in range(9)]
    assert marked.clock == ""


@pytest.mark.parametrize("names", ["GPST e-baseline(m) Q ns", "x e-baseline(m) n-baseline(m) u-baseline(m)"])
def test_a_base_line_whose_columns_are_not_all_named_is_refused(names: str) -> None:
    lines = [f"{second} 1 1 1" for second in range(20)]
    content = pos("GPST Q ns", lines, f"% {names}", "% ref pos   :  46.990000000  -0.510000000   450.0000")
    with pytest.raises(InputError, match=r"does not name the columns GPST, e-baseline, n-baseline, u-baseline"):
        read_solution(content)


def test_a_week_beyond_all_numbers_is_left_out() -> None:
    content = pos(f"GPST {DEGREES}", [row.replace("2024/05/18", "1e308") for row in rows(LLA)])
    with pytest.raises(InputError, match="holds no two places at different times"):
        read_solution(content)

"""Files that are damaged, of another kind, or too large: read in part with a note, or refused in one message."""

import pickle
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.files import sbet as sbet_files
from nav_model.flown.files.reader import read_solution


def sbet(rows: int = 400) -> np.ndarray:
    """Records at 60 m/s to the north-east, level, 200 Hz: x north, y west, z up, wander zero."""
    records = np.zeros((rows, 17))
    records[:, 0] = 400_000.0 + 0.005 * np.arange(rows)
    north, east = metres_per_radian(0.82, 1000.0)
    way = 60.0 * np.sqrt(0.5) * 0.005 * np.arange(rows)
    records[:, 1:4] = np.column_stack([0.82 + way / north, 0.15 + way / east, np.full(rows, 1000.0)])
    records[:, 4], records[:, 5], records[:, 9] = 60.0 * np.sqrt(0.5), -60.0 * np.sqrt(0.5), np.pi / 4
    return records


def test_an_sbet_that_is_cut_off_damaged_or_big_endian_is_read() -> None:
    whole = read_solution(sbet().tobytes())
    assert whole.velocity is not None
    assert whole.velocity[7] == pytest.approx([42.4264, 42.4264, 0.0], abs=1e-4)
    cut = read_solution(sbet().tobytes()[:-50])
    assert len(cut.time_s) == 399
    assert any("the last record is cut off after 86 bytes and left out" in note for note in cut.notes)
    big = read_solution(sbet().astype(">f8").tobytes())
    assert "big-endian" in big.notes[0]
    assert np.array_equal(big.place, whole.place)
    records = sbet()
    records[7, 1], records[9, 2], records[11, 0] = np.nan, 1e9, records[10, 0]
    damaged = read_solution(records.tobytes())
    assert len(damaged.time_s) == 397
    assert "2 records without a finite time and place on the Earth left out" in damaged.notes
    assert "1 record left out, not later than those before" in damaged.notes
    assert np.isfinite(damaged.place).all()
    records = sbet()
    records[50:53, 0] -= 0.1  # of which two are later than the one before
    assert len(read_solution(records.tobytes()).time_s) == 397
    records = sbet()
    records[20:30, 4] = np.inf
    assert len(read_solution(records.tobytes()).time_s) == 390
    records[:, 4:7] = np.nan
    without = read_solution(records.tobytes())
    assert without.velocity is None
    assert "velocity at 0% of the times, which is not used" in without.notes


def test_axes_of_other_writers_are_told_by_the_places() -> None:
    records = sbet()
    records[:, 4:7] = np.sqrt(0.5) * 60.0, np.sqrt(0.5) * 60.0, -0.5  # north, east, down, descending
    records[:, 3] -= -0.5 * 0.005 * np.arange(400)
    read = read_solution(records.tobytes())
    assert "velocities taken as north, east, down, as the places say" in read.notes
    assert read.velocity is not None
    assert read.velocity[0] == pytest.approx([42.4264, 42.4264, -0.5], abs=1e-4)
    degrees = sbet()
    degrees[:, [1, 2, 7, 8, 9]] = np.degrees(degrees[:, [1, 2, 7, 8, 9]])
    read = read_solution(degrees.tobytes())
    assert read.place[0] == pytest.approx([0.82, 0.15, 1000.0])
    assert read.attitude is not None
    assert read.attitude[0, 2] == pytest.approx(np.pi / 4)


def test_the_end_of_a_week_is_passed_by_the_solution_and_its_accuracies() -> None:
    records = sbet(4000)
    records[:, 0] = (604_790.0 + 0.005 * np.arange(4000)) % 604_800.0
    sigmas = np.full((40, 10), 0.5)
    sigmas[:, 0] = (604_780.0 + np.arange(40)) % 604_800.0
    sigmas[:, 1] = 0.01 * np.arange(40)
    read = read_solution(records.tobytes(), [sigmas.tobytes()])
    assert read.duration_s == pytest.approx(3999 * 0.005)
    assert read.claims is not None
    assert read.claims.position is not None
    assert read.claims.position[[0, 2000], 0] == pytest.approx([0.1, 0.2])


def test_a_long_sbet_is_thinned_and_read_without_a_copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "long.dat"
    sbet(100_000).tofile(path)
    monkeypatch.setattr(sbet_files, "MOST_RECORDS", 30_000)
    tracemalloc.start()
    read = read_solution(path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (len(read.time_s), read.rate_hz) == (25_000, pytest.approx(50.0))
    assert "of every 4 records one is read" in " ".join(read.notes)
    assert most < path.stat().st_size  # 13.6 MB


def test_a_large_file_of_no_kind_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "large.csv"
    with path.open("wb") as file:
        file.write(b"time_s,lat,lon\n")
        file.truncate(2_000_000_000)
    tracemalloc.start()
    with pytest.raises(InputError, match=r"large.csv: larger than 200 MB. Cut it."):
        read_solution(path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 10_000_000


def test_nothing_in_a_file_is_executed(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return exec, (f"open({str(tmp_path / 'executed')!r}, 'w')",)

    for content in (pickle.dumps(Trap()), pickle.dumps(Trap(), 0)):
        with pytest.raises(InputError):
            read_solution(content, name="a.pkl")
    assert not (tmp_path / "executed").exists()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "the file is empty"),
        (b" \r\n", "the file is empty"),
        (b"%PDF-1.7", "is a PDF document. Give SBET"),
        (b"a report renamed to sbet.out, with words alone\n" * 50, "No numbers found"),
        (np.random.default_rng(1).bytes(13_600), "is no text and no SBET"),
        (bytes(13_600), "is no text and no SBET"),
        (np.full(1700, np.nan).tobytes(), "is no text and no SBET"),
        (sbet(1).tobytes(), "is no text and no SBET"),
        (b"time_s,lat,lon,height_m\n" + b"5,47,8,500\n" * 20, "holds no two places at different times"),
        (b"time_s,lat,lon,height_m\n" + b",,,\n" * 20 + b"1,2,3,\n", "holds no row with time and place"),
        (b"lat,lon,height_m\n" + b"47,8,500\n" * 20, "has no column with the time"),
        (b"time_s,roll_deg\n" + b"1,2\n" * 20, "columns latitude and longitude are missing"),
        (b"#INSPVAXA,COM1;INS_SOLUTION_GOOD*00000000\n" * 5, "holds no INSPVAXA, INSPVAA or BESTPOSA message"),
        (b"$GPGGA,,,,,,0,,,,M,,M,,*66\n" * 5, "holds no GGA sentence with a fix"),
    ],
)  # fmt: skip
def test_what_is_no_solution_is_told(content: bytes, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as error:
        read_solution(content, name="given.out")
    assert error.value.key == "given.out"


def test_a_place_that_is_no_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no file"):
        read_solution(tmp_path)
    with pytest.raises(FileNotFoundError):
        read_solution(tmp_path / "absent.out")
    with pytest.raises(InputError, match=r"companion 1: does not belong to solution. Only an SBET"):
        read_solution(sbet().tobytes(), [b"time_s,lat\n1,2\n"])


def test_fields_of_messages_that_are_no_numbers_do_no_harm() -> None:
    from zlib import crc32

    lines = []
    for k in range(10):
        up = "none" if k == 4 else "500.0"
        text = (
            f"INSPVAXA,COM1,0,50.0,FINESTEERING,2300,{k}.0,0,0,1;INS_SOLUTION_GOOD,KIND_{k},47.00{k},8.5,{up},48.0,"
            + ",".join("0.1" for _ in range(15)) + ",0,0"
        )  # fmt: skip
        lines.append(f"#{text}*{crc32(text.encode(), 0xFFFFFFFF) ^ 0xFFFFFFFF:08x}")
    read = read_solution("\n".join(lines).encode())
    assert len(read.time_s) == 9
    assert "1 record without a finite time and place on the Earth left out" in read.notes

"""A trajectory from a CSV file: time, latitude, longitude, height, roll, pitch, yaw.

The first line names the columns, in any order; other columns are ignored:
`time_s, latitude_deg, longitude_deg, height_m, roll_deg, pitch_deg, yaw_deg`.
Time may start anywhere and need not be evenly spaced; the flight starts at the first row.
"""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nav_model.simulation.specification import HIGHEST_LATITUDE, TrajectorySpec, refused
from nav_model.simulation.trajectory import Trajectory, spline_through

FloatArray = NDArray[np.float64]
COLUMNS = ("time_s", "latitude_deg", "longitude_deg", "height_m", "roll_deg", "pitch_deg", "yaw_deg")
FEWEST_ROWS = 8
LARGEST_ACCELERATION = 300.0
LARGEST_RATE = math.radians(1000.0)


def parse_trajectory(text: str, name: str = "trajectory file") -> bytes:
    """Samples for `TrajectorySpec(kind="file", samples=...)` from CSV text.

    Raises ValueError naming the file, the line and the column of the first thing that cannot be flown:
    a missing column, a value that is not a finite number or is out of range, time that does not increase,
    fewer than 8 rows, or an acceleration above 300 m/s^2 or a rate above 1000 deg/s.
    """
    reader = csv.reader(io.StringIO(text.lstrip("\ufeff")))
    header = [cell.strip().lower() for cell in next(reader, [])]
    missing = [column for column in COLUMNS if column not in header]
    if missing:
        raise ValueError(
            f"{name}: line 1: column {missing[0]!r} is missing; the columns must be {', '.join(COLUMNS)}"
        )
    places = [header.index(column) for column in COLUMNS]
    rows: list[list[float]] = []
    lines: list[int] = []
    for cells in reader:
        if not any(cell.strip() for cell in cells):
            continue
        row = [
            _number(cells, place, column, reader.line_num, name)
            for place, column in zip(places, COLUMNS, strict=True)
        ]
        _check_range(row, reader.line_num, name)
        if rows and row[0] <= rows[-1][0]:
            raise ValueError(
                f"{name}: line {reader.line_num}: time_s = {row[0]!r} must be later than {rows[-1][0]!r}"
            )
        rows.append(row)
        lines.append(reader.line_num)
    if len(rows) < FEWEST_ROWS:
        raise ValueError(f"{name}: {len(rows)} rows; at least {FEWEST_ROWS} are needed")
    samples = np.array(rows)
    samples[:, 0] -= samples[0, 0]
    for column in (1, 2, 4, 5, 6):
        samples[:, column] = np.radians(samples[:, column])
    for column in (2, 4, 6):
        samples[:, column] = np.unwrap(samples[:, column])
    _check_motion(samples, lines, name)
    return samples.tobytes()


def read_trajectory(path: str | Path) -> TrajectorySpec:
    """The flight of a CSV file, see `parse_trajectory`; OSError where the file cannot be read."""
    path = Path(path)
    samples = parse_trajectory(path.read_text(encoding="utf-8"), path.name)
    return TrajectorySpec(kind="file", samples=samples)


def file_duration(samples: bytes) -> float:
    """Length of the flight [s]."""
    return float(np.frombuffer(samples)[-7])


def trajectory_from_samples(samples: bytes, duration: float) -> Trajectory:
    """Spline through the samples of `parse_trajectory`; ValueError where they end before `duration`."""
    table = np.frombuffer(samples).reshape(-1, 7)
    if duration > table[-1, 0] + 1e-9:
        raise refused("duration", duration, f"must be at most the trajectory file's {table[-1, 0]:.3f} s")
    return spline_through(table[:, 0], table[:, 1:])


def _number(cells: list[str], place: int, column: str, line: int, name: str) -> float:
    text = cells[place].strip() if place < len(cells) else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{name}: line {line}: {column} = {text!r}: must be a finite number")
    return value


def _check_range(row: list[float], line: int, name: str) -> None:
    limits = {
        "latitude_deg": math.degrees(HIGHEST_LATITUDE),
        "longitude_deg": 360.0,
        "height_m": 100_000.0,
        "roll_deg": 360.0,
        "pitch_deg": 80.0,
        "yaw_deg": 360.0,
    }
    for value, column in zip(row, COLUMNS, strict=True):
        if column in limits and abs(value) > limits[column]:
            raise ValueError(
                f"{name}: line {line}: {column} = {value!r}: must be between "
                f"{-limits[column]:g} and {limits[column]:g}"
            )


def _check_motion(samples: FloatArray, lines: list[int], name: str) -> None:
    """Refuse what no aircraft flies: it is a wrong unit or a glitch, and the spline would ring on it."""
    spline = spline_through(samples[:, 0], samples[:, 1:])
    middle = 0.5 * (samples[1:, 0] + samples[:-1, 0])
    acceleration = np.linalg.norm(np.gradient(spline.velocity(middle), middle, axis=0), axis=1)
    rate = np.max(np.abs(spline.evaluate(middle, 1)[:, 3:]), axis=1)
    for values, limit, what, unit, scale in (
        (acceleration, LARGEST_ACCELERATION, "acceleration", "m/s^2", 1.0),
        (rate, LARGEST_RATE, "angular rate", "deg/s", math.degrees(1.0)),
    ):
        worst = int(np.argmax(values))
        if values[worst] > limit:
            raise ValueError(
                f"{name}: line {lines[worst + 1]}: the path needs an "
                f"{what} of {values[worst] * scale:.4g} {unit}; "
                f"at most {limit * scale:.4g} {unit} can be flown"
            )

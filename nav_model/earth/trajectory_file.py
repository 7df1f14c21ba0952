"""A flight as a CSV file: time, latitude, longitude, height, roll, pitch, yaw.

The first line names the columns, in any order and case, after a # or not; other columns, empty lines and lines that
start with # are passed over. Time may start anywhere and need not be evenly spaced.
"""

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, shown

COLUMNS = ("time_s", "latitude_deg", "longitude_deg", "height_m", "roll_deg", "pitch_deg", "yaw_deg")
_DEGREES = [place for place, column in enumerate(COLUMNS) if column.endswith("_deg")]


@dataclass(frozen=True)
class FileBounds:
    """What a reader takes: rows, bytes, and the largest size of a value by column, in the unit of the file."""

    fewest_rows: int
    most_rows: int
    most_bytes: int
    largest: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class TrajectoryTable:
    """Samples (n, 7) in the order of `COLUMNS`: time from zero [s], angles [rad], height [m]; line of each sample."""

    samples: Array
    lines: list[int]


def read_trajectory_table(content: bytes, name: str, bounds: FileBounds) -> TrajectoryTable:
    """Samples of a trajectory file.

    Parameters
    ----------
    content : bytes
        UTF-8 text; at most one byte more than `bounds` allows need be given.
    name : str
        Name of the file, for messages.

    Raises
    ------
    InputError
        Under the file's name, with the line and the column of the first thing that is wrong: no text, too large, a
        missing column, a value that is not a finite number or is out of bounds, time that does not increase, too
        few or too many rows.
    """
    if len(content) > bounds.most_bytes:
        raise InputError(name, f"larger than {bounds.most_bytes // 1_000_000} MB; not a trajectory")
    try:
        reader = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
        header = [cell.strip(" #\t").lower() for cell in next(reader, [])]
        missing = [column for column in COLUMNS if column not in header]
        if missing:
            raise InputError(name, _missing(missing, header))
        places = [header.index(column) for column in COLUMNS]
        rows: list[list[float]] = []
        lines: list[int] = []
        for cells in reader:
            if "".join(cells).strip() and not cells[0].startswith("#"):
                rows.append(_numbers(cells, places, name, reader.line_num))
                lines.append(reader.line_num)
                if len(rows) > bounds.most_rows:  # before they take memory
                    raise InputError(name, f"more than {bounds.most_rows} rows")
    except UnicodeDecodeError as error:
        raise InputError(name, f"not a text file (byte {error.start} is not UTF-8)") from error
    except csv.Error as error:
        raise InputError(name, f"line {reader.line_num}: not CSV: {error}") from error
    if len(rows) < bounds.fewest_rows:
        raise InputError(name, f"{len(rows)} rows; at least {bounds.fewest_rows} are needed")
    samples = np.array(rows)
    _check(samples, lines, name, bounds.largest)
    samples[:, 0] -= samples[0, 0]
    samples[:, _DEGREES] = np.radians(samples[:, _DEGREES])
    return TrajectoryTable(samples, lines)


def _missing(missing: list[str], header: list[str]) -> str:
    if not any(header):
        return "the file is empty"
    found = ", ".join(header)
    found = found if len(found) <= 120 else found[:117] + "..."
    verb = "columns {} are" if len(missing) > 1 else "column {} is"
    return f"line 1: {verb.format(', '.join(missing))} missing; found {found}"


def _numbers(cells: list[str], places: list[int], name: str, line: int) -> list[float]:
    try:
        return [float(cells[place]) for place in places]
    except (ValueError, IndexError):
        for place, column in zip(places, COLUMNS, strict=True):
            text = cells[place].strip() if place < len(cells) else ""
            try:
                float(text)
            except ValueError as error:
                said = f"line {line}: {column} = {shown(text)}: must be a finite number"
                raise InputError(name, said) from error
        raise


def _check(samples: Array, lines: list[int], name: str, largest: Mapping[str, float]) -> None:
    for place, column in enumerate(COLUMNS):
        values, bound = samples[:, place], largest.get(column, np.inf)
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            row = wrong[0]
            raise InputError(name, f"line {lines[row]}: {column} = {values[row]}: must be a finite number")
        wrong = np.flatnonzero(np.abs(values) > bound)
        if wrong.size:
            row = wrong[0]
            said = f"{column} = {values[row]}: must be between {-bound:g} and {bound:g}"
            raise InputError(name, f"line {lines[row]}: {said}")
    back = np.flatnonzero(np.diff(samples[:, 0]) <= 0.0)
    if back.size:
        row = back[0] + 1
        said = f"time_s = {samples[row, 0]} must be later than {samples[row - 1, 0]}"
        raise InputError(name, f"line {lines[row]}: {said}")

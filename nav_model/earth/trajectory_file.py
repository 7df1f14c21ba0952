"""A flight as a CSV file: time, latitude, longitude, height, roll, pitch, yaw.

The first line names the columns, in any order and case, after a # or not; other columns, empty lines and lines that
start with # are passed over. Time may start anywhere and need not be evenly spaced.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.base.text.number_table import NumberTable, open_table

COLUMNS = ("time_s", "latitude_deg", "longitude_deg", "height_m", "roll_deg", "pitch_deg", "yaw_deg")
_LEAST_STEP = 1e-6  # s between rows
_DEGREES = [place for place, column in enumerate(COLUMNS) if column.endswith("_deg")]


@dataclass(frozen=True)
class FileBounds:
    """Limits of a reader: rows, bytes, and the largest size of a value by column, in the unit of the file."""

    fewest_rows: int
    most_rows: int
    most_bytes: int
    largest: Mapping[str, float] = field(default_factory=dict)


def read_trajectory_table(content: bytes, name: str, bounds: FileBounds) -> tuple[Array, list[int]]:
    """Samples (n, 7) of a trajectory file in the order of `COLUMNS` [s from the first, rad, m], and the line of each;
    of its text, one byte more than `bounds` allows is enough.

    Raises InputError under the file's name, with the line and the column of the first thing that is wrong: no
    table, too large, a missing column, a value that is not a finite number or is out of bounds, time that does
    not increase, too few or too many rows.
    """
    if len(content) > bounds.most_bytes:
        raise InputError(name, f"larger than {bounds.most_bytes // 1_000_000} MB; not a trajectory")
    if not content.strip():
        raise InputError(name, "the file is empty")
    return trajectory_of(open_table(content, name), bounds)


def has_trajectory(header: Sequence[str]) -> bool:
    """True if a header names all of `COLUMNS`."""
    return set(COLUMNS) <= {cell.lower() for cell in header}


def trajectory_of(table: NumberTable, bounds: FileBounds) -> tuple[Array, list[int]]:
    """Samples of a table with the names of `COLUMNS`; raises as `read_trajectory_table`."""
    names = next(filter(has_trajectory, table.headers), table.headers[0] if table.headers else ())
    header = [cell.lower() for cell in names]
    if missing := [column for column in COLUMNS if column not in header]:
        verb = f"columns {', '.join(missing)} are" if len(missing) > 1 else f"column {missing[0]} is"
        raise InputError(table.file_name, f"{verb} missing; found {', '.join(header)[:120] or 'no names'}")
    columns = table.columns([header.index(column) for column in COLUMNS], bounds.most_rows, bounds.most_bytes)
    samples, lines = columns.values, columns.lines.tolist()
    samples[:, _DEGREES] = np.radians(samples[:, _DEGREES])
    check_samples(samples, lines, table.file_name, bounds)
    samples[:, 0] -= samples[0, 0]
    return samples, lines


def check_samples(samples: Array, lines: Sequence[int], name: str, bounds: FileBounds, noun: str = "line") -> None:
    """Refuse samples that are too few, out of bounds, empty, or not a microsecond and more after the one before.

    Parameters
    ----------
    samples : array (n, 7)
        In the order of `COLUMNS` [s, rad, m].
    lines : sequence of int
        Number of each sample in the file.
    name : str
        Name of the file.
    bounds : FileBounds
        Limits of the reader.
    noun : str, optional
        What `lines` counts.

    Raises
    ------
    InputError
        Under the file's name, with the line.
    """
    if len(samples) < bounds.fewest_rows:
        raise InputError(name, f"{len(samples)} rows; at least {bounds.fewest_rows} are needed")
    for place, column in enumerate(COLUMNS):
        values = np.degrees(samples[:, place]) if place in _DEGREES else samples[:, place]
        bound, finite = bounds.largest.get(column, np.inf), np.isfinite(values)
        if (wrong := np.flatnonzero(~finite | (np.abs(values) > bound))).size:
            row = wrong[0]
            reason = f"must be between {-bound:g} and {bound:g}" if finite[row] else "must be a finite number"
            raise InputError(name, f"{noun} {lines[row]}: {column} = {values[row]:.12g}: {reason}")
    if (back := np.flatnonzero(np.diff(samples[:, 0]) < _LEAST_STEP)).size:
        row = back[0] + 1
        reason = f"time_s = {samples[row, 0]} must be later than {samples[row - 1, 0]} by {_LEAST_STEP:g} s at least"
        raise InputError(name, f"{noun} {lines[row]}: {reason}")

"""Solutions of RTKLIB (.pos): what its header says of the clock, the processing and the frame."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import date

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.text.number_table import NumberTable, angle_of, seconds_of
from nav_model.earth.wgs84 import central, geodetic
from nav_model.flown.files.table import epochs_of, local_axes
from nav_model.simulation.trajectory import FILE_BOUNDS
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.table import FlightColumn, FlightColumns, flight_columns, recorded_rows

_START = 16_384
_NAMES = re.compile(rb"(?m)^%\s*(GPST|UTC|JST)\b.*\bQ\b.*\bns\b")
_BASE = ("e-baseline", "n-baseline", "u-baseline")
_DAY, _WEEK = 86_400.0, 604_800.0
_EPOCHS = {"GPST": date(1980, 1, 6), "UTC": date(1970, 1, 1), "JST": date(1970, 1, 1)}
_GPS_EPOCH_IN_UTC = 315_964_800.0
_JAPAN = 9 * 3600.0


def is_pos(content: bytes) -> bool:
    """True for a solution of RTKLIB with its header."""
    return bool(_NAMES.search(content[:_START]))


def read_pos(table: NumberTable, heights: Heights) -> Epochs:
    """The epochs of a solution, with the facts of its header.

    Raises InputError under the file's name: a base line without the place of its base, a datum other than WGS 84, and
    what the reader of tables refuses.
    """
    head = "".join(table.comments)
    if "=Tokyo" in head:
        raise heights.refuse("has places in the Tokyo datum. Write them with out-outdatum = wgs84.")
    if "/geodetic" in head:
        heights.note("heights above sea level (geodetic) taken as above the ellipsoid")
    roles, rows, lines = _relative(table, heights, head) if _BASE[0] in head else _absolute(table, heights)
    clock, time = _time(table, lines, head, heights)
    epochs = epochs_of(table, heights, roles, rows, lines)
    sigma = epochs.sigma_position
    if sigma is not None and len(sigma) > 1 and (sigma[:, 0] == sigma[:, 1]).all() and sigma.any():
        heights.note("sigmas north and east are always the same: made of one horizontal accuracy, as from u-blox")
    direction = re.search(r"(?mi)^%\s*solution\s*:\s*(forward|backward|combined)", head)
    after = re.search(r"(?mi)^%\s*(inp file|program\s*:\s*(rtkpost|rnx2rtkp))", head)
    live = re.search(r"(?mi)^%\s*program\s*:\s*(rtknavi|rtkrcv)", head)
    return replace(
        epochs, format="rtklib", clock=clock, time=time, smoothing=direction[1].lower() if direction else "",
        kind="post-processed" if after else "real-time" if live else "",
    )  # fmt: skip


def _absolute(table: NumberTable, heights: Heights) -> tuple[FlightColumns, Array, NDArray[np.int32]]:
    """Columns, rows and lines of latitudes and longitudes, or of places from the Earth's centre."""
    roles = flight_columns(table, heights)
    segment, lines = recorded_rows(table, heights, roles)
    return roles, segment.rows, lines


def _relative(table: NumberTable, heights: Heights, head: str) -> tuple[FlightColumns, Array, NDArray[np.int32]]:
    """Columns, rows and lines of places east, north, up of a base, whose place is in the header."""
    angle = r"(-?\d+(?:\.\d+|\s+\d+\s+\d+\.\d+))"
    base = re.search(rf"(?m)^%\s*ref pos\s*:\s*{angle}\s+{angle}\s+(-?\d+\.\d+)", head)
    if base is None:
        advice = "Write latitude and longitude (out-solformat = llh), or with the header (out-outhead = on)."
        raise heights.refuse(f"has places east, north and up of a base that the header has not. {advice}")
    place = np.array([[math.radians(angle_of(base[1])), math.radians(angle_of(base[2])), float(base[3])]])
    header = next(filter(_names_a_base_line, table.headers), None)
    if header is None:
        raise heights.refuse(f"does not name the columns GPST, {', '.join(_BASE)} above its rows. Write them whole.")
    at = [next(at for at, name in enumerate(header) if name.startswith(axis)) for axis in _BASE]
    read = table.columns(at, FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes)
    whole = np.isfinite(read.values).all(axis=1)
    east, north, up = read.values[whole].T
    centre = central(place) + np.column_stack([north, east, -up]) @ local_axes(place)[0]
    heights.note("places east, north and up of the base of the header")
    columns = [FlightColumn(0, False, at, 1.0, name) for at, name in enumerate(header)]
    quality = next((column for column in columns if column.header == "Q"), None)
    taken = {axis[0]: columns[place] for axis, place in zip(_BASE, at, strict=True)}
    taken["time"] = next(column for column in columns if column.header in _EPOCHS)
    rows = geodetic(centre) * (180.0 / math.pi, 180.0 / math.pi, 1.0)
    roles = FlightColumns(taken, "ellipsoid", header, quality, ())
    return roles, np.column_stack([np.zeros(len(rows)), rows]), read.lines[whole]


def _names_a_base_line(header: Sequence[str]) -> bool:
    """True for a header with a time and all of a base line."""
    stamped = any(name in _EPOCHS for name in header)
    return stamped and all(any(name.startswith(axis) for name in header) for axis in _BASE)


def _time(table: NumberTable, lines: NDArray[np.int32], head: str, heights: Heights) -> tuple[str, Array]:
    """The clock of the header and times of lines, from the week or the date of each and the time behind it."""
    names = _NAMES.search(head.encode())
    system = names[1].decode() if names else "GPST"
    apart = any(header[0] == "date" for header in table.headers)
    places = [0, 1] if apart else [0]
    read = table.columns(
        places, FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes, {0: lambda text: _moment(text, system), 1: seconds_of}
    )
    stamps = read.values[np.searchsorted(read.lines, lines)]
    weeks = "/" not in table.first_row[:11]
    if weeks:
        with np.errstate(over="ignore"):  # of a row that is no place in time, and left out
            stamps[:, 0] *= _WEEK
    time = stamps.sum(axis=1)
    if system == "GPST":
        return "gps", time
    if weeks:
        time += _GPS_EPOCH_IN_UTC
    if system == "JST":
        heights.note("times in JST, which is UTC + 9 h")
        time -= _JAPAN
    return "utc", time


def _moment(text: str, system: str) -> float:
    """Seconds of a date, and the time of day behind it, since the epoch of a system of time; NaN: none."""
    match = re.fullmatch(r"\s*(\d{4})/(\d\d)/(\d\d)(\s+[\d:.]+)?\s*", text)
    if match is None:
        return math.nan
    try:
        days = (date(int(match[1]), int(match[2]), int(match[3])) - _EPOCHS[system]).days
    except ValueError:
        return math.nan
    return _DAY * days + (seconds_of(match[4]) if match[4] else 0.0)

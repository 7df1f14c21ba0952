"""Columns of an inertial log that mean something, from a text table or an NPZ archive, and what else the file states.
Nothing in the file is executed."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.log_names import COUNTS, SENSORS, Meaning, meaning_of, meanings_of, names_sensors
from nav_model.base.errors import InputError, quoted
from nav_model.base.text.column_names import listed
from nav_model.base.text.file_kind import KINDS, kind_of
from nav_model.base.text.message_dump import lines_of
from nav_model.base.text.npz_arrays import read_npz_arrays
from nav_model.base.text.number_table import NumberTable, open_table, seconds_of

IGNORED = "-"
_ROLES = (*SENSORS, "time", "temperature")
_SIX_COLUMN_NAMES = ("counts", "imu", "data", "samples", "log")
# A comment states the rate of the samples if it holds no other word than these, a number and a unit.
_RATE_WORDS = re.compile(
    r"[\s/#%]*(?:(?:imu|log|data|sensor|samples?|sampled|sampling|recorded|recording|logged|logging|output|update|odr|"
    r"rate|frequency|freq|fs|at|of|the|is|was|k?hz|sps)(?![a-z])[\s:=_,;()\[\]]*)+(\d+\.?\d*(?:e[-+]?\d\d?)?|\.\d+)\s*(k?hz|sps)?[\s.,;]*"
)
_INERTIAL_MESSAGES = ("IMU", "IMU2", "IMU3")
_LONGEST_COMMENT = 200
_MOST_SENSORS = 16  # in one table; a column with more values counts something else
_LONGEST_NAME = 60  # of a sensor
_LEAST_SHARE = 0.02  # of the rows; what is rarer is no sensor's number


@dataclass(frozen=True)
class Limits:
    """Limits of an upload: bytes of the file, bytes unpacked, rows."""

    file_bytes: int = 512_000_000
    unpacked_bytes: int = 1_000_000_000
    rows: int = 20_000_000


@dataclass(frozen=True)
class LogOptions:
    """Statements of the user about a log; None: read it from the file, or refuse and ask.

    `rate_hz`; `gyro_unit`, `accelerometer_unit`: a unit ("deg/s"), a unit per count ("0.05 deg/s") or an
    increment ("rad", "m/s"); `columns`: names of a table's columns in order ("time", "gyro_x", ..., "-" to
    ignore one); `arrays`: role -> array name of an NPZ archive, for archives with several candidates; `sensor`: the
    one of several in a table, as the column that numbers or names them has it.
    """

    rate_hz: float | None = None
    gyro_unit: str | None = None
    accelerometer_unit: str | None = None
    columns: Sequence[str] | None = None
    arrays: Mapping[str, str] | None = None
    sensor: str | None = None

    def unit(self, role: str) -> str | None:
        """The unit that is given for a sensor."""
        return self.gyro_unit if role == "gyro" else self.accelerometer_unit


class LogColumn(NamedTuple):
    """A column by its name in the file."""

    label: str
    meaning: Meaning
    values: NDArray[Any]


class LogContent(NamedTuple):
    """Columns of a file that mean something and the names of the others; what else it states: scales per count, rate;
    where in the file a row is; whether its last line ends too early; columns without any number; how the sensor was
    chosen where the file has several."""

    columns: list[LogColumn]
    others: list[str]
    count_units: dict[str, str]
    rate_hz: float | None
    place: Callable[[int], str]
    cut: bool = False
    empty: Sequence[LogColumn] = ()
    choice: str = ""

    def of(self, role: str) -> list[LogColumn]:
        """The columns of a sensor, of times or of temperatures."""
        return [column for column in self.columns if column.meaning.role == role]

    def unit(self, role: str, options: LogOptions) -> str | None:
        """Unit of a sensor: as given, else as the file states it."""
        of_column = self.of(role)[0].meaning.unit
        counted = of_column is None or of_column.lower() in COUNTS
        return options.unit(role) or (self.count_units.get(role) if counted else of_column)


def read_content(content: bytes, name: str, options: LogOptions, limits: Limits) -> LogContent:
    """Read a file, whose kind its content tells; columns whose names mean nothing here are not read.

    Parameters
    ----------
    content : bytes
        The whole file.
    name : str
        Name of the file, for messages.
    options : LogOptions
        Statements of the user.
    limits : Limits
        Bounds of bytes and rows.

    Raises
    ------
    InputError
        Under `name`, "columns" or "arrays"; under "sensor", with the choices as its value, where a file has rows of
        several sensors and none of them is chosen.
    """
    kind = kind_of(content)
    if kind is None and options.arrays:
        raise InputError("arrays", "The file is a table. Its columns are named by `columns`.", options.arrays)
    if kind == "an NPZ archive" and options.columns:
        reason = "The file is an NPZ archive. Its arrays are chosen by `arrays`."
        raise InputError("columns", reason, options.columns)
    if kind not in (None, "an NPZ archive"):
        packed = "Unpack it and give the log in it." if kind.endswith("archive") else ""
        advice = packed or KINDS["log_advice"].get(kind, "Write the inertial data as CSV, a row for each sample.")
        raise InputError(name, f"The file is {kind}. {advice}")
    read = (_from_npz if kind else _from_text)(content, name, options, limits)
    empty = [c for c in read.columns if np.isnan(c.values[:1]).all() and np.isnan(c.values).all()]
    labels = {column.label for column in empty}
    return read._replace(columns=[column for column in read.columns if column.label not in labels], empty=empty)


def _from_text(content: bytes, name: str, options: LogOptions, limits: Limits) -> LogContent:
    dump = lines_of(content, name, _INERTIAL_MESSAGES)
    table = open_table(dump.table if dump else content, name)
    names, meanings = _named(table, options.columns)
    known = {place: meaning for place, meaning in enumerate(meanings) if meaning is not None}
    times = [place for place, meaning in known.items() if meaning.role == "time"]
    # Rows of several sensors are never read as one.
    telling = [place for place, label in enumerate(names) if place not in known and names_sensors(label)]
    tallies = dict(zip(telling, table.tally(telling, _MOST_SENSORS), strict=True)) if telling else {}
    place, sensor, choice = _sensor({place: (names[place], tally) for place, tally in tallies.items()}, options)
    only = None if place is None else (place, sensor)
    readers = dict.fromkeys(times, seconds_of)
    read = table.columns([*known], limits.rows, limits.unpacked_bytes, readers, only)
    columns = [
        LogColumn(names[place], known[place], values) for place, values in zip(known, read.values.T, strict=True)
    ]
    used = {*known, place}
    others = [label for at, label in enumerate(names) if at not in used and label.strip(" -")]
    choice = "; ".join(filter(None, (dump.choice if dump else "", choice)))
    lines, rate_hz = read.lines, _rate_of(table.comments)
    return LogContent(columns, others, {}, rate_hz, lambda row: f"line {lines[row]}", read.cut, choice=choice)


def _sensor(tallies: Mapping[Any, tuple[str, Mapping[str, int]]], options: LogOptions) -> tuple[Any, str, str]:
    """The column that tells sensors apart, the text that it has in rows of the chosen one, and this in words.

    Parameters
    ----------
    tallies : mapping
        Of each column that may tell them apart: its name, and its texts with the rows that have each.
    options : LogOptions
        Statements of the user.

    Returns
    -------
    tuple
        None and empty texts where the file has one sensor.

    Raises
    ------
    InputError
        Under "sensor": there are several and none is chosen, or one that is not there.
    """
    for place, (label, tally) in tallies.items():
        rows = sum(tally.values())
        sensors = sorted(t for t, count in tally.items() if count >= _LEAST_SHARE * rows and len(t) <= _LONGEST_NAME)
        if len(sensors) < 2:
            continue
        each = f"{', '.join(sensors[:-1])} and {sensors[-1]}"
        if options.sensor is None:
            reason = f"The column {quoted(label)} tells {len(sensors)} sensors apart: {each}. Choose one of them."
            raise InputError("sensor", reason, tuple(sensors))
        chosen = next((text for text in sensors if _same(text, options.sensor)), None)
        if chosen is None:
            reason = f"{options.sensor!r} is not in the column {quoted(label)}, which has {each}."
            raise InputError("sensor", reason, tuple(sensors))
        return place, chosen, f"rows with {chosen} under {label}, which has {each}"
    if options.sensor is not None:
        reason = f"{options.sensor!r} is given, but no column of the file tells several sensors apart."
        raise InputError("sensor", reason, options.sensor)
    return None, "", ""


def _named(table: NumberTable, given: Sequence[str] | None) -> tuple[Sequence[str], list[Meaning | None]]:
    """Name and meaning of each column: as given, or from the header nearest to the rows that has a sensor."""
    name, width = table.file_name, table.width
    if given is not None:
        (given,) = table.named(given).headers
        meanings = meanings_of(given)
        for label, meaning in zip(given, meanings, strict=True):
            if meaning is None and label != IGNORED and not names_sensors(label):
                allowed = (
                    f"time, gyro_x .. gyro_z, accelerometer_x .. accelerometer_z, temperature, sensor, {IGNORED}"
                )
                raise InputError(name, f"column name {label!r} is not understood; allowed: {allowed}")
        return given, meanings
    if not table.headers:
        example = "time,gyro_x,gyro_y,gyro_z,accelerometer_x,accelerometer_y,accelerometer_z"
        raise InputError(name, f"No header names its {width} columns. Give `columns`, such as {example}")
    for labels in table.names():
        meanings = meanings_of(labels)
        if any(meaning and meaning.role in SENSORS for meaning in meanings):
            break
    return labels, meanings


def _rate_of(comments: Sequence[str]) -> float | None:
    """The rate of the samples that a comment states."""
    for line in comments:
        text = line.strip().lower()
        if len(text) < _LONGEST_COMMENT and re.search("hz|sps", text) and (match := _RATE_WORDS.fullmatch(text)):
            return float(match[1]) * (1000.0 if "khz" in text else 1.0)
    return None


def _from_npz(content: bytes, name: str, options: LogOptions, limits: Limits) -> LogContent:
    arrays = read_npz_arrays(content, name, limits.unpacked_bytes)
    roles = {label: role for role, label in (options.arrays or {}).items()}
    for label, role in roles.items():
        if label not in arrays or role not in _ROLES:
            allowed = f"roles are {', '.join(_ROLES)}, arrays are {listed(sorted(arrays))}"
            raise InputError(name, f"arrays {role}={quoted(label)}; {allowed}")
    count_units, rate_hz = _scalars(arrays)
    columns: list[LogColumn] = []
    for label, array in arrays.items():
        meaning = meaning_of(label)
        if label in roles:
            unit = meaning.unit if meaning and meaning.role == roles[label] else None
            meaning = Meaning(roles[label], None, unit)
        elif meaning is None or meaning.role in roles.values() or array.ndim == 0:
            continue
        triad = meaning.role in SENSORS and meaning.axis is None and array.ndim == 2 and array.shape[1] == 3
        if not (triad or array.ndim == 1) or not 0 < len(array) <= limits.rows:
            allowed = f"1 to {limits.rows} rows of one column, or of three for a triad, are allowed"
            raise InputError(name, f"array {quoted(label)}: shape {array.shape}; {allowed}")
        axes = [(meaning._replace(axis=axis), array[:, axis]) for axis in range(3)] if triad else [(meaning, array)]
        columns += [LogColumn(label, *axis) for axis in axes]
    if not any(column.meaning.role in SENSORS for column in columns):
        # An array of six columns under a telling name is gyro x, y, z then accelerometer x, y, z.
        unit = "counts" if count_units else None
        sixes = [label for label in arrays if label.lower() in _SIX_COLUMN_NAMES and arrays[label].shape[1:] == (6,)]
        for label, i in product(sixes[:1], range(6)):
            columns.append(LogColumn(label, Meaning(SENSORS[i // 3], i % 3, unit), arrays[label][:, i]))
    used = {column.label for column in columns}
    rows = {len(column.values) for column in columns}
    telling = {
        label: (label, tally) for label, array in arrays.items()
        if label not in used and names_sensors(label) and array.ndim == 1 and {array.size} == rows
        and (tally := _tally(array))
    }  # fmt: skip
    at, sensor, choice = _sensor(telling, options)
    of_sensor = np.arange(0)
    if choice:
        of_sensor = np.flatnonzero([f"{value:g}" == sensor for value in arrays[at]])
        columns = [column._replace(values=column.values[of_sensor]) for column in columns]
    others = [label for label, array in arrays.items() if array.size > 1 and label not in used | {at}]

    def place(row: int) -> str:
        return f"sample {of_sensor[row] if choice else row}"

    return LogContent(columns, others, count_units, rate_hz, place, choice=choice)


def _same(text: str, other: str) -> bool:
    """True for equal texts, or equal numbers however they are written."""
    try:
        return text == other or float(text) == float(other)
    except ValueError:
        return False


def _tally(array: NDArray[Any]) -> dict[str, int]:
    """Values of an array and how often each is there; nothing of one with more than sensors in a file."""
    values, counts = np.unique(array, return_counts=True)
    few = len(values) <= _MOST_SENSORS
    return {f"{value:g}": int(count) for value, count in zip(values, counts, strict=True)} if few else {}


def _scalars(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, str], float | None]:
    """Units per count and the rate from an archive's scalar entries."""
    units: dict[str, str] = {}
    rate: float | None = None
    for label, value in [(label, float(array.item())) for label, array in arrays.items() if array.size == 1]:
        if label.endswith("_per_count"):
            meaning = meaning_of(label.removesuffix("_per_count"))
            if meaning is not None and meaning.unit is not None:
                units[meaning.role] = f"{value!r} {meaning.unit}"
        elif label.lower() in ("fs", "rate", "rate_hz", "sample_rate", "frequency"):
            rate = value
        elif label.lower() in ("dt", "interval", "interval_s", "ts") and value > 0.0:
            rate = 1.0 / value
    return units, rate

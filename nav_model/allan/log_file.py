"""Reads an inertial log (a text table or NPZ) into SI rates. Nothing in the file is executed; every error says what
and where."""

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.imu_log import AXIS_LETTERS, NO_BREAKS, ImuLog
from nav_model.allan.log_names import COUNTS, Meaning, meaning_of, meanings_of, scale_of
from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.base.file_kind import kind_of
from nav_model.base.npz_arrays import read_npz_arrays
from nav_model.base.number_table import NumberTable, open_table
from nav_model.base.sampling import Rows, Sampling, held_values, judge_stamps
from nav_model.design.file import read_bytes

IGNORED = "-"
RATE_TOLERANCE = 0.01
_RATES = (1e-3, 1e7)  # Hz
_LIKELY_RATES = (5.0, 2e4)  # Hz, of a log whose stamps have no unit
_LARGEST = 1e9  # rad/s or m/s²: no sensor measures more, and its square would overflow
_LEAST_FORCE = 0.5  # of gravity
_JITTER = 0.02  # of an interval; less is not worth a word
_MOST_NAMES = 8  # of columns that are not used
_EXAMPLES = {
    "rate": "100 Hz",
    "gyro_unit": "deg/s, rad/s, increments in rad, or 0.05 deg/s per count",
    "accelerometer_unit": "m/s2, g, increments in m/s, or 0.00333 g per count",
}
_SENSORS = ("gyro", "accelerometer")
_SIX_COLUMN_NAMES = ("counts", "imu", "data", "samples", "log")
_BAG = "If it is a ROS 2 bag, write its IMU topic as CSV, for example with PlotJuggler."
_ARRAYS = "Write its arrays with numpy.savez, each under its name, or as CSV."
_ADVICE = {
    "an MCAP recording": _BAG, "an SQLite database": _BAG,
    "a ROS bag": "Write its IMU topic as CSV: rostopic echo -b FILE -p /imu/data > imu.csv.",
    "a PX4 log (ULog)": "Run ulog2csv on it and give the CSV of sensor_combined.",
    "an ArduPilot log (DataFlash)": "Write its IMU messages as CSV: mavlogdump.py --format csv --types IMU FILE.",
    "a MATLAB file": _ARRAYS, "an HDF5 file": _ARRAYS, "a single NumPy array": _ARRAYS,
    "an Excel workbook": "Save its sheet as CSV.",
}  # fmt: skip
# A comment states the rate of the samples if it holds no other word than these, a number and a unit.
_RATE_WORDS = re.compile(
    r"[\s/#%]*(?:(?:imu|log|data|sensor|samples?|sampled|sampling|recorded|recording|logged|logging|output|update|odr|"
    r"rate|frequency|freq|fs|at|of|the|is|was|k?hz|sps)(?![a-z])[\s:=_,;()\[\]]*)+([0-9.]+(?:e[-+]?\d+)?)\s*(k?hz|sps)?[\s.,;]*"
)
_LONGEST_COMMENT = 200


@dataclass(frozen=True)
class Limits:
    """What an upload may hold: bytes of the file, bytes unpacked, rows."""

    file_bytes: int = 512_000_000
    unpacked_bytes: int = 1_000_000_000
    rows: int = 20_000_000


@dataclass(frozen=True)
class LogOptions:
    """What the user states about a log; None: read it from the file, or refuse and ask.

    `rate_hz`; `gyro_unit`, `accelerometer_unit`: a unit ("deg/s"), a unit per count ("0.05 deg/s") or an
    increment ("rad", "m/s"); `columns`: names of a table's columns in order ("time", "gyro_x", ..., "-" to
    ignore one); `arrays`: role -> array name of an NPZ archive, for archives with several candidates.
    """

    rate_hz: float | None = None
    gyro_unit: str | None = None
    accelerometer_unit: str | None = None
    columns: Sequence[str] | None = None
    arrays: Mapping[str, str] | None = None

    def unit(self, role: str) -> str | None:
        """The unit that is given for a sensor."""
        return self.gyro_unit if role == "gyro" else self.accelerometer_unit


@dataclass(frozen=True)
class _Column:
    label: str
    meaning: Meaning
    values: NDArray[Any]


@dataclass(frozen=True)
class _Content:
    """Columns of a file that mean something and the names of the others; what else it states: scales per count, rate;
    where in the file a row is."""

    columns: list[_Column]
    others: tuple[str, ...]
    count_units: dict[str, str]
    rate_hz: float | None
    place: Callable[[int], str]
    cut: bool = False

    def of(self, role: str) -> list[_Column]:
        return [column for column in self.columns if column.meaning.role == role]


@dataclass(frozen=True)
class _Clock:
    """Stamps of the rows [s] and the sampling behind them; None where rows follow each other at `rate_hz`."""

    rate_hz: float
    stamps: Array | None = None
    sampling: Sampling | None = None


@dataclass(frozen=True)
class _Signal:
    """A sensor in SI, shape (samples, axes), its rate, the first sample after each gap, and the row of each sample
    (None: every row in turn)."""

    values: Array
    rate_hz: float
    breaks: Rows
    rows: Rows | None


def read_log(
    source: str | Path | bytes,
    options: LogOptions | None = None,
    file_name: str | None = None,
    limits: Limits | None = None,
) -> ImuLog:
    """Read a path or the bytes of a file into an ImuLog.

    The format is told by its content. Columns whose names mean nothing here are not read. Rows without a value are
    lost samples; where samples are lost the log has a break.

    Raises InputError under the name of the file, with row or array, what was found and what is allowed; under "rate",
    "gyro_unit" and "accelerometer_unit", or those of them together with commas, where the file does not say them or
    has no such sensor.
    """
    options, limits = options or LogOptions(), limits or Limits()
    bytes_read, name = _content(source, file_name, limits)
    digest = hashlib.sha256(bytes_read).hexdigest()
    kind = kind_of(bytes_read)
    if kind == "an NPZ archive":
        if options.columns:
            reason = "The file is an NPZ archive. Its arrays are chosen by `arrays`."
            raise InputError("columns", reason, options.columns)
        content = _from_npz(bytes_read, name, options, limits)
    elif kind is None:
        if options.arrays:
            raise InputError("arrays", "The file is a table. Its columns are named by `columns`.", options.arrays)
        content = _from_text(bytes_read, name, options, limits)
    else:
        packed = "Unpack it and give the log in it." if kind.endswith("archive") else ""
        advice = packed or _ADVICE.get(kind, "Write the inertial data as CSV, a row for each sample.")
        raise InputError(name, f"The file is {kind}. {advice}")
    del bytes_read
    content, notes = _without_empty(content, name)
    _complete(content, options, name)
    clock = _clock(content, options, name, notes)
    lengths = {len(column.values) for role in _SENSORS for column in content.of(role)}
    if len(lengths) > 1:
        raise InputError(name, f"The sensors have {' and '.join(map(str, sorted(lengths)))} samples. Give all alike.")
    signals = {role: _signal(role, content, options, clock, name, notes) for role in _SENSORS if content.of(role)}
    if (alpha := signals.get("accelerometer")) and content.of("accelerometer")[0].label.startswith("alpha"):
        force = float(np.linalg.norm(alpha.values.mean(axis=0)))
        if force < _LEAST_FORCE * STANDARD_GRAVITY:
            notes.append(f"alpha not used: {force:.3g} m/s² on average is no specific force at rest")
            del signals["accelerometer"]
    rate_hz = max(signal.rate_hz for signal in signals.values())
    if content.others:
        names = ", ".join(label[:40] for label in content.others[:_MOST_NAMES])
        more = f" and {len(content.others) - _MOST_NAMES} more" if len(content.others) > _MOST_NAMES else ""
        notes.append(f"not used: {names}{more}")
    if content.cut:
        notes.append("the last line ends too early and is left out")
    return ImuLog(
        gyro=signals["gyro"].values if "gyro" in signals else None,
        accelerometer=signals["accelerometer"].values if "accelerometer" in signals else None,
        rate_hz=rate_hz,
        temperature_c=_temperature(content, signals, notes),
        file_name=name,
        sha256=digest,
        reading=tuple(dict.fromkeys(notes)),
        rates={role: signal.rate_hz for role, signal in signals.items() if signal.rate_hz != rate_hz},
        breaks={role: signal.breaks for role, signal in signals.items() if len(signal.breaks)},
        **{f"{role}_axis": content.of(role)[0].meaning.axis or 0 for role in signals},
    )


def _content(source: str | Path | bytes, file_name: str | None, limits: Limits) -> tuple[bytes, str]:
    content = source if isinstance(source, bytes) else read_bytes(source, limits.file_bytes)
    name = file_name or ("upload" if isinstance(source, bytes) else Path(source).name)
    if len(content) > limits.file_bytes:
        raise InputError(name, f"The file is larger than {limits.file_bytes / 1e6:.0f} MB. Cut the log.")
    if not content:
        raise InputError(name, "The file is empty.")
    return content, name


def _from_text(content: bytes, name: str, options: LogOptions, limits: Limits) -> _Content:
    table = open_table(content, name)
    names, meanings = _named(table, name, options)
    known = {place: meaning for place, meaning in enumerate(meanings) if meaning is not None}
    times = [place for place, meaning in known.items() if meaning.role == "time"]
    read = table.columns([*known], limits.rows, limits.unpacked_bytes, times)
    columns = [
        _Column(names[place], known[place], values) for place, values in zip(known, read.values.T, strict=True)
    ]
    others = tuple(label for place, label in enumerate(names) if place not in known and label.strip(" -"))
    lines = read.lines
    return _Content(columns, others, {}, _rate_of(table.comments), lambda row: f"line {lines[row]}", read.cut)


def _named(table: NumberTable, name: str, options: LogOptions) -> tuple[Sequence[str], list[Meaning | None]]:
    """Name and meaning of each column: as given, or from the header nearest to the rows that has a sensor."""
    if options.columns is not None:
        names = [*options.columns]
        if len(names) != table.width:
            raise InputError(name, f"{len(names)} column names are given, but the file has {table.width} columns.")
        meanings = meanings_of(names)
        for label, meaning in zip(names, meanings, strict=True):
            if meaning is None and label != IGNORED:
                raise InputError(
                    name,
                    f"column name {label!r} is not understood; allowed: time, gyro_x .. gyro_z, "
                    f"accelerometer_x .. accelerometer_z, temperature, {IGNORED}",
                )
        return names, meanings
    if not table.headers:
        raise InputError(
            name,
            f"No header names its {table.width} columns. Give `columns`, such as "
            "time,gyro_x,gyro_y,gyro_z,accelerometer_x,accelerometer_y,accelerometer_z",
        )
    below: Sequence[str] = [""] * table.width
    for header in table.headers:
        # The line between names and numbers may have the units.
        with_units = [
            f"{label} [{unit.strip('[]()')}]" if unit else label for label, unit in zip(header, below, strict=True)
        ]
        for labels in (with_units, [*header]):
            meanings = meanings_of(labels)
            if any(meaning and meaning.role in _SENSORS for meaning in meanings):
                return labels, meanings
        below = header
    return table.headers[0], meanings_of(table.headers[0])


def _rate_of(comments: Sequence[str]) -> float | None:
    """The rate of the samples that a comment states."""
    for line in comments:
        text = line.strip().lower()
        if len(text) < _LONGEST_COMMENT and re.search("hz|sps", text) and (match := _RATE_WORDS.fullmatch(text)):
            return float(match[1]) * (1000.0 if "khz" in text else 1.0)
    return None


def _from_npz(content: bytes, name: str, options: LogOptions, limits: Limits) -> _Content:
    arrays = read_npz_arrays(content, name, limits.unpacked_bytes)
    count_units, rate_hz = _scalars(arrays)
    meanings: dict[str, Meaning] = {}
    chosen = dict(options.arrays or {})
    for role, label in chosen.items():
        if label not in arrays or role not in ("gyro", "accelerometer", "time", "temperature"):
            raise InputError(
                name,
                f"arrays {role}={label!r}; roles are gyro, accelerometer, time, temperature, "
                f"arrays are {', '.join(sorted(arrays))}",
            )
        of_name = meaning_of(label)
        meanings[label] = Meaning(role, None, of_name.unit if of_name and of_name.role == role else None)
    for label in arrays:
        meaning = meaning_of(label)
        if meaning is not None and meaning.role not in chosen and arrays[label].ndim > 0:
            meanings[label] = meaning
    columns: list[_Column] = []
    for label, meaning in meanings.items():
        columns += _npz_columns(label, meaning, arrays[label], name, limits)
    if not any(column.meaning.role in _SENSORS for column in columns):
        columns += _six_columns(arrays, count_units)
    used = {column.label for column in columns}
    others = tuple(label for label, array in arrays.items() if array.size > 1 and label not in used)
    return _Content(columns, others, count_units, rate_hz, lambda row: f"sample {row}")


def _scalars(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, str], float | None]:
    """Units per count and the rate from an archive's scalar entries."""
    units: dict[str, str] = {}
    rate: float | None = None
    for label, array in arrays.items():
        if array.size != 1:
            continue
        value = float(array.reshape(()))
        if label.endswith("_per_count"):
            meaning = meaning_of(label.removesuffix("_per_count"))
            if meaning is not None and meaning.unit is not None:
                units[meaning.role] = f"{value!r} {meaning.unit}"
        elif label.lower() in ("fs", "rate", "rate_hz", "sample_rate", "frequency"):
            rate = value
        elif label.lower() in ("dt", "interval", "interval_s", "ts") and value > 0.0:
            rate = 1.0 / value
    return units, rate


def _npz_columns(label: str, meaning: Meaning, array: NDArray[Any], name: str, limits: Limits) -> list[_Column]:
    if array.ndim == 0 or not len(array):
        raise InputError(name, f"array {label!r}: holds no samples")
    if len(array) > limits.rows:
        raise InputError(name, f"array {label!r}: {len(array)} rows; at most {limits.rows}")
    if array.ndim == 1:
        return [_Column(label, meaning, array)]
    if meaning.role in _SENSORS and array.ndim == 2 and array.shape[1] == 3 and meaning.axis is None:
        return [_Column(label, Meaning(meaning.role, axis, meaning.unit), array[:, axis]) for axis in range(3)]
    raise InputError(name, f"array {label!r}: shape {array.shape}; one column, or three for a triad, is allowed")


def _six_columns(arrays: Mapping[str, NDArray[Any]], count_units: Mapping[str, str]) -> list[_Column]:
    """An array of six columns under a telling name is gyro x, y, z then accelerometer x, y, z."""
    for label, array in arrays.items():
        if label.lower() in _SIX_COLUMN_NAMES and array.ndim == 2 and array.shape[1] == 6:
            unit = "counts" if count_units else None
            return [_Column(label, Meaning(_SENSORS[i // 3], i % 3, unit), array[:, i]) for i in range(6)]
    return []


def _without_empty(content: _Content, name: str) -> tuple[_Content, list[str]]:
    """The content without columns that hold no number at all, and a note of those."""
    empty = [
        column.label
        for column in content.columns
        if np.isnan(column.values[:1]).all() and np.isnan(column.values).all()
    ]
    if not empty:
        return content, []
    columns = [column for column in content.columns if column.label not in empty]
    if content.of("gyro") + content.of("accelerometer") and not any(c.meaning.role in _SENSORS for c in columns):
        raise InputError(name, f"{', '.join(label[:40] for label in empty[:_MOST_NAMES])} hold no numbers.")
    return replace(content, columns=columns), [f"empty: {', '.join(empty)}"]


def _complete(content: _Content, options: LogOptions, name: str) -> None:
    """Refuse a log without sensors, rate or units, under all that is missing, and units of a sensor it has not."""
    first = {column.meaning.role: column for column in reversed(content.columns)}
    if not first.keys() & {*_SENSORS}:
        raise InputError(
            name,
            "No gyro or accelerometer columns are recognised: "
            "name them (gyro_x ... accelerometer_z) in `columns` or `arrays`",
        )
    for role in _SENSORS:
        if (given := options.unit(role)) and role not in first:
            raise InputError(f"{role}_unit", f"{given!r} is given, but the file has no {role}.", given)
    timed = "time" in first and len(first["time"].values) > 1
    stated = options.rate_hz is not None or content.rate_hz is not None
    missing = [] if timed or stated else ["rate"]
    missing += [f"{role}_unit" for role in _SENSORS if role in first and not _unit(role, content, options)]
    if missing:
        wanted = " or the ".join(key.replace("_", " ") for key in missing)
        examples = "; ".join(_EXAMPLES[key] for key in missing)
        raise InputError(", ".join(missing), f"The file does not give the {wanted}. Enter for example {examples}.")


def _unit(role: str, content: _Content, options: LogOptions) -> str | None:
    """Unit of a sensor: as given, else as the file states it."""
    of_column = content.of(role)[0].meaning.unit
    counted = of_column is None or of_column.lower() in COUNTS
    return options.unit(role) or (content.count_units.get(role) if counted else of_column)


def _clock(content: _Content, options: LogOptions, name: str, notes: list[str]) -> _Clock:
    """Stamps and rate of the rows. A rate that is given must agree with stamps; one in a comment yields to them."""
    _check_rate(options.rate_hz, name)
    candidates = [
        (_stamps(column, content, options, name), column)
        for column in _joined(content.of("time"))
        if len(column.values) > 1
    ]
    if not candidates:
        stated = options.rate_hz if options.rate_hz is not None else content.rate_hz
        _check_rate(stated, name)
        assert stated is not None  # `_complete` has seen to it
        notes.append(f"rate {stated:g} Hz as stated")
        return _Clock(stated)
    rates = [1.0 / sampling.interval_s for (_, sampling, _), _ in candidates]
    if max(rates) > (1.0 + RATE_TOLERANCE) * min(rates):
        each = ", ".join(
            f"{column.label!r} {rate:.5g} Hz" for rate, (_, column) in zip(rates, candidates, strict=True)
        )
        raise InputError(name, f"Several columns are times and disagree: {each}. Say which by `columns` or `arrays`.")
    (stamps, sampling, reading), column = min(candidates, key=lambda each: each[0][1].jitter_s)
    rate = 1.0 / sampling.interval_s
    _check_rate(rate, name)
    if options.rate_hz is not None and abs(rate / options.rate_hz - 1.0) > RATE_TOLERANCE:
        raise InputError(
            name,
            f"rate stated as {options.rate_hz:g} Hz, but {column.label!r} runs at {rate:.5g} Hz. Correct one.",
        )
    notes.append(f"rate {rate:.6g} Hz from {column.label}{reading}")
    if content.rate_hz is not None and abs(rate / content.rate_hz - 1.0) > RATE_TOLERANCE:
        notes.append(f"a comment in the file says {content.rate_hz:g} Hz, which its stamps contradict")
    if sampling.jitter_s > _JITTER * sampling.interval_s:
        notes.append(f"jitter of the stamps {1e3 * sampling.jitter_s:.2g} ms (1σ)")
    notes += [f"{other.label} not used" for _, other in candidates if other is not column]
    return _Clock(options.rate_hz if options.rate_hz is not None else rate, stamps, sampling)


def _joined(columns: list[_Column]) -> list[_Column]:
    """Time columns; two of them, whole seconds and the nanoseconds after them, as one."""
    by_factor = {scale_of("time", column.meaning.unit).factor: column for column in columns if column.meaning.unit}
    whole, part = by_factor.get(1.0), by_factor.get(1e-9)
    if whole is None or part is None or not np.nanmax(part.values) < 1e9:
        return columns
    seconds = _Column(f"{whole.label} and {part.label}", whole.meaning, whole.values + 1e-9 * part.values)
    return [seconds, *(column for column in columns if column not in (whole, part))]


def _stamps(column: _Column, content: _Content, options: LogOptions, name: str) -> tuple[Array, Sampling, str]:
    """Stamps of the rows [s], NaN where there is none; the sampling behind them; how their unit was read."""
    values = np.asarray(column.values, dtype=np.float64)
    known = np.flatnonzero(np.isfinite(values)) if not np.isfinite(values).all() else None
    stamped = values if known is None else values[known]

    def place(row: int) -> str:
        return content.place(row if known is None else int(known[row]))

    if len(stamped) < 2:
        raise InputError(name, f"{column.label!r} holds fewer than two times.")
    sampling = judge_stamps(stamped, name, place)
    unit, convention = column.meaning.unit, column.meaning.convention
    reading = f", in {unit} by convention ({convention})" if convention else ""
    if unit is None:
        unit = _time_unit(column.label, stamped, sampling.interval_s, options.rate_hz)
        reading = "" if unit == "s" else f", taken as {unit}"
    factor = scale_of("time", unit).factor
    in_seconds = replace(sampling, interval_s=sampling.interval_s * factor, jitter_s=sampling.jitter_s * factor)
    return values * factor, in_seconds, reading


def _time_unit(label: str, stamps: Array, interval: float, rate_hz: float | None) -> str:
    """The unit of stamps without one: what the given rate says, or the years since 1970, or else a likely rate.

    Raises InputError under "rate" where that leaves two.
    """
    factors = {unit: scale_of("time", unit).factor for unit in ("s", "ms", "us", "ns")}
    rates = {unit: 1.0 / (interval * factor) for unit, factor in factors.items()}
    if rate_hz is not None and (near := [unit for unit in rates if abs(rate_hz / rates[unit] - 1.0) < 0.05]):
        return near[0]
    for unit, factor in factors.items():
        if 1e9 < stamps[0] * factor < 4e9 and 0.1 <= rates[unit] <= 1e5:  # 2001 to 2096
            return unit
    whole = bool(np.all(stamps[:1000] == np.rint(stamps[:1000])))
    if not whole and 0.1 <= rates["s"] <= 1e5:
        return "s"
    likely = [unit for unit, rate in rates.items() if _LIKELY_RATES[0] <= rate <= _LIKELY_RATES[1]]
    if len(likely) == 1 and interval != 1.0:
        return likely[0]
    readings = " or ".join(f"{rates[unit]:g} Hz in {unit}" for unit in likely) or "no likely rate in s, ms, us or ns"
    raise InputError(
        "rate",
        f"{label!r} goes up by {interval:g} a sample, which is {readings}. Enter the rate, for example 100 Hz.",
    )


def _check_rate(rate_hz: float | None, name: str) -> None:
    low, high = _RATES
    if rate_hz is not None and not low <= rate_hz <= high:
        raise InputError(name, f"A rate of {rate_hz:g} Hz is not allowed. It must be {low:g} to {high:g} Hz.")


def _signal(role: str, content: _Content, options: LogOptions, clock: _Clock, name: str, notes: list[str]) -> _Signal:
    """A sensor in SI at its own rate, with breaks where samples are lost."""
    columns = _axes(role, content, name, notes)
    labels = ", ".join(column.label for column in columns)
    scale = scale_of(role, _unit(role, content, options) or "")
    signal = np.empty((len(columns[0].values), len(columns)))
    for axis, column in enumerate(columns):
        signal[:, axis] = column.values
    if clock.stamps is not None and len(clock.stamps) != len(signal):
        raise InputError(name, f"{len(clock.stamps)} times but {len(signal)} samples of {labels}")
    source = " .. ".join(dict.fromkeys((columns[0].label, columns[-1].label)))
    values = "increments per sample" if scale.per_sample else "rates"
    by = "" if options.unit(role) else columns[0].meaning.convention
    notes.append(f"{role} from {source}, {values} in {scale.symbol}" + (f" by convention ({by})" if by else ""))
    # Rows without a value or a time are lost samples.
    rows: Rows | None = None
    sampling, rate = clock.sampling, clock.rate_hz
    usable = ~np.isnan(signal).any(axis=1)
    if clock.stamps is not None:
        usable &= np.isfinite(clock.stamps)
    if not usable.all():
        rows = np.flatnonzero(usable)
        if len(rows) < 2:
            raise InputError(name, f"{labels}: fewer than two rows have a number and a time.")
        signal, of_rows = signal[rows], rows
        stamps = rows / rate if clock.stamps is None else clock.stamps[rows]
        sampling = judge_stamps(stamps, name, lambda row: content.place(int(of_rows[row])))
        if abs(sampling.interval_s * rate - 1.0) > RATE_TOLERANCE:
            rate = 1.0 / sampling.interval_s
            notes.append(f"{role} in every {clock.rate_hz / rate:.3g}th row or so, {rate:.6g} Hz")
    breaks = NO_BREAKS if sampling is None else sampling.breaks
    if held := held_values(signal, breaks):
        first, length = held
        notes.append(
            f"each value of {role} is held for {length:.4g} rows; analysed at its own {rate / length:.6g} Hz"
        )
        signal, rate, rows = signal[first], rate / length, first if rows is None else rows[first]
        breaks = np.unique(np.searchsorted(first, breaks))
    signal *= scale.factor * (rate if scale.per_sample else 1.0)
    _check_size(role, signal, rows, content, name)
    if sampling is not None and sampling.lost:
        longest = float(np.diff(np.concatenate([[0], breaks, [len(signal)]])).max()) / rate
        notes.append(
            f"{sampling.lost} samples lost, so read in {len(breaks) + 1} stretches, the longest of {longest:.3g} s"
        )
    return _Signal(signal, rate, breaks, rows)


def _axes(role: str, content: _Content, name: str, notes: list[str]) -> list[_Column]:
    """The columns of a sensor: x, y and z, or one axis alone."""
    columns = sorted(content.of(role), key=lambda column: column.meaning.axis or 0)
    axes = [column.meaning.axis for column in columns]
    labels = ", ".join(column.label for column in columns)
    if axes == [None]:
        notes.append(f"{role} {labels!r} names no axis; taken as x")
    elif None in axes or len(set(axes)) < len(axes):
        raise InputError(name, f"several or unclear {role} columns ({labels}); say which by `columns` or `arrays`")
    if len(axes) > 1 and axes != [0, 1, 2]:
        # Two of three are more often a name that was not understood than a sensor of two axes.
        raise InputError(name, f"{role} columns {labels}; x, y and z are needed, each once, or one of them alone")
    return columns


def _check_size(role: str, signal: Array, rows: Rows | None, content: _Content, name: str) -> None:
    if signal.min() >= -_LARGEST and signal.max() <= _LARGEST:
        return
    usable = np.abs(signal) <= _LARGEST
    bad = np.flatnonzero(~usable.all(axis=1))
    axis = int(np.flatnonzero(~usable[bad[0]])[0])
    what = f"larger than {_LARGEST:g} in SI units" if np.isfinite(signal[bad[0], axis]) else "not a finite number"
    row = int(bad[0]) if rows is None else int(rows[bad[0]])
    raise InputError(name, f"{content.place(row)}: {role}_{AXIS_LETTERS[axis]} is {what} ({len(bad)} such rows)")


def _temperature(content: _Content, signals: Mapping[str, _Signal], notes: list[str]) -> Array | None:
    """Temperature at the samples, where it has one for each of them and all sensors share them."""
    column = next(iter(content.of("temperature")), None)
    if column is None:
        return None
    values = np.asarray(column.values, dtype=np.float64)
    (first, *others) = signals.values()
    if first.rows is not None and len(first.rows) and first.rows[-1] < len(values):
        values = values[first.rows]
    if any(len(values) != len(signal.values) for signal in (first, *others)) or not np.isfinite(values).all():
        notes.append("temperature ignored: sampled differently from the sensors")
        return None
    return values

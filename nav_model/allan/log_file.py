"""Reads an inertial log (CSV or NPZ) into SI rates. Nothing in the file is executed; every error says what and
where."""

import hashlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.csv_table import read_csv_table
from nav_model.allan.imu_log import AXIS_LETTERS, ImuLog
from nav_model.allan.log_names import Meaning, meaning_of, scale_of
from nav_model.allan.noise_terms import FloatArray
from nav_model.base.errors import InputError
from nav_model.base.npz_arrays import read_npz_arrays
from nav_model.design.file import read_bytes

IGNORED = "-"
RATE_TOLERANCE = 0.01
_RATES = (1e-3, 1e7)  # Hz
_LARGEST = 1e9  # rad/s or m/s²: no sensor measures more, and its square would overflow
_GAP = 1.5
_EXAMPLES = {
    "rate": "100 Hz",
    "gyro_unit": "deg/s, rad/s, increments in rad, or 0.05 deg/s per count",
    "accelerometer_unit": "m/s2, g, increments in m/s, or 0.00333 g per count",
}
_SENSORS = ("gyro", "accelerometer")
_SIX_COLUMN_NAMES = ("counts", "imu", "data", "samples", "log")


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


@dataclass(frozen=True)
class _Column:
    label: str
    meaning: Meaning
    values: NDArray[Any]


@dataclass(frozen=True)
class _Found:
    """Columns of a file and what else it states: scales per count, rate, line of row 0."""

    columns: list[_Column]
    count_units: dict[str, str]
    rate_hz: float | None
    first_row: int
    row_word: str


def read_log(
    source: str | Path | bytes,
    options: LogOptions | None = None,
    file_name: str | None = None,
    limits: Limits | None = None,
) -> ImuLog:
    """Read a path or the bytes of a file into an ImuLog.

    The format is told by its first bytes (ZIP: NPZ; otherwise delimited text). Raises InputError under the
    name of the file, with row or array, what was found and what is allowed; under "rate", "gyro_unit" and
    "accelerometer_unit", or those of them together with commas, where the file does not say them.
    """
    options, limits = options or LogOptions(), limits or Limits()
    content, name = _content(source, file_name, limits)
    digest = hashlib.sha256(content).hexdigest()
    if content[:4] == b"PK\x03\x04":
        found = _from_npz(content, name, options, limits)
    else:
        found = _from_csv(content, name, options, limits)
    notes: list[str] = []
    _complete(found, options, name)
    rate_hz = _rate(found, options, name, notes)
    signals = {role: _signal(role, found, options, rate_hz, name, notes) for role in _SENSORS}
    temperature = next((c.values for c in found.columns if c.meaning.role == "temperature"), None)
    lengths = {role: len(signal) for role, signal in signals.items() if signal is not None}
    if len(set(lengths.values())) > 1:
        raise InputError(name, f"{lengths['gyro']} gyro but {lengths['accelerometer']} accelerometer samples")
    samples = next(iter(lengths.values()))
    if temperature is not None and len(temperature) != samples:
        temperature = None
        notes.append("temperature ignored: sampled differently from the sensors")
    return ImuLog(
        gyro=signals["gyro"],
        accelerometer=signals["accelerometer"],
        rate_hz=rate_hz,
        temperature_c=None if temperature is None else np.asarray(temperature, dtype=np.float64),
        file_name=name,
        sha256=digest,
        reading=tuple(notes),
        **{f"{role}_axis": _single_axis(role, found) for role in _SENSORS},
    )


def _content(source: str | Path | bytes, file_name: str | None, limits: Limits) -> tuple[bytes, str]:
    if isinstance(source, bytes):
        content, name = source, file_name or "upload"
    else:
        content, name = read_bytes(source, limits.file_bytes), file_name or Path(source).name
    if len(content) > limits.file_bytes:
        raise InputError(name, f"The file is larger than {limits.file_bytes / 1e6:.0f} MB. Cut the log.")
    if not content:
        raise InputError(name, "The file is empty.")
    return content, name


def _from_csv(content: bytes, name: str, options: LogOptions, limits: Limits) -> _Found:
    table = read_csv_table(io.BytesIO(content), name, limits.rows, limits.unpacked_bytes)
    width = table.data.shape[1]
    names = options.columns if options.columns is not None else table.names
    if names is None:
        raise InputError(
            name,
            f"No header names its {width} columns. Give `columns`, such as "
            "time,gyro_x,gyro_y,gyro_z,accelerometer_x,accelerometer_y,accelerometer_z",
        )
    if len(names) != width:
        raise InputError(name, f"{len(names)} column names are given, but the file has {width} columns.")
    columns = []
    for index, label in enumerate(names):
        meaning = None if label == IGNORED else meaning_of(label)
        if meaning is None and options.columns is not None and label != IGNORED:
            raise InputError(
                name,
                f"column name {label!r} is not understood; allowed: time, gyro_x .. gyro_z, "
                f"accelerometer_x .. accelerometer_z, temperature, {IGNORED}",
            )
        if meaning is not None:
            columns.append(_Column(label, meaning, table.data[:, index]))
    return _Found(columns, {}, table.rate_hz, table.first_line, "line")


def _from_npz(content: bytes, name: str, options: LogOptions, limits: Limits) -> _Found:
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
        stated = meaning_of(label)
        meanings[label] = Meaning(role, None, stated.unit if stated and stated.role == role else None)
    for label in arrays:
        meaning = meaning_of(label)
        if meaning is not None and meaning.role not in chosen and arrays[label].ndim > 0:
            meanings[label] = meaning
    columns: list[_Column] = []
    for label, meaning in meanings.items():
        columns += _npz_columns(label, meaning, arrays[label], name, limits)
    if not any(column.meaning.role in _SENSORS for column in columns):
        columns += _six_columns(arrays, count_units)
    return _Found(columns, count_units, rate_hz, 0, "sample")


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


def _signal(
    role: str, found: _Found, options: LogOptions, rate_hz: float, name: str, notes: list[str]
) -> FloatArray | None:
    columns = [column for column in found.columns if column.meaning.role == role]
    if not columns:
        return None
    axes = [column.meaning.axis for column in columns]
    labels = ", ".join(column.label for column in columns)
    single = len(columns) == 1
    if single and axes[0] is None:
        notes.append(f"{role} {labels!r} names no axis; taken as x")
    elif None in axes or len(set(axes)) < len(axes):
        raise InputError(name, f"several or unclear {role} columns ({labels}); say which by `columns` or `arrays`")
    columns.sort(key=lambda column: column.meaning.axis or 0)
    if not single and [column.meaning.axis for column in columns] != [0, 1, 2]:
        # Two of three are more often a name that was not understood than a sensor of two axes.
        raise InputError(name, f"{role} columns {labels}; x, y and z are needed, each once, or one of them alone")
    scale = scale_of(role, _unit(role, columns[0], found, options) or "")
    signal = np.empty((len(columns[0].values), len(columns)))
    for axis, column in enumerate(columns):
        if len(column.values) != len(signal):
            raise InputError(name, f"{column.label} has {len(column.values)} samples, {labels} differ in length")
        np.multiply(column.values, scale.factor * (rate_hz if scale.per_sample else 1.0), out=signal[:, axis])
    usable = np.abs(signal) <= _LARGEST
    bad = np.flatnonzero(~usable.all(axis=1))
    if len(bad):
        axis = int(np.flatnonzero(~usable[bad[0]])[0])
        what = f"larger than {_LARGEST:g} in SI units" if np.isfinite(signal[bad[0], axis]) else "not a finite number"
        raise InputError(
            name,
            f"{found.row_word} {found.first_row + bad[0]}: {role}_{AXIS_LETTERS[axis]} is {what} "
            f"({len(bad)} such rows)",
        )
    source = " .. ".join(dict.fromkeys((columns[0].label, columns[-1].label)))
    kind = "increments per sample" if scale.per_sample else "rates"
    notes.append(f"{role} from {source}, {kind} in {scale.symbol}")
    return signal


def _single_axis(role: str, found: _Found) -> int:
    """The axis of a single-axis sensor."""
    return next((column.meaning.axis or 0 for column in found.columns if column.meaning.role == role), 0)


def _unit(role: str, column: _Column, found: _Found, options: LogOptions) -> str | None:
    given = options.gyro_unit if role == "gyro" else options.accelerometer_unit
    stated = found.count_units.get(role) if column.meaning.unit in ("counts", "raw", None) else column.meaning.unit
    return given or stated


def _complete(found: _Found, options: LogOptions, name: str) -> None:
    """Refuse a log without sensors, rate or units, under all that is missing."""
    first = {column.meaning.role: column for column in reversed(found.columns)}
    if not first.keys() & {*_SENSORS}:
        raise InputError(
            name,
            "No gyro or accelerometer columns are recognised: "
            "name them (gyro_x ... accelerometer_z) in `columns` or `arrays`",
        )
    timed = "time" in first and len(first["time"].values) > 1
    stated = options.rate_hz is not None or found.rate_hz is not None
    missing = [] if timed or stated else ["rate"]
    missing += [f"{role}_unit" for role in _SENSORS if role in first and not _unit(role, first[role], found, options)]
    if missing:
        said = " or the ".join(key.replace("_", " ") for key in missing)
        examples = "; ".join(_EXAMPLES[key] for key in missing)
        raise InputError(", ".join(missing), f"The file does not give the {said}. Enter for example {examples}.")


def _rate(found: _Found, options: LogOptions, name: str, notes: list[str]) -> float:
    """The rate from the options, the file's comment or its time column, which must agree (RATE_TOLERANCE)."""
    stated = options.rate_hz if options.rate_hz is not None else found.rate_hz
    _check_rate(stated, name)
    times = [column for column in found.columns if column.meaning.role == "time"]
    if len(times) > 1:
        raise InputError(
            name,
            f"The file has several time columns ({', '.join(t.label for t in times)}). "
            "Say which by `columns` or `arrays`.",
        )
    if stated is not None and (not times or len(times[0].values) < 2):
        notes.append(f"rate {stated:g} Hz as stated")
        return stated
    measured = _rate_of_time(times[0], found, name, stated)
    _check_rate(measured, name)
    if stated is not None and abs(measured / stated - 1.0) > RATE_TOLERANCE:
        raise InputError(
            name,
            f"rate stated as {stated:g} Hz, but {times[0].label!r} runs at {measured:.5g} Hz. Correct one of them.",
        )
    notes.append(f"rate {measured:.6g} Hz from {times[0].label}")
    return stated if stated is not None else measured


def _check_rate(rate_hz: float | None, name: str) -> None:
    low, high = _RATES
    if rate_hz is not None and not low <= rate_hz <= high:
        raise InputError(name, f"A rate of {rate_hz:g} Hz is not allowed. It must be {low:g} to {high:g} Hz.")


def _rate_of_time(column: _Column, found: _Found, name: str, stated: float | None) -> float:
    time = np.asarray(column.values, dtype=np.float64)
    if not np.all(np.isfinite(time)):
        row = found.first_row + int(np.flatnonzero(~np.isfinite(time))[0])
        raise InputError(name, f"{found.row_word} {row}: the time is not a finite number")
    unit = column.meaning.unit
    step = np.diff(column.values).astype(np.float64)
    median = float(np.median(step))
    if unit is None and stated is not None and median > 0.0:
        unit = next(
            (u for u in ("s", "ms", "us", "ns") if abs(median * scale_of("time", u).factor * stated - 1) < 0.05),
            None,
        )
    factor = scale_of("time", unit or "s").factor
    if median <= 0.0 or np.any(step <= 0.0):
        row = found.first_row + int(np.argmin(step)) + 1
        raise InputError(
            name,
            f"{found.row_word} {row}: the time does not increase; "
            f"ignore its column with '{IGNORED}' and give the rate",
        )
    worst = int(np.argmax(step))
    if step[worst] > _GAP * median:
        gaps = int(np.count_nonzero(step > _GAP * median))
        raise InputError(
            name,
            f"{found.row_word} {found.first_row + worst + 1}: irregular rate, a step of {step[worst] * factor:.6g} s "
            f"where {median * factor:.6g} s is usual ({gaps} such); cut the log there",
        )
    rate = len(step) / (float(time[-1] - time[0]) * factor)
    if unit is None and not 0.1 <= rate <= 1e5:
        raise InputError(name, f"{column.label!r} read in seconds gives {rate:.3g} Hz; state its unit or the rate")
    return rate

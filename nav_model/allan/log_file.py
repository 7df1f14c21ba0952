"""Reads an inertial log (a text table or NPZ) into SI rates; every error says what and where."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nav_model.allan.imu_log import AXIS_LETTERS, NO_BREAKS, ImuLog
from nav_model.allan.log_content import Limits, LogColumn, LogContent, LogOptions, read_content
from nav_model.allan.log_names import SENSORS, scale_of
from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.base.sampling import Rows, held_values, judge_stamps
from nav_model.base.text.column_names import listed
from nav_model.design.file import read_bytes

RATE_TOLERANCE = 0.01
_RATES = (1e-3, 1e7)  # Hz
_SHORTEST = 1e-300  # s between stamps: some are closer than the inverse of any number
_LIKELY_RATES = (5.0, 2e4)  # Hz, of a log whose stamps have no unit
_LARGEST = 1e9  # rad/s or m/s²: no sensor measures more, and its square would overflow
_LEAST_FORCE = 0.5  # of gravity
_JITTER = 0.02  # of an interval; less is not worth a word
_SAME_TIME = 0.02  # of an interval
_MOST_ROWS = 16  # of one time; more are stamps in whole seconds
_USUAL_SHARE = 0.9
_EXAMPLES = {
    "rate": "100 Hz",
    "gyro_unit": "deg/s, rad/s, increments in rad, or 0.05 deg/s per count",
    "accelerometer_unit": "m/s2, g, increments in m/s, or 0.00333 g per count",
}


class _Clock(NamedTuple):
    """Rate of the rows, their breaks, samples lost and jitter; the stamps [s], NaN where a row has none, None where
    rows follow each other at a stated rate; the column, and how its unit was read; rows that share each stamp."""

    rate_hz: float
    breaks: Rows = NO_BREAKS
    lost: int = 0
    jitter_s: float = 0.0
    stamps: Array | None = None
    label: str = ""
    reading: str = ""
    rows: int = 1


class _Signal(NamedTuple):
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

    Parameters
    ----------
    source : str, Path or bytes
        Path, or content of the file.
    options : LogOptions, optional
        Statements of the user about rate, units and columns; without them the file says so, or is refused.
    file_name : str, optional
        Name for messages and results; that of the path by default.
    limits : Limits, optional
        Bounds of bytes and rows.

    Raises
    ------
    InputError
        Under the name of the file, with row or array, what was found and what is allowed; under "sensor", with the
        choices, where it has rows of several sensors and none is chosen; under "rate", "gyro_unit"
        and "accelerometer_unit", or those of them together with commas, where the file does not say them or has no
        such sensor.
    """
    options, limits = options or LogOptions(), limits or Limits()
    of_file = source if isinstance(source, bytes) else read_bytes(source, limits.file_bytes)
    name = file_name or ("upload" if isinstance(source, bytes) else Path(source).name)
    if len(of_file) > limits.file_bytes:
        raise InputError(name, f"The file is larger than {limits.file_bytes / 1e6:.0f} MB. Cut the log.")
    if not of_file:
        raise InputError(name, "The file is empty.")
    digest = hashlib.sha256(of_file).hexdigest()
    content = read_content(of_file, name, options, limits)
    del of_file
    notes: list[str] = []
    reader = _Reader(name, options, content, notes)
    reader.check_complete()
    signals = reader.signals()
    rate_hz = max(signal.rate_hz for signal in signals.values())
    notes += [content.choice] if content.choice else []
    if content.others:
        notes.append(f"not used: {listed(content.others)}")
    if content.cut:
        notes.append("the last line ends too early and is left out")
    return ImuLog(
        gyro=signals["gyro"].values if "gyro" in signals else None,
        accelerometer=signals["accelerometer"].values if "accelerometer" in signals else None,
        rate_hz=rate_hz,
        temperature_c=reader.temperature(signals),
        file_name=name,
        sha256=digest,
        reading=tuple(dict.fromkeys(notes)),
        rates={role: signal.rate_hz for role, signal in signals.items() if signal.rate_hz != rate_hz},
        breaks={role: signal.breaks for role, signal in signals.items() if len(signal.breaks)},
        rows_of_time=reader.rows_of_time,
        **{f"{role}_axis": content.of(role)[0].meaning.axis or 0 for role in signals},
    )


@dataclass
class _Reader:
    """One log: the name of its file, what the user states, what the file holds, how that is understood, and how many
    rows of the sensors share each time."""

    name: str
    options: LogOptions
    content: LogContent
    notes: list[str]
    rows_of_time: int = 1

    def refuse(self, reason: str) -> InputError:
        """The error for the file."""
        return InputError(self.name, reason)

    def check_complete(self) -> None:
        """Refuse a log without sensors, rate or units, under all that is missing; and units of no sensor in it."""
        content, options = self.content, self.options
        sensors = [role for role in SENSORS if content.of(role)]
        empty = listed([column.label for column in content.empty])
        if not sensors and any(column.meaning.role in SENSORS for column in content.empty):
            raise self.refuse(f"{empty} hold no numbers.")
        self.notes += [f"empty: {empty}"] if empty else []
        if not sensors:
            labels = listed([*content.others, *(column.label for column in content.columns)])
            advice = "name them (gyro_x ... accelerometer_z) in `columns` or `arrays`"
            raise self.refuse(f"No gyro or accelerometer columns are recognised among {labels}: {advice}")
        for role in SENSORS:
            if (given := options.unit(role)) and role not in sensors:
                raise InputError(f"{role}_unit", f"{given!r} is given, but the file has no {role}.", given)
        timed = any(len(column.values) > 1 for column in content.of("time"))
        missing = [] if timed or options.rate_hz is not None or content.rate_hz is not None else ["rate"]
        missing += [f"{role}_unit" for role in sensors if not content.unit(role, options)]
        if missing:
            wanted = " or the ".join(key.replace("_", " ") for key in missing)
            examples = "; ".join(_EXAMPLES[key] for key in missing)
            reason = f"The file does not give the {wanted}. Enter for example {examples}."
            raise InputError(", ".join(missing), reason)

    def clock(self) -> _Clock:
        """When the rows were. A rate that is given must agree with stamps; one in a comment yields to them."""
        given, commented = self.options.rate_hz, self.content.rate_hz
        clocks = [self.clock_of(column) for column in _joined(self.content.of("time")) if len(column.values) > 1]
        if not clocks:
            rate = given if given is not None else commented or 0.0
            self.notes.append(f"rate {rate:g} Hz as stated")
            return _Clock(rate)
        rates = [clock.rate_hz for clock in clocks]
        if max(rates) > (1.0 + RATE_TOLERANCE) * min(rates):
            each = ", ".join(f"{clock.label!r} {clock.rate_hz:.5g} Hz" for clock in clocks)
            raise self.refuse(f"Several columns are times and disagree: {each}. Say which by `columns` or `arrays`.")
        clock = min(clocks, key=lambda clock: clock.jitter_s)
        rate = clock.rate_hz
        if given is not None and abs(rate - given) > RATE_TOLERANCE * given:
            raise self.refuse(f"rate stated as {given:g} Hz, but {clock.label!r} runs at {rate:.5g} Hz. Correct one.")
        self.notes.append(f"rate {rate:.6g} Hz from {clock.label}{clock.reading}")
        if commented is not None and abs(rate - commented) > RATE_TOLERANCE * commented:
            self.notes.append(f"a comment in the file says {commented:g} Hz, which its stamps contradict")
        if clock.jitter_s > _JITTER / rate:
            self.notes.append(f"jitter of the stamps {1e3 * clock.jitter_s:.2g} ms (1σ)")
        self.notes += [f"{other.label} not used" for other in clocks if other is not clock]
        return clock if given is None else clock._replace(rate_hz=given)

    def clock_of(self, column: LogColumn) -> _Clock:
        """The clock that a column of times is."""
        values = np.asarray(column.values, dtype=np.float64)
        rows = np.flatnonzero(np.isfinite(values))
        if len(rows) < 2:
            raise self.refuse(f"{column.label!r} holds fewer than two times.")
        stamped = values if len(rows) == len(values) else values[rows]
        sampling = judge_stamps(stamped, self.name, lambda row: self.content.place(int(rows[row])))
        unit, convention = column.meaning.unit, column.meaning.convention
        reading = f", in {unit} by convention ({convention})" if convention else ""
        if unit is None:
            rate = self.options.rate_hz or self.content.rate_hz
            unit = _time_unit(column.label, stamped, sampling.interval_s, rate)
            reading = "" if unit == "s" else f", taken as {unit}"
        size = scale_of("time", unit).factor
        rate, jitter = 1.0 / max(sampling.interval_s * size, _SHORTEST), sampling.jitter_s * size
        rows_of_time = _rows_of_time(stamped)
        return _Clock(
            rate, sampling.breaks, sampling.lost, jitter, values * size, column.label, reading, rows_of_time
        )

    def signals(self) -> dict[str, _Signal]:
        """The sensors of the log."""
        content, clock, (low, high) = self.content, self.clock(), _RATES
        if not low <= clock.rate_hz <= high:
            raise self.refuse(f"A rate of {clock.rate_hz:g} Hz is not allowed. It must be {low:g} to {high:g} Hz.")
        lengths = {len(column.values) for role in SENSORS for column in content.of(role)}
        if len(lengths) > 1:
            samples = " and ".join(map(str, sorted(lengths)))
            raise self.refuse(f"The sensors have {samples} samples. Give all alike.")
        signals = {role: self.signal(role, clock) for role in SENSORS if content.of(role)}
        # Not where the rows of one time hold the same value, or one of the sensors each.
        if clock.rows > 1 and any(
            2.0 * signal.rate_hz > (2.0 - RATE_TOLERANCE) * clock.rate_hz for signal in signals.values()
        ):
            self.rows_of_time = clock.rows
            self.notes.append(f"each time is on {clock.rows} rows")
        if (alpha := signals.get("accelerometer")) and content.of("accelerometer")[0].label.startswith("alpha"):
            force = float(np.linalg.norm(alpha.values.mean(axis=0)))
            if force < _LEAST_FORCE * STANDARD_GRAVITY:
                self.notes.append(f"alpha not used: {force:.3g} m/s² on average is no specific force at rest")
                del signals["accelerometer"]
        return signals

    def signal(self, role: str, clock: _Clock) -> _Signal:
        """A sensor in SI at its own rate, with breaks where samples are lost."""
        columns, notes = self.axes(role), self.notes
        labels = ", ".join(column.label for column in columns)
        unit = self.content.unit(role, self.options) or ""
        scale = scale_of(role, unit)
        signal = np.stack([column.values for column in columns], axis=1, dtype=np.float64)
        if clock.stamps is not None and len(clock.stamps) != len(signal):
            raise self.refuse(f"{len(clock.stamps)} times but {len(signal)} samples of {labels}")
        # Rows without a value or a time are lost samples.
        usable = np.ones(len(signal), dtype=bool) if clock.stamps is None else np.isfinite(clock.stamps)
        for axis in signal.T:
            usable &= ~np.isnan(axis)
        source = " .. ".join(dict.fromkeys((columns[0].label, columns[-1].label)))
        values = "increments per sample" if scale.per_sample else "rates"
        by = "" if self.options.unit(role) else columns[0].meaning.convention
        notes.append(f"{role} from {source}, {values} in {unit.strip()}" + (f" by convention ({by})" if by else ""))
        rows: Rows | None = None
        rate, breaks, lost = clock.rate_hz, clock.breaks, clock.lost
        if not usable.all():
            rows = of_rows = np.flatnonzero(usable)
            if len(rows) < 2:
                raise self.refuse(f"{labels}: fewer than two rows have a number and a time.")
            signal = signal[rows]
            stamps = rows / rate if clock.stamps is None else clock.stamps[rows]
            sampling = judge_stamps(stamps, self.name, lambda row: self.content.place(int(of_rows[row])))
            breaks, lost = sampling.breaks, sampling.lost
            if abs(sampling.interval_s * rate - 1.0) > RATE_TOLERANCE:
                rate = 1.0 / sampling.interval_s
                notes.append(f"{role} in every {clock.rate_hz / rate:.3g}th row or so, {rate:.6g} Hz")
        if held := held_values(signal, breaks):
            first, length = held
            how = f"analysed at its own {rate / length:.6g} Hz"
            notes.append(f"each value of {role} is held for {length:.4g} rows; {how}")
            signal, rate, rows = signal[first], rate / length, first if rows is None else rows[first]
            breaks = np.unique(np.searchsorted(first, breaks))
        signal *= scale.factor * (rate if scale.per_sample else 1.0)
        self.check_size(role, signal, rows)
        if lost:
            longest = float(np.diff(np.concatenate([[0], breaks, [len(signal)]])).max()) / rate
            stretches = f"{len(breaks) + 1} stretches, the longest of {longest:.3g} s"
            notes.append(f"{lost} samples lost, so read in {stretches}")
        return _Signal(signal, rate, breaks, rows)

    def axes(self, role: str) -> list[LogColumn]:
        """The columns of a sensor: x, y and z, or one axis alone."""
        columns = sorted(self.content.of(role), key=lambda column: column.meaning.axis or 0)
        axes = [column.meaning.axis for column in columns]
        labels = ", ".join(column.label for column in columns)
        if axes == [None]:
            self.notes.append(f"{role} {labels!r} names no axis; taken as x")
        elif len(axes) > 1 and axes != [0, 1, 2]:
            # Two of three are more often a name that was not understood than a sensor of two axes.
            needed = "x, y and z are needed, each once, or one of them alone. Say which by `columns` or `arrays`"
            raise self.refuse(f"several or unclear {role} columns ({labels}); {needed}")
        return columns

    def check_size(self, role: str, signal: Array, rows: Rows | None) -> None:
        """Refuse what no sensor measures."""
        for letter, values in zip(AXIS_LETTERS, signal.T, strict=False):
            if (bad := np.flatnonzero(~(np.abs(values) <= _LARGEST))).size:
                finite = np.isfinite(values[bad[0]])
                what = f"larger than {_LARGEST:g} in SI units" if finite else "not a finite number"
                where = self.content.place(int(bad[0] if rows is None else rows[bad[0]]))
                raise self.refuse(f"{where}: {role}_{letter} is {what} ({len(bad)} such rows)")

    def temperature(self, signals: Mapping[str, _Signal]) -> Array | None:
        """Temperature at the samples, where it has one for each of them and all sensors share them."""
        if not (columns := self.content.of("temperature")):
            return None
        values, rows = np.asarray(columns[0].values, dtype=np.float64), next(iter(signals.values())).rows
        if rows is not None:
            values = values[rows[rows < len(values)]]
        if any(len(values) != len(signal.values) for signal in signals.values()) or not np.isfinite(values).all():
            self.notes.append("temperature ignored: sampled differently from the sensors")
            return None
        return values


def _joined(columns: list[LogColumn]) -> list[LogColumn]:
    """Time columns; two of them, whole seconds and the nanoseconds after them, as one."""
    by_size = {scale_of("time", column.meaning.unit).factor: column for column in columns if column.meaning.unit}
    whole, part = by_size.get(1.0), by_size.get(1e-9)
    if whole is None or part is None or not np.nanmax(part.values) < 1e9:
        return columns
    seconds = LogColumn(f"{whole.label} and {part.label}", whole.meaning, whole.values + 1e-9 * part.values)
    return [seconds, *(column for column in columns if column is not whole and column is not part)]


def _rows_of_time(stamps: Array) -> int:
    """Rows that share each stamp, or all but share it, where nearly all stamps are on the same number; else 1."""
    steps = np.diff(stamps)
    apart = steps > _SAME_TIME * (stamps[-1] - stamps[0]) / len(steps)
    runs = np.diff(np.flatnonzero(np.concatenate([[True], apart, [True]])))
    usual = int(np.median(runs))
    return usual if 1 < usual <= _MOST_ROWS and np.mean(runs == usual) > _USUAL_SHARE else 1


def _time_unit(label: str, stamps: Array, interval: float, rate_hz: float | None) -> str:
    """The unit of stamps without one: what the given rate says, or the years since 1970, or else a likely rate.

    Raises InputError under "rate" where that leaves two.
    """
    sizes = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
    rates = {unit: 1.0 / max(interval * size, _SHORTEST) for unit, size in sizes.items()}
    # Xsens counts tenths of a millisecond under the names with which Movella counts microseconds.
    counted = rates | {"0.1 ms": 10.0 * rates["ms"]}
    if rate_hz is not None and (near := [unit for unit in counted if abs(rate_hz / counted[unit] - 1.0) < 0.05]):
        return near[0]
    for unit, size in sizes.items():
        if 1e9 < stamps[0] * size < 4e9 and 0.1 <= rates[unit] <= 1e5:  # 2001 to 2096
            return unit
    whole = bool(np.all(stamps[:1000] == np.rint(stamps[:1000])))
    if not whole and 0.1 <= rates["s"] <= 1e5:
        return "s"
    likely = [unit for unit, rate in rates.items() if _LIKELY_RATES[0] <= rate <= _LIKELY_RATES[1]]
    if len(likely) == 1 and interval != 1.0:
        return likely[0]
    readings = " or ".join(f"{rates[unit]:g} Hz in {unit}" for unit in likely) or "no likely rate in s, ms, us or ns"
    reason = f"{label!r} goes up by {interval:g} a sample, which is {readings}. Enter the rate, for example 100 Hz."
    raise InputError("rate", reason)

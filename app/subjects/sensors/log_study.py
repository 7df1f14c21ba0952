"""Analysis of a log for the command and for the Sensors page, which runs it in a separate process."""

import re
from collections.abc import Callable
from pathlib import Path

from nav_model.allan.log_content import Limits, LogOptions
from nav_model.allan.log_file import read_log
from nav_model.allan.motion import BenchNoise, MotionAnalysis, analyse_motion
from nav_model.allan.result import LogAnalysis
from nav_model.allan.static_log import analyse_log
from nav_model.base.errors import InputError, quoted
from nav_model.design import Design
from nav_model.design.parts import quantity

Study = LogAnalysis | MotionAnalysis
Progress = Callable[[float, str], None]


def read_options(
    rate: float | None,
    gyro_unit: str | None,
    accelerometer_unit: str | None,
    columns: str | None,
    arrays: str | None,
    sensor: str | None,
) -> LogOptions:
    """Options as typed; empty means not said.

    Parameters
    ----------
    rate : float or None
        Samples per second.
    gyro_unit, accelerometer_unit : str or None
        Units of the values, of an increment or of a count.
    columns : str or None
        Columns of a table in order, ``a,b,c``.
    arrays : str or None
        Arrays of an NPZ archive, ``gyro=w,accelerometer=f``.
    sensor : str or None
        The one of several in a table.

    Raises
    ------
    InputError
        If `arrays` is not a list of assignments.
    """
    chosen = {}
    for part in (arrays or "").split(","):
        role, equals, name = part.partition("=")
        if part.strip() and not (equals and name.strip()):
            raise InputError("arrays", f"{quoted(part.strip())} is not an assignment such as gyro=w")
        if part.strip():
            chosen[role.strip()] = name.strip()
    names = [name.strip() for name in columns.split(",")] if columns and columns.strip() else None
    gyro, accelerometer, one = ((text or "").strip() or None for text in (gyro_unit, accelerometer_unit, sensor))
    return LogOptions(rate, gyro, accelerometer, names, chosen or None, one)


def read_bandwidth(text: str | None, design: Design | None) -> float | None:
    """Bandwidth [Hz] of a sensor's low pass as typed, a number being in Hz; where nothing is, that of a design.

    Raises
    ------
    InputError
        If it is not a frequency that a sensor may have.
    """
    text = (text or "").strip()
    if not text:
        return design.imu.bandwidth if design else None
    try:
        return quantity("imu.bandwidth").read(f"{text} Hz" if re.fullmatch(r"[-+\d.eE]+", text) else text).value
    except InputError as error:
        raise InputError("bandwidth", error.reason, text) from error


def study_log(
    source: str | Path | bytes,
    options: LogOptions | None = None,
    file_name: str | None = None,
    limits: Limits | None = None,
    bench: BenchNoise | None = None,
    bandwidth_hz: float | None = None,
    *,
    progress: Progress,
) -> Study:
    """Read a log and analyse it, with fractions from 0 to 1 and what is being done for `progress`.

    Without `bench` it was taken at rest and gives noise parameters; with `bench` it was taken in motion and gives
    the effective noise, against that. `bandwidth_hz` is that of a low pass inside the sensor, for a log at rest.

    Raises
    ------
    InputError
        Naming the file, and where in it, when it cannot be opened, read or analysed as asked.
    """
    progress(0.0, "reading")
    log = read_log(source, options, file_name, limits)
    try:
        if bench is not None:
            return analyse_motion(log, bench, progress=progress)
        return analyse_log(log, progress, bandwidth_hz)
    except InputError:
        raise
    except ValueError as error:  # of a step that knows no file, such as a log too short to fit
        raise InputError(log.file_name, str(error)) from error

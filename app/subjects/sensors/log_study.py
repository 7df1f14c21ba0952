"""Analysis of a log for the command line and the Sensors page: reading, analysis at rest or in motion, progress.

Everything here pickles, so that the page can run it in a separate process (`app.work.alone`).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nav_model.allan.log_file import Limits, LogOptions, read_log
from nav_model.allan.motion import BenchNoise, MotionAnalysis, analyse_motion, motion_to_json
from nav_model.allan.result import LogAnalysis, to_json
from nav_model.allan.static_log import analyse_log
from nav_model.base.errors import InputError

Study = LogAnalysis | MotionAnalysis
Progress = Callable[[float, str], None]

READING = "reading"


@dataclass(frozen=True)
class LogRequest:
    """A log and the options for its analysis.

    `motion` chooses effective noise in motion over noise parameters at rest, against `bench` (angle and
    velocity random walk, SI, None where not known).
    """

    source: str | Path | bytes
    file_name: str | None = None
    options: LogOptions = field(default_factory=LogOptions)
    limits: Limits = field(default_factory=Limits)
    motion: bool = False
    bench: BenchNoise = field(default_factory=BenchNoise)


def read_options(
    rate: float | None, gyro_unit: str | None, accelerometer_unit: str | None, columns: str | None, arrays: str | None
) -> LogOptions:
    """Options as typed; `columns` is ``a,b,c`` and `arrays` ``gyro=w,accelerometer=f``; empty means not said.

    Raises
    ------
    InputError
        If `arrays` is not a list of assignments.
    """
    chosen = {}
    for part in (arrays or "").split(","):
        role, equals, name = part.partition("=")
        if part.strip() and not (equals and name.strip()):
            raise InputError("arrays", f"{part.strip()!r} is not an assignment such as gyro=w")
        if part.strip():
            chosen[role.strip()] = name.strip()
    names = [name.strip() for name in columns.split(",")] if columns and columns.strip() else None
    return LogOptions(
        rate, (gyro_unit or "").strip() or None, (accelerometer_unit or "").strip() or None, names, chosen or None
    )


def study_log(request: LogRequest, progress: Progress) -> Study:
    """Read and analyse; `progress` receives fractions from 0 to 1 and what is being done.

    Raises
    ------
    InputError
        Naming the file, and where in it, when it cannot be opened, read or analysed as asked.
    """
    progress(0.0, READING)
    log = read_log(request.source, request.options, request.file_name, request.limits)
    try:
        if request.motion:
            return analyse_motion(log, request.bench, progress=progress)
        return analyse_log(log, progress=progress)
    except InputError:
        raise
    except ValueError as error:  # of a step that knows no file, such as a log too short to fit
        raise InputError(_name(request), str(error)) from error


def study_to_json(study: Study) -> dict[str, Any]:
    """The study as JSON-ready data (contract.md, `allan`)."""
    return motion_to_json(study) if isinstance(study, MotionAnalysis) else to_json(study)


def _name(request: LogRequest) -> str:
    return request.file_name or (Path(request.source).name if not isinstance(request.source, bytes) else "upload")

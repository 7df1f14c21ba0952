"""The command `allan`: noise parameters from a log."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from app.console.arguments import declare, put_json, read_design
from app.console.progress import show_progress
from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import declaration_of


def add_to(commands: Any) -> None:
    """Declare the command."""
    declare(commands, __file__, allan=_allan)


def _allan(options: argparse.Namespace) -> int:
    from app.report.supplier import acceptance_json
    from app.subjects.sensors.log_study import LogRequest, read_options, study_log, study_to_json
    from nav_model.allan.log_file import Limits
    from nav_model.allan.motion import BenchNoise
    from nav_model.allan.result import LogAnalysis
    from nav_model.explore.supplier import judge_log, required

    if not options.motion and (options.bench_arw or options.bench_vrw):
        options.parser.error("--bench-arw and --bench-vrw belong to --motion")
    if options.motion and options.against:
        options.parser.error("--against is of a log at rest, without --motion")
    design = read_design(options.against, ()) if options.against else None
    lines = required(design, "imu") if design else ()  # refused now, not after the log
    passes = True
    request = LogRequest(
        source=sys.stdin.buffer.read(Limits().file_bytes + 1) if options.log == "-" else options.log,
        file_name="standard input" if options.log == "-" else None,
        options=read_options(
            options.rate, options.gyro_unit, options.accelerometer_unit, options.columns, options.arrays
        ),
        motion=options.motion,
        bench=BenchNoise(
            _bench("--bench-arw", "imu.angle_random_walk", options.bench_arw),
            _bench("--bench-vrw", "imu.velocity_random_walk", options.bench_vrw),
        ),
    )

    def work() -> Any:
        nonlocal passes
        with show_progress() as progress:
            study = study_log(request, lambda share, what: progress(what, share))
        if design is None:
            return study_to_json(study)
        assert isinstance(study, LogAnalysis)
        judged = acceptance_json(design, judge_log(lines, study))
        passes = judged["passes"]
        return {**study_to_json(study), "acceptance": judged}

    return put_json(work, options.output) or int(not passes)


def _bench(option: str, key: str, text: str | None) -> float | None:
    if text is None:
        return None
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    try:
        return declaration.read(text).value
    except InputError as error:
        raise InputError(option, error.reason) from error

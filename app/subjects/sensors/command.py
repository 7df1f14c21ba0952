"""The command `allan`: noise parameters from a log."""

import argparse
import sys
from pathlib import Path
from typing import Any

from app.console.arguments import put_json, read_design
from app.console.progress import show_progress
from nav_model.base.errors import InputError
from nav_model.design.parts import quantity


def add_to(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "allan", help="get noise parameters or a vibration factor from a log (CSV or NPZ), as JSON"
    )
    parser.add_argument("log", metavar="LOG", help="a CSV or NPZ file, or - for stdin")
    parser.add_argument("--rate", type=float, metavar="HZ", help="samples per second, if not in the file")
    parser.add_argument("--gyro-unit", metavar="UNIT", help='"deg/s", increments "rad", or per count "0.05 deg/s"')
    parser.add_argument("--accelerometer-unit", metavar="UNIT", help='"m/s2", "g", "m/s", or "0.00333 g" per count')
    parser.add_argument("--columns", metavar="NAME,...", help="columns of a CSV in order; use - to skip one")
    parser.add_argument("--arrays", metavar="ROLE=NAME,...", help="arrays of an NPZ, e.g. gyro=w,accelerometer=f")
    parser.add_argument("--sensor", metavar="VALUE", help="the one of several in a table, as the column has it")
    parser.add_argument("--bandwidth", metavar="HZ", help="-3 dB of the sensor's own low pass; default: the design's")
    parser.add_argument("--motion", action="store_true", help="log recorded in motion: effective noise, no fit")
    parser.add_argument("--bench-arw", metavar="QUANTITY", help='angle random walk at rest, "0.1 °/√h"')
    parser.add_argument("--bench-vrw", metavar="QUANTITY", help='velocity random walk at rest, "0.03 m/s/√h"')
    parser.add_argument(
        "--against",
        metavar="DESIGN",
        help="judge a log at rest by what the design requires of its IMU; 1 if it fails",
    )
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="write the JSON to this file")
    parser.set_defaults(run=_allan, parser=parser)


def _allan(options: argparse.Namespace) -> int:
    from app.subjects.sensors.log_study import read_bandwidth, read_options, study_log
    from nav_model.allan.log_content import Limits
    from nav_model.allan.motion import BenchNoise, MotionAnalysis, motion_to_json
    from nav_model.allan.result import to_json
    from nav_model.explore.supplier import judge_log, required

    if not options.motion and (options.bench_arw or options.bench_vrw):
        options.parser.error("--bench-arw and --bench-vrw belong to --motion")
    if options.motion and options.against:
        options.parser.error("--against is of a log at rest, without --motion")
    if options.motion and options.bandwidth is not None:
        options.parser.error("--bandwidth is of a log at rest, without --motion")
    design = read_design(options.against, ()) if options.against else None
    bandwidth_hz = read_bandwidth(options.bandwidth, design)
    lines = required(design, "imu") if design else ()  # refused now, not after the log
    passes = True
    piped = options.log == "-"
    source = sys.stdin.buffer.read(Limits().file_bytes + 1) if piped else options.log
    log_options = read_options(
        options.rate, options.gyro_unit, options.accelerometer_unit, options.columns, options.arrays, options.sensor
    )
    bench = BenchNoise(
        _bench("--bench-arw", "imu.angle_random_walk", options.bench_arw),
        _bench("--bench-vrw", "imu.velocity_random_walk", options.bench_vrw),
    )

    def work() -> Any:
        nonlocal passes
        with show_progress() as progress:
            try:
                study = study_log(
                    source, log_options, "standard input" if piped else None, bench=bench if options.motion else None,
                    bandwidth_hz=bandwidth_hz,
                    progress=lambda share, what: progress(what, share),
                )  # fmt: skip
            except InputError as error:
                keys = error.key.split(", ")
                asked = (f"--{key.replace('_', '-')}" if hasattr(log_options, key) else key for key in keys)
                raise error.under(", ".join(asked)) from error
        if isinstance(study, MotionAnalysis):
            return motion_to_json(study)
        if design is None:
            return to_json(study)
        from app.report.supplier import acceptance_json  # as much to load as all the rest

        judged = acceptance_json(design, judge_log(lines, study))
        passes = judged["passes"]
        return {**to_json(study), "acceptance": judged}

    return put_json(work, options.output) or int(not passes)


def _bench(option: str, key: str, text: str | None) -> float | None:
    if text is None:
        return None
    try:
        value: float = quantity(key).read(text).value
        return value
    except InputError as error:
        raise InputError(option, error.reason) from error

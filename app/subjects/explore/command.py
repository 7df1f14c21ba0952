"""The commands `explore` and `sweep`: questions about many designs."""

import argparse
import os
from typing import Any

from app.console.arguments import design_arguments, paths_of, read_design


def add_to(commands: Any) -> None:
    """Declare the command."""
    _add_explore(commands)
    sweep = commands.add_parser("sweep", help="evaluate a grid of designs, by formula or by simulation, into a table")
    sweep.add_argument("file", metavar="FILE", help="sweep file (TOML): the design and what to vary")
    sweep.add_argument("-o", "--output", required=True, metavar="OUT", help="OUT.csv or OUT.parquet")
    cores = os.cpu_count() or 1
    sweep.add_argument("--workers", type=count, default=cores, help="local processes (default: all cores)")
    sweep.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers do the work")
    sweep.set_defaults(run=_sweep)


def _add_explore(commands: Any) -> None:
    explore = commands.add_parser("explore", help="questions about many designs, as JSON or CSV")
    questions = explore.add_subparsers(dest="question", required=True, metavar="QUESTION")
    helps = {
        "close": "find what must change: the smallest sets of levers with which the design closes",
        "solve": "find the largest noise, interval or time that meets the requirements",
        "rank": "list the inputs that a figure depends on, strongest first",
        "map": "compute a result over a grid of two inputs",
        "search": "list the IMUs and receivers of the catalogue that meet the requirements",
        "uncertainty": "compute the probability that the design closes when inputs are ranges",
        "invert": "find the IMU noise that rows of a vendor's table imply, or what contradicts what",
        "manoeuvre": "find the manoeuvre, aid or IMU with which the lines of a flight meet their limits",
    }
    parsers = {name: questions.add_parser(name, help=text) for name, text in helps.items()}
    for parser in parsers.values():
        design_arguments(parser, single=True)
        parser.add_argument("--csv", action="store_true", help="as CSV instead of JSON")
        parser.set_defaults(run=_explore)
    add = parsers["close"].add_argument
    add("--allow", type=names, default=(), metavar="GROUP,...", help="groups to allow too: flight, radar")
    add("--lock", type=names, default=(), metavar="NAME,...",
        help="what must stay: keys of inputs, or groups (processing, velocity, receiver, imu ...)")  # fmt: skip
    add("--at-most", type=int, default=3, metavar="N", help="levers of a set (default %(default)s)")
    add("--reserve", type=percent, default=0.0, metavar="PERCENT", help="margin to keep (default 0)")
    _sensor_files(parsers["close"])
    add = parsers["rank"].add_argument
    add("--result", metavar="FIGURE", help="figure to rank for (default: the design's first requirement)")
    add = parsers["map"].add_argument
    for axis, usual in (("x", "imu.angle_random_walk"), ("y", "gnss.position_noise")):
        add(f"--{axis}", default=usual, metavar="KEY", help=f"input on the {axis} axis (default %(default)s)")
    add("--result", default="all requirements", metavar="FIGURE", help="result to map (default %(default)s)")
    add("--size", type=count, metavar="N", help="points along a side (default 64)")
    _sensor_files(parsers["search"])
    add = parsers["search"].add_argument
    help_text = (
        "residual biases of every IMU: the design's (default), zero, or the in-run biases of its sheet; sheet: the "
        "design's, with all errors that each sheet prints"
    )
    add("--biases", choices=("design", "zero", "in-run", "sheet"), default="design", help=help_text)
    add = parsers["invert"].add_argument
    add("--row", action="append", default=[], dest="rows", metavar="ROW",
        help='e.g. "60 s: horizontal 0.10 m, vertical 0.07 m, velocity 0.015 m/s, roll and pitch 0.005°, heading '
        '0.010°" or "no outage: ..."; in real time, 1 sigma per axis; may be repeated')  # fmt: skip
    add = parsers["manoeuvre"].add_argument
    add("--line", default="", metavar="NAME", help="line to close (default: all that fail)")
    add = parsers["uncertainty"].add_argument
    add("--vary", action="append", default=[], metavar="KEY=RANGE",
        help='range of an input, e.g. imu.angle_random_walk="0.1 °/√h .. 0.2 °/√h" (uniform; with log after it, '
        'log-uniform) or "0.15 °/√h */ 1.3" (typical value and factor, log-normal); may be repeated')  # fmt: skip
    add("--seed", type=int, default=1, metavar="S", help="seed of the samples (default 1)")


def _sensor_files(parser: argparse.ArgumentParser) -> None:
    for name, what in (("imus", "IMUs"), ("receivers", "receivers")):
        also = ", a table of them as CSV, or kalibr's imu.yaml" if name == "imus" else ""
        help_text = f"catalogue file of your own {what}{also}; may be repeated"
        parser.add_argument(f"--{name}", action="append", default=[], metavar="FILE", help=help_text)


def names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def percent(text: str) -> float:
    return float(text.rstrip(" %")) / 100


def count(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 2000:
        raise ValueError(text)
    return number


def _explore(options: argparse.Namespace) -> int:
    (path,) = paths_of(options)
    from app.subjects.explore.console import explore

    return explore(read_design(path, options.changes), options)


def _sweep(options: argparse.Namespace) -> int:
    from app.subjects.explore.console import sweep

    return sweep(options)

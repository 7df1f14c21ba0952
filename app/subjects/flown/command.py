"""The command `flown`: did a flight meet the budget, by its solution and a second one, or by its claims."""

import argparse
import sys
from pathlib import Path
from typing import Any

from app.console.arguments import put_json, read_design
from app.console.progress import show_progress
from nav_model.base.errors import InputError

_EXIT = {"met": 0, "not met": 1}
_UNDECIDED = 5


def add_to(commands: Any) -> None:
    """Declare the command."""
    flown = commands.add_parser(
        "flown",
        help="hold a flown solution against the budget of a design",
        description="Holds the navigation solution of a flight against the design's budget along the same track: by "
        "its difference to a second solution, line by line and figure by figure, with the band in which the flight's "
        "sigma lies; without a second one, what the file claims stands beside the budget. Exit: 0 met, 1 not met, "
        "2 bad input, 5 open or cannot be told.",
    )
    add = flown.add_argument
    add("solution", nargs="+", metavar="SOLUTION",
        help="the solution: SBET with its smrmsg, RTKLIB .pos, NovAtel or NMEA text, ULog, or a table with named "
        "columns")  # fmt: skip
    add("--reference", nargs="+", metavar="FILE", default=[], help="a second solution of the flight")
    add("--relation", choices=("smoothed", "reverse", "independent"),
        help="how the reference belongs to the solution: the smoothed answer on the same data, the pass in the other "
        "direction, or another system (default: what the files tell)")  # fmt: skip
    add("--kind", choices=("real-time", "post-processed"), default="",
        help="what the solution is, where its file does not tell")  # fmt: skip
    add("--lag", choices=("keep", "remove"), default="remove", help="a lag of the clocks (default: remove)")
    add("--columns", metavar="NAME,...", default="",
        help="columns of a table without names, e.g. time,latitude,longitude,height; - skips one")  # fmt: skip
    add("--design", required=True, metavar="D", help="design file (TOML), or - for standard input")
    add("--set", dest="changes", action="extend", nargs="+", default=[], metavar="KEY=VALUE",
        help="override values of the design")  # fmt: skip
    add("-o", "--output", type=Path, metavar="FILE", help="FILE.json (default: standard output)")
    flown.set_defaults(run=_flown)


def _flown(options: argparse.Namespace) -> int:
    from app.document.flown import sentence
    from nav_model.flown.result import to_json
    from nav_model.flown.study import flown_study

    design = read_design(options.design, options.changes)
    solution = _read("SOLUTION", options.solution, options.columns)
    reference = _read("--reference", options.reference, options.columns) if options.reference else None
    with show_progress() as show:
        result = flown_study(
            design,
            solution,
            reference,
            relation=options.relation,
            kind=options.kind,
            remove_lag=options.lag == "remove",
            progress=show,
        )
    code = put_json(lambda: to_json(result), options.output)
    print(sentence(result), file=sys.stderr)
    return code or _EXIT.get(result.verdict, _UNDECIDED)


def _read(option: str, files: list[str], columns: str) -> Any:
    from nav_model.flown.files.reader import read_solution

    names = [name.strip() for name in columns.split(",")] if columns else ()
    try:
        return read_solution(files[0], files[1:], names)
    except OSError as error:
        raise InputError(option, f"{error.filename!r} cannot be read: {error.strerror}.") from error

"""The commands `explore` and `sweep`: questions about many designs."""

from __future__ import annotations

import argparse
import os
from typing import Any

from app.console.arguments import declare, paths_of, read_design


def add_to(commands: Any) -> None:
    """Declare the command."""
    explore = commands.add_parser("explore", help="questions about many designs, as JSON or CSV")
    questions = explore.add_subparsers(dest="question", required=True, metavar="QUESTION")
    declare(questions, __file__, **dict.fromkeys(("solve", "rank", "map", "search", "uncertainty"), _explore))
    sweep = declare(commands, __file__, sweep=_sweep)["sweep"]
    sweep.set_defaults(workers=os.cpu_count() or 1)


def _explore(options: argparse.Namespace) -> int:
    (path,) = paths_of(options)
    from app.subjects.explore.console import explore

    return explore(read_design(path, options.changes), options)


def _sweep(options: argparse.Namespace) -> int:
    from app.subjects.explore.console import sweep

    return sweep(options)

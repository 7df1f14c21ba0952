"""The command `navbudget`. Results go to standard output, messages to standard error.

Exit codes: 0 done (for ``check``: every design closes), 1 a design does not close, 2 bad input, 3 a fault of the
system, 4 a fault in NavBudget, 130 and 143 stopped (`app.console.ending`). Heavy modules are imported only by the
commands that need them.
"""

import argparse
import io
import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any, NoReturn

from app.console.ending import BAD_INPUT, run_to_end
from app.console.files import spare_what_is_read
from app.report import command as report
from app.serving import command as serve
from app.subjects import SUBJECTS


class _Parser(argparse.ArgumentParser):
    """A parser that reports a wrong command line in one line, like any other bad input."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, f"{self.prog}: {message}\n")

    def _print_message(self, message: str, file: Any = None) -> None:
        """As argparse, which takes help that nobody could read for done."""
        print(message, end="", file=file or sys.stderr, flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # units and names need it, whatever the locale says
        sys.stdout.reconfigure(encoding="utf-8")
    return run_to_end(lambda: _run(arguments))


def _run(arguments: Sequence[str] | None) -> int:
    options = _parser().parse_args(_with_values(sys.argv[1:] if arguments is None else arguments))
    spare_what_is_read(options)
    return int(options.run(options))


def _with_values(arguments: Sequence[str]) -> list[str]:
    """Arguments in which "--columns -,time" is one, since argparse takes what begins with - for an option.

    >>> _with_values(["allan", "--columns", "-,time", "-"])
    ['allan', '--columns=-,time', '-']
    """
    whole: list[str] = []
    for argument in arguments:
        if argument.startswith("-,") and whole and whole[-1].startswith("--"):
            whole[-1] += f"={argument}"
        else:
            whole.append(argument)
    return whole


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="navbudget", description="Navigation error budgets for airborne SAR.")
    parser.add_argument("--version", action="version", version=f"navbudget {version('navbudget')}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in (serve, report, *(subject.load("command") for subject in SUBJECTS if subject.command)):
        module.add_to(commands)
    return parser

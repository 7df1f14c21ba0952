"""`report`: designs, and studies of them, on paper."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments, paths_of, read_design


def add_to(commands: Any) -> None:
    """Declare the command."""
    report = commands.add_parser("report", help="write a design report")
    design_arguments(report, one=False)
    report.add_argument("-o", "--output", required=True, type=Path, metavar="FILE", help="FILE.html or FILE.pdf")
    _study_arguments(report)
    report.set_defaults(run=_report)


def _study_arguments(report: argparse.ArgumentParser) -> None:
    report.add_argument(
        "--with",
        dest="studies",
        default="",
        metavar="STUDY,...",
        help="run these and tell their results in each design's chapter: simulation, sar, suborbital",
    )
    add = report.add_argument_group("the studies of --with").add_argument
    add("--runs", type=int, metavar="N", help="of simulation and SAR (default 100 and 200)")
    add("--seed", type=int, default=1, metavar="S", help="of every study (default 1)")
    add("--trajectory", default="wandering", metavar="NAME-or-FILE", help="of the simulation, as in `simulate`")
    add("--duration", type=float, metavar="S",
        help="of a simulated run (default: 400 s with fixes, then the design's outage; or the file's)")  # fmt: skip
    add("--outage", dest="outages", action="append", default=[], metavar="START,STOP",
        help="of the simulation; may be repeated (default: the design's own, at the end)")  # fmt: skip
    add("--workers", type=int, metavar="W", help="processes of the simulation (default: all cores but one)")


def _report(options: argparse.Namespace) -> int:
    paths = paths_of(options)
    from app.report.console import write_report_with

    write_report_with([read_design(path, options.changes) for path in paths], options)
    print(f"wrote {options.output}", file=sys.stderr)
    return 0

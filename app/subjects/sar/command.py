"""`sar`: image quality for every way of navigating through the aperture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments, paths_of, put_json, read_design


def add_to(commands: Any) -> None:
    """Declare the command."""
    sar = commands.add_parser("sar", help="image quality for every way of navigating through the aperture, as JSON")
    design_arguments(sar, one=True)
    sar.add_argument("--runs", type=int, default=200, help="runs of the ensemble (default 200)")
    sar.add_argument("--seed", type=int, default=0, help="of the ensemble (default 0)")
    sar.add_argument(
        "--engine",
        choices=("fast", "simulator"),
        default="fast",
        help="per-axis error model, or full flights of the simulator with the error model beside them (default fast)",
    )
    sar.add_argument(
        "--workers", type=int, metavar="W", help="processes of the simulator (default: all cores but one)"
    )
    sar.add_argument("-o", "--output", type=Path, metavar="FILE", help="write there instead of standard output")
    sar.set_defaults(run=_sar)


def _sar(options: argparse.Namespace) -> int:
    (path,) = paths_of(options)
    from app.subjects.sar.console import sar

    return put_json(sar(read_design(path, options.changes), options), options.output)

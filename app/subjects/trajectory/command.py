"""The command `trajectory`: the covariance along a flight, real time and post-processed, by source."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments, paths_of, put_json, read_design
from app.console.flight import changes_of, flight_arguments, flight_study
from app.console.progress import show_progress

_DOES_NOT_CLOSE = 1


def add_to(commands: Any) -> None:
    """Declare the command."""
    trajectory = commands.add_parser(
        "trajectory",
        help="follow the covariance of a design along a flight, with the image figures of every line",
        description="Follows the error covariance of the design along a flight, real time and post-processed, with "
        "the share of every source: the limit of `simulate` for many runs. The flight is that of the design's "
        "section [trajectory], or of a file: plans are flown at the design's speed with coordinated turns, "
        "recordings as they were flown.",
    )
    design_arguments(trajectory, single=True)
    flight_arguments(trajectory, "plan")
    add = trajectory.add_argument
    add("-o", "--output", type=Path, metavar="FILE", help="FILE.json (default: standard output)")
    trajectory.set_defaults(run=_trajectory)


def _trajectory(options: argparse.Namespace) -> int:
    from nav_model.budget import analyse
    from nav_model.trajectory.covariance import covariance
    from nav_model.trajectory.design_study import PLAN, along_flight, covariance_specification
    from nav_model.trajectory.line_length import with_lengths
    from nav_model.trajectory.result import to_json
    from nav_model.trajectory.swath import with_swath
    from nav_model.trajectory.verdict import checks_of

    (path,) = paths_of(options)
    design = read_design(path, changes_of(options))
    study, flight = flight_study(design, options)
    lines = flight.lines if flight else ()
    # The design's own flight is that of its verdict; another is a study, which judges all that it knows.
    of_verdict = options.trajectory == PLAN and not options.outages
    if of_verdict and flight and options.duration is None and options.every is None:
        spec = along_flight(design, flight)
    else:
        spec = covariance_specification(design, study, lines, every=design.trajectory.planned or not of_verdict)
    result = covariance(spec)
    if options.trajectory == PLAN and options.duration is None:
        with show_progress() as show:
            for solve in (with_lengths, with_swath):
                result = solve(result, design, lambda share, what: show(what, share))
    budget = analyse(design)
    verdict = replace(budget, flight=checks_of(result, budget)).verdict
    return put_json(lambda: to_json(result, verdict), options.output) or (0 if verdict.closes else _DOES_NOT_CLOSE)

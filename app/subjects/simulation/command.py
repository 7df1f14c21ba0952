"""The command `simulate`: Monte Carlo of a design against the closed forms."""

import argparse
from pathlib import Path
from typing import Any

from app.console.arguments import design_arguments, paths_of, read_design
from app.console.flight import changes_of, flight_arguments


def add_to(commands: Any) -> None:
    """Declare the command."""
    simulate = commands.add_parser(
        "simulate",
        help="run a Monte Carlo of a design and compare it with the formulas",
        description="Runs a Monte Carlo of the design, a strapdown INS with a Kalman filter, and compares the errors "
        "with the filter covariance and the formulas. --set takes sensor errors, receiver and filter tuning too, "
        "e.g. --set gyro.bias_instability='25 °/h'.",
    )
    design_arguments(simulate, single=True)
    add = simulate.add_argument
    add("--inputs", action="store_true", help="list the inputs of sensors and filter beside noise, and stop")
    add("--runs", type=int, default=100, metavar="N", help="independent runs (default 100)")
    add("--seed", type=int, default=1, metavar="S", help="seed of every run (default 1)")
    flight_arguments(simulate, "wandering")
    add("--workers", type=int, metavar="W", help="processes (default: all cores but one)")
    add("--scheduler", metavar="ADDRESS", help="address of a Dask scheduler whose workers do the runs")
    add("-o", "--output", type=Path, metavar="FILE", help="FILE.json, .npz (every run) or .csv")
    simulate.set_defaults(run=_simulate)


def _simulate(options: argparse.Namespace) -> int:
    from app.subjects.simulation.console import list_inputs, simulate_design

    if options.inputs:
        return list_inputs()
    (path,) = paths_of(options)
    simulate_design(read_design(path, changes_of(options)), options)
    return 0

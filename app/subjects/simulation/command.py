"""The command `simulate`: Monte Carlo of a design against the closed forms."""

from __future__ import annotations

import argparse
from typing import Any

from app.console.arguments import declare, paths_of, read_design
from app.console.flight import flight_arguments


def add_to(commands: Any) -> None:
    """Declare the command."""
    simulate = declare(commands, __file__, simulate=_simulate)["simulate"]
    flight_arguments(simulate, "wandering")


def _simulate(options: argparse.Namespace) -> int:
    from app.subjects.simulation.console import list_inputs, simulate_design
    from nav_model.simulation.study_inputs import read_study_inputs, split_changes

    if options.inputs:
        return list_inputs()
    (path,) = paths_of(options)
    of_design, of_study = split_changes(options.changes)
    simulate_design(read_design(path, of_design), read_study_inputs(of_study), options)
    return 0

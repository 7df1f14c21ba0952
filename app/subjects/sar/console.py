"""`navbudget sar`: the strategies of a design as JSON, by either engine."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any

from nav_model.design import Design
from nav_model.errors import InputError
from nav_model.sar.agreement import LEAST_BESIDE
from nav_model.sar.design_study import SarStudy, chunks, design_study
from nav_model.sar.study_json import to_json


def sar(design: Design, options: argparse.Namespace) -> dict[str, Any]:
    """The study asked for; with the simulator the fast engine's stands beside it.

    Raises InputError naming the option or the key of the design.
    """
    if options.seed < 0:
        raise InputError("--seed", f"{options.seed} is not allowed; zero or a positive whole number")
    if options.workers is not None and options.workers < 1:
        raise InputError("--workers", f"{options.workers} is not allowed; 1 or more")
    try:
        chunks(options.runs)
    except InputError as error:
        raise error.under("--runs") from error
    if options.engine == "fast":
        return to_json(design_study(design, options.runs, options.seed))
    flown = _flown(design, options)
    return to_json(flown, design_study(design, max(options.runs, LEAST_BESIDE), options.seed))


def _flown(design: Design, options: argparse.Namespace) -> SarStudy:
    from app.subjects.simulation.console import show_progress
    from nav_model.simulation.monte_carlo import local_pool

    print("preparing; the first use on a machine compiles the simulator, half a minute", file=sys.stderr, flush=True)
    workers = options.workers or max(1, (os.cpu_count() or 2) - 1)
    try:
        with show_progress() as progress:
            if workers == 1:
                return design_study(design, options.runs, options.seed, progress, engine="simulator")
            with local_pool(workers) as pool:
                return design_study(design, options.runs, options.seed, progress, engine="simulator", pool=pool)
    except ArithmeticError as error:
        raise InputError("--engine", str(error)) from error

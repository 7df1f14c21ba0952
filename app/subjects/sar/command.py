"""The command `sar`: image quality of every navigation strategy, by either engine."""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.console.arguments import design_arguments, paths_of, put_json, read_design
from nav_model.base.errors import InputError

if TYPE_CHECKING:
    from nav_model.design import Design
    from nav_model.sar.design_study import SarStudy


def add_to(commands: Any) -> None:
    """Declare the command."""
    sar = commands.add_parser("sar", help="compute image quality for every navigation strategy, as JSON")
    design_arguments(sar, single=True)
    add = sar.add_argument
    add("--runs", type=int, default=200, help="runs of the ensemble (default 200)")
    add("--seed", type=int, default=0, help="seed of the ensemble (default 0)")
    add("--engine", choices=("fast", "simulator"), default="fast",
        help="per-axis error model, or full flights of the simulator, compared with the error model (default "
             "fast)")  # fmt: skip
    add("--workers", type=int, metavar="W", help="processes of the simulator (default: all cores but one)")
    add("-o", "--output", type=Path, metavar="FILE", help="write to this file instead of standard output")
    sar.set_defaults(run=_sar)


def _sar(options: argparse.Namespace) -> int:
    (path,) = paths_of(options)
    design = read_design(path, options.changes)
    return put_json(lambda: _study(design, options), options.output)


def _study(design: Design, options: argparse.Namespace) -> dict[str, Any]:
    """The study asked for as plain data; with the simulator the error model's study beside it."""
    from app.console.progress import COMPILES
    from nav_model.sar.agreement import LEAST_BESIDE
    from nav_model.sar.design_study import image_study
    from nav_model.sar.study_json import to_json
    from nav_model.simulation.monte_carlo import local_pool

    if options.workers is not None and options.workers < 1:
        raise InputError("--workers", f"{options.workers} is not allowed. Enter 1 or more.")
    if options.engine == "fast":
        return to_json(studied(design, options.runs, options.seed))
    print(COMPILES, file=sys.stderr, flush=True)
    workers = options.workers or max(1, (os.cpu_count() or 2) - 1)
    with nullcontext() if workers == 1 else local_pool(workers) as pool:
        flown = studied(design, options.runs, options.seed, engine="simulator", pool=pool)
    return to_json(flown, image_study(design, max(options.runs, LEAST_BESIDE), options.seed))


def studied(design: Design, runs: int, seed: int, what: str = "", **how: Any) -> SarStudy:
    """A study of so many runs, progress on standard error; ``how`` as `design_study` takes it.

    Raises
    ------
    InputError
        Naming the option or the key of the design that cannot be run.
    """
    from app.console.progress import count_runs
    from nav_model.sar.design_study import image_study

    if seed < 0:
        raise InputError("--seed", f"{seed} is not allowed. Enter zero or a positive whole number.")
    try:
        with count_runs(what) as progress:
            return image_study(design, runs, seed, progress, **how)
    except InputError as error:
        raise (error.under("--runs") if error.key == "runs" else error) from error
    except ArithmeticError as error:
        raise InputError("--engine", str(error)) from error

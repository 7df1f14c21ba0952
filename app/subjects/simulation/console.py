"""`navbudget simulate`: runs, progress on standard error, result in the requested file."""

import argparse
import os
import sys

from app.console.files import whole_file
from app.console.flight import flight_study
from app.console.progress import COMPILES, count_runs
from app.subjects.simulation.files import FILES, as_json
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import Accelerometer, Filter, Gyro
from nav_model.simulation.design_study import SimulationStudy, closed_form, study_of
from nav_model.simulation.specification import SimulationSpec

_LARGEST_KEPT = 4e9  # bytes: every run's errors are held in memory until they are written
_PER_SAMPLE = 130  # bytes that a process takes for each sample of the instruments


def list_inputs() -> int:
    """Print the inputs of sensors and filter beside noise, with default and help."""
    for part in (Gyro, Accelerometer, Filter):
        print(part.title)
        for name, declared in part.inputs().items():
            default = declared.show(declared.default) if isinstance(declared, BaseQuantity) else declared.default
            print(f"  {part.section}.{name:24} {default:12} {declared.label}. {declared.doc}")
    return 0


def simulate_design(design: Design, options: argparse.Namespace) -> None:
    """Fly a design's runs as the command line says and write the study.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be flown, or a file that cannot be written.
    """
    kind = _kind(options)
    spec = _specification(design, options, keep_runs=kind == ".npz")
    if options.output is None:
        sys.stdout.write(as_json(_run(design, spec, options)).decode())
        return
    with whole_file(options.output) as file:
        file.write(FILES[kind](_run(design, spec, options)))
    print(f"wrote {options.output}", file=sys.stderr)


def fly_design(design: Design, options: argparse.Namespace) -> SimulationStudy:
    """The study of a design alone with options as `navbudget simulate` has them, progress on standard error.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be flown.
    """
    return _run(design, _specification(design, options, keep_runs=False), options)


def _kind(options: argparse.Namespace) -> str:
    if options.output is None:
        return ".json"
    kind: str = options.output.suffix.lower()
    if kind not in FILES:
        raise InputError("-o", f"{str(options.output)!r} does not end in {', '.join(FILES)}")
    return kind


def _specification(design: Design, options: argparse.Namespace, keep_runs: bool) -> SimulationSpec:
    for name in ("workers", "runs"):
        value = getattr(options, name)
        if value is not None and value < 1:
            raise InputError(f"--{name}", f"{value} is not allowed. Enter 1 or more.")
    spec, _ = flight_study(design, options, runs=options.runs, seed=options.seed, keep_runs=keep_runs)
    size = spec.runs * (spec.duration / spec.every) * 8 * spec.filter.inertial
    if keep_runs and size > _LARGEST_KEPT:
        raise InputError(
            "-o", f"every run's errors would take {size / 1e9:.3g} GB; use fewer --runs or a longer --every"
        )
    return spec


def _check_memory(spec: SimulationSpec, workers: int) -> None:
    """Refuse a flight whose samples this machine cannot hold in so many processes and this one."""
    if not hasattr(os, "sysconf"):  # Windows
        return
    processes = 1 if workers == 1 else workers + 1
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    each = _PER_SAMPLE * spec.steps
    if each * processes > memory:
        longest = memory / (_PER_SAMPLE * processes * spec.imu.rate)
        raise InputError(
            "--duration",
            f"{spec.steps:,} IMU samples take {each / 1e9:.2g} GB a process, {processes} in all, and this machine "
            f"has {memory / 1e9:.2g} GB. Give at most {longest:.0f} s, or fewer --workers",
        )


def _run(design: Design, spec: SimulationSpec, options: argparse.Namespace) -> SimulationStudy:
    print(COMPILES, file=sys.stderr, flush=True)
    from nav_model.simulation.cluster import cluster_pool
    from nav_model.simulation.monte_carlo import chunks, simulate

    compare = closed_form(design, spec)
    with count_runs() as progress:
        try:
            if options.scheduler:
                with cluster_pool(options.scheduler) as (pool, threads):
                    result = simulate(spec, pool=pool, workers=threads, closed_form=compare, progress=progress)
            else:
                workers = options.workers or max(1, (os.cpu_count() or 2) - 1)
                workers = min(workers, len(chunks(spec)))
                _check_memory(spec, workers)
                result = simulate(spec, workers=workers, closed_form=compare, progress=progress)
        except InputError as error:
            raise (error if "." in error.key else error.under(f"--{error.key}")) from error
        except (ArithmeticError, ValueError) as error:
            raise InputError("simulate", str(error)) from error
    print(result.verdict, file=sys.stderr)
    return study_of(design, result)

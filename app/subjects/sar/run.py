"""Runs the strategies of a design in worker processes, for a `Run`."""

from dataclasses import dataclass
from functools import lru_cache

from app.charts.kinds import PictureChart
from app.work.pool import run_in_pool
from app.work.run import Run
from app.work.simulator import made_ready
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import decisive
from nav_model.design import Design
from nav_model.design.figures import DETRENDED, QUADRATIC
from nav_model.sar.agreement import LEAST_BESIDE
from nav_model.sar.design_case import DesignCase, Engine, design_case
from nav_model.sar.design_study import SarStudy, chunks, gather, run_chunk, typical_history, typical_place
from nav_model.sar.pictures import Pictures, point_pictures
from nav_model.sar.study import choose_tuning


@dataclass(frozen=True)
class SarResult:
    """A study, the case it was run for, and images of a point, also without an autofocus that has limits of its own;
    beside flights of the simulator the fast engine's
    study, and a phase history of the user's with its navigation error, if there is one."""

    case: DesignCase
    study: SarStudy
    points: Pictures
    unfocused: Pictures | None = None
    beside: SarStudy | None = None
    uploaded: PictureChart | None = None


@lru_cache(maxsize=8)
def subject(design: Design, engine: Engine) -> tuple[object, ...]:
    """All of a design that the runs follow from: case, processing, contributors to a phase, limits and confidence.

    Raises InputError as `design_case`.
    """
    budget = analyse(design)
    phases = QUADRATIC, DETRENDED
    parts = (budget.x.contributors.in_figures.get(phase) for phase in phases)
    limits = (decisive(design, phase) for phase in phases)
    return design_case(budget, engine), design.processing.mode, *parts, *limits


async def run_strategies(run: Run, budget: Budget, runs: int, seed: int, engine: Engine = "fast") -> SarResult:
    """Run every strategy; beside flights of the simulator the error model too, with its own runs.

    Raises
    ------
    InputError
        Naming the key of the design that cannot be run.
    ValueError
        For a number of runs that gives no band.
    ArithmeticError
        Where the filter of a flight does not hold.
    """
    if engine == "simulator":
        await made_ready(run)
    case, study = await _study(run, budget, runs, seed, engine)
    beside = None
    if engine == "simulator":
        _, beside = await _study(run, budget, max(runs, LEAST_BESIDE), seed, "fast", "error model: ")
    run.tell("Forming the images")
    points = await run_in_pool(point_pictures, budget, study.typical.residual)
    unfocused = None if case.focusing is None else await run_in_pool(point_pictures, budget, study.typical.line)
    return SarResult(case, study, points, unfocused, beside)


async def _study(
    run: Run, budget: Budget, runs: int, seed: int, engine: Engine, what: str = ""
) -> tuple[DesignCase, SarStudy]:
    sizes = chunks(runs, engine)
    case = design_case(budget, engine)
    run.tell(f"{what}0 of {runs} runs", 0.0)
    tuning = await run_in_pool(choose_tuning, case.models[1], case.aperture_time, seed)
    parts = []
    for index, size in enumerate(sizes):
        parts.append(await run_in_pool(run_chunk, case, tuning, seed, index, size))
        done = sum(sizes[: index + 1])
        run.tell(f"{what}{done} of {runs} runs", done / runs)
    history = await run_in_pool(typical_history, case, tuning, seed, *typical_place(parts))
    return case, gather(budget, case, tuning, seed, parts, history)

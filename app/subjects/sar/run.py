"""Runs the strategies of a design in worker processes, for a `Run`."""

from dataclasses import dataclass

from app.charts.kinds import PictureChart
from app.work.pool import run_in_pool
from app.work.run import Run
from app.work.simulator import made_ready
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.sar.agreement import LEAST_BESIDE
from nav_model.sar.design_case import DesignCase, Engine, design_case
from nav_model.sar.design_study import SarStudy, chunks, gather, run_chunk, typical_history, typical_place
from nav_model.sar.pictures import Pictures, point_pictures
from nav_model.sar.study import choose_tuning


@dataclass(frozen=True)
class SarResult:
    """A study, the case it was run for, and images of a point; beside flights of the simulator the fast engine's
    study, and a phase history of the user's with its navigation error, if there is one."""

    case: DesignCase
    study: SarStudy
    points: Pictures
    beside: SarStudy | None = None
    uploaded: PictureChart | None = None

    def stale(self, budget: Budget) -> bool:
        """Whether the ensemble no longer matches the design; a name or a requirement does not matter to it."""
        try:
            return design_case(budget, self.case.engine) != self.case
        except InputError:
            return True


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
    return SarResult(case, study, await run_in_pool(point_pictures, budget, study.typical), beside)


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

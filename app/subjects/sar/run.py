"""One person's run of the strategies: in worker processes, with progress, cancelled at once."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.charts.kinds import PictureChart
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.errors import InputError
from nav_model.sar.agreement import LEAST_BESIDE
from nav_model.sar.design_case import DesignCase, Engine, design_case
from nav_model.sar.design_study import SarStudy, chunks, gather, run_chunk, typical_history, typical_place
from nav_model.sar.pictures import Pictures, point_pictures, scene_pictures
from nav_model.sar.study import choose_tuning


@dataclass(frozen=True)
class SarResult:
    """A study, the case it was run for, and its pictures; beside flights of the simulator the fast engine's study,
    and a phase history of the user's with its navigation error, if there is one."""

    case: DesignCase
    study: SarStudy
    points: Pictures
    scene: Pictures
    beside: SarStudy | None = None
    uploaded: PictureChart | None = None

    def stale(self, budget: Budget) -> bool:
        """Whether the ensemble no longer matches the design; a name or a requirement does not matter to it."""
        try:
            return design_case(budget, self.case.engine) != self.case
        except InputError:
            return True


@dataclass(frozen=True)
class Progress:
    """Runs done of how many, and the seconds left (None: not known yet)."""

    done: int
    runs: int
    left: float | None


class SarRun:
    """Starts, cancels and reports; `told` is called with a Progress, a SarResult, or a message."""

    def __init__(self, told: Callable[[Progress | SarResult | str], Any]) -> None:
        self._told = told
        self._task: asyncio.Task[None] | None = None

    @property
    def running(self) -> bool:
        """Whether a run is under way."""
        return self._task is not None and not self._task.done()

    def start(self, budget: Budget, runs: int, seed: int, engine: Engine = "fast") -> None:
        """Start a run in the loop that is running; one under way is cancelled first."""
        self.cancel()
        self._task = asyncio.create_task(self._run(budget, runs, seed, engine))

    def cancel(self) -> None:
        """Stop at once; the piece a worker is busy with is dropped."""
        if self._task is not None:
            self._task.cancel()

    async def _run(self, budget: Budget, runs: int, seed: int, engine: Engine) -> None:
        try:
            self._told(await self._result(budget, runs, seed, engine))
        except asyncio.CancelledError:
            self._told("Cancelled.")
            raise
        except (InputError, ValueError, ArithmeticError) as error:
            self._told(f"Not run. {error}")
        except BrokenProcessPool:
            self._told("The worker process ended before its time; run again.")

    async def _result(self, budget: Budget, runs: int, seed: int, engine: Engine) -> SarResult:
        self._told(Progress(0, runs, None))
        case, study = await self._study(budget, runs, seed, engine)
        beside = None
        if engine == "simulator":
            _, beside = await self._study(budget, max(runs, LEAST_BESIDE), seed, "fast", quiet=True)
        points, scene = await elsewhere(pictures, budget, study.typical)
        return SarResult(case, study, points, scene, beside)

    async def _study(
        self, budget: Budget, runs: int, seed: int, engine: Engine, *, quiet: bool = False
    ) -> tuple[DesignCase, SarStudy]:
        sizes = chunks(runs, engine)
        case = design_case(budget, engine)
        tuning = await elsewhere(choose_tuning, case.models[1], case.aperture_time, seed)
        parts = []
        begun = time.monotonic()
        for index, size in enumerate(sizes):
            parts.append(await elsewhere(run_chunk, case, tuning, seed, index, size))
            done = sum(sizes[: index + 1])
            if not quiet:
                self._told(Progress(done, runs, (time.monotonic() - begun) * (runs - done) / done))
        history = await elsewhere(typical_history, case, tuning, seed, *typical_place(parts))
        return case, gather(budget, case, tuning, seed, parts, history)


def pictures(budget: Budget, residual: NDArray[np.float64]) -> tuple[Pictures, Pictures]:
    """Of the points and of the scene, with this residual; in a worker process."""
    return point_pictures(budget, residual), scene_pictures(budget, residual)

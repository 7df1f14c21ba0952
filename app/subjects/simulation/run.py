"""Runs a Monte Carlo of a design in worker processes, for a `Run`, with partial results."""

from __future__ import annotations

import asyncio
import copy
import time
from collections import deque
from dataclasses import dataclass, replace

from app.work.pool import run_in_pool, size
from app.work.run import Run
from app.work.simulator import made_ready
from nav_model.design import Design
from nav_model.design.parts import PRESET_KEYS
from nav_model.design.trajectory import AIDING
from nav_model.simulation.design_study import SimulationStudy, conclude
from nav_model.simulation.monte_carlo import chunks, run_chunk
from nav_model.simulation.single_run import POSTERIOR, fly_without_errors
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.statistics import Statistics

_AIDING = tuple(f"trajectory.{name}" for name in AIDING)
_LOOK_SECONDS = 2.0  # between results shown while runs are still flying


@dataclass(frozen=True)
class Flown:
    """A study of all the runs asked for (``wanted``) or of those flown so far."""

    study: SimulationStudy
    wanted: int

    @property
    def partial(self) -> bool:
        """True while runs are missing."""
        return self.study.result.spec.runs < self.wanted


async def fly(run: Run, design: Design, spec: SimulationSpec) -> Flown:
    """Fly `spec`; every few seconds `run` shows what the runs so far have found.

    Raises
    ------
    InputError
        Naming the key of the design, or the input, that cannot be flown.
    ArithmeticError
        Where the filter does not hold.
    """
    await made_ready(run)
    nominal = await run_in_pool(fly_without_errors, spec)  # compiles once more where nothing could be kept on disk
    scale = nominal.filter_sigma[POSTERIOR]
    total = Statistics.empty(scale)
    began = looked = time.monotonic()

    async def study(runs: Statistics) -> Flown:
        wall_s, so_far = time.monotonic() - began, replace(spec, runs=runs.runs)
        return Flown(await run_in_pool(conclude, design, so_far, runs, nominal, wall_s), spec.runs)

    flying: deque[asyncio.Task[Statistics]] = deque()
    looking: asyncio.Task[Flown] | None = None
    waiting = deque(chunks(spec))
    run.tell(f"0 of {spec.runs} runs", 0.0)
    try:
        while waiting or flying:
            # One chunk more than there are workers: they never wait, and another person's come in between.
            while waiting and len(flying) <= size():
                flying.append(asyncio.create_task(run_in_pool(run_chunk, spec, scale, *waiting.popleft())))
            total.merge(await flying[0])
            flying.popleft()
            run.tell(f"{total.runs} of {spec.runs} runs", total.runs / spec.runs)
            if looking is not None and looking.done():
                run.show(await looking)
                looking = None
            if flying and looking is None and time.monotonic() - looked > _LOOK_SECONDS:
                looked = time.monotonic()
                # A copy: merging replaces the sums of `total`, and the copy is sent off later.
                looking = asyncio.create_task(study(copy.copy(total)))
    except asyncio.CancelledError:
        if total.runs and run.mine:  # what was flown is not thrown away
            result = await study(total)
            if run.mine:
                run.show(result)
        raise
    finally:
        for task in (*flying, *([looking] if looking else [])):
            task.cancel()
    return await study(total)


def subject(design: Design, *, plan: bool) -> tuple[object, ...]:
    """All of a design that runs and formulas follow from: instruments, place, speed and aiding; of a ``plan`` all of
    the trajectory's inputs."""
    sections = ["imu", "gyro", "accelerometer", "gnss", "filter", "flight", *(["trajectory"] if plan else [])]
    return tuple(
        value
        for key, value in design.items()
        if key in _AIDING or (key.partition(".")[0] in sections and key not in PRESET_KEYS)
    )

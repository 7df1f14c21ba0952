"""One person's Monte Carlo: flown by the worker processes, followed as it goes, cancelled at once."""

from __future__ import annotations

import asyncio
import copy
import importlib
import multiprocessing
import time
from collections import deque
from collections.abc import Awaitable, Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from app.work.pool import elsewhere, size
from nav_model.design import Design
from nav_model.errors import InputError
from nav_model.simulation.design_study import SimulationStudy, conclude
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.warm import warm_up

_T = TypeVar("_T")
_LOOK_SECONDS = 2.0  # between results shown while runs are still flying
_TELL_SECONDS = 1.0  # between words about a compilation

_prepared: asyncio.Task[None] | None = None


def prepare() -> asyncio.Task[None]:
    """Have the simulator compiled, once per server: what the first run would otherwise wait for."""
    global _prepared
    loop = asyncio.get_running_loop()
    if _prepared is None or _prepared.get_loop() is not loop:
        _prepared = loop.create_task(_compile())
    return _prepared


async def _compile() -> None:
    """In a process of its own: the pool's are for people who wait. What goes wrong there the first run tells."""
    process = multiprocessing.get_context("spawn").Process(target=warm_up, daemon=True)
    process.start()
    await asyncio.to_thread(process.join)


@dataclass(frozen=True)
class Compiling:
    """The simulator and the flight are being made ready, for so many seconds now."""

    seconds: float


@dataclass(frozen=True)
class Progress:
    """Runs done of how many, and the seconds left (None: the first of them are flying)."""

    done: int
    runs: int
    left: float | None


@dataclass(frozen=True)
class Result:
    """A study of `design`, of all its runs or (``partial``) of those flown so far."""

    design: Design
    study: SimulationStudy
    partial: bool


News = Compiling | Progress | Result | str
"""What a run tells: how far it is, what it found, or in words why it ended without a result."""


class SimulationRun:
    """Starts, follows and cancels; `told` is called with all `News`, the last of them after `running` ended."""

    def __init__(self, told: Callable[[News], Any]) -> None:
        self._told = told
        self._task: asyncio.Task[None] | None = None
        self._done = 0

    @property
    def running(self) -> bool:
        """Whether runs are under way."""
        return self._task is not None

    def start(self, design: Design, spec: SimulationSpec) -> None:
        """Fly `spec` in the running event loop; does nothing while runs are under way."""
        if not self.running:
            self._done = 0
            self._task = asyncio.create_task(self._run(design, spec))

    def cancel(self) -> None:
        """Stop at once; the runs a worker is busy with end by themselves within a second and are dropped."""
        if self._task is not None:
            self._task.cancel()

    async def _run(self, design: Design, spec: SimulationSpec) -> None:
        try:
            last: News = Result(design, await self._fly(design, spec), partial=False)
        except asyncio.CancelledError:
            last = f"Cancelled after {self._done} of {spec.runs} runs."
        except (ValueError, ArithmeticError) as error:
            last = f"Not flown. {error}"
        except BrokenProcessPool:
            last = "Not flown. A worker process ended before its runs were done; start again."
        self._task = None
        self._told(last)

    async def _fly(self, design: Design, spec: SimulationSpec) -> SimulationStudy:
        pressed = time.monotonic()
        await self._patiently(prepare(), pressed)
        # Numba and the kernels' modules take a second to import: in a thread, so that others' sliders move on.
        single = await asyncio.to_thread(importlib.import_module, "nav_model.simulation.single_run")
        many = await asyncio.to_thread(importlib.import_module, "nav_model.simulation.monte_carlo")
        sums = importlib.import_module("nav_model.simulation.statistics")
        # Compiles once more where nothing could be kept on disk.
        nominal = await self._patiently(elsewhere(single.fly_without_errors, spec), pressed)
        self._told(Progress(0, spec.runs, None))
        scale = nominal.filter_sigma[single.POSTERIOR]
        total = sums.Statistics.empty(scale)
        began = looked = time.monotonic()
        flying: deque[asyncio.Task[Any]] = deque()
        looking: asyncio.Task[None] | None = None
        waiting = deque(many.chunks(spec))
        try:
            while waiting or flying:
                # One chunk more than there are workers: they never wait, and another person's come in between.
                while waiting and len(flying) <= size():
                    flying.append(asyncio.create_task(elsewhere(many.run_chunk, spec, scale, *waiting.popleft())))
                total.merge(await flying[0])
                flying.popleft()
                self._done = total.runs
                now = time.monotonic()
                self._told(Progress(total.runs, spec.runs, (now - began) * (spec.runs - total.runs) / total.runs))
                if flying and now - looked > _LOOK_SECONDS and (looking is None or looking.done()):
                    looked = now
                    # A copy: merging replaces the sums of `total`, and the copy is sent off later.
                    looking = asyncio.create_task(self._look(design, spec, copy.copy(total), nominal, now - began))
        finally:
            for task in (*flying, *([looking] if looking else [])):
                task.cancel()
        return await elsewhere(conclude, design, spec, total, nominal, time.monotonic() - began)

    async def _patiently(self, preparing: Awaitable[_T], began: float) -> _T:
        """What `preparing` gives, with word of how long it has been."""
        task = asyncio.ensure_future(preparing)
        try:
            while not task.done():
                self._told(Compiling(time.monotonic() - began))
                await asyncio.wait({task}, timeout=_TELL_SECONDS)
        except asyncio.CancelledError:
            if task is not _prepared:  # that one is everybody's
                task.cancel()
            raise
        return task.result()

    async def _look(self, design: Design, spec: SimulationSpec, total: Any, nominal: Any, wall_s: float) -> None:
        so_far = replace(spec, runs=total.runs)
        self._told(Result(design, await elsewhere(conclude, design, so_far, total, nominal, wall_s), partial=True))


def same_subject(one: Design, other: Design) -> bool:
    """Whether a study of one design holds for another: instruments and flight agree, whatever the rest."""
    return all(
        value == other[key]
        for key, value in one.items()
        if key.partition(".")[0] in {"imu", "gnss", "flight"} and not key.endswith(".preset")
    )


def outages_of(text: str) -> tuple[tuple[float, float], ...]:
    """Outages as people write them: ``200,300`` or ``100,150; 200,300``, seconds; none for an empty text.

    Raises
    ------
    InputError
        Under "outages".
    """
    try:
        pairs = [tuple(float(part) for part in piece.split(",")) for piece in text.split(";") if piece.strip()]
    except ValueError:
        pairs = [()]
    if any(len(pair) != 2 for pair in pairs):
        raise InputError("outages", f"{text[:60]!r} is not start,stop in seconds, such as 200,300 or 50,80; 200,300")
    return tuple((pair[0], pair[1]) for pair in pairs)

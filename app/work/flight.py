"""The covariance along the flight of a design, worked out in a worker process: once for the verdict and its page."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.work.cancellable import run_alone
from app.work.pool import run_in_pool
from app.work.result_cache import cached, keep
from app.work.run import Progress, Run
from nav_model.base.errors import InputError
from nav_model.base.units import clock, time_in_words
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.parts import Trajectory

if TYPE_CHECKING:
    from nav_model.explore.manoeuvre import Manoeuvres
    from nav_model.trajectory.plan import PlannedFlight
    from nav_model.trajectory.result import TrajectoryResult

_REST = 0.3  # seconds without a change until a design is flown
OF_DESIGN = "flight"
"""The kind of these results in the cache of the server (`app.work.result_cache`)."""
_MOST_STEPS = 30_000  # fixes
_MOST_WEIGHTS, _WEIGHTS_OF_A_FIX = 1_000_000, 20  # fixes of all apertures, with as many for each of the flight
_SHORT, _FEW = 1500, 100_000  # the same of a flight for the pool
_seconds_per_fix = 8e-4  # as measured on two shared cores; then that of the last long flight of this process


@dataclass(frozen=True)
class File:
    """A file with a flight, as the person calls it and on the disk of the server."""

    name: str
    path: Path


@dataclass(frozen=True, eq=False)
class Followed:
    """The covariance along the flight, the checks it makes in either processing, and its path [m] north and east of
    the start.

    file: that it is of; else empty. options: what would close it, once that is known.
    """

    design: Design
    result: TrajectoryResult
    checks: Mapping[str, tuple[Check, ...]]
    north: NDArray[np.float64]
    east: NDArray[np.float64]
    file: str = ""
    options: Manoeuvres | None = None

    @property
    def study(self) -> bool:
        """True for a flight that is not the design's."""
        return bool(self.file)

    @cached_property
    def budget(self) -> Budget:
        """The budget of the design with the checks of this flight."""
        return replace(analyse(self.design), flight=self.checks)

    @property
    def flight(self) -> str:
        """The flight in words."""
        study, lines = self.result.spec.study, len(self.result.spec.lines)
        plan: Any = Trajectory.param["flight"]
        what = f"the file {self.file}" if self.file else plan.options[self.design.trajectory.flight]
        gaps = ", ".join(f"{clock(start)} to {clock(stop)} min" for start, stop in study.outages)
        counted = f"{lines} line{'' if lines == 1 else 's'}, " if lines else ""
        text = f"Flight: {what}, {counted}{time_in_words(study.duration)}; outages: {gaps or 'none'}"
        return f"{text}; filter of {study.filter.states} states."

    def place(self, north: float, east: float) -> tuple[float, float]:
        """Latitude and longitude [rad] of a place north and east of the start [m]."""
        from nav_model.earth.wgs84 import metres_per_radian

        start = self.result.truth.position[0]
        to_north, to_east = metres_per_radian(start[0], start[2])
        return start[0] + north / to_north, start[1] + east / to_east


def follow(
    design: Design,
    file: File | None = None,
    lengths: bool = False,
    *,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> Followed:
    """Follow the covariance along the flight of the design's plan, or of a file; for a process of its own.

    Parameters
    ----------
    design : Design
    file : File, optional
        Flown in place of the plan.
    lengths : bool
        Solve how long each line of the plan may be, and its near and far range, which takes many flights.
    progress : callable
        Called with the share done, 0 where it is not known, and with what is being done.

    Raises
    ------
    InputError
        Naming the file, the input or the key of the design.
    """
    from nav_model.earth.wgs84 import metres_per_radian
    from nav_model.trajectory.covariance import covariance
    from nav_model.trajectory.design_study import along_flight, planned
    from nav_model.trajectory.line_length import with_lengths
    from nav_model.trajectory.swath import with_swath
    from nav_model.trajectory.verdict import checks_of

    global _seconds_per_fix
    flight = read_file(file, design) if file else planned(design)
    check_length(flight, design)
    fixes = flight.duration / design.gnss.interval
    progress(0.0, f"Following {fixes:.0f} fixes, about {max(fixes * _seconds_per_fix, 1.0):.0f} s")
    began = time.monotonic()
    result = covariance(along_flight(design, flight), _MOST_STEPS)
    if fixes > _SHORT:
        _seconds_per_fix = (time.monotonic() - began) / fixes
    if lengths and file is None:
        result = with_swath(with_lengths(result, design, progress), design, progress)
    checks = checks_of(result, analyse(design))
    position = result.truth.position
    north, east = metres_per_radian(position[0, 0], position[0, 2])
    return Followed(
        design,
        result,
        checks,
        north * (position[:, 0] - position[0, 0]),
        east * (np.unwrap(position[:, 1]) - position[0, 1]),
        file.name if file else "",
    )


def check_length(flight: PlannedFlight, design: Design, most: int = _MOST_STEPS) -> None:
    """Refuse a flight of more than `most` fixes, or whose apertures have too many, with an InputError."""
    from nav_model.budget.inputs import inputs_of

    reason = ""
    if flight.duration > most * design.gnss.interval:
        reason = f"{flight.duration:g} s have more than {most} fixes"
    elif (
        _weights(design, flight.duration) + _WEIGHTS_OF_A_FIX * flight.duration / design.gnss.interval > _MOST_WEIGHTS
    ):
        reason = f"{flight.duration:g} s have too many fixes for an aperture of {inputs_of(design).aperture:.3g} s"
    if reason:
        raise InputError("Flight", f"{reason}: too long for this page; use the command `navbudget trajectory`")


def _weights(design: Design, duration: float) -> float:
    """Fixes of the apertures of all results along a flight."""
    from nav_model.budget.inputs import inputs_of
    from nav_model.trajectory.design_study import MOST_RESULTS

    return float(inputs_of(design).aperture) / design.gnss.interval * min(duration, MOST_RESULTS)


def read_file(file: File, design: Design) -> PlannedFlight:
    """The flight of a file, flown as the design flies its plan."""
    from nav_model.trajectory.design_study import plan_like
    from nav_model.trajectory.files.reader import parse_file

    heights = design.flight.altitude, design.trajectory.ground or None
    return parse_file(file.path.read_bytes(), file.name, *heights).flown(plan_like(design))


def follow_if_short(design: Design) -> Followed | None:
    """`follow` of a flight of few enough fixes and short apertures for the pool, whose processes are not
    ended; None of a longer one.

    Raises InputError as `follow`.
    """
    from nav_model.trajectory.design_study import planned

    duration = planned(design).duration
    short = duration <= _SHORT * design.gnss.interval and _weights(design, duration) <= _FEW
    return follow(design) if short else None


async def followed(
    design: Design,
    file: File | None = None,
    lengths: bool = False,
    *,
    progress: Callable[[float, str], None],
) -> Followed:
    """`follow` in a worker: a short flight in the pool, a long one in a process that ends when this is cancelled.

    Parameters and errors as `follow`.
    """
    # Imports Numba, which takes a second: in a thread, so that others' sliders move on.
    await asyncio.to_thread(import_module, "nav_model.trajectory.lines")
    flown: Followed | None = None
    if file is None and not lengths:
        # A short flight is not worth a process that ends with the next step of a slider.
        flown = await run_in_pool(follow_if_short, design)
    if flown is None:
        flown = await run_alone(follow, design, file, lengths, progress=progress)
    return flown


class DesignFlight:
    """The flight of a session's design: followed once, whoever asks for it, and dropped when the design changes.

    ``run`` has the last result, the progress, and the message of a flight that ended without a result.
    """

    def __init__(self) -> None:
        self.run = Run()
        self._design: Design | None = None  # of the run under way, or the last
        self._due: asyncio.TimerHandle | None = None

    def known(self, design: Design) -> Followed | None:
        """The last result, if it is of this design."""
        last: Followed | None = self.run.result
        return last if last is not None and last.design == design else None

    @property
    def _refused(self) -> bool:
        """True where the last run has found why its design cannot be flown."""
        return bool(self.run.message) and not self.run.cancelled

    def rest(self, design: Design) -> None:
        """Fly a design once no other has come for a while; in a script, where no loop runs, not at all."""
        self.drop()
        with suppress(RuntimeError):
            self._due = asyncio.get_running_loop().call_later(_REST, self.begin, design)

    def drop(self) -> None:
        """Forget what is due, and end what is under way."""
        if self._due is not None:
            self._due.cancel()
            self._due = None
        if self.run.running:
            self.run.drop()
            self.run.param.update(running=False, progress=None)

    def begin(self, design: Design) -> None:
        """Fly a design now, unless the server has its flight, or it is under way."""
        if self._design == design and (self.run.running or self.known(design) or self._refused):
            return
        self.drop()
        self._design, key = design, design.content_hash
        if (flown := cached(OF_DESIGN, key)) is not None:
            self.run.take(flown)
            return

        async def work(run: Run) -> Followed:
            flown = await followed(design, progress=lambda share, what: run.tell(what, share or None))
            keep(flown, OF_DESIGN, key)
            return flown

        self.run.start(work)

    async def of(self, design: Design, tell: Callable[[Progress | None], object]) -> Followed:
        """The flight of a design, whoever has asked for it first; `tell` is called with its progress.

        Raises
        ------
        ValueError
            With the message of a flight that ended without a result.
        """
        if (flown := self.known(design)) is not None:
            return flown
        ended = asyncio.Event()

        def look(event: Any) -> None:
            if not event.new:
                ended.set()

        watchers = (
            self.run.param.watch(look, "running"),
            self.run.param.watch(lambda event: tell(event.new), "progress"),
        )
        try:
            self.begin(design)
            if self.run.running:
                await ended.wait()
        finally:
            for watcher in watchers:
                self.run.param.unwatch(watcher)
        if self._design != design or not (self.run.message or self.known(design)):
            raise asyncio.CancelledError  # another has taken its place
        if (flown := self.known(design)) is None:
            raise ValueError(self.run.message)
        return flown

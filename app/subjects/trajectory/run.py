"""What the page follows: the flight of a design, worked out in a worker process."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.parts import Trajectory
from nav_model.design.trajectory import Rows

if TYPE_CHECKING:
    from nav_model.budget.verdict import Check, Verdict
    from nav_model.trajectory.manoeuvre import Manoeuvres
    from nav_model.trajectory.plan import PlannedFlight
    from nav_model.trajectory.result import TrajectoryResult

_MOST_STEPS = 30_000  # seconds of work, and memory, of one person
_SHORT = 1500  # fixes
_seconds_per_fix = 8e-4  # as measured on two shared cores; then that of the last long flight of this process


@dataclass(frozen=True)
class File:
    """A file with a flight, as the person calls it and on the disk of the server."""

    name: str
    path: Path


@dataclass(frozen=True, eq=False)
class Followed:
    """The covariance along the flight, its path [m] north and east of the start, its checks by processing, the
    design's verdict with them, the file it is of, if any, and what would close it, once that is known."""

    design: Design
    result: TrajectoryResult
    north: NDArray[np.float64]
    east: NDArray[np.float64]
    checks: Mapping[str, tuple[Check, ...]]
    verdict: Verdict
    file: str = ""
    options: Manoeuvres | None = None

    @property
    def flight(self) -> str:
        """The flight in words."""
        study, lines = self.result.spec.study, len(self.result.spec.lines)
        plan: Any = Trajectory.param["flight"]
        what = f"the file {self.file}" if self.file else plan.options[self.design.trajectory.flight]
        gaps = ", ".join(f"{start:g} s to {stop:g} s" for start, stop in study.outages)
        counted = f"{lines} line{'' if lines == 1 else 's'}, " if lines else ""
        text = f"Flight: {what}, {counted}{study.duration:.0f} s; outages: {gaps or 'none'}"
        return f"{text}; filter of {study.filter.states} states."

    def place(self, north: float, east: float) -> tuple[float, float]:
        """Latitude and longitude [rad] of a place north and east of the start [m]."""
        from nav_model.earth.wgs84 import metres_per_radian

        start = self.result.truth.position[0]
        to_north, to_east = metres_per_radian(start[0], start[2])
        return start[0] + north / to_north, start[1] + east / to_east


def follow(
    design: Design,
    states: int = 0,
    file: File | None = None,
    lengths: bool = False,
    *,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> Followed:
    """Follow the covariance along the flight of the design's plan, or of a file; for a process of its own.

    lengths: solve how long each line of the plan may be, and its near and far range, which takes many flights.

    Raises
    ------
    InputError
        Naming the file, the input or the key of the design.
    """
    from nav_model.budget import analyse
    from nav_model.earth.wgs84 import metres_per_radian
    from nav_model.trajectory.covariance import covariance
    from nav_model.trajectory.design_study import along_flight, planned
    from nav_model.trajectory.line_length import with_lengths
    from nav_model.trajectory.swath import with_swath
    from nav_model.trajectory.verdict import checks_of

    global _seconds_per_fix
    flight = _read(file, design) if file else planned(design)
    if flight.duration > _MOST_STEPS * design.gnss.interval:
        message = f"{flight.duration:g} s have more than {_MOST_STEPS} fixes: too long for this page; "
        raise InputError("Flight", message + "use the command `navbudget trajectory`")
    fixes = flight.duration / design.gnss.interval
    progress(0.0, f"Following {fixes:.0f} fixes, about {max(fixes * _seconds_per_fix, 1.0):.0f} s")
    began = time.monotonic()
    result = covariance(along_flight(design, flight, states), _MOST_STEPS)
    if fixes > _SHORT:
        _seconds_per_fix = (time.monotonic() - began) / fixes
    if lengths and file is None:
        result = with_swath(with_lengths(result, design, progress), design, progress)
    budget = analyse(design)
    checks = checks_of(result, budget)
    position = result.truth.position
    north, east = metres_per_radian(position[0, 0], position[0, 2])
    return Followed(
        design,
        result,
        north * (position[:, 0] - position[0, 0]),
        east * (np.unwrap(position[:, 1]) - position[0, 1]),
        checks,
        replace(budget, flight=checks).verdict,
        file.name if file else "",
    )


def _read(file: File, design: Design) -> PlannedFlight:
    """What is flown of a file."""
    from nav_model.trajectory.design_study import plan_like
    from nav_model.trajectory.files.reader import parse_file

    heights = design.flight.altitude, design.trajectory.ground or None
    return parse_file(file.path.read_bytes(), file.name, *heights).flown(plan_like(design))


def follow_if_short(design: Design, states: int) -> Followed | None:
    """`follow` of a flight of few enough fixes for the pool, whose processes are not ended; None of a longer one.

    Raises InputError as `follow`.
    """
    from nav_model.trajectory.design_study import planned

    return follow(design, states) if planned(design).duration <= _SHORT * design.gnss.interval else None


async def follow_ahead(design: Design) -> None:
    """Have what following a flight loads, here and in a process of the pool."""
    await asyncio.to_thread(import_module, "nav_model.trajectory.lines")
    with suppress(InputError):  # whoever asks is told
        await run_in_pool(follow_if_short, design, 0)


def closing_options(
    design: Design, states: int = 0, file: File | None = None, *, progress: Callable[[float, str], None]
) -> Manoeuvres:
    """Options that would close the flight of a design's plan, or of a file; for a process of its own.

    Raises InputError as `follow` and `manoeuvres`.
    """
    from nav_model.trajectory.manoeuvre import manoeuvres

    return manoeuvres(design, states=states, progress=progress, flight=_read(file, design) if file else None)


def waypoints_in(content: bytes, name: str, design: Design) -> tuple[Rows, str]:
    """The waypoints of a plan, none of a recording, and what was read of the file.

    Places without a height are at the design's altitude; heights above the ground are above its ground, unless that
    is 0.

    Raises
    ------
    InputError
        Naming the file, with what is wrong and where.
    """
    from nav_model.trajectory.design_study import rows_of
    from nav_model.trajectory.files.reader import parse_file

    file = parse_file(content, name, design.flight.altitude, design.trajectory.ground or None)
    return rows_of(file.waypoints), file.note


def waypoints_of_lines(design: Design) -> Rows:
    """The parallel lines of a design as waypoints."""
    from nav_model.trajectory.design_study import lines_of, rows_of

    return rows_of(lines_of(design).waypoints)

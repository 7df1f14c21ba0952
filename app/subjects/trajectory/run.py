"""Further answers of the page about a flight beside its covariance, worked out in a worker process."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING

from app.work.flight import File, check_length, follow_if_short, read_file
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.trajectory import Rows

if TYPE_CHECKING:
    from nav_model.explore.manoeuvre import Manoeuvres

_MOST_FOR_OPTIONS = 15_000  # fixes of a flight that is flown some thirty times


async def follow_ahead(design: Design) -> None:
    """Have what following a flight loads, here and in a process of the pool."""
    await asyncio.to_thread(import_module, "nav_model.trajectory.lines")
    with suppress(InputError):  # whoever asks is told
        await run_in_pool(follow_if_short, design)


def closing_options(
    design: Design, file: File | None = None, *, progress: Callable[[float, str], None]
) -> Manoeuvres:
    """Options that would close the flight of a design's plan, or of a file; for a process of its own.

    Raises InputError as `follow` and `manoeuvres`, and for a flight too long to be flown for each option.
    """
    from nav_model.explore.manoeuvre import manoeuvres
    from nav_model.trajectory.design_study import planned

    flight = read_file(file, design) if file else None
    check_length(flight or planned(design), design, _MOST_FOR_OPTIONS)
    return manoeuvres(design, progress=progress, flight=flight)


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

"""The options of a flight, which `simulate` and `trajectory` have alike, and the study that they describe."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from nav_model.base.errors import InputError, under
from nav_model.base.units import parse_quantity

if TYPE_CHECKING:
    from nav_model.budget import Budget
    from nav_model.design import Design
    from nav_model.simulation.specification import SimulationSpec
    from nav_model.trajectory.plan import PlannedFlight

_DURATION = 500.0


def flown_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the option of the commands that give a verdict, which fly the design's plan for it."""
    parser.add_argument(
        "--no-flight", action="store_true", help="do not fly the design's plan: what it judges stays open (faster)"
    )


def flown_budget(budget: Budget, options: argparse.Namespace) -> Budget:
    """The budget with the checks of the design's flight, unless the options leave it out or it judges nothing.

    Raises InputError for a flight that cannot be flown.
    """
    from nav_model.budget.verdict import flies

    if options.no_flight or not flies(budget.design):
        return budget
    from nav_model.trajectory.verdict import with_flight  # with Numba, which takes a second

    return with_flight(budget)


def flight_arguments(parser: argparse.ArgumentParser, usual: str) -> None:
    """Declare them; usual: the flight unless another is named."""
    add = parser.add_argument
    add("--duration", type=float, metavar="S", help="length of the flight (default: 500 s, or the plan's or file's)")
    add("--outage", dest="outages", action="append", default=[], metavar="START,STOP",
        help="start and stop of a time without fixes, in seconds; may be repeated")  # fmt: skip
    add("--trajectory", default=usual, metavar="NAME-or-FILE",
        help="plan (the design's), wandering, straight, turns, climb, or a file: KML, KMZ, GPX, .plan, .waypoints, "
        f"CSV, SBET, NovAtel, NMEA, ULog; default: {usual}")  # fmt: skip
    add("--height", metavar="H", help="height of the places of a file that have none, e.g. '3 km'")
    add("--ground", metavar="G",
        help="height of the ground, or of the take-off, for a file with heights above it, e.g. '430 m' "
        "(default: the design's, unless that is 0)")  # fmt: skip
    add("--columns", metavar="NAME,...",
        help="columns of a table without names, e.g. week,time,latitude,longitude,height; - skips one")  # fmt: skip
    add("--every", type=float, metavar="S",
        help="spacing of the results (default 1 s; of the design's plan a 1200th, where that is more)")  # fmt: skip
    add("--states", type=int, choices=(9, 12, 15, 18, 21, 24), default=0,
        help="filter states: 15 estimates biases, 21 constant and varying ones separately; 12, 18 and 24 the slow "
        "GNSS error too (default: filter.states of the design)")  # fmt: skip


def changes_of(options: argparse.Namespace) -> list[str]:
    """The changes of --set, and the filter of --states as one of them."""
    return [*options.changes, *([f"filter.states={options.states}"] if options.states else [])]


def flight_study(
    design: Design, options: argparse.Namespace, **others: Any
) -> tuple[SimulationSpec, PlannedFlight | None]:
    """The study that the options describe, and the flight of a plan or file with its lines.

    others: as `specification` has them.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be flown.
    """
    from nav_model.design.parts import declaration_of
    from nav_model.simulation.design_study import NAMED_TRAJECTORIES, specification
    from nav_model.simulation.trajectory import plan_trajectory
    from nav_model.trajectory.design_study import PLAN, planned

    height, ground = (_length(options, name) for name in ("height", "ground"))
    with under("--outage"):
        outages = list(declaration_of("trajectory.outages").read(";".join(options.outages)))
    flight: PlannedFlight | None
    if options.trajectory == PLAN:
        flight, outages = planned(design), outages or list(design.trajectory.outages)
    else:
        flight = None if options.trajectory in NAMED_TRAJECTORIES else _of_file(options, design, height, ground)
    whole = flight.duration if flight else _DURATION
    try:
        spec = specification(
            design,
            trajectory=flight.trajectory if flight else options.trajectory,
            duration=whole if options.duration is None else options.duration,
            outages=outages,
            every=1.0 if options.every is None else options.every,
            **others,
        )
        plan_trajectory(spec.trajectory, spec.duration)  # refuses what cannot be flown before anything is prepared
    except InputError as error:
        # Under the option's name; a key of the design keeps its own, and a plan has its outages from there.
        from_design = error.key == "outage" and not options.outages
        key = "trajectory.outages" if from_design else error.key if "." in error.key else f"--{error.key}"
        raise error.under(key) from error
    return spec, flight


def _of_file(
    options: argparse.Namespace, design: Design, height: float | None, ground: float | None
) -> PlannedFlight:
    from nav_model.simulation.design_study import NAMED_TRAJECTORIES
    from nav_model.trajectory.design_study import PLAN, plan_like
    from nav_model.trajectory.files.reader import KINDS, read_file

    if ground is None and design.trajectory.ground:
        ground = design.trajectory.ground
    try:
        names = [name.strip() for name in (options.columns or "").split(",")] if options.columns else ()
        flight = read_file(options.trajectory, height, ground, names).flown(plan_like(design))
    except OSError as error:
        known = ", ".join((PLAN, *NAMED_TRAJECTORIES))
        reason = f"{options.trajectory!r} is not a file that can be read. Name a {KINDS} file, or {known}."
        raise InputError("--trajectory", reason) from error
    except ValueError as error:
        raise InputError("--trajectory", str(error)) from error
    print(f"{options.trajectory}: {flight.note}", file=sys.stderr)
    return flight


def _length(options: argparse.Namespace, name: str) -> float | None:
    text = getattr(options, name)
    with under(f"--{name}"):
        return None if text is None else parse_quantity(text, "length").value

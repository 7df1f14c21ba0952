"""What the page follows: a flight of a design, worked out in a worker process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from nav_model.base.errors import InputError
from nav_model.design import Design

if TYPE_CHECKING:
    from nav_model.trajectory.plan import PlannedFlight
    from nav_model.trajectory.result import TrajectoryResult

MOST_FIXES = 20_000  # seconds of work, and memory, of one person
_POINTS = 1200  # results kept along a flight


@dataclass(frozen=True)
class Strip:
    """Parallel lines to fly, as `nav_model.trajectory.plan.strip` takes them; None: the design's."""

    count: int
    length: float
    spacing: float
    bank: float
    heading: float | None = None
    speed: float | None = None


@dataclass(frozen=True)
class File:
    """A file with a flight."""

    name: str
    content: bytes


@dataclass(frozen=True)
class Asked:
    """A flight: a name of the simulator's, flown for `duration` [s]; a strip or a file, flown whole. outages [s]."""

    flight: str | Strip | File
    duration: float
    outages: tuple[tuple[float, float], ...]
    states: int


@dataclass(frozen=True, eq=False)
class Followed:
    """The covariance along the flight, and its path [m] north and east of the start."""

    design: Design
    result: TrajectoryResult
    north: NDArray[np.float64]
    east: NDArray[np.float64]


def follow(design: Design, asked: Asked) -> Followed:
    """Follow the covariance along a flight; for a worker process.

    Raises
    ------
    InputError
        Naming the file, the input or the key of the design.
    """
    from nav_model.earth.wgs84 import curvature_radii
    from nav_model.simulation.design_study import specification
    from nav_model.trajectory.covariance import covariance
    from nav_model.trajectory.design_study import covariance_specification

    planned = None if isinstance(asked.flight, str) else _planned(design, asked.flight)
    duration = planned.duration if planned else asked.duration
    if duration > MOST_FIXES * design.gnss.interval:
        said = f"{duration:g} s have more than {MOST_FIXES} fixes, which is too long for this page; "
        raise InputError("Length", said + "use the command `navbudget trajectory`")
    study = specification(
        design,
        trajectory=planned.trajectory if planned else str(asked.flight),
        runs=1,
        duration=duration,
        outages=asked.outages,
        every=max(1.0, round(duration / _POINTS)),
        states=asked.states,
    )
    result = covariance(covariance_specification(design, study, lines=planned.lines if planned else ()))
    latitude, longitude, height = result.truth.position.T
    meridian, prime = curvature_radii(np.sin(latitude[0]))
    north = (meridian + height[0]) * (latitude - latitude[0])
    east = (prime + height[0]) * np.cos(latitude[0]) * (np.unwrap(longitude) - longitude[0])
    return Followed(design, result, north, east)


def _planned(design: Design, flight: Strip | File) -> PlannedFlight:
    from nav_model.trajectory.design_study import plan_like
    from nav_model.trajectory.files import parse_flight
    from nav_model.trajectory.plan import Waypoint, fly, strip

    own = design.flight
    if isinstance(flight, File):
        return parse_flight(flight.content, flight.name, plan_like(design), own.altitude)
    heading = own.heading if flight.heading is None else flight.heading
    speed = own.speed if flight.speed is None else flight.speed
    first = Waypoint(own.latitude, 0.0, own.altitude)
    return fly(strip(first, heading, flight.length, flight.spacing, flight.count, speed, flight.bank))

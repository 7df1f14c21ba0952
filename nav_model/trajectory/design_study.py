"""The covariance along a flight of a design: its plan, its aperture, its limits."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from nav_model.analytic.turning import Bend
from nav_model.aperture.phase import SOURCES
from nav_model.base.errors import InputError, under
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Contribution, Contributors
from nav_model.budget.inputs import RECTIFICATION, Inputs, inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.budget.shares import ESTIMATION
from nav_model.budget.smoothed import Smoothed
from nav_model.budget.varying import VARYING
from nav_model.budget.verdict import all_required, confidence_of, flight_required
from nav_model.design import Design
from nav_model.design.contributors import BOTH
from nav_model.design.figures import FIGURES, IN_FLIGHT, OF_BUDGET, PHASES, STEADY
from nav_model.design.trajectory import LIMITED, LINES, WAYPOINTS, Rows, row_of
from nav_model.simulation.design_study import named_flight, specification
from nav_model.simulation.specification import SimulationSpec
from nav_model.trajectory.plan import PlannedFlight, fly
from nav_model.trajectory.result import TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec, FlightLine, Most
from nav_model.trajectory.waypoints import Plan, Waypoint, lengthened, strip

_SAME = 0.005
_SAME_AFTER = 0.01
_WAITS = 24  # to a thousandth of the leg after an aperture
MOST_RESULTS = 1200  # along a flight
PLAN = "plan"
"""Name of a design's own flight among those that the commands fly."""


def plan_like(design: Design) -> Plan:
    """A plan that flies as the design does, without waypoints."""
    trajectory = design.trajectory
    flown = trajectory.bank, trajectory.climb_rate, trajectory.ground, trajectory.acceleration
    return Plan((), design.flight.speed, *flown)


def lines_of(design: Design) -> Plan:
    """The plan of the design's parallel lines: from its first waypoint, or from its latitude, at longitude 0.

    Raises InputError if they cannot be laid out.
    """
    route, flight = design.trajectory, design.flight
    if route.lines != int(route.lines):
        raise InputError("lines", f"{route.lines:g} is not a whole number")
    places = route.waypoints or ((flight.latitude, 0.0, flight.altitude),)
    first = Waypoint(*places[0][:3])
    return strip(plan_like(design), first, flight.heading, route.length, route.spacing, int(route.lines))


def plan_of(design: Design) -> Plan:
    """The plan of a design with waypoints or lines; raises InputError as `lines_of`."""
    places = tuple(Waypoint(*row) for row in design.trajectory.waypoints)
    return lines_of(design) if design.trajectory.flight == LINES else replace(plan_like(design), waypoints=places)


def rows_of(points: Iterable[Waypoint]) -> Rows:
    """Waypoints as a design has them."""
    return tuple(row_of(p.latitude, p.longitude, p.height, p.line, p.speed) for p in points)


def planned(design: Design, number: int = 0, longer: float = 0.0) -> PlannedFlight:
    """The flight of the design's plan, or straight without one.

    It is `longer` [s] in its line `number` (from 0), or as a whole without lines.

    Raises InputError under the key of the design, where it cannot be flown.
    """
    trajectory = design.trajectory
    if not trajectory.planned:
        return PlannedFlight(named_flight(design, "straight"), trajectory.duration + longer, ())
    if trajectory.flight not in (LINES, WAYPOINTS):
        return PlannedFlight(named_flight(design, trajectory.flight), trajectory.duration + longer, ())
    with under(f"trajectory.{trajectory.flight}"):
        plan = plan_of(design)
        return fly(lengthened(plan, number, longer) if longer else plan)


def flight_covariance(design: Design, file: str | Path | None = None) -> TrajectoryResult:
    """The covariance along the flight of a design's plan, or of a file, in real time and post-processed, by source.

    Parameters
    ----------
    design : Design
        Without a plan it flies straight for `trajectory.duration`.
    file : path, optional
        Flown in place of the plan: any that `navbudget trajectory` reads.

    Raises
    ------
    InputError
        For a flight that cannot be flown, or a file that cannot be read.
    ArithmeticError
        Where the covariance is not finite.

    Examples
    --------
    >>> from nav_model import flight_covariance, parse_design
    >>> flight = flight_covariance(parse_design("trajectory.duration = '60 s'"))
    >>> flight.real_time.attitude.shape  # roll, pitch, yaw [rad] at each of flight.time_s
    (61, 3)
    """
    from nav_model.trajectory.covariance import covariance
    from nav_model.trajectory.files.reader import read_file

    ground = design.trajectory.ground or None
    flight = read_file(file, None, ground).flown(plan_like(design)) if file else planned(design)
    return covariance(along_flight(design, flight))


def along_flight(design: Design, flight: PlannedFlight) -> CovarianceSpec:
    """The covariance along a flight of the design, with the outages of its plan and at most `MOST_RESULTS`.

    Raises InputError as `simulation.design_study.specification` and `covariance_specification`.
    """
    study = specification(
        design,
        trajectory=flight.trajectory,
        runs=1,
        duration=flight.duration,
        outages=design.trajectory.outages,
        every=max(1.0, round(flight.duration / MOST_RESULTS)),
    )
    # A straight flight that is no plan judges only what the straight leg does not.
    every = design.trajectory.planned or flight.trajectory.kind != "straight"
    return covariance_specification(design, study, flight.lines, every=every)


def covariance_specification(
    design: Design, study: SimulationSpec, lines: tuple[FlightLine, ...] = (), *, every: bool = True
) -> CovarianceSpec:
    """The covariance along a flight of a design.

    The limits are the design's requirements on figures that are known along a flight, less their confidence, in its
    processing; those of the plan's `limits` hold for the line of that name.

    Parameters
    ----------
    design : Design
        The design.
    study : SimulationSpec
        Its flight, as `simulation.design_study.specification` makes it.
    lines : tuple of FlightLine, optional
        Lines of the flight.
    every : bool, optional
        False for only those limits that a straight leg does not tell.

    Raises
    ------
    InputError
        If the plan limits a line that the flight does not have.
    """
    trajectory = design.trajectory
    names = [line.name for line in lines]
    limited: dict[str, Most] = {}
    for number, (name, *most) in enumerate(trajectory.limits, 1):
        if name not in names:
            reason = f"the flight has no line {name!r}; its lines: {', '.join(dict.fromkeys(names)) or 'none'}"
            raise InputError(f"trajectory.limits[{number}].line", reason, name)
        limited[name] = limited.get(name, ()) + _limits(design, dict(zip(LIMITED, most, strict=True)))
    flown = tuple(replace(line, most=limited.get(line.name, ())) for line in lines)
    x = inputs_of(design)
    waits = _waited(x)
    return CovarianceSpec(
        study,
        x,
        flown,
        design.processing.mode,
        _lowest(design, every=every),
        _besides(x),
        every,
        settled=True,
        moment=x.steady_state,
        smoothed_after=_smoothed_after(x),
        smoother_waits=waits,
        flown_further=0.0 if lines or study.trajectory.kind == "file" else waits,
    )


def _waited(x: Inputs) -> float:
    """Seconds for which the smoother waits for fixes after an aperture: of the leg after it, as many as the budget's
    smoothed figures need to be those of the whole one to a percent. [P-3]"""
    shares = 0.75 ** np.arange(_WAITS)
    smoothed = Smoothed(replace(x, leg_after=x.leg_after * shares))
    values = np.array([smoothed.value(name) + np.zeros(_WAITS) for name in IN_FLIGHT if name in OF_BUDGET])
    same = np.all(np.abs(values - values[:, :1]) <= _SAME_AFTER * values[:, :1], axis=0)
    return float(x.leg_after * shares[np.argmin([*same, False]) - 1])


def at_range(spec: CovarianceSpec, design: Design) -> CovarianceSpec:
    """The flight of `spec`, looked at from the slant range and grazing angle of a design that has others."""
    x = inputs_of(design)
    return replace(
        spec,
        inputs=x,
        contributors=_besides(x),
        smoothed_after=_smoothed_after(x),
    )


def _smoothed_after(x: Inputs) -> float:
    """Time after a fix of the budget's smoothed states [s]: in the middle of an aperture that begins with
    one [P-3]. Zero where they are those at a fix to half a percent, which takes fewer steps."""
    half = float(x.aperture) / 2
    since = half % float(x.interval)
    there, at_fix = Smoothed(x), Smoothed(replace(x, aperture=np.asarray(2 * (half - since + float(x.interval)))))
    same = all(abs(float(there.value(name)) / float(at_fix.value(name)) - 1) < _SAME for name in STEADY)
    return 0.0 if same else since


def _lowest(design: Design, *, every: bool) -> Most:
    """The lowest limit at one sigma of the requirements on each figure that the flight judges."""
    lowest: dict[str, float] = {}
    limited = all_required(design)
    for name, requirement in flight_required(design, every=every).items():
        if name in limited:  # else of single lines alone
            limit = requirement.at_one_sigma
            lowest[requirement.on] = min(limit, lowest.get(requirement.on, limit))
    return tuple(lowest.items())


def _besides(x: Inputs) -> Contributors:
    """Contributions to the figures beside the errors of the flight: in the phases vibration, unsensed motion and the
    oscillator [P-8], and all else that the budget's phases have; and the user's own contributors."""
    in_figures = dict(x.contributors.in_figures)
    if x.estimation is not None and x.estimated is not None:
        for name, weight in zip(PHASES, x.estimated, strict=True):
            part = Contribution(ESTIMATION, x.estimation * math.sqrt(weight), False, BOTH)
            in_figures[name] = (*in_figures.get(name, ()), part)
        x = replace(x, estimation=np.zeros(()))
    for source, variances in RealTime(x).phases.items():
        if source in (*SOURCES, RECTIFICATION, VARYING):  # along the flight
            continue
        alone = RealTime(x)
        alone.phases, alone.phases_before = {source: variances}, {source: RealTime(x).phases_before[source]}
        alone.quadratic_bend = alone.cubic_bend = (Bend(*np.zeros(5)),) * 2  # none moves along the track
        for name in IN_FLIGHT:
            if FIGURES[name].kind == "phase":
                part = Contribution(source, alone.value(name), False, BOTH)
                in_figures[name] = (*in_figures.get(name, ()), part)
    return Contributors(FrozenMapping(in_figures), x.contributors.alone)


def _limits(design: Design, most: Mapping[str, float | None]) -> Most:
    """Limits on figures along a flight, brought to one sigma."""
    limits = ((name, most[name]) for name in LIMITED)
    return tuple((name, limit / confidence_of(design, name)) for name, limit in limits if limit is not None)

"""A sweep through the simulator: how every design is flown, and which results of a flight its row has.

    [simulate]
    runs = 200
    seed = 1                               # the same noise for every design, so that differences are the designs'
    duration = "600 s"
    outages = [["500 s", "600 s"]]         # fixes lost
    trajectory = "wandering"               # or another named flight, or a CSV file beside the sweep file
    states = 15                            # number of filter states; default: what the design declares
    every = "1 s"                          # spacing of the times over which consistency is judged

A row holds the figures at the end of the flight: end it where they matter, such as with an outage.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from nav_model.base.errors import InputError, quoted, under
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.simulation.design_study import NAMED_TRAJECTORIES, closed_form, specification
from nav_model.simulation.specification import SimulationSpec, TrajectorySpec

_NOT_FLOWN = float("nan")


@dataclass(frozen=True)
class SweepFlight:
    """Flight of every design: times in seconds, `trajectory` a name or a file's samples."""

    runs: int = 100
    seed: int = 1
    duration: float = 500.0
    outages: tuple[tuple[float, float], ...] = ()
    trajectory: str | TrajectorySpec = "wandering"
    states: int = 0
    every: float = 1.0

    @property
    def identity(self) -> dict[str, Any]:
        """Everything that decides the result, as data for JSON."""
        stated = asdict(self)
        if isinstance(self.trajectory, TrajectorySpec):
            stated["trajectory"] = hashlib.sha256(self.trajectory.samples).hexdigest()
        return stated

    def specification(self, design: Design) -> SimulationSpec:
        """The study of one design.

        Raises
        ------
        InputError
            As `nav_model.simulation.design_study.specification`.
        """
        options = dict(vars(self))  # named as the options are
        if states := options.pop("states"):
            design = design.replace({"filter.states": states})
        return specification(design, **options)


def read_flight(table: Any, folder: Path) -> SweepFlight:
    """The section [simulate] of a sweep file; a trajectory's file is looked for in `folder`.

    Raises
    ------
    InputError
        Naming the key, what was given and what is allowed. What only a design can be refused for is left to
        `SweepFlight.specification`.
    """
    if not isinstance(table, dict):
        raise InputError("simulate", "must be a section, such as [simulate] with runs = 100")
    unknown = set(table) - {*_READ, "trajectory"}
    if unknown:
        raise InputError(f"simulate.{sorted(unknown)[0]}", f"unknown key; it has {', '.join((*_READ, 'trajectory'))}")
    given: dict[str, Any] = {
        key: _READ[key](f"simulate.{key}", value) for key, value in table.items() if key in _READ
    }
    flight = SweepFlight(**given)
    return replace(flight, trajectory=_trajectory(table["trajectory"], folder)) if "trajectory" in table else flight


def _whole(key: str, value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise InputError(key, f"{quoted(value)} is not a whole number", value)
    return value


def _time(key: str, value: Any) -> float:
    if not isinstance(value, str):
        raise InputError(key, f'{quoted(value)}: a time is written with its unit, such as "500 s"', value)
    with under(key):
        return parse_quantity(value, "time").value


def _outages(key: str, value: Any) -> tuple[tuple[float, float], ...]:
    if not isinstance(value, list) or not all(isinstance(pair, list) and len(pair) == 2 for pair in value):
        raise InputError(key, f'{quoted(value)} is not a list of pairs such as [["400 s", "500 s"]]', value)
    return tuple((_time(key, start), _time(key, stop)) for start, stop in value)


_READ: Mapping[str, Callable[[str, Any], Any]] = {
    "runs": _whole,
    "seed": _whole,
    "states": _whole,
    "duration": _time,
    "every": _time,
    "outages": _outages,
}


def _trajectory(value: Any, folder: Path) -> str | TrajectorySpec:
    if value in NAMED_TRAJECTORIES:
        return str(value)
    if not isinstance(value, str):
        raise InputError("simulate.trajectory", f"{quoted(value)} is not a name or a file", value)
    from nav_model.trajectory.files.reader import read_file

    try:
        flight = read_file(folder / value).flight
        if flight is None:
            raise ValueError(f"{value} is a plan. Fly it as the designs' own, or give a recording.")
        return flight.trajectory
    except OSError as error:
        known = ", ".join(NAMED_TRAJECTORIES)
        raise InputError(
            "simulate.trajectory",
            f"{quoted(value)} is not a file that can be read. Name a file of a flight, or choose {known}.",
            value,
        ) from error
    except ValueError as error:
        raise InputError("simulate.trajectory", str(error), value) from error


def check_flight(flight: SweepFlight, design: Design) -> None:
    """Refuse at once what no design could be flown with.

    Raises
    ------
    InputError
        Under "simulate", for an option; a design that cannot be flown is its row's affair.
    """
    try:
        flight.specification(design)
    except InputError as error:
        key = "states" if error.key == "filter.states" and flight.states else error.key
        if "." not in key:
            raise error.under(f"simulate.{key}") from error


def fly(flight: SweepFlight, design: Design) -> dict[str, float | str]:
    """One row's flight: filter's verdict, NEES with its 95 % band, and the nine errors at the end of the flight.

    Of each error the rms over the runs, the filter's own sigma and the closed form's, after the fix. A design
    that cannot be flown has its reason under ``not_flown`` and no numbers.
    """
    from nav_model.simulation.monte_carlo import simulate
    from nav_model.simulation.result import STATES
    from nav_model.simulation.single_run import POSTERIOR

    names = [(f"simulated_{group}_{axis}", unit) for group, axis, unit in STATES]
    try:
        spec = flight.specification(design)
        result = simulate(spec, closed_form=closed_form(design, spec))
    except (ValueError, ArithmeticError) as error:
        reason = str(error)
        empty = {f"{name}_{kind}_{unit}": _NOT_FLOWN for name, unit in names for kind in _KINDS}
        return {"filter_verdict": "", "nees_mean": _NOT_FLOWN, "nees_low": _NOT_FLOWN, "nees_high": _NOT_FLOWN,
                **empty, "not_flown": reason}  # fmt: skip
    assert result.closed_form_sigma is not None
    ends = (result.rms[POSTERIOR, -1], result.filter_sigma[POSTERIOR, -1], result.closed_form_sigma[-1])
    numbers = {
        f"{name}_{kind}_{unit}": float(values[column])
        for column, (name, unit) in enumerate(names)
        for kind, values in zip(_KINDS, ends, strict=True)
    }
    nees = result.nees
    return {
        "filter_verdict": result.verdict.partition(":")[0].partition(",")[0],
        "nees_mean": nees.mean,
        "nees_low": nees.low,
        "nees_high": nees.high,
        **numbers,
        "not_flown": "",
    }


_KINDS = ("rms", "filter_sigma", "closed_form_sigma")

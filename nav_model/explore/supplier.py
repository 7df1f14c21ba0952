"""Values that a supplier of an inertial unit or a receiver has to deliver for a design, and how a log shows them.

The required values are those that the design's allocation leaves to the sources of a unit. Without one they are the
largest multiple of the design's own, of all units together, with which every limit is still met: every unit can be at
its limit at once, and the margin is spent once. They are frozen when a log's values enter the design. A log is
accepted where the upper confidence limit of its reading is within the required value, so that noise in the test
counts against the unit.

Sources: IEEE Std 952-1997, annex C (Allan variance of inertial sensors); NIST SP 1065, sections 5.3 and 5.4
(confidence from chi-square); C. Greenhall and W. Riley, PTTI 2003 (equivalent degrees of freedom).
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from nav_model.allan.degrees import degrees_of_freedom, pooled_degrees
from nav_model.allan.result import LogAnalysis
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.allocation import allocate
from nav_model.budget.refusals import imaged_inputs
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.figures import RESPONSE
from nav_model.design.parts import quantity
from nav_model.design.user_entries import Allotment, UserEntries
from nav_model.explore.margins import needed_limits, ratios, worst
from nav_model.explore.solve import rounded_offer

Unit = Literal["imu", "gnss"]

CONFIDENCE = 0.95
"""One-sided: a unit at its required value passes in one case of twenty."""

AVERAGING = 1.0
"""Averaging time of the Allan deviation at which a random walk is read, s: N is the deviation there times √s."""

_NOISES: Mapping[Unit, tuple[str, ...]] = {
    "imu": ("imu.angle_random_walk", "imu.velocity_random_walk"),
    "gnss": (
        "gnss.position_noise", "gnss.vertical_position_noise", "gnss.velocity_noise", "gnss.vertical_velocity_noise",
    ),
}  # fmt: skip
_TRIADS = {"gyro": "imu.angle_random_walk", "accelerometer": "imu.velocity_random_walk"}
_LARGEST = 1e4
_HALVINGS = 60
_ROUNDING = 1e-12  # so that a value of three digits is not rounded down to the next one


@dataclass(frozen=True)
class RequiredInput:
    """One line of a sheet: the largest value [SI] of an input, and the one that the design has."""

    key: str
    value: float
    current: float

    @property
    def bounded(self) -> bool:
        """True if no limit of the design asks for less than the most that a design may have, which is the value."""
        return self.value >= quantity(self.key).limits[1]


@dataclass(frozen=True)
class Acceptance:
    """One axis of a log against a line: reading, the largest that is accepted, and the required value, SI."""

    name: str
    input: str
    reading: float
    accepted: float
    required: float
    degrees_of_freedom: float

    @property
    def passes(self) -> bool:
        """True if the upper confidence limit of the reading is within the required value."""
        return self.reading <= self.accepted


def required(design: Design, unit: Unit) -> tuple[RequiredInput, ...]:
    """The lines of the sheet of a unit: from the design's allocation where it has one.

    Raises
    ------
    InputError
        If the design gives no requirement, if no unit of this kind meets them, or if every unit does; if its
        allocation does not close; if a value below what a design may have would be required; if the design is one
        that `analyse` refuses.
    """
    imaged_inputs(design)
    now = _noises(design, unit)
    if frozen := {key: value for key, value, _ in design.allocation.required} if design.allocation else {}:
        return tuple(RequiredInput(key, frozen[key], value) for key, value in now.items() if key in frozen)
    needed_limits(design, "require values for")
    plan = design.allocation
    factors = _alike(design, unit) if plan is None else _allocated(design, unit, now)
    largest = {key: _allowed(key, (1 + _ROUNDING) * factors[key] * value) for key, value in now.items()}
    return tuple(
        RequiredInput(key, rounded_offer(design, key, largest[key]).value, value) for key, value in now.items()
    )


def exceeding(design: Design) -> tuple[str, ...]:
    """Sources beside the noises of all sheets that take more of a limit than the design's allocation leaves them: the
    values of the sheets meet that limit only once these keep to it too."""
    if design.allocation is None:
        return ()
    budget, of_sheets = analyse(design), {quantity(key).source for key in _noises(design, *_NOISES)}
    entries = (entry for check in _allocated_checks(budget) for entry in allocate(budget, check.name).entries)
    over = (entry.source for entry in entries if entry.estimated > entry.allocated * (1 + _ROUNDING))
    return tuple(dict.fromkeys(source for source in over if source not in of_sheets))


def _allocated_checks(budget: Budget) -> list[Check]:
    """Limits that are allocated: those on measures of the impulse response are not."""
    return [check for check in budget.straight_leg().checks if check.on not in RESPONSE]


def _allowed(key: str, largest: float) -> float:
    """A required value within what a design may have: less noise than asked for meets the limits as well."""
    declaration = quantity(key)
    if largest < declaration.limits[0]:
        raise InputError(key, f"{declaration.show(largest, 3)} would be required. {declaration.allowed()}", largest)
    return min(largest, declaration.limits[1])


def frozen(design: Design, day: str = "") -> UserEntries:
    """Entries of a design with the required values of every sheet frozen as they are; unchanged where no sheet is.

    Required values follow the design's own, so a log whose values enter the design would move what it is judged by.
    `day` is noted beside the hash of the design.
    """
    plan = design.allocation or Allotment()
    if plan.required:
        return design.entries
    values: list[tuple[str, float, str]] = []
    for unit in _NOISES:
        with suppress(InputError):
            values += [(line.key, line.value, design.unit(line.key)) for line in required(design, unit)]
    if not values:
        return design.entries
    note = ", ".join(filter(None, (design.content_hash[:12], day)))
    return replace(design.entries, allocation=replace(plan, required=tuple(values), frozen=note))


def released(design: Design) -> UserEntries:
    """Entries of a design without frozen values: those of its sheets follow it again."""
    plan = replace(design.allocation or Allotment(), required=(), frozen="")
    return replace(design.entries, allocation=None if plan == Allotment() else plan)


def _noises(design: Design, *units: Unit) -> dict[str, float]:
    """Noises that the design states for some units, SI."""
    keys = (key for unit in units for key in _NOISES[unit])
    return {key: float(value) for key in keys if isinstance(value := design[key], float)}


def _alike(design: Design, unit: Unit) -> dict[str, float]:
    """The largest factor of the noises of all units together with which every limit is met, for each."""
    now = _noises(design, *_NOISES)

    def closes(factor: float) -> bool:
        largest = worst(ratios(design, {key: np.array(factor * value) for key, value in now.items()}))
        return bool(largest <= 1)

    low, high = math.log(1 / _LARGEST), math.log(_LARGEST)
    if not closes(math.exp(low)):
        raise InputError(unit, "the other inputs alone exceed a limit, whatever its noise")
    if closes(math.exp(high)):
        raise InputError(unit, "no limit depends on its noise")
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if closes(math.exp(middle)) else (low, middle)
    return dict.fromkeys(now, math.exp(low))


def _allocated(design: Design, unit: Unit, now: Mapping[str, float]) -> dict[str, float]:
    """Of each noise the least ratio of allocated to estimated among its entries.

    With the filter as it is, the entry of a noise scales with it, what it adds to the initial tilt included [T-18].
    The filter that fits the new noises is better than the old one with them, so that each limit less its reserve is
    met with all values at once, if no other source is `exceeding` its part.
    """
    budget, factors = analyse(design), dict[str, float]()
    for check in _allocated_checks(budget):
        allocation = allocate(budget, check.name)
        if not allocation.closes:
            raise InputError(
                "allocation", f"{check.label} does not close: {', '.join(allocation.blocked_by)} locked too high"
            )
        for entry in allocation.entries:
            factors[entry.source] = min(factors.get(entry.source, math.inf), entry.allocated / entry.estimated)
    if not any(quantity(key).source in factors for key in now):
        raise InputError(unit, "no allocated limit depends on its noise")
    return {key: factors.get(quantity(key).source, 1.0) for key in now}


def accepted_share(degrees: float) -> float:
    """Largest reading over required value that is accepted with so many degrees of freedom.

    Examples
    --------
    >>> round(accepted_share(100.0), 4)
    0.8828
    """
    from scipy.special import chdtri

    return math.sqrt(float(chdtri(degrees, CONFIDENCE)) / degrees)


def degrees_of(duration: float, rate: float) -> float:
    """Equivalent degrees of freedom of the reading at `AVERAGING` of a log of this duration [s] and rate [Hz]."""
    return degrees_of_freedom(0, max(1, round(AVERAGING * rate)), round(duration * rate))


def judge_log(lines: tuple[RequiredInput, ...], log: LogAnalysis) -> tuple[Acceptance, ...]:
    """Every axis of a log at rest against the lines of an inertial unit.

    Raises
    ------
    InputError
        If the log is too short or too slow for a reading at `AVERAGING`, or has no sensor of one kind.
    """
    for quantity_of in _TRIADS:
        if not any(axis.quantity == quantity_of for axis in log.axes):
            raise InputError(log.provenance.file_name, f"has no {quantity_of}; the sheet requires values of both")
    by_key = {line.key: line for line in lines}
    acceptances = []
    for axis in log.axes:
        line, taus = by_key[_TRIADS[axis.quantity]], axis.deviation.tau_s
        near = int(np.argmin(np.abs(np.log(taus / AVERAGING))))
        if not 0.5 <= taus[near] / AVERAGING <= 2.0:
            raise InputError(
                log.provenance.file_name,
                f"has no Allan deviation at {AVERAGING:g} s; a longer or faster log is needed",
            )
        degrees = pooled_degrees(0, round(float(taus[near]) * axis.rate_hz), axis.lengths)
        reading = float(axis.deviation.deviation[near]) * math.sqrt(float(taus[near]))
        limit = accepted_share(degrees) * line.value
        acceptances.append(Acceptance(axis.name, line.key, reading, limit, line.value, degrees))
    return tuple(acceptances)

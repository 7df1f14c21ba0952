"""What a user adds to a design beside its inputs: contributors, limits on any value, and how limits are allocated."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from nav_model.base.errors import InputError, not_a_choice, shown
from nav_model.base.units import QuantityError, format_quantity, parse_quantity
from nav_model.design.contributors import (
    COASTING,
    ENTERED,
    IN_OUTAGE,
    UNSCALED,
    Contributor,
    Sized,
    check_text,
    checked,
    dimensions_of,
    given_tables,
    read_contributors,
    read_ratio,
    read_size,
)
from nav_model.design.parts import Coast, Requirements

OWN_KEYS = ("contributors", "limits", "allocation")
"""Their tables in a design file."""

SPLITS = ("equal", "shares", "cheapest")
_LONGEST_OUTAGE = float(Coast.param["duration"].bounds[1])  # s
_LEAST_SIGMAS, _MOST_SIGMAS = map(float, Requirements.param["confidence"].bounds)


@dataclass(frozen=True)
class Limit(Sized):
    """A requirement of the user's own.

    Attributes
    ----------
    name : str
    on : str
        The value limited: key of `ENTERED`, or the name of a contributor.
    value : float
        The limit in SI.
    dimension : str
        Of the value.
    confidence : float or None
        How many sigmas must stay within; None for that of the design.
    at : float or None
        Seconds after the last fix, of a value in the outage; None for its end.
    unit : str
        As that of `Contributor`.
    """

    table: ClassVar[str] = "limits"
    name: str
    on: str
    value: float
    dimension: str
    confidence: float | None = None
    at: float | None = None
    unit: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        check_text(f"{self.where}.name", self.name)
        if not self.name[:1].isalnum():  # it heads columns of tables: "=1+1" would be a formula there
            raise InputError(f"{self.where}.name", "must begin with a letter or a digit.", self.name)
        if self.name in ENTERED or self.name in ("requirements", "all requirements"):
            raise InputError(self.where, "is the name of a requirement already. Choose another name.", self.name)
        if not 0 < self.value < math.inf:
            raise InputError(
                f"{self.where}.limit", f"{self.value:g} is not allowed. Give more than zero.", self.value
            )
        if self.at is not None:
            if self.on not in (*COASTING, *IN_OUTAGE):
                raise InputError(
                    f"{self.where}.at", f"{self.on} is no value of the outage, so it has no time.", self.at
                )
            if not 0 <= self.at <= _LONGEST_OUTAGE:
                raise InputError(
                    f"{self.where}.at", f"{self.at:g} s is not from 0 to {_LONGEST_OUTAGE:g} s.", self.at
                )
        if self.confidence is not None:
            if self.on in UNSCALED:
                raise InputError(f"{self.where}.confidence", f"does not multiply {self.on}. Leave it out.")
            if not _LEAST_SIGMAS <= self.confidence <= _MOST_SIGMAS:
                raise InputError(
                    f"{self.where}.confidence",
                    f"{self.confidence:g} is not from {_LEAST_SIGMAS:g} to {_MOST_SIGMAS:g} sigmas.", self.confidence,
                )  # fmt: skip

    def record(self) -> dict[str, str]:
        """The limit as a design file has it."""
        texts = {"name": self.name, "on": self.on, "limit": self.show()}
        if self.at is not None:
            texts["at"] = format_quantity(self.at, "s", "time")
        return texts if self.confidence is None else texts | {"confidence": repr(self.confidence)}


@dataclass(frozen=True)
class Lock(Sized):
    """What a source may take of a requirement, set by hand: at the confidence of the limit."""

    requirement: str
    name: str
    value: float
    dimension: str
    unit: str = field(default="", compare=False)


@dataclass(frozen=True)
class Allotment:
    """How limits are split among their sources."""

    split: str = "shares"
    reserve: float = 0.2
    locks: tuple[Lock, ...] = ()

    def __post_init__(self) -> None:
        if self.split not in SPLITS:
            raise InputError("allocation.split", not_a_choice(self.split, SPLITS), self.split)
        if not 0 <= self.reserve < 1:
            raise InputError(
                "allocation.reserve", f"{self.reserve:g} is not allowed. Give 0 % or more and less than 100 %.",
                self.reserve,
            )  # fmt: skip

    def record(self) -> dict[str, Any]:
        """The table ``[allocation]`` of a design file."""
        locks: dict[str, dict[str, str]] = {}
        for lock in self.locks:
            locks.setdefault(lock.requirement, {})[lock.name] = lock.show()
        texts = {"split": self.split, "reserve": format_quantity(self.reserve, "%", "ratio")}
        return texts | ({"locks": locks} if locks else {})


@dataclass(frozen=True)
class Own:
    """Contributors, limits and an allocation; no two of one kind and name, and every value limited is known."""

    contributors: tuple[Contributor, ...] = ()
    limits: tuple[Limit, ...] = ()
    allocation: Allotment | None = None

    def __post_init__(self) -> None:
        checked(self.contributors)
        checked(self.limits)
        names = {one.name for one in self.contributors}
        for limit in self.limits:
            if limit.on not in ENTERED and limit.on not in names:
                raise InputError(f"{limit.where}.on", not_a_choice(limit.on, (*ENTERED, *names)), limit.on)
        for lock in self.allocation.locks if self.allocation else ():
            dimensions_limited(lock.requirement, self.limits)

    def tables(self) -> dict[str, Any]:
        """What a design file has of it; `read_own` takes it back."""
        found: dict[str, Any] = {
            "contributors": [one.record() for one in self.contributors],
            "limits": [one.record() for one in self.limits],
            "allocation": self.allocation and self.allocation.record(),
        }
        return {key: table for key, table in found.items() if table}

    def identity(self) -> list[str]:
        """Lines for a design's hash; none where there is nothing."""
        lines = []
        for one in self.contributors:
            sizes = f"{one.value.hex()} {one.dimension} {one.allowance.hex()}"
            lines.append(
                f"contributor={(one.name, one.enters, one.kind, one.processing, one.owner, one.source)} {sizes}"
            )
        for limit in self.limits:
            lines.append(f"limit={(limit.name, limit.on, limit.confidence, limit.at)} {limit.value.hex()}")
        if plan := self.allocation:
            locks = [(lock.requirement, lock.name, lock.value.hex(), lock.dimension) for lock in plan.locks]
            lines.append(f"allocation={plan.split} {plan.reserve.hex()} {locks}")
        return lines


def dimensions_limited(requirement: str, limits: tuple[Limit, ...]) -> tuple[str, ...]:
    """Dimensions of a size in a requirement.

    Raises
    ------
    InputError
        If there is no such requirement.
    """
    for limit in limits:
        if limit.name == requirement:
            return dimensions_of(limit.on) if limit.on in ENTERED else (limit.dimension,)
    if requirement not in ENTERED:
        raise InputError(
            "allocation.locks", not_a_choice(requirement, (*ENTERED, *(each.name for each in limits))), requirement
        )
    return dimensions_of(requirement)


def read_own(tables: Mapping[str, Any]) -> Own:
    """What the tables of a design file under `OWN_KEYS` say; others are not looked at.

    Raises
    ------
    InputError
        Naming the contributor, limit or lock and the key that is wrong, what was given and what is allowed.
    """
    contributors = read_contributors(tables.get("contributors", []))
    limits = read_limits(tables.get("limits", []), contributors)
    plan = read_allocation(tables["allocation"], limits) if "allocation" in tables else None
    return Own(contributors, limits, plan)


def read_limits(tables: Any, contributors: tuple[Contributor, ...] = ()) -> tuple[Limit, ...]:
    """Limits from the tables ``[[limits]]`` of a design file.

    Raises
    ------
    InputError
        As `read_own`.
    """
    own, found = {one.name: one.dimension for one in contributors}, []
    for where, texts in given_tables("limits", tables, ("name", "on", "limit", "at", "confidence"), ("on", "limit")):
        on, at, sigmas = texts["on"], texts.get("at"), texts.get("confidence")
        if on not in ENTERED and on not in own:
            raise InputError(f"{where}.on", not_a_choice(on, (*ENTERED, *own)), on)
        dimensions = (ENTERED.get(on) or own[on],)
        value, unit, dimension = read_size(f"{where}.limit", texts["limit"], on, dimensions)
        try:
            time = None if at is None else parse_quantity(at, "time").value
        except QuantityError as error:
            raise InputError(f"{where}.at", f'{shown(at)} is not a time. Write for example "30 s".', at) from error
        try:
            confidence = None if sigmas is None else float(sigmas)
        except ValueError as error:
            raise InputError(f"{where}.confidence", f"{shown(sigmas)} is not a number of sigmas.", sigmas) from error
        found.append(Limit(texts["name"], on, value, dimension, confidence, time, unit))
    return checked(found)


def read_allocation(table: Any, limits: tuple[Limit, ...] = ()) -> Allotment:
    """How limits are split, from the table ``[allocation]`` of a design file.

    Raises
    ------
    InputError
        As `read_own`.
    """
    if not isinstance(table, dict):
        raise InputError("allocation", "must be a section, [allocation]", table)
    for key in table:
        if key not in ("split", "reserve", "locks"):
            raise InputError(f"allocation.{key}", "unknown key; [allocation] has split, reserve, locks", table[key])
    texts = {key: table[key] for key in ("split", "reserve") if key in table}
    for key, text in texts.items():
        if not isinstance(text, str):
            raise InputError(f"allocation.{key}", f"{shown(text)} is not text in quotes", text)
    locks, given = [], table.get("locks", {})
    for requirement, entries in given.items() if isinstance(given, dict) else [("", given)]:
        where = f"allocation.locks.{requirement}"
        if not isinstance(entries, dict):
            raise InputError("allocation.locks", "must be sections, [allocation.locks.REQUIREMENT]", entries)
        dimensions = dimensions_limited(requirement, limits)
        for source, text in entries.items():
            if not isinstance(text, str):
                raise InputError(f"{where}.{source}", f"{shown(text)} is not text in quotes", text)
            value, unit, dimension = read_size(f"{where}.{source}", text, requirement, dimensions)
            if not 0 < value < math.inf:
                raise InputError(f"{where}.{source}", "must be locked at more than zero.", text)
            locks.append(Lock(requirement, source, value, dimension, unit))
    reserve = read_ratio("allocation.reserve", texts.get("reserve", "20 %"))
    return Allotment(texts.get("split", "shares"), reserve, tuple(locks))

"""Entries of a user beside a design's inputs: contributors, limits on any value, and the allocation of limits."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from nav_model.base.errors import InputError, not_a_choice, quoted, under
from nav_model.base.units import format_quantity
from nav_model.design.contributors import (
    MOST,
    Contributor,
    OneSigma,
    check_text,
    read_contributors,
    read_records,
    read_size,
)
from nav_model.design.declaration import BaseQuantity, Quantity
from nav_model.design.figures import FIGURES, column_of, label_of
from nav_model.design.parts import INPUTS, Coast, Requirements

ENTRY_KEYS = ("contributors", "limits", "allocation")
"""Their tables in a design file."""

SPLITS = ("equal", "shares", "cheapest")
_ALLOCATION = ("split", "reserve", "locks", "frozen", "required")
_LIKE: dict[str, Any] = {"confidence": Requirements.param["confidence"], "at": Coast.param["duration"]}
"""Keys of a limit -> the input whose bounds they have."""
RESERVE = Quantity(
    default=0.2, dimension="ratio", unit="%", short="", bounds=(0.0, 1.0), inclusive_bounds=(True, False),
    label="reserve", variable=False,
)  # fmt: skip


@dataclass(frozen=True)
class Limit(OneSigma):
    """A requirement of the user's own.

    Attributes
    ----------
    name : str
    on : str
        The value limited: name of a figure, or the name of a contributor.
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
    unit: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        check_text(f"{self.where}.name", self.name)
        if not self.name[:1].isalnum():  # it heads columns of tables: "=1+1" would be a formula there
            raise InputError(f"{self.where}.name", "must begin with a letter or a digit.", self.name)
        # What only a flight judges is no check of a budget: files of before have limits of such a name.
        if (self.name in FIGURES and FIGURES[self.name].kind != "flight") or self.name in (
            "requirements",
            "all requirements",
        ):
            raise InputError(self.where, "is the name of a requirement already. Choose another name.", self.name)
        if not 0 < self.value < math.inf:
            raise InputError(f"{self.where}.limit", "must be more than zero.", self.value)
        self.refuse_accuracy(f"{self.where}.limit")
        figure = FIGURES.get(self.on)
        if self.at is not None and (figure is None or figure.kind != "outage"):
            why = f"{label_of(self.on)} has no time after the last fix. Limit its value after the outage instead."
            raise InputError(f"{self.where}.at", why, self.at)
        if self.confidence is not None and figure and not figure.scaled:
            raise InputError(f"{self.where}.confidence", f"does not multiply {label_of(self.on)}. Leave it out.")

    @property
    def column(self) -> str:
        """The limit's name with what it is on and the SI unit, as `Figure.column`."""
        figure = FIGURES.get(self.on)
        return column_of(self.name, self.dimension, figure is None or figure.scaled)

    def record(self) -> dict[str, str]:
        """The limit as a design file has it."""
        texts = {"name": self.name, "on": self.on, "limit": self.show()}
        if self.at is not None:
            texts["at"] = format_quantity(self.at, "s", "time")
        return texts if self.confidence is None else texts | {"confidence": repr(self.confidence)}


@dataclass(frozen=True)
class Lock(OneSigma):
    """Allowance of a source in a requirement, set by hand: more than zero, at the confidence of the limit."""

    requirement: str
    name: str
    value: float
    dimension: str
    unit: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        if not 0 < self.value < math.inf:
            where = f"allocation.locks.{self.requirement}.{self.name}"
            raise InputError(where, "must be locked at more than zero.", self.value)
        self.refuse_accuracy(f"allocation.locks.{self.requirement}.{self.name}")


@dataclass(frozen=True)
class Allotment:
    """Split of limits among their sources.

    ``required`` holds the values [SI] of inputs that suppliers' sheets require, with the units they were written in,
    frozen when the design had the hash ``frozen``; empty where the sheets follow the design.
    """

    split: str = "shares"
    reserve: float = RESERVE.default
    locks: tuple[Lock, ...] = ()
    required: tuple[tuple[str, float, str], ...] = field(default=(), repr=False)  # a hash of before has neither
    frozen: str = field(default="", repr=False)

    def __post_init__(self) -> None:
        if self.split not in SPLITS:
            raise InputError("allocation.split", not_a_choice(self.split, SPLITS), self.split)
        if not 0 <= self.reserve < 1:
            raise InputError(
                "allocation.reserve", f"{self.reserve:g} is not allowed. {RESERVE.allowed()}", self.reserve
            )

    def record(self) -> dict[str, Any]:
        """The table ``[allocation]`` of a design file."""
        locks: dict[str, dict[str, str]] = {}
        for lock in self.locks:
            locks.setdefault(lock.requirement, {})[lock.name] = lock.show()
        texts = {"split": self.split, "reserve": format_quantity(self.reserve, "%", "ratio")}
        tables: dict[str, Any] = texts | ({"locks": locks} if locks else {})
        if self.required:
            values = {key: _quantity(key).write(value, unit)[1] for key, value, unit in self.required}
            tables |= {"frozen": self.frozen, "required": values}
        return tables


def _quantity(key: str) -> BaseQuantity[Any]:
    """The declaration of an input that a sheet may require a value of."""
    section, _, name = key.partition(".")
    declaration = INPUTS.get(section, {}).get(name)
    if not isinstance(declaration, BaseQuantity) or not declaration.source:
        raise InputError(
            f"allocation.required.{key}", "is not a sensor noise. Write for example imu.angle_random_walk"
        )
    return declaration


@dataclass(frozen=True)
class UserEntries:
    """Contributors, limits and an allocation; no two of one kind and name, and at most `MOST` of a kind."""

    contributors: tuple[Contributor, ...] = ()
    limits: tuple[Limit, ...] = ()
    allocation: Allotment | None = None

    def __post_init__(self) -> None:
        for named in (self.contributors, self.limits):
            by_name: dict[str, OneSigma] = {}
            for entry in named:
                if by_name.setdefault(entry.name.casefold(), entry) is not entry:
                    raise InputError(entry.where, f"is the name of two {entry.table}. Rename one.", entry.name)
                if len(by_name) > MOST:
                    raise InputError(entry.table, f"are too many. Give at most {MOST}.")

    def tables(self) -> dict[str, Any]:
        """Tables for a design file; `read_entries` takes them back."""
        content: dict[str, Any] = {
            "contributors": [entry.record() for entry in self.contributors],
            "limits": [entry.record() for entry in self.limits],
            "allocation": self.allocation and self.allocation.record(),
        }
        return {key: table for key, table in content.items() if table}

    def identity(self) -> list[str]:
        """Lines for a design's hash; none where there is nothing.

        Names and order of the entries' fields are part of it: another name for one changes the hash of saved designs.
        """
        lines = [repr(entry) for entry in (*self.contributors, *self.limits, self.allocation) if entry]
        frozen = self.allocation.required if self.allocation else ()
        return [*lines, repr([(key, value) for key, value, _ in frozen])] if frozen else lines


def read_entries(tables: Mapping[str, Any]) -> UserEntries:
    """Read the tables of a design file under `ENTRY_KEYS`; others are not looked at.

    Raises
    ------
    InputError
        Naming the contributor, limit or lock and the key that is wrong, what was given and what is allowed.
    """
    contributors = read_contributors(tables.get("contributors", []))
    limits = read_limits(tables.get("limits", []), contributors)
    plan = read_allocation(tables["allocation"], limits) if "allocation" in tables else None
    return UserEntries(contributors, limits, plan)


def read_limits(tables: Any, contributors: tuple[Contributor, ...] = ()) -> tuple[Limit, ...]:
    """Limits from the tables ``[[limits]]`` of a design file.

    Raises
    ------
    InputError
        As `read_entries`.
    """
    dimensions = {contributor.name: contributor.dimension for contributor in contributors}
    dimensions |= {name: figure.dimension for name, figure in FIGURES.items()}
    limits = []
    for where, texts in read_records("limits", tables, ("name", "on", "limit", "at", "confidence"), ("on", "limit")):
        on = texts["on"]
        if on not in dimensions:
            raise InputError(
                f"{where}.on",
                f"The requirement {quoted(texts['name'])} limits {quoted(on)}, which is neither a contributor nor "
                "a figure of the budget. Remove that requirement first, or change what it limits.",
                on,
            )
        size = read_size(f"{where}.limit", texts["limit"], on, (dimensions[on],))
        for key, declaration in _LIKE.items():
            if key in texts:
                with under(f"{where}.{key}"):
                    size[key] = declaration.read(texts[key]).value
        limits.append(Limit(texts["name"], on, **size))
    return tuple(limits)


def read_allocation(table: Any, limits: tuple[Limit, ...] = ()) -> Allotment:
    """Read the table ``[allocation]`` of a design file.

    Raises
    ------
    InputError
        As `read_entries`.
    """
    if not isinstance(table, dict):
        raise InputError("allocation", "must be a section, [allocation]", table)
    for key in table:
        if key not in _ALLOCATION:
            reason = f"unknown key; [allocation] has {', '.join(_ALLOCATION)}"
            raise InputError(f"allocation.{key}", reason, table[key])
    fitting = {name: figure.accepts for name, figure in FIGURES.items()}
    fitting |= {limit.name: fitting.get(limit.on, (limit.dimension,)) for limit in limits}
    locks, given = [], table.get("locks", {})
    for requirement, entries in given.items() if isinstance(given, dict) else [("", given)]:
        where = f"allocation.locks.{requirement}"
        if not isinstance(entries, dict):
            raise InputError("allocation.locks", "must be sections, [allocation.locks.REQUIREMENT]", entries)
        if requirement not in fitting:
            reason = (
                f"{quoted(requirement)} is not a requirement, but some of its sources are locked. Remove these "
                "locks first."
            )
            raise InputError("allocation.locks", reason, requirement)
        for source, text in entries.items():
            size = read_size(f"{where}.{source}", text, requirement, fitting[requirement])
            locks.append(Lock(requirement, source, **size))
    with under("allocation.reserve"):
        reserve = RESERVE.read(table.get("reserve", "20 %")).value
    values, frozen = table.get("required", {}), table.get("frozen", "")
    if not isinstance(values, dict):
        raise InputError("allocation.required", "must be a section, [allocation.required]", values)
    check_text("allocation.frozen", frozen)
    required = tuple((key, *_quantity(key).read(text)[:2]) for key, text in values.items())
    return Allotment(table.get("split", "shares"), reserve, tuple(locks), required, frozen)

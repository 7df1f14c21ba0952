"""Contributors of the user's own: errors that the model does not know, added to a figure by their 1σ.

A design has any number up to `MOST`; `nav_model.budget.contributors` adds them to the figures they enter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError, not_a_choice, shown
from nav_model.base.units import QuantityError, format_quantity, parse_quantity
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

RANDOM, SYSTEMATIC = "random", "systematic"
KINDS = (RANDOM, SYSTEMATIC)
BOTH = "both"
PROCESSINGS = (BOTH, REAL_TIME, POST_PROCESSED)
MOST = 100
"""Contributors that a design may have."""

PHASES = ("quadratic_phase", "along_track_quadratic_phase", "cubic_phase", "detrended_phase")
"""Figures that a length along the line of sight may enter."""

ENTERED: Mapping[str, str] = MappingProxyType(
    {
        name: declaration.dimension
        for name, declaration in INPUTS["requirements"].items()
        if isinstance(declaration, BaseQuantity) and declaration.dimension
    }
    | {"along_track_quadratic_phase": "angle"}
)
"""Figure that a contributor may enter -> its dimension."""

ALIKE = ("coast_horizontal_position", "coast_vertical_position", "paired_echo", "islr")
"""Figures that are the same in both processings."""

_SOURCES = frozenset(
    declaration.source
    for names in INPUTS.values()
    for declaration in names.values()
    if isinstance(declaration, BaseQuantity) and declaration.source
) | {
    "initial tilt", "coast before aperture", "vibration", "unsensed motion", "oscillator", "vibration rectification",
    "no such source",
}  # fmt: skip
"""Names that budgets give to sources of the model."""

_LARGEST = 1e9  # SI; no figure is limited there
_LONGEST = 200  # characters of a text


@dataclass(frozen=True)
class Contributor:
    """One contributor.

    Attributes
    ----------
    name : str
    value : float
        1σ in SI: of the figure entered, or m along the line of sight where it is a phase and `dimension` is length.
        For ce90 and le90 the 90 % value, for a level the amplitude over the target's.
    enters : str
        Key of `ENTERED`.
    dimension : str
        Of the value.
    kind : str
        "random" adds in quadrature, "systematic" linearly.
    processing : str
        "both", "real time" or "post-processed".
    allowance : float
        Maturity allowance; the value counts 1 + allowance times.
    owner, source : str
        Who answers for it, and where the value came from.
    unit : str
        Unit the value was written in; not part of what makes two contributors equal.
    """

    name: str
    value: float
    enters: str
    dimension: str
    kind: str = RANDOM
    processing: str = BOTH
    allowance: float = 0.0
    owner: str = ""
    source: str = ""
    unit: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        for key in ("name", "owner", "source"):
            _check_text(f"{self.where}.{key}", getattr(self, key))
        if not self.name:
            raise InputError("contributors", "one has no name. Give each a name.")
        if self.name.casefold() in _SOURCES_FOLDED:
            raise InputError(self.where, "is the name of a source of the model. Choose another name.", self.name)
        for key, options in (("enters", ENTERED), ("kind", KINDS), ("processing", PROCESSINGS)):
            if getattr(self, key) not in options:
                raise InputError(f"{self.where}.{key}", not_a_choice(getattr(self, key), options))
        if self.dimension not in dimensions_of(self.enters):
            raise InputError(f"{self.where}.value", _misfit(f"a {self.dimension}", self.enters))
        for key in ("value", "allowance"):
            number = getattr(self, key)
            if not 0 <= number <= _LARGEST:  # NaN lands here too
                raise InputError(f"{self.where}.{key}", f"{number:g} is not allowed. Give zero or more.", number)
        if self.enters in ALIKE and self.processing != BOTH:
            raise InputError(
                f"{self.where}.processing", f'{self.enters} is the same in both processings. Write "both".'
            )

    @property
    def where(self) -> str:
        """How messages name it."""
        return f"contributors[{self.name}]"

    @property
    def counted(self) -> float:
        """The value with its allowance, SI."""
        return self.value * (1 + self.allowance)

    def show(self, digits: int | None = None) -> str:
        """The value with its unit; without `digits` the shortest text that reads back to the same value."""
        return format_quantity(
            self.value, self.unit or DIMENSIONS[self.dimension].default_unit, self.dimension, digits
        )

    def record(self) -> dict[str, str]:
        """The contributor as a design file has it; `read_contributors` takes it back."""
        texts = {"name": self.name, "value": self.show(), "enters": self.enters, "kind": self.kind,
                 "processing": self.processing}  # fmt: skip
        if self.allowance:
            texts["allowance"] = format_quantity(self.allowance, "%", "ratio")
        return texts | {key: text for key in ("owner", "source") if (text := getattr(self, key))}


_SOURCES_FOLDED = frozenset(name.casefold() for name in _SOURCES)


def dimensions_of(enters: str) -> tuple[str, ...]:
    """Dimensions that the value of a contributor to a figure may have."""
    return (ENTERED[enters], "length") if enters in PHASES else (ENTERED[enters],)


def read_contributors(tables: Any) -> tuple[Contributor, ...]:
    """Contributors from the tables ``[[contributors]]`` of a design file.

    Raises
    ------
    InputError
        Naming the contributor and the key that is wrong, what was given and what is allowed.
    """
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError("contributors", "must be tables, [[contributors]]", tables)
    return checked(_read(table, number) for number, table in enumerate(tables[: MOST + 1], 1))


def checked(contributors: Iterable[Contributor]) -> tuple[Contributor, ...]:
    """The contributors, of which no two have one name.

    Raises
    ------
    InputError
        If two have, or if there are more than `MOST`.
    """
    found: dict[str, Contributor] = {}
    for one in contributors:
        if found.setdefault(one.name.casefold(), one) is not one:
            raise InputError(one.where, "is the name of two contributors. Rename one.", one.name)
        if len(found) > MOST:
            raise InputError("contributors", f"are too many. Give at most {MOST}.")
    return tuple(found.values())


_KEYS = tuple(item.name for item in fields(Contributor) if item.name not in ("dimension", "unit"))


def _read(table: Mapping[str, Any], number: int) -> Contributor:
    name = table.get("name")
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"contributors[{number}].name", "Give a name as text in quotes.", name)
    where = f"contributors[{shown(name.strip())[1:-1]}]"
    for key, text in table.items():
        if key not in _KEYS:
            raise InputError(f"{where}.{key}", f"unknown key; a contributor has {', '.join(_KEYS)}", text)
        if not isinstance(text, str):
            raise InputError(f"{where}.{key}", f"{shown(text)} is not text in quotes", text)
    for key in ("value", "enters"):
        if key not in table:
            raise InputError(f"{where}.{key}", "is missing")
    texts = {key: text.strip() for key, text in table.items() if key not in ("value", "allowance")}
    if texts["enters"] not in ENTERED:
        raise InputError(f"{where}.enters", not_a_choice(texts["enters"], ENTERED), texts["enters"])
    value, unit, dimension = read_size(f"{where}.value", table["value"], texts["enters"])
    allowance = 0.0
    if "allowance" in table:
        try:
            allowance = parse_quantity(table["allowance"], "ratio").value
        except QuantityError as error:
            raise InputError(f"{where}.allowance", 'Write for example "20 %".', table["allowance"]) from error
    return Contributor(value=value, dimension=dimension, allowance=allowance, unit=unit, **texts)


def read_size(where: str, text: str, enters: str) -> tuple[float, str, str]:
    """A size in a figure, or along the line of sight where that is a phase: its value in SI, unit and dimension.

    Raises
    ------
    InputError
        If the unit does not fit; `where` names what is wrong.
    """
    for dimension in dimensions_of(enters):
        try:
            return *parse_quantity(text, dimension), dimension
        except QuantityError:
            continue
    raise InputError(where, _misfit(shown(text), enters), text)


def _misfit(what: str, enters: str) -> str:
    examples = "5° or 1 mm" if enters in PHASES else DIMENSIONS[ENTERED[enters]].examples[0]
    return f"{what} does not fit {enters}. Write for example {examples}."


def _check_text(where: str, text: object) -> None:
    if not isinstance(text, str) or len(text.splitlines()) > 1 or (text and not text.isprintable()):
        raise InputError(where, f"{shown(text)} is not a line of text", text)
    if len(text) > _LONGEST:
        raise InputError(where, f"longer than {_LONGEST} characters")

"""Contributors of the user's own: errors that the model does not know, added to a figure by their 1σ.

A design has any number up to `MOST`; `nav_model.budget.contributors` adds them to the figures they enter.
"""

from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, ClassVar

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError, not_a_choice, quoted, under
from nav_model.base.units import format_quantity, parse_quantity
from nav_model.design.declaration import BaseQuantity, Quantity
from nav_model.design.figures import FIGURES, label_of
from nav_model.design.parts import INPUTS
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

RANDOM, SYSTEMATIC = "random", "systematic"
KINDS = (RANDOM, SYSTEMATIC)
BOTH = "both"
PROCESSINGS = (BOTH, REAL_TIME, POST_PROCESSED)
MOST = 100
"""Contributors that a design may have."""

_SOURCES = frozenset(
    declaration.source.casefold()
    for names in INPUTS.values()
    for declaration in names.values()
    if isinstance(declaration, BaseQuantity) and declaration.source
) | {
    "initial tilt", "coast before aperture", "vibration", "unsensed motion", "oscillator", "no such source", "total",
    "along-track",
}  # fmt: skip
"""Names that budgets give to sources of the model and to sums of them, in lower case."""

_ALLOWANCE = Quantity(
    default=0.0, dimension="ratio", unit="%", short="", bounds=(0.0, 1e9), label="allowance", variable=False
)

_LARGEST = 1e9  # SI; no figure is limited there
_LONGEST = 200  # characters of a text


class OneSigma:
    """Entry of a user with a name and a size: `value` in SI, its `dimension`, and the `unit` it was written in.

    `table` is the name of its tables in a design file.
    """

    table: ClassVar[str]
    name: str
    value: float
    dimension: str
    unit: str

    @property
    def where(self) -> str:
        """Name of the entry in messages."""
        return f"{self.table}[{quoted(self.name)[1:-1]}]"

    def refuse_accuracy(self, where: str) -> None:
        """Refuse a value such as "2 m CEP" where it is not a 1σ."""
        if self.unit and DIMENSIONS[self.dimension].scale(self.unit).how:
            raise InputError(where, f"{quoted(self.show())} states an accuracy, but this is not a 1σ.", self.show())

    def show(self, digits: int | None = None) -> str:
        """The value with its unit; without `digits` the shortest text that reads back to the same value."""
        return format_quantity(
            self.value, self.unit or DIMENSIONS[self.dimension].default_unit, self.dimension, digits
        )


@dataclass(frozen=True)
class Contributor(OneSigma):
    """One contributor.

    Attributes
    ----------
    name : str
    value : float
        1σ in SI: of the figure entered, or m along the line of sight where it is a phase and `dimension` is length.
        For a percentage the 90 % value, for a level the amplitude over the target's.
    enters : str
        Name of a figure.
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
        Unit the value was written in; not part of what makes two contributors equal, nor of their hash.
    """

    table: ClassVar[str] = "contributors"
    name: str
    value: float
    enters: str
    dimension: str
    kind: str = RANDOM
    processing: str = BOTH
    allowance: float = 0.0
    owner: str = ""
    source: str = ""
    unit: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        for key in ("name", "owner", "source"):
            check_text(f"{self.where}.{key}", getattr(self, key))
        if not self.name:
            raise InputError("contributors", "one has no name. Give each a name.")
        if self.name.casefold() in _SOURCES:
            raise InputError(self.where, "is a name that the budget itself uses. Choose another name.", self.name)
        figure = FIGURES.get(self.enters)
        allowed = {"enters": FIGURES, "kind": KINDS, "processing": PROCESSINGS,
                   "dimension": figure.accepts if figure else ()}  # fmt: skip
        for key, options in allowed.items():
            if getattr(self, key) not in options:
                raise InputError(f"{self.where}.{key}", not_a_choice(getattr(self, key), options))
        if not 0 <= self.value <= _LARGEST:  # NaN lands here too
            raise InputError(f"{self.where}.value", f"{self.value:g} is not allowed. Give zero or more.", self.value)
        if figure and not figure.scaled:
            self.refuse_accuracy(f"{self.where}.value")
        if figure and not figure.smoothed_mark and self.processing != BOTH:
            raise InputError(
                f"{self.where}.processing", f'{figure.label} is the same in both processings. Write "both".'
            )

    @property
    def counted(self) -> float:
        """The value with its allowance, SI."""
        return self.value * (1 + self.allowance)

    def record(self) -> dict[str, str]:
        """The contributor as a design file has it; `read_contributors` takes it back."""
        texts = {"name": self.name, "value": self.show(), "enters": self.enters, "kind": self.kind,
                 "processing": self.processing}  # fmt: skip
        if self.allowance:
            texts["allowance"] = format_quantity(self.allowance, "%", "ratio")
        return texts | {key: text for key in ("owner", "source") if (text := getattr(self, key))}


def read_contributors(tables: Any) -> tuple[Contributor, ...]:
    """Contributors from the tables ``[[contributors]]`` of a design file.

    Raises
    ------
    InputError
        Naming the contributor and the key that is wrong, what was given and what is allowed.
    """
    keys = ("name", "value", "enters", "kind", "processing", "allowance", "owner", "source")
    contributors = []
    for where, texts in read_records("contributors", tables, keys, ("value", "enters")):
        if (enters := texts["enters"]) not in FIGURES:
            raise InputError(f"{where}.enters", not_a_choice(enters, FIGURES), enters)
        given: dict[str, Any] = texts | read_size(f"{where}.value", texts["value"], enters, FIGURES[enters].accepts)
        with under(f"{where}.allowance"):
            given["allowance"] = _ALLOWANCE.read(texts.get("allowance", "0 %")).value
        contributors.append(Contributor(**given))
    return tuple(contributors)


def read_records(
    kind: str, tables: Any, keys: Collection[str], needed: Iterable[str]
) -> Iterator[tuple[str, dict[str, str]]]:
    """Name in messages, and texts, of each table ``[[kind]]`` of a design file; up to one more than `MOST`.

    Parameters
    ----------
    kind : str
        Name of the tables.
    tables : object
        As the parser gives them.
    keys, needed : collection of str, iterable of str
        Keys that a table may have, and must have.

    Raises
    ------
    InputError
        If something is no table, a name or a key that is `needed` is missing, a key is unknown or a value no text.
    """
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(kind, f"must be tables, [[{kind}]]", tables)
    for number, table in enumerate(tables[: MOST + 1], 1):
        name = table.get("name")
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"{kind}[{number}].name", "Give a name as text in quotes.", name)
        where = f"{kind}[{quoted(name.strip())[1:-1]}]"
        for key, text in table.items():
            if key not in keys:
                raise InputError(f"{where}.{key}", f"unknown key. Here go {', '.join(keys)}.", text)
            if not isinstance(text, str) and type(text) not in (int, float):
                raise InputError(f"{where}.{key}", f"{quoted(text)} is not text in quotes", text)
        for key in needed:
            if key not in table:
                raise InputError(f"{where}.{key}", "is missing")
        yield where, {key: str(text).strip() for key, text in table.items()}


def read_size(where: str, text: str, figure: str, allowed: tuple[str, ...]) -> dict[str, Any]:
    """A size in a figure: `value` [SI], `unit` and `dimension`.

    Parameters
    ----------
    where : str
        Name of the entry, for messages.
    text : str
        Number and unit.
    figure : str
        Name of the figure.
    allowed : tuple of str
        Dimensions that the size may have.

    Raises
    ------
    InputError
        If the unit does not fit.
    """
    for dimension in allowed:
        with suppress(InputError):
            return parse_quantity(str(text), dimension)._asdict() | {"dimension": dimension}
    examples = " or ".join(
        {"length": "1 mm", "angle": "5°"}.get(each, DIMENSIONS[each].examples[0]) for each in allowed
    )
    raise InputError(where, f"{quoted(text)} does not fit {label_of(figure)}. Write for example {examples}.", text)


def check_text(where: str, text: object) -> None:
    """Refuse what is not one printable line, or is too long a one."""
    if not isinstance(text, str) or len(text.splitlines()) > 1 or (text and not text.isprintable()):
        raise InputError(where, f"{quoted(text)} is not a line of text", text)
    if len(text) > _LONGEST:
        raise InputError(where, f"longer than {_LONGEST} characters")

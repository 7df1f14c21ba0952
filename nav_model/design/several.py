"""Further kinds of inputs: whole numbers, one number per axis, intervals of time."""

import math
import re
from decimal import Decimal
from typing import Any

import param

from nav_model.base.errors import InputError, quoted, under
from nav_model.base.units import (
    exact_bound,
    format_bound,
    format_quantity,
    join_quantity,
    parse_quantity,
    with_point,
)
from nav_model.design.declaration import Declared, Quantity, in_sentence

Spans = tuple[tuple[float, float], ...]
_COUNTS = {3: "three", 6: "six"}
_NUMBER = re.compile(r"^[+\-−]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+\-−]?\d+)?")
_SPAN = re.compile(r"(\d+(?:\.\d+)?)\s*[-–]\s*(\d+(?:\.\d+)?)\s*s?")


class Whole(Quantity):
    """A plain number without fraction, held as a float."""

    def __init__(self, default: float, *, bounds: tuple[float, float], **params: Any) -> None:
        super().__init__(default, dimension="", unit="", short="", bounds=bounds, **params)

    def _validate(self, val: Any) -> None:
        super()._validate(val)
        if val != round(val):
            raise InputError(self.key, f"{val:g} is not a whole number. {self.allowed()}", val)


class _Several(Declared, param.Parameter[Any]):
    """Base class of inputs with several numbers."""

    def __init__(self, default: Any, **params: Any) -> None:
        super().__init__(default=default, constant=True, **params)

    def _parts(self, text: Any, example: str) -> list[str]:
        if not isinstance(text, str):
            raise InputError(self.key, f"{quoted(text)} is not text in quotes. Write for example {example!r}.", text)
        return [part.strip() for part in re.split(r"[,;]", text)]


class Axes(_Several):
    """A quantity with one value on each of several axes, a tuple in SI.

    Parameters
    ----------
    default : tuple of float
        As many as there are axes.
    dimension, unit : str
        As `nav_model.design.declaration.Quantity`.
    softbounds : tuple of float
        Where a slider starts above zero, and the largest size on an axis; SI.
    """

    __slots__ = ["dimension", "softbounds", "unit"]

    dimension: str
    unit: str
    softbounds: tuple[float, float]

    def __init__(
        self, default: tuple[float, ...], *, dimension: str, unit: str, softbounds: tuple[float, float], **params: Any
    ) -> None:
        low, high = softbounds
        self.dimension, self.unit, self.softbounds = dimension, unit, (low, exact_bound(high, unit, dimension))
        super().__init__(default, **params)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest size on an axis, SI."""
        return 0.0, self.softbounds[1]

    def _validate(self, val: Any) -> None:
        count = len(self.default)
        if not isinstance(val, tuple) or len(val) != count:
            raise InputError(self.key, f"{quoted(val)} is not {_COUNTS[count]} numbers.", val)
        most = self.softbounds[1]
        for number in val:
            if not abs(number) <= most:  # NaN lands here too
                largest = format_bound(most, self.unit, self.dimension, low=False)
                problem = f"is not allowed. Each axis must be at most {largest} in size."
                raise InputError(self.key, f"{self._one(number, 6)} {problem}", val)

    def show(self, value: tuple[float, ...], digits: int | None = 6) -> str:
        """A value in SI as text in the usual unit, "60, 0, 0 arcsec", which `read` takes back; without `digits`
        the shortest text that gives the same value."""
        numbers = (self._one(number, digits).removesuffix(self.unit).strip() for number in value)
        return join_quantity(", ".join(numbers), self.unit)

    def _one(self, number: float, digits: int | None) -> str:
        return format_quantity(number, self.unit, self.dimension, digits) if math.isfinite(number) else f"{number}"

    def read(self, text: Any, unit: str = "") -> tuple[float, ...]:
        """One number for all axes or one for each, separated by commas -> SI.

        A number without a unit takes that of the last one, and the last one takes `unit`.

        Raises
        ------
        InputError
            Naming the key, what was given and what is allowed.
        """
        example = self.show(self.default)
        parts, count = self._parts(text, example), len(self.default)
        if not text.strip().removesuffix(unit).strip():
            raise InputError(self.key, f"Enter the {in_sentence(self.label)}, for example {example}.", text)
        if len(parts) not in (1, count):
            problem = f"has {len(parts)} values. Give one for all axes, or {_COUNTS[count]} separated by commas."
            raise InputError(self.key, f"{quoted(text.strip())} {problem}", text)
        last = _unit_of(parts[-1]) or unit
        with under(self.key):
            numbers = [parse_quantity(with_unit(part, last), self.dimension).value for part in parts]
        value = tuple(numbers if len(numbers) > 1 else numbers * count)
        self._validate(value)
        return value


class Intervals(_Several):
    """Intervals of time, a tuple of (start, stop) in s: "200-260 s, 400-410 s"."""

    def _validate(self, val: Any) -> None:
        for start, stop in val:
            if not 0 <= start < stop < math.inf:
                raise InputError(
                    self.key, f"{start:g}-{stop:g} s must start at 0 s or later and stop after it starts.", val
                )

    def show(self, value: Spans, digits: int | None = None) -> str:
        """Intervals as text that `read` takes back, always with every digit."""
        return ", ".join(f"{_plain(start)}-{_plain(stop)} s" for start, stop in value)

    def read(self, text: Any) -> Spans:
        """Text such as "200-260 s, 400-410 s" -> (start, stop) in s; empty: none.

        Raises
        ------
        InputError
            Naming the key, what was given and what is allowed.
        """
        example = "200-260 s, 400-410 s"
        spans = []
        for part in filter(None, self._parts(text, example)):
            match = _SPAN.fullmatch(part)
            if match is None:
                raise InputError(self.key, f"{part[:40]!r} is not an interval. Write for example {example}.", text)
            spans.append((float(match[1]), float(match[2])))
        self._validate(spans)
        return tuple(spans)


def with_unit(text: str, unit: str) -> str:
    """A quantity as text, with `unit` where it gives none."""
    return f"{text} {unit}" if text and unit and not _unit_of(with_point(text)) else text


def _unit_of(part: str) -> str:
    """Unit of a quantity as text; empty without one."""
    return _NUMBER.sub("", part, count=1).strip()


def _plain(number: float) -> str:
    return f"{Decimal(repr(number)).normalize():f}"

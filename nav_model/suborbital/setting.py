"""One input of the suborbital study: what it may be, and text with units <-> SI.

Text with units exists only in `Setting.read`, `Setting.take` and `Setting.show`. Inputs of several axes take one
number for all of them or one each, separated by commas.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from nav_model.errors import InputError, shown
from nav_model.units import QuantityError, format_quantity, join_quantity, parse_quantity

Value = float | str | tuple[float, ...] | tuple[tuple[float, float], ...] | None
"""What an input may hold, SI."""


@dataclass(frozen=True)
class Setting:
    """One input.

    kind: "number" (a plain one when dimension is empty), "whole", "axes" (as many numbers as the default has),
    "choice" or "intervals" (pairs start-stop); low and high bound a number, or the size on each axis; optional:
    None is allowed; small: where a slider starts above zero; grid: a slider stops at its multiples only.
    """

    key: str
    label: str
    doc: str
    kind: str
    default: Value
    dimension: str = ""
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    small: float | None = None
    grid: float | None = None
    optional: bool = False
    choices: tuple[str, ...] = ()

    def check(self, value: Value) -> Value:
        """The value itself; InputError with the key, the value and what is allowed."""
        if value is None and self.optional:
            return value
        if self.kind == "choice":
            if value not in self.choices:
                raise InputError(self.key, f"{value!r} is not allowed; it must be one of {', '.join(self.choices)}")
            return value
        if self.kind == "intervals":
            assert isinstance(value, tuple)
            for pair in value:
                assert isinstance(pair, tuple)
                if not (0 <= pair[0] < pair[1] < math.inf):
                    said = f"{pair[0]:g}-{pair[1]:g} s"
                    raise InputError(self.key, f"{said} must start at 0 or later, and before it stops")
            return value
        numbers = value if isinstance(value, tuple) else (value,)
        if self.kind == "axes" and len(numbers) != self._count:
            raise InputError(self.key, f"{shown(value)} is not {_COUNTS[self._count]} numbers")
        for number in numbers:
            assert isinstance(number, float | int)
            size = abs(number) if self.kind == "axes" else number
            if not self.low <= size <= self.high:  # NaN lands here too
                raise InputError(self.key, f"{self._one(number, 6)} is not allowed; {self.allowed()}")
            if self.kind == "whole" and number != round(number):
                raise InputError(self.key, f"{number:g} is not a whole number")
        return value

    def allowed(self) -> str:
        """The bounds in words."""
        low, high = (self._one(x, 6) for x in (self.low, self.high))
        if self.kind == "axes":
            return f"each axis must be at most {high} in size"
        return f"it must be at least {low} and at most {high}"

    def read(self, text: str, unit: str = "") -> Value:
        """Text as a person writes it -> SI, checked. unit: taken where the text gives none.

        Raises
        ------
        InputError
            Naming the key, what was given and what is allowed.
        """
        stripped = text.strip()
        if self.optional and stripped.lower() in ("", "none"):
            return None
        if self.kind == "choice":
            return self.check(stripped)
        if self.kind == "intervals":
            return self.check(_read_intervals(self.key, stripped))
        parts = [part.strip() for part in re.split(r"[,;]", stripped)] if self.kind == "axes" else [stripped]
        if self.kind == "axes" and len(parts) not in (1, self._count):
            raise InputError(
                self.key,
                f"{shown(stripped)} has {len(parts)} values; give one for all axes, or {_COUNTS[self._count]}",
            )
        last = _NUMBER_FIRST.sub("", parts[-1]).strip() or unit
        try:
            numbers = [self._number(part, last) for part in parts]
        except QuantityError as error:
            raise InputError(self.key, str(error)) from error
        if self.kind != "axes":
            return self.check(numbers[0])
        return self.check(tuple(numbers if len(numbers) > 1 else numbers * self._count))

    def take(self, content: Any) -> Value:
        """A value as a study file holds it: text as `read` takes it, or a bare number where there is no unit.

        Raises
        ------
        InputError
            As `read`.
        """
        plain = isinstance(content, int | float) and not isinstance(content, bool)
        if plain and self.kind in ("number", "whole") and not self.dimension:
            return self.check(math.inf if abs(content) >= 1e300 else float(content))
        if not isinstance(content, str):
            example = self.show(self.default)
            raise InputError(self.key, f"{shown(content)} is not text in quotes; write for example {example!r}")
        return self.read(content)

    @property
    def _count(self) -> int:
        return len(self.default) if self.kind == "axes" and isinstance(self.default, tuple) else 1

    def _number(self, part: str, unit: str) -> float:
        if not self.dimension:
            try:
                return float(part.replace("−", "-"))
            except ValueError as error:
                raise QuantityError(f"{part[:40]!r} is not a number") from error
        return parse_quantity(part if _NUMBER_FIRST.sub("", part).strip() else f"{part} {unit}", self.dimension).value

    def show(self, value: Value, digits: int | None = 6) -> str:
        """A value in SI as text that `read` takes back, to `digits` significant digits; without digits, the
        shortest text that gives the same value back."""
        if value is None:
            return "none"
        if isinstance(value, str):
            return value
        if self.kind == "intervals":
            assert isinstance(value, tuple)
            return ", ".join(f"{_plain(start)}-{_plain(stop)} s" for start, stop in value)  # type: ignore[misc]
        if not isinstance(value, tuple):
            return self._one(value, digits)
        numbers = (self._one(x, digits).removesuffix(self.unit).strip() for x in value)  # type: ignore[arg-type]
        return join_quantity(", ".join(numbers), self.unit)

    def _one(self, value: float, digits: int | None) -> str:
        if not self.dimension or not math.isfinite(value):
            return f"{value:.{digits}g}" if digits else repr(value).removesuffix(".0")
        return format_quantity(value, self.unit, self.dimension, digits)


def _plain(number: float) -> str:
    return f"{Decimal(repr(number)).normalize():f}"


_COUNTS = {1: "one", 3: "three", 6: "six"}
_NUMBER_FIRST = re.compile(r"^[+\-−]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+\-−]?\d+)?")
_INTERVAL = re.compile(r"(\d+(?:\.\d+)?)\s*[-–]\s*(\d+(?:\.\d+)?)\s*s?")


def _read_intervals(key: str, text: str) -> tuple[tuple[float, float], ...]:
    pairs = []
    for part in filter(None, (piece.strip() for piece in re.split(r"[,;]", text))):
        match = _INTERVAL.fullmatch(part)
        if match is None:
            raise InputError(key, f'{part[:40]!r} is not an interval; write for example "200-260 s, 400-410 s"')
        pairs.append((float(match[1]), float(match[2])))
    return tuple(pairs)

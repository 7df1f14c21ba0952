"""The scale of a slider: places are decades of the value, and the far left may be zero."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, cast

from nav_model.base.units import from_si, to_si
from nav_model.design.declaration import BaseQuantity
from nav_model.design.several import Axes

STEP = 0.02
"""Decades of a key press: 4.7 %."""
_ZERO = 10 * STEP  # how far below the lowest value zero lies


@dataclass(frozen=True)
class LogScale:
    """A range of values [SI], the lowest above zero; with `zero` the far left means zero."""

    low: float
    high: float
    zero: bool

    @property
    def ends(self) -> tuple[float, float]:
        """Places of the two ends."""
        return math.log10(self.low) - (_ZERO if self.zero else 0.0), math.log10(self.high)

    @property
    def zero_below(self) -> float:
        """The place below which lies zero; below the scale if that is not on it."""
        return math.log10(self.low) - STEP / 2 if self.zero else -math.inf

    def place(self, value: float) -> float:
        """Where a value [SI] lies, or the nearest end."""
        start, end = self.ends
        return start if value <= 0 else min(max(math.log10(value), math.log10(self.low)), end)

    def amount(self, place: float, unit: str, dimension: str) -> float:
        """The value [SI] at a place, to three digits in a unit: one that can be quoted."""
        start, end = self.ends
        place = min(max(place, start), end)
        if place < self.zero_below:
            return 0.0
        number = 10.0**place
        if not dimension:
            return float(f"{number:.3g}")
        return to_si(Fraction(f"{from_si(number, unit, dimension):.3g}"), unit, dimension)


def scale_of(declared: BaseQuantity[Any] | Axes) -> LogScale:
    """The scale of a declaration, over its soft bounds; its far left is zero if that is allowed."""
    low, high = cast("tuple[float, float]", declared.softbounds)
    above_zero = isinstance(declared, BaseQuantity) and not declared.inclusive_bounds[0]
    return LogScale(low, high, declared.limits[0] == 0 and not above_zero)

"""A table as one input: rows of a frequency and an amount, such as "20 Hz 0.1 g; 80 Hz 0.02 g"."""

import math
import re
from itertools import pairwise
from types import MappingProxyType
from typing import Any

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError, quoted
from nav_model.base.units import format_bound, format_quantity, parse_quantity
from nav_model.design.table import Table

Row = tuple[float, float, str]
"""Frequency [Hz], amount [SI], and the dimension that the amount has."""
_FREQUENCIES = (1e-4, 1e9)  # Hz
_ROW = re.compile(r"([^\s:]+\s*[kMG]?Hz)\s*[:,]?\s*(.+)")
_MOST = MappingProxyType(
    {"acceleration": 1e4, "length": 1e2, "acceleration density": 1e8, "length density": 1e4, "phase noise": 1e3}
)
_LEAST = 1e-40  # of a density: below it, a logarithm of rounding


class Rows(Table):
    """A table: a tuple of `Row`, empty when it is not given.

    Parameters
    ----------
    dimensions : tuple of str
        Of the amount, each row in one of them; the first unit of each is the one it is shown in.
    curve : bool
        Whether the rows are points of a curve, straight in logarithms: two or more, frequencies rising, amounts above
        zero. Otherwise each row counts by itself.
    """

    __slots__ = ["curve", "dimensions"]

    dimensions: tuple[str, ...]
    curve: bool

    def __init__(self, *, dimensions: tuple[str, ...], curve: bool, **params: Any) -> None:
        self.dimensions, self.curve = dimensions, curve
        super().__init__(columns={"frequency": None, "amplitude": None, "dimension": None}, **params)

    def _check(self, val: tuple[Row, ...]) -> None:
        low, high = _FREQUENCIES
        for frequency, amount, dimension in val:
            if dimension not in self.dimensions:
                raise InputError(self.key, f"{dimension!r} is not one of {', '.join(self.dimensions)}", val)
            if not low <= frequency <= high:  # NaN lands here too
                raise InputError(
                    self.key, f"{frequency:g} Hz is not allowed. Give frequencies from 0.0001 Hz to 1 GHz.", val
                )
            least, most = _LEAST if self.curve else 0.0, _MOST[dimension]
            if not least <= amount <= most:
                sayable = math.isfinite(amount) and (amount > 0 or not DIMENSIONS[dimension].decibels)
                text = _amount_text(amount, dimension) if sayable else f"{amount:g} (SI)"
                above = "more than zero and " if self.curve else "zero or more and "
                above = "" if DIMENSIONS[dimension].decibels else above
                bound = f"It must be {above}at most {format_bound(most, _unit(dimension), dimension, low=False)}."
                raise InputError(self.key, f"{text} at {frequency:g} Hz is not allowed. {bound}", val)
        if self.curve and val:
            self._validate_curve(val)

    def _validate_curve(self, val: tuple[Row, ...]) -> None:
        if len(val) < 2:
            raise InputError(self.key, "A curve needs two rows or more.", val)
        for (before, *_), (after, *_) in pairwise(val):
            if not after > before:
                raise InputError(
                    self.key, f"{after:g} Hz comes after {before:g} Hz. Sort the rows by rising frequency.", val
                )
        if len({dimension for *_, dimension in val}) > 1:
            raise InputError(self.key, f"The rows mix {' and '.join(self.dimensions)}. Give all in one of them.", val)

    def _row(self, row: Any, number: int) -> Row:
        del number  # the message quotes the row
        pair: Any = row
        if isinstance(row, str) and (match := _ROW.fullmatch(row.strip())):
            pair = match.groups()
        elif isinstance(row, dict) and row.keys() == {"frequency", "amplitude"}:
            pair = row["frequency"], row["amplitude"]
        if not isinstance(pair, list | tuple) or len(pair) != 2 or not all(isinstance(part, str) for part in pair):
            raise InputError(self.key, f"{quoted(row)} is not a row. Write for example {self.example}.", row)
        refused = ""
        for dimension in self.dimensions:
            try:
                return parse_quantity(pair[0], "frequency").value, parse_quantity(pair[1], dimension).value, dimension
            except InputError as error:
                refused = refused or error.reason
        raise InputError(self.key, refused, row)

    def write(self, value: tuple[Row, ...]) -> list[list[str]] | list[dict[str, str]]:
        pairs = [
            [format_quantity(frequency, "Hz", "frequency"), _amount_text(amount, dimension, None)]
            for frequency, amount, dimension in value
        ]
        return pairs if self.curve else [{"frequency": at, "amplitude": amount} for at, amount in pairs]

    def show(self, value: tuple[Row, ...], digits: int | None = None) -> str:
        return "; ".join(
            f"{format_quantity(frequency, 'Hz', 'frequency', digits)} {_amount_text(amount, dimension, digits)}"
            for frequency, amount, dimension in value
        )

    def link(self, value: tuple[Row, ...]) -> str:
        """Text for a link, with a colon in each row: links go without spaces."""
        return ";".join(self.show((row,)).replace("Hz ", "Hz:", 1) for row in value)


def _amount_text(amount: float, dimension: str, digits: int | None = 6) -> str:
    return format_quantity(amount, _unit(dimension), dimension, digits)


def _unit(dimension: str) -> str:
    return {"acceleration": "g", "length": "mm"}.get(dimension, DIMENSIONS[dimension].default_unit)

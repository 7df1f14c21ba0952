"""The kinds of quantity, and the units of each with their exact factors to SI, read from `dimensions.toml`."""

import math
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.toml_text import shipped

_FINE = Context(prec=40)
MAX_EXPONENT = 400
"""Powers of ten beyond this are refused: no float has them, and an exact rational would only cost memory."""
_NAMED = {"deg": Fraction(math.pi) / 180, "g": Fraction(str(STANDARD_GRAVITY)), "ft": Fraction("0.3048")}


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity.

    Attributes
    ----------
    name : str
        As used in messages.
    units : dict
        Canonical symbol -> exact factor to SI. The first is the default for display.
    examples : tuple of str
        Quantity strings offered to a user whose text was refused.
    decibels : int
        20 where the units are decibels of an amplitude, 10 of a power: SI then is the ratio itself. 0: no decibels.
    """

    name: str
    units: dict[str, Fraction]
    examples: tuple[str, ...]
    decibels: int = 0

    def amount(self, number: Fraction, unit: str) -> Fraction:
        """A number of `unit` (canonical symbol) in SI."""
        scaled = number * self.units[unit]
        if not self.decibels:
            return scaled
        exponent = _FINE.divide(Decimal(scaled.numerator), Decimal(scaled.denominator * self.decibels))
        largest = Decimal(MAX_EXPONENT)
        return Fraction(_FINE.power(10, min(max(exponent, -largest), largest)))

    def number(self, amount: Fraction, unit: str) -> Fraction:
        """An amount in SI as a number of `unit`; in decibels, one that is not above zero is far below any."""
        if self.decibels:
            amount = max(amount, Fraction(1, 10**MAX_EXPONENT))
            level = _FINE.divide(Decimal(amount.numerator), Decimal(amount.denominator)).log10(_FINE)
            amount = Fraction(level) * self.decibels
        return amount / self.units[unit]

    @property
    def default_unit(self) -> str:
        """The unit a value is shown in unless its owner says otherwise."""
        return next(iter(self.units))


def _factor(text: str) -> Fraction:
    """The factor that a product over other factors says, such as "deg/3600/60".

    >>> _factor("2*3/4")
    Fraction(3, 2)
    """
    above, *below = ([_NAMED.get(each) or Fraction(each) for each in part.split("*")] for part in text.split("/"))
    return math.prod(above, start=Fraction(1)) / math.prod((math.prod(part) for part in below), start=Fraction(1))


DIMENSIONS: dict[str, Dimension] = {
    name: Dimension(
        name,
        {unit: _factor(text) for unit, text in row["units"].items()},
        tuple(row["examples"]),
        row.get("decibels", 0),
    )
    for name, row in shipped("nav_model.base", "dimensions").items()
}

"""Quantity strings as printed on data sheets, both ways: ``"0.5 °/√h"`` <-> SI.

Inside the model everything is SI; a unit exists only here, at the edge. A quantity is a decimal number
followed by a unit of the dimension its key asks for. Every unit has one canonical spelling, used for
printing, and is read in the usual ASCII spellings too (``deg/sqrt(h)``, ``ug/sqrt(Hz)``, ``m/s^2``).

Conversions are exact rational arithmetic rounded once, so that printing and reading again gives the same
float, whatever the unit. The units themselves are in `nav_model.base.dimensions`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cache, lru_cache
from typing import NamedTuple

from nav_model.base.dimensions import DIMENSIONS, MAX_EXPONENT
from nav_model.base.errors import InputError, shown

_KEY = "quantity"  # in errors, until whoever asked for the quantity puts his own key in its place


class Parsed(NamedTuple):
    """A value in SI and the canonical symbol of the unit it was written in."""

    value: float
    unit: str


# Spellings met on data sheets and keyboards, rewritten in this order before the table is consulted.
_REWRITES: tuple[tuple[str, str], ...] = (
    ("μ", "µ"),  # Greek mu -> micro sign
    ("º", "°"),
    ("˚", "°"),
    ("degrees", "°"),
    ("degree", "°"),
    ("deg", "°"),
    ("√(", "sqrt("),
    ("rtHz", "√Hz"),
    ("**", "^"),
    ("^2", "²"),
    ("s2", "s²"),
    ("2/Hz", "²/Hz"),
    ("sec", "s"),
    ("hour", "h"),
    ("hr", "h"),
)
_SQRT = re.compile(r"sqrt\((\w+)\)|sqrt(Hz|h|s)\b|(Hz|h|s)\^(?:0\.5|\(?1/2\)?)")
_NUMBER = re.compile(r"[+\-−]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+\-−]?\d+)?")
_APART = re.compile(r"\w\s+\w")


def _canonical_spelling(unit: str) -> str:
    if _APART.search(unit.strip()):  # "1 m m" must not pass for millimetres
        return unit
    text = "".join(unit.split()).replace("arcsec", "\0")  # "sec" below must not touch it
    for old, new in _REWRITES:
        text = text.replace(old, new)
    text = _SQRT.sub(lambda m: "√" + (m[1] or m[2] or m[3]), text)
    if text.startswith("u") and text[1:2] in {"g", "m"}:
        text = "µ" + text[1:]
    return text.replace("\0", "arcsec")


_ALIASES: dict[str, str] = {
    "dps/√Hz": "°/s/√Hz",
    "dps": "°/s",
    "dph": "°/h",
    "fps/√h": "ft/s/√h",
    "fps": "ft/s",
    "kt": "kn",
    "kmh": "km/h",
    "nmi": "NM",
    "'": "arcmin",
    '"': "arcsec",
    "as": "arcsec",
}


def unit_symbol(unit: str, dimension: str) -> str:
    """Canonical symbol of a unit in any accepted spelling.

    Raises
    ------
    InputError
        If the text is not a unit of the dimension.
    """
    table = DIMENSIONS[dimension]
    text = _canonical_spelling(unit)
    text = _ALIASES.get(text, text)
    if text not in table.units:
        rate = dimension == "interval"
        *most, last = [*table.units, "Hz"] if rate else table.units
        choice = f"{', '.join(most)} or {last}" if most else last
        name = "time" if rate else table.name
        raise InputError(_KEY, f"{shown(unit.strip())} is not a unit of {name}. Use {choice}.", unit)
    return text


def _article(name: str) -> str:
    """A name with its indefinite article.

    >>> _article("angle"), _article("length")
    ('an angle', 'a length')
    """
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def parse_quantity(text: str, dimension: str) -> Parsed:
    """Read a quantity string.

    Parameters
    ----------
    text : str
        A number and a unit, such as ``"0.5 °/√h"``, ``"80 ug/sqrt(Hz)"`` or ``"45°"``.
    dimension : str
        Key of `DIMENSIONS`.

    Returns
    -------
    Parsed
        Value in SI and the canonical unit symbol.

    Raises
    ------
    InputError
        If there is no number, no unit, the unit belongs to another dimension, or no float holds the value.
    """
    exact, symbol = parse_exact(text, dimension)
    try:
        return Parsed(float(exact), symbol)
    except OverflowError as error:
        raise InputError(_KEY, f"{shown(text)} is too large.", text) from error


def parse_exact(text: str, dimension: str, advice: str = "") -> tuple[Fraction, str]:
    """As `parse_quantity`, with the value in SI as an exact rational.

    `advice` is the sentence that says what to write instead of a text that is no quantity; empty: an example.
    """
    table = DIMENSIONS[dimension]
    refused = f"{shown(text)} is not {_article(table.name)}. {advice or f'Try {table.examples[0]}.'}"
    stripped = with_point(text.strip())
    match = _NUMBER.match(stripped)
    if match is None or len(stripped) > 100:
        raise InputError(_KEY, refused, text)
    number, unit = match[0].replace("−", "-"), stripped[match.end() :]
    if not unit.strip():
        example = join_quantity(match[0], table.examples[0].lstrip("-.0123456789e "))
        raise InputError(_KEY, f"{shown(text)} has no unit. Write for example {example}.", text)
    if re.match(r",\d", unit):
        raise InputError(_KEY, f"{shown(text)} can be read in two ways. Write it without the comma.", text)
    if re.match(r"\s+\d", unit):
        raise InputError(_KEY, f"{shown(text)} has a space in its number. Write it without.", text)
    if dimension == "interval" and _canonical_spelling(unit) in DIMENSIONS["frequency"].units:
        rate = parse_exact(stripped, "frequency")[0]  # "5 Hz" is 0.2 s
        if rate <= 0:
            raise InputError(_KEY, refused, text)
        return 1 / rate, table.default_unit
    symbol = unit_symbol(unit, dimension)
    return table.amount(_decimal(number, text), symbol), symbol


_COMMA = re.compile(r"([+\-−]?\d*),(\d+)(?![\d.,])")


def with_point(text: str) -> str:
    """A number with a decimal comma as one with a point; "1,000", which may mean a thousand, stays as it is.

    >>> with_point("0,5 °/√h"), with_point("1,000 m")
    ('0.5 °/√h', '1,000 m')
    """
    match = _COMMA.match(text)
    if match is None or (len(match[2]) == 3 and match[1].lstrip("+-−") not in {"", "0"}):
        return text
    return f"{match[1]}.{match[2]}{text[match.end() :]}"


def _decimal(number: str, text: str) -> Fraction:
    exponent = number.lower().partition("e")[2]
    if exponent and abs(int(exponent)) > MAX_EXPONENT:
        raise InputError(_KEY, f"{shown(text)} is too large or too small.", text)
    return Fraction(number)


def to_si(number: float | Fraction, unit: str, dimension: str) -> float:
    """Number in `unit` (canonical symbol) to SI, rounded once.

    Raises
    ------
    InputError
        If the result is too large for a float.
    """
    try:
        return float(DIMENSIONS[dimension].amount(Fraction(number), unit))
    except OverflowError as error:
        raise InputError(_KEY, f"The number before {unit!r} is too large.", number) from error


def from_si(value: float, unit: str, dimension: str) -> float:
    """Value in SI to a number in `unit` (canonical symbol), rounded once."""
    if math.isfinite(value) and (times := _whole_times(unit, dimension)):
        return float(value) * times  # rounds once as well
    return float(DIMENSIONS[dimension].number(Fraction(value), unit))


@cache
def _whole_times(unit: str, dimension: str) -> float:
    """How many of the unit make one in SI, where that is a whole number, or zero."""
    kind = DIMENSIONS[dimension]
    share = 0 if kind.decibels else 1 / kind.units[unit]
    return float(share) if share.denominator == 1 and share < 2**53 else 0.0


@lru_cache(maxsize=4096)
def format_quantity(
    value: float, unit: str, dimension: str, digits: int | None = None, *, zeros: bool = False
) -> str:
    """Print a value in SI as a quantity string in `unit`.

    Parameters
    ----------
    value : float
        SI.
    unit : str
        Canonical symbol.
    dimension : str
        Key of `DIMENSIONS`.
    digits : int, optional
        Significant digits. Without it, the fewest that read back as exactly the same float.
    zeros : bool
        Whether zeros at the end count as digits: ``"0.500 °/√h"``.

    Returns
    -------
    str
        ``"0.5 °/√h"``; a plain degree sign follows its number without a space: ``"45°"``.
    """
    kind = DIMENSIONS[dimension]
    exact = kind.number(Fraction(value), unit)
    if digits is None:
        number = shortest_decimal(exact, lambda decimal: float(kind.amount(decimal, unit)) == value)
    else:
        number = plain_number(float(exact), digits, zeros=zeros)
    return join_quantity(number, unit)


def format_bound(value: float, unit: str, dimension: str, *, low: bool) -> str:
    """The lowest or highest allowed value (SI) as a quantity string that is itself allowed.

    Six digits at most; the last is rounded towards the inside of the range.
    """
    inside = Context(prec=6, rounding=ROUND_CEILING if low else ROUND_FLOOR).plus(_near(value, unit, dimension))
    return join_quantity(_plain_decimal(inside.normalize()), unit)


def exact_bound(value: float, unit: str, dimension: str) -> float:
    """A lowest or highest allowed value (SI) as its text in `unit` reads, if six digits say it.

    Declared as a product of floats, it may miss that by rounding, and its own text would be refused.
    """
    near = _near(value, unit, dimension)
    return to_si(Fraction(near), unit, dimension) if Context(prec=6).plus(near) == near else value


def _near(value: float, unit: str, dimension: str) -> Decimal:
    """A value in SI as a number of `unit`, without the rounding in its last digits."""
    exact = DIMENSIONS[dimension].number(Fraction(value), unit)
    return Context(prec=12).divide(Decimal(exact.numerator), Decimal(exact.denominator))


def join_quantity(number: str, unit: str) -> str:
    """Number and unit as the field writes them: a space between, none before a plain degree sign."""
    return f"{number}{'' if unit == '°' else ' '}{unit}"


def shortest_decimal(exact: Fraction, reads_back: Callable[[Fraction], bool]) -> str:
    """Fewest significant digits of `exact` that `reads_back` accepts.

    Seventeen digits rounded from the exact value always identify a float, nineteen one in decibels.
    """
    quotient = Context(prec=40).divide(Decimal(exact.numerator), Decimal(exact.denominator))
    for digits in range(1, 20):
        rounded = Context(prec=digits).plus(quotient)
        if reads_back(Fraction(rounded)):
            break
    return _plain_decimal(rounded.normalize())


def plain_number(number: float, digits: int, *, zeros: bool = False) -> str:
    """Decimal text of `number` with `digits` significant digits; `zeros`: those at the end too, but for a zero."""
    rounded = Decimal(f"{number:.{digits - 1}e}")  # once, from the exact value
    if not rounded.is_finite():
        return str(rounded)
    return _plain_decimal(rounded if zeros else rounded.normalize())


_POSITIONAL = -5, 9
"""Powers of ten between which a reader expects positional digits: 1e-5 to 1e9; scientific outside."""


def _plain_decimal(number: Decimal) -> str:
    if not number:
        return "0"
    if _POSITIONAL[0] <= number.adjusted() <= _POSITIONAL[1]:
        return f"{number:f}"
    mantissa, _, exponent = f"{number:e}".partition("e")
    return f"{mantissa}e{int(exponent)}"

"""Quantity strings as printed on data sheets, both ways: ``"0.5 °/√h"`` <-> SI.

Inside the model everything is SI; a unit exists only here, at the edge. A quantity is a decimal number
followed by a unit of the dimension its key asks for, in any spelling of `nav_model.base.text.unit_text`; what is
printed has one. Words about its accuracy bring it to one sigma per axis (`nav_model.base.dimensions`).

Conversions are exact rational arithmetic rounded once, so that printing and reading again gives the same
float, whatever the unit. The units themselves are in `nav_model.base.dimensions`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from contextlib import suppress
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cache, lru_cache
from typing import NamedTuple

from nav_model.base.dimensions import DIMENSIONS, MAX_EXPONENT
from nav_model.base.errors import InputError, quoted
from nav_model.base.text.unit_text import LONGEST, RAISED, plain_signs

_KEY = "quantity"  # in errors, until the caller puts the key of the input in its place


class Parsed(NamedTuple):
    """A value in SI and the canonical symbol of the unit it was written in."""

    value: float
    unit: str


# Of texts with `plain_signs`.
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_BEFORE = re.compile(r"(?:([A-Za-z]\w*\.?)[\s:=]+(?=[\d.,±<≤~≈+]))?(?:[±<≤~≈]|\+\s*/\s*-)?\s*(?=[\d.,])")
_TIMES_TEN = re.compile(r"^([+-]?[\d.]+)\s*[x·*]\s*10\s*(?:\^|\*\*)?\s*([-+⁻⁺]?[\d⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3})(?=\D)")
_IN_BRACKETS = re.compile(r"\((?=[\d.])([^()]*)\)(.*)")
_PLACE = re.compile(
    r"""([NSEW])?\s*([+-])?(\d+(?:\.\d*)?)\s*
    (?:(?:°|deg\b)\s*(?:(\d+(?:\.\d*)?)\s*'\s*(?:(\d+(?:\.\d*)?)\s*"\s*)?)?)?([NSEW])?""",
    re.VERBOSE,
)


def parse_quantity(text: str, dimension: str) -> Parsed:
    """Read a quantity string: a number and a unit of a dimension (key of `DIMENSIONS`), such as ``"0.5 °/√h"``,
    ``"80 ug/sqrt(Hz)"`` or ``"45°"``.

    Raises InputError if there is no number, no unit, the unit belongs to another dimension, or no float holds the
    value.
    """
    exact, symbol = parse_exact(text, dimension)
    try:
        return Parsed(float(exact), symbol)
    except OverflowError as error:
        raise InputError(_KEY, f"{quoted(text)} is too large.", text) from error


def parse_exact(
    text: str, dimension: str, advice: str = "", *, baseline: float | None = None, letters: str = ""
) -> tuple[Fraction, str]:
    """As `parse_quantity`, with the value in SI as an exact rational.

    Parameters
    ----------
    text : str
        Number and unit.
    dimension : str
        Key of `DIMENSIONS`.
    advice : str, optional
        Sentence that says what to write instead of a text that is no quantity; an example by default.
    baseline : float, optional
        Distance from the base station [m], which "1 cm + 1 ppm" needs.
    letters : str, optional
        The two letters that the angle of a place may have, "NS" or "EW".

    Raises
    ------
    InputError
        If there is no number, no unit, or the unit belongs to another dimension.
    """
    table = DIMENSIONS[dimension]
    stripped = with_point(plain_signs(text.strip()))
    match = _NUMBER.match(stripped)
    if match and len(stripped) <= LONGEST and (unit := stripped[match.end() :].strip()) in table.units:
        return table.amount(_decimal(match[0], text), unit), unit
    article = "an" if table.name[0] in "aeiou" else "a"
    refused = f"{quoted(text)} is not {article} {table.name}. {advice or f'Try {table.examples[0]}.'}"
    if len(stripped) > LONGEST:
        raise InputError(_KEY, refused, text)
    if dimension == "angle" and (place := _place(stripped, letters)) is not None:
        return place * table.units["°"], "°"
    if match is None or "10" in stripped:
        stripped = _from_its_number(stripped)
        match = _NUMBER.match(stripped)
    if match is None:
        raise InputError(_KEY, refused, text)
    unit = stripped[match.end() :]
    if not unit.strip():
        if dimension == "ratio":
            return _decimal(match[0], text), table.default_unit
        example = join_quantity(match[0], table.examples[0].lstrip("-.0123456789e "))
        raise InputError(_KEY, f"{quoted(text)} has no unit. Write for example {example}.", text)
    if re.match(r",\d", unit):
        raise InputError(_KEY, f"{quoted(text)} can be read in two ways. Write it without the comma.", text)
    if re.match(r"\s+\d", unit):
        raise InputError(_KEY, f"{quoted(text)} has a space in its number. Write it without.", text)
    if dimension == "interval":
        rate = None
        with suppress(InputError):
            rate = parse_exact(stripped, "frequency")[0]  # "5 Hz" is 0.2 s
        if rate is not None:
            if rate <= 0:
                raise InputError(_KEY, refused, text)
            return 1 / rate, table.default_unit
    scale = table.scale(unit.strip())
    if scale.per_metre and not (baseline is not None and math.isfinite(baseline)):
        asked = "Write" if baseline is None else "Give gnss.baseline, for example 10 km, or write"
        raise InputError(_KEY, f"{quoted(text)} grows with the baseline. {asked} the sum at yours.", text)
    along = baseline if scale.per_metre and baseline else 0.0
    return table.amount(_decimal(match[0], text), scale.unit, along), scale.unit


def _from_its_number(text: str) -> str:
    """A quantity without ± or < before its number and brackets about a sum; a word such as CEP goes behind.

    >>> _from_its_number("CEP: ±2·10⁻³ m")
    '2e-3 m CEP'
    """
    match = _IN_BRACKETS.fullmatch(text)
    bare = match[1] + match[2] if match else text
    if before := _BEFORE.match(bare):
        bare = with_point(f"{bare[before.end() :]} {before[1] or ''}".strip())
    return _TIMES_TEN.sub(lambda ten: f"{ten[1]}e{ten[2].translate(RAISED)}", bare, count=1)


def _place(text: str, letters: str) -> Fraction | None:
    """Degrees of 48°12'30" or 48.2° N; None for a text of another kind.

    Raises InputError for minutes or seconds above 60, or a letter that the angle does not take.
    """
    match = _PLACE.fullmatch(text)
    if match is None or not (match[1] or match[4] or match[6]):
        return None
    minutes, seconds = Fraction(match[4] or 0), Fraction(match[5] or 0)
    if not (minutes < 60 and seconds < 60):
        raise InputError(_KEY, f"{quoted(text)} has 60 minutes or seconds, or more.", text)
    letter = (match[1] or "") + (match[6] or "")
    if letter not in ("", *letters) or (letter and match[2]):
        advice = f"with {letters[0]} or {letters[1]}" if letters else "without a point of the compass"
        raise InputError(_KEY, f"{quoted(text)} is not such an angle. Write it {advice}, or with a sign.", text)
    degrees = Fraction(match[3]) + minutes / 60 + seconds / 3600
    return -degrees if letter in ("S", "W") or match[2] == "-" else degrees


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
        raise InputError(_KEY, f"{quoted(text)} is too large or too small.", text)
    return Fraction(number)


def to_si(number: float | Fraction, unit: str, dimension: str) -> float:
    """Number in `unit` (canonical symbol) to SI, rounded once; InputError if it is too large for a float."""
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
    """Number of the unit that make one in SI where that is whole, or else zero."""
    kind = DIMENSIONS[dimension]
    share = 0 if kind.decibels or (scale := kind.scale(unit)).per_metre else 1 / scale.size
    return float(share) if share.denominator == 1 and share < 2**53 else 0.0


@lru_cache(maxsize=4096)
def format_quantity(
    value: float, unit: str, dimension: str, digits: int | None = None, *, zeros: bool = False, baseline: float = 0.0
) -> str:
    """Print a value in SI as a quantity string, ``"0.5 °/√h"`` or ``"45°"``.

    Parameters
    ----------
    value : float
        SI.
    unit : str
        Canonical symbol, or what follows the number, as `parse_quantity` has it.
    dimension : str
        Key of `DIMENSIONS`.
    digits : int, optional
        Significant ones; by default the fewest that read back as exactly the same float.
    zeros : bool, optional
        True to keep those at the end: ``"0.500 °/√h"``.
    baseline : float, optional
        Distance from the base station [m], where the unit has a part for each kilometre.
    """
    kind = DIMENSIONS[dimension]
    exact = kind.number(Fraction(value), unit, baseline)
    if digits is None:
        number = shortest_decimal(exact, lambda decimal: float(kind.amount(decimal, unit, baseline)) == value)
    else:
        number = plain_number(float(exact), digits, zeros=zeros)
    return join_quantity(number, unit)


def format_bound(value: float, unit: str, dimension: str, *, low: bool) -> str:
    """The lowest or highest allowed value as a quantity string that is itself allowed.

    Six digits at most; the last is rounded towards the inside of the range.

    Parameters
    ----------
    value : float
        SI.
    unit : str
        Canonical symbol.
    dimension : str
        Key of `DIMENSIONS`.
    low : bool
        True for the lowest value.
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


def clock(seconds: float) -> str:
    """A time as minutes and seconds.

    >>> clock(489.6), clock(7.0)
    ('8:10', '0:07')
    """
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"


def time_in_words(seconds: float) -> str:
    """A time to three digits below a minute, in minutes and whole seconds from there on.

    >>> time_in_words(12.34), time_in_words(489.6), time_in_words(600.0)
    ('12.3 s', '8 min 10 s', '10 min')
    """
    if seconds < 59.95:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if rest else f"{minutes} min"

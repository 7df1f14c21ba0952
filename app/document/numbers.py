"""One digit rule for page, report and command: three significant digits, and the unit that keeps them near one.

A computed figure shows all its digits, zeros too: 0.150 says more than 0.15. What a person gave, such as a limit or
an outage, is shown as it was given: a limit of 2 m is not one of 2.00 m.
"""

import math
import re
from collections.abc import Sequence

from nav_model.aperture.geometry import phase_to_metres
from nav_model.base.units import format_quantity, from_si, plain_number, to_si

DIGITS = 3
NONE = "–"
"""Text of a table where there is no figure."""

_LADDERS: dict[str, tuple[str, ...]] = {
    "length": ("mm", "cm", "m", "km"),
    "speed": ("mm/s", "cm/s", "m/s"),
    "angle": ("arcsec", "°"),
    "time": ("ms", "s"),
}
_LEAST = {
    dimension: tuple((to_si(1, unit, dimension), unit) for unit in reversed(ladder))
    for dimension, ladder in _LADDERS.items()
}
_LEFT = 1e-8  # of the whole: less is rounding
_NEAR = 0.005  # of a limit: nearer, three digits of the value may be those of the limit
_SMALL_ANGLE = math.radians(0.001)
_POWER = re.compile(r"(?<=\d)e(-?\d+)")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int = DIGITS, *, given: bool = False) -> str:
    """A number to `digits` significant digits, with a minus sign as typeset; ``given``: without zeros at its end.

    >>> number(-0.0123456), number(0.15), number(0.15, given=True), number(6.2e-6)
    ('−0.0123', '0.150', '0.15', '6.20·10⁻⁶')
    """
    return _signed(plain_number(float(value), digits, zeros=not given))


def show(value: float, dimension: str, *, given: bool = False, like: float | None = None) -> str:
    """A value [SI] with the unit of its dimension that puts it at or above one, or the smallest unit.

    ``like``: in the unit of this one, which it is compared with.

    >>> show(0.0474565, "length"), show(100.0, "time"), show(50.0, "time", given=True)
    ('4.75 cm', '100 s', '50 s')
    >>> show(0.0474565, "length", like=2.0)
    '0.0475 m'
    """
    ladder = _LADDERS[dimension]
    size = abs(value if like is None else like)
    if dimension == "angle":
        unit = "arcsec" if 0 < size < _SMALL_ANGLE else "°"
    else:
        unit = next((unit for least, unit in _LEAST[dimension] if size >= least), ladder[0])
        if size == 0:
            unit = ladder[-2] if dimension == "length" else ladder[-1]
    return f"{number(from_si(value, unit, dimension), given=given)}{'' if unit == '°' else ' '}{unit}"


def in_one_unit(values: Sequence[float | None], dimension: str) -> tuple[str, ...]:
    """The values [SI] of a column in one unit: the largest in which none is below one, while none has four digits.

    >>> in_one_unit((0.00866, 0.198, None), "speed"), in_one_unit((0.002, 5.0), "length")
    (('8.66 mm/s', '198 mm/s', '–'), ('0.200 cm', '500 cm'))
    """
    sizes = [abs(value) for value in values if value] or [1.0]
    units = [(least, unit) for least, unit in _LEAST[dimension] if max(sizes) < 999.5 * least] or _LEAST[dimension][
        :1
    ]
    unit = next((unit for least, unit in units if min(sizes) >= least), units[-1][1])
    if dimension == "angle":
        unit = "arcsec" if max(sizes) < _SMALL_ANGLE else "°"
    between = "" if unit == "°" else " "
    numbers = (None if value is None else number(from_si(value, unit, dimension)) for value in values)
    return tuple(NONE if text is None else f"{text}{between}{unit}" for text in numbers)


def show_in(value: float, unit: str, dimension: str, *, given: bool = False) -> str:
    """A value [SI] in a unit of its dimension."""
    return _signed(format_quantity(value, unit, dimension, DIGITS, zeros=not given))


def percent(share: float) -> str:
    """A share: whole percents, a tenth below ten and where all would be said of less.

    >>> percent(0.783), percent(0.0456), percent(0.0001), percent(0.996), percent(1.0)
    ('78 %', '4.6 %', '< 0.1 %', '99.6 %', '100 %')
    """
    value = _short_of_all(share)
    if 0 < value < 0.05:
        return "< 0.1 %"
    return f"{value:.1f} %" if 0 < value < 9.95 or 99.5 <= value < 100 else f"{value:.0f} %"


def signed_percent(margin: float) -> str:
    """A margin: three significant digits of a percent that is left, at most a tenth; of a limit that is exceeded, how
    many times it is reached.

    >>> signed_percent(0.1421), signed_percent(-0.0967), signed_percent(0.0), signed_percent(0.9996)
    ('+14.2 %', '1.10 × the limit', 'at the limit', '+99.9 %')
    """
    value = _short_of_all(margin)
    if margin <= -_NEAR:
        return f"{number(1 - margin)} × the limit"
    return _at_limit(margin) if value < 0.05 else f"+{value:.1f} %" if value < 99.95 else "+100 %"


def margin_in_sentence(margin: float) -> str:
    """A margin with its noun where it is a percentage.

    >>> margin_in_sentence(0.1421), margin_in_sentence(-1.4437)
    ('margin +14.2 %', '2.44 × the limit')
    """
    text = signed_percent(margin)
    return f"margin {text}" if text.endswith("%") else text


def margin_in_short(margin: float) -> str:
    """Margin of a requirement in short, met or not: whole percents, or a tenth where
    little of the limit is used, as 100 says that nothing is.

    >>> margin_in_short(0.798), margin_in_short(0.0004), margin_in_short(-0.0967), margin_in_short(0.996)
    ('✓ +80 %', '✓ at the limit', '✗ 1.10 ×', '✓ +99.6 %')
    """
    words = signed_percent(margin).removesuffix(" the limit") if margin <= -_NEAR else _at_limit(margin)
    if margin >= _NEAR:
        little = _LEFT < 1 - margin < _NEAR
        words = f"{_short_of_all(margin):+.1f} %" if little else f"{100 * margin:+.0f} %"
    return f"{'✓' if margin >= 0 else '✗'} {words}"


def _short_of_all(share: float) -> float:
    """In percent, at most 99.9 while any of the whole is left."""
    return min(100 * share, 99.9) if share < 1 - _LEFT else 100 * share


def _at_limit(margin: float) -> str:
    return "at the limit" if margin >= 0 else "just over the limit"


def decibels(value: float) -> str:
    """A level or a ratio."""
    return f"{hundredths(value)} dB"


def signed_decibels(value: float) -> str:
    """A level over another, its sign always shown."""
    return f"{hundredths(value, sign='+')} dB"


def hundredths(value: float, sign: str = "-") -> str:
    """A number with two decimals, such as decibels; no minus before a zero.

    >>> hundredths(-0.001), hundredths(-13.264), hundredths(0.15, sign="+")
    ('0.00', '−13.26', '+0.15')
    """
    return _signed(f"{round(value, 2) + 0.0:{sign}.2f}")


def degrees(phase: float) -> str:
    """A phase [rad] as a number of degrees."""
    return number(math.degrees(phase))


def millimetres(phase: float, wavelength: float) -> str:
    """A phase [rad] as a number of millimetres along the line of sight."""
    return number(1000 * float(phase_to_metres(phase, wavelength)))


def _signed(text: str) -> str:
    powers = _POWER.sub(lambda match: f"·10{match[1].translate(_RAISED)}", text)
    return powers.replace("-", "−")

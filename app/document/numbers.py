"""Numbers as an engineer reads them: three significant digits, a unit that keeps them near one."""

from __future__ import annotations

import math

from nav_model.units import from_si, plain_number

_LADDERS: dict[str, tuple[str, ...]] = {
    "length": ("mm", "cm", "m", "km"),
    "speed": ("mm/s", "cm/s", "m/s"),
    "angle": ("arcsec", "°"),
    "time": ("ms", "s"),
}
_SMALL_ANGLE = math.radians(0.001)


def show(value: float, dimension: str, digits: int = 3) -> str:
    """A value in SI with the unit of its ladder that puts it at or above one, or the smallest unit."""
    ladder = _LADDERS[dimension]
    if dimension == "angle":
        unit = "arcsec" if 0 < abs(value) < _SMALL_ANGLE else "°"
    else:
        unit = next((u for u in reversed(ladder) if abs(from_si(value, u, dimension)) >= 1), ladder[0])
        if value == 0:
            unit = ladder[-2] if dimension == "length" else ladder[-1]
    return f"{plain_number(from_si(value, unit, dimension), digits)}{'' if unit == '°' else ' '}{unit}"


def percent(fraction: float) -> str:
    """A fraction as a percentage without decimals, signed minus as typeset."""
    return f"{100 * fraction:.0f} %".replace("-", "−")


def signed_percent(fraction: float) -> str:
    """A margin: its sign always shown."""
    return f"{100 * fraction:+.0f} %".replace("-", "−")


def decibels(value: float) -> str:
    """A level or a ratio, to a hundredth."""
    return f"{float(value):.2f} dB".replace("-", "−")

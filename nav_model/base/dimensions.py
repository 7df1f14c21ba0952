"""The kinds of quantity, and the units of each with their exact factors to SI.

Factors follow theory.md section 1: standard gravity 9.80665 m/s² converts units; the local gravity of a design is a
separate quantity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction

from nav_model.base.constants import STANDARD_GRAVITY

_PI = Fraction(math.pi)
_DEGREE = _PI / 180
_G = Fraction(str(STANDARD_GRAVITY))
_FOOT = Fraction("0.3048")
_FINE = Context(prec=40)
MAX_EXPONENT = 400
"""Powers of ten beyond this are refused: no float has them, and an exact rational would only cost memory."""
_MICRO = Fraction(1, 10**6)
_MILLI = Fraction(1, 1000)


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


DIMENSIONS: dict[str, Dimension] = {
    dimension.name: dimension
    for dimension in (
        Dimension(
            "velocity random walk",
            {
                "m/s/√h": Fraction(1, 60),
                "µg/√Hz": _G * _MICRO,
                "mg/√Hz": _G * _MILLI,
                "m/s²/√Hz": Fraction(1),
                "m/s/√s": Fraction(1),
                "ft/s/√h": _FOOT / 60,
            },
            ("0.05 m/s/√h", "80 µg/√Hz", "0.0008 m/s²/√Hz"),
        ),
        Dimension(
            "angle random walk",
            {
                "°/√h": _DEGREE / 60,
                "°/s/√Hz": _DEGREE,
                "°/h/√Hz": _DEGREE / 3600,
                "°/√s": _DEGREE,
                "mrad/√h": _MILLI / 60,
                "rad/√s": Fraction(1),
                "rad/s/√Hz": Fraction(1),
            },
            ("0.5 °/√h", "0.008 °/s/√Hz", "30 °/h/√Hz"),
        ),
        Dimension(
            "acceleration",
            {"m/s²": Fraction(1), "mg": _G * _MILLI, "µg": _G * _MICRO, "g": _G, "mm/s²": _MILLI},
            ("0.1 mg", "50 µg", "0.001 m/s²"),
        ),
        Dimension(
            "angular rate",
            {"°/h": _DEGREE / 3600, "°/s": _DEGREE, "rad/s": Fraction(1), "mrad/s": _MILLI},
            ("1 °/h", "0.01 °/s", "5e-6 rad/s"),
        ),
        Dimension(
            "rate random walk",
            {"°/h/√h": _DEGREE / 3600 / 60, "°/s/√s": _DEGREE, "rad/s/√s": Fraction(1)},
            ("4 °/h/√h", "1e-6 rad/s/√s"),
        ),
        Dimension(
            "acceleration random walk",
            {"µg/√h": _G * _MICRO / 60, "mg/√h": _G * _MILLI / 60, "m/s²/√s": Fraction(1)},
            ("20 µg/√h", "1e-6 m/s²/√s"),
        ),
        Dimension(
            "length",
            {
                "m": Fraction(1),
                "km": Fraction(1000),
                "cm": Fraction(1, 100),
                "mm": _MILLI,
                "µm": _MICRO,
                "ft": _FOOT,
                "NM": Fraction(1852),
            },
            ("1 m", "2 cm", "7 km"),
        ),
        Dimension(
            "time",
            {"s": Fraction(1), "ms": _MILLI, "min": Fraction(60), "h": Fraction(3600)},
            ("1 s", "200 ms", "2 min"),
        ),
        Dimension(
            "interval",
            {"s": Fraction(1), "ms": _MILLI, "min": Fraction(60)},
            ("0.2 s", "200 ms", "5 Hz"),
        ),
        Dimension(
            "frequency",
            {
                "Hz": Fraction(1),
                "kHz": Fraction(1000),
                "MHz": Fraction(10**6),
                "GHz": Fraction(10**9),
            },
            ("100 Hz", "1325 MHz", "9.6 GHz"),
        ),
        Dimension(
            "speed",
            {
                "m/s": Fraction(1),
                "km/h": Fraction(1000, 3600),
                "kn": Fraction(1852, 3600),
                "cm/s": Fraction(1, 100),
                "mm/s": _MILLI,
                "ft/s": _FOOT,
            },
            ("100 m/s", "360 km/h", "200 kn"),
        ),
        Dimension(
            "angle",
            {
                "°": _DEGREE,
                "rad": Fraction(1),
                "mrad": _MILLI,
                "arcmin": _DEGREE / 60,
                "arcsec": _DEGREE / 3600,
            },
            ("45°", "0.5 rad", "3 mrad"),
        ),
        Dimension(
            "ratio",
            {"ppm": _MICRO, "%": Fraction(1, 100)},
            ("100 ppm", "0.01 %"),
        ),
        Dimension(
            "acceleration density",
            {"g²/Hz": _G**2, "(m/s²)²/Hz": Fraction(1), "mg²/Hz": (_G * _MILLI) ** 2},
            ("0.01 g²/Hz", "1 (m/s²)²/Hz"),
        ),
        Dimension(
            "length density",
            {"mm²/Hz": _MILLI**2, "µm²/Hz": _MICRO**2, "m²/Hz": Fraction(1)},
            ("0.001 mm²/Hz", "1e-9 m²/Hz"),
        ),
        Dimension(
            "vibration rectification",
            {"µg/g²": _MICRO / _G, "mg/g²": _MILLI / _G},
            ("50 µg/g²", "0.1 mg/g²"),
        ),
        Dimension("level", {"dB": Fraction(1)}, ("-30 dB",), decibels=20),
        Dimension("phase noise", {"dBc/Hz": Fraction(1)}, ("-120 dBc/Hz",), decibels=10),
    )
}

"""The kinds of quantity, and what may follow a number of each: a unit, and how good the number is.

"m CEP", "mg @ 100 Hz" and "cm + 1 ppm" are scales as "m" is: a number of them is one sigma per axis in SI.
Percentages are of the normal distribution on one axis, circles (CEP, R95, CE90, "horizontal 95 %") of the radius in a
plane, spheres (SEP, SEP90) of the distance in space. DRMS, HRMS and "2D RMS" are √2 sigmas, MRSE and "3D RMS" √3.
"""

import math
import re
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from statistics import NormalDist
from typing import NamedTuple

from nav_model.base.errors import InputError, quoted
from nav_model.base.text.unit_text import LONGEST, TABLES, Product, plain_signs, product_of, root_of, size_of, spelled

_FINE = Context(prec=40)
MAX_EXPONENT = 400
"""Powers of ten beyond this are refused: no float has them, and an exact rational would only cost memory."""


class Scale(NamedTuple):
    """The part after a number: its text, the size of one in SI at 1σ per axis, what a metre of baseline adds [SI],
    and in words how the size came about; empty for a unit alone."""

    unit: str
    size: Fraction
    per_metre: Fraction = Fraction(0)
    how: str = ""


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity, by its name in messages.

    units: canonical symbol -> exact factor to SI, the default for display first. products: product of named units ->
    its canonical symbol. base: base unit -> its power, the same for all units. examples: quantity strings offered to
    a user whose text was refused. decibels: 20 where the units are decibels of an amplitude, 10 of a power, and SI is
    the ratio itself; 0: no decibels.
    """

    name: str
    units: dict[str, Fraction]
    products: dict[frozenset[tuple[str, Fraction]], str]
    base: Product
    examples: tuple[str, ...]
    decibels: int = 0

    def scale(self, text: str) -> Scale:
        """Read the text after a number.

        Raises InputError if it is no unit of this kind, or its accuracy cannot be brought to one sigma.
        """
        return Scale(text, self.units[text]) if text in self.units else _scale(text, self.name)

    def amount(self, number: Fraction, unit: str, baseline: float = 0.0) -> Fraction:
        """A number of `unit` in SI, at a baseline [m]."""
        scale = self.scale(unit)
        scaled = number * scale.size + scale.per_metre * Fraction(baseline)
        if not self.decibels:
            return scaled
        exponent = _FINE.divide(Decimal(scaled.numerator), Decimal(scaled.denominator * self.decibels))
        largest = Decimal(MAX_EXPONENT)
        return Fraction(_FINE.power(10, min(max(exponent, -largest), largest)))

    def number(self, amount: Fraction, unit: str, baseline: float = 0.0) -> Fraction:
        """An amount in SI as a number of `unit`; in decibels, one that is not above zero is far below any."""
        scale = self.scale(unit)
        if self.decibels:
            amount = max(amount, Fraction(1, 10**MAX_EXPONENT))
            level = _FINE.divide(Decimal(amount.numerator), Decimal(amount.denominator)).log10(_FINE)
            amount = Fraction(level) * self.decibels
        return (amount - scale.per_metre * Fraction(baseline)) / scale.size

    @property
    def default_unit(self) -> str:
        """The unit a value is shown in unless its owner says otherwise."""
        return next(iter(self.units))


def _dimension(name: str, units: list[str], examples: list[str], decibels: int = 0) -> Dimension:
    products = {unit: product_of(unit) for unit in units}
    sizes = {unit: size_of(product)[0] for unit, product in products.items()}
    symbols = {frozenset(product.items()): unit for unit, product in products.items()}
    return Dimension(name, sizes, symbols, size_of(products[units[0]])[1], tuple(examples), decibels)


DIMENSIONS: dict[str, Dimension] = {name: _dimension(name, **row) for name, row in TABLES.items()}

# What may follow the unit, from the end on: words that leave the number as it is, its accuracy, a bandwidth.
_AFTER = re.compile(
    r"""[\s,;@(\[]+(?:
    (?P<rms>rmse?)|typ(?:ical)?\.?|max(?:imum)?\.?|nom(?:inal)?\.?|(?:per|each)\ axis|A?MSL|HAE
    |(?:at\s+|T\s*=\s*)?[+-]?\d{1,3}(?:\.\d)?\s*(?:°|deg)\s*C
    |(?P<extent>[23]-?D|(?-i:[HV])|horiz(?:ontal|\.)?|vert(?:ical|\.)?)
    |(?:1\s*-?\s*|one[\s-])?(?:σ|sigma)
    |(?P<accuracy>(?P<number>\d\d?(?:\.\d+)?)\s*-?\s*(?P<share>σ|sigmas?|%(?:\s*(?:confidence|CL))?)
    |(?P<times>\d?)\s*DRMS|(?P<mean>[HV]RMSE?|MRSE)|(?P<word>[CLS]EP|(?:CE|LE|R)(?=\d))\s*-?(?P<of>\d\d)?)
    |(?:in\s+|over\s+|at\s+)?(?:BW\s*=?\s*)?(?P<band>\d{1,6}(?:\.\d{1,6})?)\s*(?P<kilo>k?)Hz(?:\s*(?:BW|bandwidth))?
    )[\s)\]]*$""",
    re.VERBOSE | re.IGNORECASE,
)
_ON_BASE_LINE = re.compile(r"(.+?)\s*[+±]\s*(\d{1,6}(?:\.\d{1,6})?)\s*([^\d\s].*)")
_TIMES_BASE_LINE = re.compile(
    r"\s*\(?\s*(?:[x·*]|of|times)\s*(?:the\s+)?(?:[DL]|base[\s-]?line(?:\s+length)?|distance)\s*\)?$", re.IGNORECASE
)
_EXTENTS = {"2": "H", "3": "3D", "h": "H", "v": "V"}
"""First letter of a word -> in a plane, in space, of one axis."""
_ROOT_MEAN = {"HRMS": 2, "VRMS": 1, "MRSE": 3}
"""Name -> its square in squares of a sigma."""
# What is no such number, and what to write.
_NO_NUMBER = (
    (re.compile(r"%\s*(?:of\s+)?(?:FSR?|full[\s-]scale|reading|rdg)\b", re.I),
     "is of a range. Write the value itself"),
    (re.compile(r"\d\s*(?:°\s*C?\s*)?(?:to|\.{2,3}|…|-|~)\s*\+?\d+\s*(?:°|deg)\s*C\b", re.I),
     "is over a range of temperatures. Write the value at yours without it"),
    (re.compile(r"(?:@|\bat\b)\s*[\d.]+\s*(?:m/s|km/h|kph|kn|kts?|mph)\b", re.I),
     "holds at one speed. Write the value at yours without it"),
    (re.compile(r"\b[HV][a-z]*\.?\s*[:=]\s*[\d±]", re.I), "has two numbers. Write the one of this input"),
)  # fmt: skip
_OF_A_PLACE = ("length", "speed", "angle")
_HALF = Fraction(1, 2)


@lru_cache(maxsize=4096)
def _scale(text: str, name: str) -> Scale:
    """As `Dimension.scale`, of a text that is not one of the usual symbols."""
    kind = DIMENSIONS[name]
    if len(text) > LONGEST:
        raise _refused(text, kind)
    unit = re.sub(r"[\s-]*\brms\s*(?=/)", "", plain_signs(text).strip())  # "µg rms/√Hz"
    if reason := next((reason for pattern, reason in _NO_NUMBER if pattern.search(unit)), ""):
        raise InputError("quantity", f"{quoted(unit)} {reason}.", text)
    accuracies, band, slope, more, how = [], Fraction(0), Fraction(0), "", ""
    extent, rms = "", False
    while match := _AFTER.search(unit):
        unit, rms = unit[: match.start()], rms or match["rms"] is not None
        if match["extent"]:
            extent = _EXTENTS[match["extent"][0].lower()]
        elif match["band"]:
            band = Fraction(match["band"]) * (1000 if match["kilo"] else 1)
        elif match["accuracy"]:
            accuracies.append(match)
    if match := _ON_BASE_LINE.fullmatch(unit):
        unit, ratio = match[1], DIMENSIONS["ratio"].scale(_TIMES_BASE_LINE.sub("", match[3]))
        slope, more = Fraction(match[2]) * ratio.size, f" + {match[2]} {ratio.unit}"
    try:
        product = product_of(unit)
        size, base = size_of(product)
    except InputError:
        raise
    except ValueError as error:
        raise _refused(unit, kind) from error
    symbol = kind.products.get(frozenset(product.items()))
    if kind.decibels and (accuracies or more or symbol is None):
        raise _refused(text, kind)
    density = size_of({**product, "Hz": product.get("Hz", 0) - _HALF})[1]
    if base != kind.base == density and band:  # an rms within a bandwidth, where its density is asked for
        size, more, how = size / root_of(band), f" @ {float(band):g} Hz", f" over √({float(band):g} Hz)"
    elif base != kind.base:
        raise _refused(unit, kind, spelled(product) if density == kind.base else "")
    if extent and kind.name not in _OF_A_PLACE:
        raise _refused(text, kind)
    if accuracies or (extent and rms):
        sigmas, accuracy = _sigmas(accuracies, kind, extent)
        size, slope, more = size / sigmas, slope / sigmas, f"{more} {accuracy}"
        how += ", 1σ per axis" + (", taken as of one axis" if "%" in accuracy else "")
    elif slope:
        how = ", 1σ per axis"
    return Scale((symbol or spelled(product)) + more, size, slope, how)


def _sigmas(accuracies: list[re.Match[str]], kind: Dimension, extent: str) -> tuple[Fraction, str]:
    """Sigmas of an axis in an accuracy, or in an rms of an extent, and its name."""
    if not accuracies:
        name = {"H": "HRMS", "V": "VRMS", "3D": "MRSE"}[extent]
        return Fraction(math.sqrt(_ROOT_MEAN[name])), name
    first, *others = sorted(accuracies, key=lambda match: match["word"] is None)
    word, share, unit = (first["word"] or "").upper(), first["of"], (first["share"] or " ")[0]
    if word in ("CEP", "SEP") and not share and [(other["share"] or " ")[0] for other in others] == ["%"]:
        share, others = others[0]["number"], []  # "CEP (95 %)"
    if unit == "%" and not word and extent in ("H", "3D"):  # "horizontal 95 %"
        word, share, unit = {"H": "R", "3D": "SEP"}[extent], first["number"], " "
    if others:
        stated = " and ".join(match["accuracy"] for match in accuracies)
        raise InputError("quantity", f"The number states its accuracy twice, {stated}. Write one of them.")
    if unit == " " and word[:1] != "L" and kind.name not in _OF_A_PLACE:
        raise InputError("quantity", f"{first['accuracy']} is of a place, not of {kind.name}.")
    name = f"{word}{share or ''}"
    if unit == "%" or word[:1] == "L":
        name, share = name or f"{first['number']} %", first["number"] or share or "50"
        sigmas = 1.0 if share == "68" else NormalDist().inv_cdf(0.5 + float(share) / 200)
    elif word == "SEP":
        sigmas = _radius_in_space(float(share or 50) / 100)
    elif word:
        sigmas = math.sqrt(-2 * math.log(1 - float(share or 50) / 100))
    elif unit != " ":
        sigmas, name = float(first["number"]), f"{first['number']}σ"
    elif first["mean"]:
        name = first["mean"].upper().removesuffix("E") if first["mean"][0] in "HVhv" else "MRSE"
        sigmas = math.sqrt(_ROOT_MEAN[name])
    elif first["times"] == "3":
        choice = "Write a third of it as DRMS, or it as MRSE."
        raise InputError("quantity", f"3DRMS may mean three times the rms in a plane, or the rms in space. {choice}")
    else:
        sigmas, name = math.sqrt(2) * float(first["times"] or 1), f"{first['times']}DRMS"
    if not sigmas > 0:
        raise InputError("quantity", f"{name} is no accuracy.")
    return Fraction(sigmas), name


def _radius_in_space(share: float) -> float:
    """Radius of the sphere that holds a share of a normal distribution alike on three axes, in sigmas of one."""
    low, high = 0.0, 10.0
    for _ in range(60):
        radius = (low + high) / 2
        inside = math.erf(radius / math.sqrt(2)) - math.sqrt(2 / math.pi) * radius * math.exp(-(radius**2) / 2)
        low, high = (radius, high) if inside < share else (low, radius)
    return (low + high) / 2


def _refused(unit: str, kind: Dimension, rms: str = "") -> InputError:
    """Why a text is no unit of a kind; where it is that of an `rms` or a drift, which random walks it may mean."""
    unit, interval = unit.strip(), kind.name == "interval"
    if rms:
        walk = re.sub(r"/(?=[hs]$)", "/√", rms)
        choice = f"{rms} rms @ 100 Hz" if walk == rms else walk
        reason = f"is no {kind.name}. Write {choice} or {rms}/√Hz, whichever is meant."
    elif unit in ("'", '"') and kind.name == "length":
        length, arc = ("ft", "arcmin") if unit == "'" else ("in", "arcsec")
        reason = f"may mean {length} or {arc}. Write {length} for a length."
    else:
        *most, last = [*kind.units, "Hz"] if interval else kind.units
        choice = f"{', '.join(most)} or {last}" if most else last
        reason = f"is not a unit of {'time' if interval else kind.name}. Use {choice}."
    return InputError("quantity", f"{quoted(unit)} {reason}", unit)

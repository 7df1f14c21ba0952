"""The grammar of units: a text such as "deg/sqrt(hr)" as a product of powers of units that have a name.

A product is written with / or "per", ·, *, a dot or a space, brackets of any kind, powers as ², ^2, **2, s-1 or s⁻¹,
roots as √, sqrt, rt, root, ^0.5 or ^1/2; a name has its prefix as a letter or a word, and may be a plural. The names
are in `dimensions.toml`. Whether a product fits the quantity asked for, `nav_model.base.dimensions` decides.
"""

import math
import re
from collections.abc import Mapping
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from typing import Any

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.base.text.toml_text import shipped

Product = Mapping[str, Fraction]
"""Symbol of a unit -> its power; also base unit -> power."""

LONGEST = 100
"""Characters of a quantity; what a text takes grows with its length alone."""
_MOST_POWER = 12
_PREFIXES: dict[str, tuple[Any, ...]] = {
    letter: (Fraction(10) ** power, *spellings.split(" "))
    for letter, power, spellings in (
        ("", 0, ""), ("n", -9, "n nano"), ("µ", -6, "µ u micro"), ("m", -3, "m milli"), ("c", -2, "c centi"),
        ("k", 3, "k kilo"), ("M", 6, "M mega"), ("G", 9, "G giga"),
    )
}  # fmt: skip
"""Letter -> factor, and how it is written."""
_SIGNS = str.maketrans("μº˚−–‐‑′’‘´″”“×⋅∙•⁄∕", "µ°°----''''\"\"\"····//")
RAISED = str.maketrans({**dict(zip("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ", "+-0123456789/", strict=True)), "½": "1/2"})
"""Raised signs -> plain ones."""
_APART = re.compile(r"\b(nano|micro|milli|centi|kilo|mega|giga|arc|nautical)[\s-]+(?=[^\W\d_]|°)", re.IGNORECASE)
_NUMBER = r"([+-]?(?:\d{1,2}(?:\.\d{1,2}|/[1-9])?|\.\d{1,2})(?!\d))"
_TOKEN = re.compile(
    rf"""\s*(?:
    (?P<root>√|(?i:sqrt|(?:square[\s-]*)?root(?:\ of)?|rt)(?=[\s(\[{{a-zA-Z-]))[\s-]*
    |(?P<open>[(\[{{])|(?P<close>[)\]}}])
    |(?P<per>/|per\b)|(?P<times>[·*.])
    |(?P<name>[^\W\d_]*[°'"%]|[^\W\d_]+₀?)
    )(?:\s*(?:\^|\*\*)\s*(?:\(\s*{_NUMBER}\s*\)|{_NUMBER})|{_NUMBER})?""",
    re.VERBOSE,
)
_CLOSING = {"(": ")", "[": "]", "{": "}"}

UNITS: dict[str, tuple[Fraction, Product]] = {
    "π": (Fraction(math.pi), {}),
    "g₀": (Fraction(str(STANDARD_GRAVITY)), {"m": Fraction(1), "s": Fraction(-2)}),
}
"""Symbol -> size in SI and base units."""
_NAMES: dict[str, Product] = {symbol: {symbol: Fraction(1)} for symbol in UNITS}
_FOLDED: dict[str, Product] = {}  # names in small letters, which are read in others too but for these
_TWO_MEANINGS = {"mhz": "mHz or MHz", "nm": "NM (nautical miles) or 0.001 µm"}


def plain_signs(text: str) -> str:
    """The signs that look alike as one of them."""
    return text.translate(_SIGNS).replace("''", '"')


@lru_cache(maxsize=4096)
def product_of(text: str) -> Product:
    """The product that a text is; its powers are whole or half numbers.

    Raises InputError if a name in it has two meanings, ValueError if it is none.
    """
    text = re.sub("\\^?[⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ½]+", lambda m: f"^{m[0].lstrip('^').translate(RAISED)}", plain_signs(text))
    text = re.sub(r"\s+squared\b", "^2", _APART.sub(r"\1", text)).strip()
    product: dict[str, Fraction] = {}
    sign, root = 1, Fraction(1)  # of the factor that comes next
    outer: list[tuple[dict[str, Fraction], int, Fraction, str]] = []  # before a bracket, and the sign that ends it
    place = 0
    while place < len(text):
        token = _TOKEN.match(text, place)
        if token is None or place > LONGEST:
            raise ValueError(f"{text[place:]!r} is no part of a unit")
        place = token.end()
        power = token[7] or token[8] or token[9]
        if token["root"]:
            root /= 2
        elif token["per"]:
            sign = -1
        elif token["open"]:
            outer.append((product, sign, root, _CLOSING[token["open"]]))
            product, sign, root = {}, 1, Fraction(1)
        elif not token["times"]:  # a factor: a name, or a bracket that ends here
            factor: Product = _named(token["name"]) if token["name"] else product
            if token["close"]:
                product, sign, root, ending = outer.pop() if outer else (product, sign, root, "")
                if ending != token["close"]:
                    raise ValueError("a bracket is not closed")
            for symbol, inner in factor.items():
                product[symbol] = product.get(symbol, 0) + inner * sign * root * Fraction(power or 1)
                if abs(product[symbol]) > _MOST_POWER or product[symbol].denominator > 2:
                    raise ValueError(f"{product[symbol]} is no power of {symbol}")
            sign, root, power = 1, Fraction(1), None
        if power:
            raise ValueError("a power of nothing")
    if outer or sign < 0 or root < 1:
        raise ValueError("the unit is not complete")
    return {symbol: power for symbol, power in product.items() if power}


def spelled(product: Product) -> str:
    """A product as `product_of` reads it: "m°/s/√Hz".

    >>> spelled(product_of("mdeg/(s*sqrt(Hz))"))
    'm°/s/√Hz'
    """

    def raised(symbol: str, power: Fraction) -> str:
        if power == Fraction(1, 2):
            return f"√{symbol}"
        return symbol if power == 1 else f"{symbol}²" if power == 2 else f"{symbol}^{float(power):g}"

    above = "·".join(raised(symbol, power) for symbol, power in product.items() if power > 0)
    return above + "".join(f"/{raised(symbol, -power)}" for symbol, power in product.items() if power < 0)


def _named(name: str) -> Product:
    folded = name.lower()
    if name not in _NAMES and folded in _TWO_MEANINGS:
        raise InputError("quantity", f"{name!r} has two meanings. Write {_TWO_MEANINGS[folded]}.", name)
    product = _NAMES.get(name) or (_FOLDED.get(folded) if len(name) > 1 else None)
    if product is None:
        raise ValueError(f"{name!r} is not the name of a unit")
    return product


def size_of(product: Product) -> tuple[Fraction, Product]:
    """One of a product in SI, and its base units: exact but for roots that are not rational, which have 40 digits."""
    squared = Fraction(1)
    base: dict[str, Fraction] = {}
    for symbol, power in product.items():
        factor, of_base = UNITS[symbol]
        squared *= factor ** int(2 * power)
        for unit, inner in of_base.items():
            base[unit] = base.get(unit, Fraction(0)) + inner * power
    return root_of(squared), {unit: power for unit, power in base.items() if power}


def root_of(squared: Fraction) -> Fraction:
    """The square root of a number, exact where it is rational, else to 40 digits."""
    root = Fraction(math.isqrt(squared.numerator), math.isqrt(squared.denominator))
    if root * root == squared:
        return root
    fine = Context(prec=40)
    return Fraction(fine.sqrt(fine.divide(Decimal(squared.numerator), Decimal(squared.denominator))))


def _define(symbol: str, names: str, letters: str, size: Fraction, base: Product, product: Product) -> None:
    """A unit, or the product that it abbreviates, under each of its names with each prefix."""
    for letter in ("", *letters):
        factor, *prefixes = _PREFIXES[letter]
        UNITS[letter + symbol] = size * factor, base
        for name in (symbol, *names.split()):
            for prefix in prefixes:
                for ending in ("", "s") if len(name) > 2 and name.isalpha() else ("",):
                    whole = prefix + name + ending
                    _NAMES.setdefault(whole, {letter + symbol: Fraction(1)} if letter else product)
                    _FOLDED.setdefault(whole.lower(), _NAMES[whole])


TABLES = shipped("nav_model.base", "dimensions")
"""Of `dimensions.toml`: the kinds of quantity."""
for _symbol, (_text, _letters, _names) in TABLES.pop("units").items():
    _number, _, _unit = _text.partition(" ")
    _size, _base = size_of(product_of(_unit)) if _text else (Fraction(1), {_symbol: Fraction(1)})
    _define(_symbol, _names, _letters, _size * Fraction(_number or 1), _base, {_symbol: Fraction(1)})
for _symbol, (_text, _letters) in TABLES.pop("abbreviations").items():
    _define(_symbol, "", _letters, *size_of(product_of(_text)), product_of(_text))

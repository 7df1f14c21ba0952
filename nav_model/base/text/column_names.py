"""Names of columns with their units: "gyro_x [deg/s]", "accX_m_s2", "Height (ft)", "alt_feet".

What other programs call them is in `column_names.toml`.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress

from nav_model.base.errors import InputError
from nav_model.base.text.toml_text import shipped
from nav_model.base.units import parse_quantity

_MOST_NAMES, _LONGEST_NAME = 8, 25
_MOST_UNIT_WORDS = 8  # "degrees per second per root hertz" has six
_NUMBER = re.compile(r"\s*([0-9.]+(?:[eE][-+]?[0-9]+)?)?(.*)", re.DOTALL)
_BRACKETS = re.compile(r"(.+?)[\s_]*[\[({](.*)[\])}]\s*")
_UNIT_MAY_START = re.compile(r"(?<=[\s_.])(?=[A-Za-z°µ])|(?<=[a-z])(?=[A-Z])")


TABLES = shipped("nav_model.base.text", "column_names")
_UNIT_OF = {spelling: unit for unit, spellings in TABLES["units"].items() for spelling in spellings.split()}


def vocabulary(of: str) -> dict[str, tuple[str, int]]:
    """Names in a "log" or a "flight" -> the quantity, and how well the name fits it, 0 the best."""
    return {name: (key, rank) for key, names in TABLES[of].items() for rank, name in enumerate(names.split())}


def listed(names: Sequence[str]) -> str:
    """The first names of a file, and how many more there are."""
    more = len(names) - _MOST_NAMES
    return ", ".join(name[:_LONGEST_NAME] for name in names[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


def parted(text: str) -> Iterator[tuple[str, str, bool]]:
    """The ways to part a column's name from its unit, the likeliest first; whether brackets say that it is one."""
    if match := _BRACKETS.fullmatch(text):
        yield match[1], match[2].strip(), True
        return
    yield text, "", False
    starts = [place.start() for place in _UNIT_MAY_START.finditer(text)]
    for start in reversed(starts[-_MOST_UNIT_WORDS:]):
        yield text[:start], text[start:].strip(" _"), False


def size_of_unit(unit: str, dimension: str) -> float | None:
    """The size in SI of a unit, or of a number of it ("0.001 s"), as it may be meant in a name: "m_s2", "deg_per_s".

    None where it is no unit of the dimension.
    """
    number, text = _NUMBER.findall(unit)[0]
    text = re.sub(r"^in[\s_]+", "", text.strip(" _"))
    for plain in (text, text.lower()):
        for spelling in (
            _UNIT_OF.get(re.sub(r"[\s_^.]", "", plain), plain),
            re.sub(r"_(?:per_)?", "/", plain),
        ):
            with suppress(InputError):
                return parse_quantity(f"{number or 1} {spelling}", dimension).value
    return None

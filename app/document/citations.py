"""Which equations a part of a report cites."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from typing import Any

from app.document.blocks import ChartBlock, Section

_MARK = re.compile(r"\[([TSBP]-\d+)\]")


def marks_in(sections: Iterable[Section]) -> set[str]:
    """Marks of the equations named in any text of some sections, captions and sources of curves included."""
    return {mark for section in sections for text in _texts(section) for mark in _MARK.findall(text)}


def _texts(thing: Any) -> Iterator[str]:
    """Every string in a tree of dataclasses and tuples; arrays are skipped."""
    if isinstance(thing, str):
        yield thing
    elif isinstance(thing, ChartBlock):
        yield thing.alt
        yield from (getattr(line, "source", "") for line in getattr(thing.chart, "lines", ()))
    elif isinstance(thing, tuple):
        for one in thing:
            yield from _texts(one)
    elif is_dataclass(thing):
        for field in fields(thing):
            yield from _texts(getattr(thing, field.name))

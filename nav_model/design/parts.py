"""The inputs of a design, section by section: bounds, units, defaults, help. A table of declarations.

What must be positive has a lowest value, far below any hardware, above which no equation leaves the range of
floats.
"""

from __future__ import annotations

from typing import Any

from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.flight import Coast, Flight
from nav_model.design.part import Part
from nav_model.design.radar import Radar
from nav_model.design.requirements import Requirements
from nav_model.design.sensors import Gnss, Imu

__all__ = [
    "INPUTS", "LONGEST_ORIGIN", "PARTS", "PRESET_KEYS", "TOP_KEYS", "Coast", "Flight", "Gnss",
    "Imu", "Part", "Radar", "Requirements", "all_keys", "declaration_of",
]  # fmt: skip

PARTS: tuple[type[Part], ...] = (Imu, Gnss, Flight, Coast, Radar, Requirements)
"""The sections of a design, in the order of the file."""

INPUTS: dict[str, dict[str, BaseQuantity[Any] | Choice]] = {part.section: part.inputs() for part in PARTS}
"""Section -> name -> declaration."""

PRESET_KEYS = tuple(f"{part.section}.preset" for part in PARTS if "preset" in part.param)
"""Keys that name an entry of the catalogue."""

TOP_KEYS = ("name", "description")
"""Keys above the sections: plain text."""

LONGEST_ORIGIN = 1000
"""Characters of a value's origin, which is one line."""


def declaration_of(key: str) -> BaseQuantity[Any] | Choice:
    """The declaration of the input under a dotted key.

    Raises
    ------
    KeyError
        If there is none.
    """
    section, _, name = key.rpartition(".")
    return INPUTS[section][name]


def all_keys() -> list[str]:
    """Every dotted key of an input, in the order of the file."""
    return [f"{section}.{name}" for section, names in INPUTS.items() for name in names]

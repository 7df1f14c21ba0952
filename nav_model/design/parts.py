"""The inputs of a design, section by section: bounds, units, defaults, help. A table of declarations.

Inputs that must be positive have a lower bound far below any hardware, so that no equation leaves the range of
floats.
"""

import re
from typing import Any

from nav_model.base.errors import InputError
from nav_model.design.autofocus import Autofocus
from nav_model.design.declaration import BaseQuantity
from nav_model.design.filter import Filter
from nav_model.design.flight import Coast, Flight
from nav_model.design.motion import Motion, Oscillator
from nav_model.design.part import Input, Part
from nav_model.design.processing import Processing
from nav_model.design.radar import Radar
from nav_model.design.requirements import Requirements
from nav_model.design.sensor_errors import Accelerometer, Gyro
from nav_model.design.sensors import Gnss, Imu
from nav_model.design.trajectory import Trajectory

__all__ = [
    "INPUTS", "LONGEST_ORIGIN", "OUTDATED", "PARTS", "PRESET_KEYS", "RENAMED", "TOP_KEYS", "Accelerometer",
    "Autofocus", "Coast", "Filter", "Flight", "Gnss", "Gyro", "Imu", "Input", "Motion", "Oscillator", "Part",
    "Processing", "Radar", "Requirements", "Trajectory", "all_keys", "declaration_of", "labelled", "quantity",
]  # fmt: skip

PARTS: tuple[type[Part], ...] = (
    Imu, Gyro, Accelerometer, Gnss, Filter, Flight, Coast, Radar, Autofocus, Motion, Oscillator, Processing,
    Trajectory, Requirements,
)  # fmt: skip
"""The sections of a design, in the order of the file."""

INPUTS: dict[str, dict[str, Input]] = {part.section: part.inputs() for part in PARTS}
"""Section -> name -> declaration."""

INPUTS_SINCE = {"gnss.preset"} | {
    declaration.key for names in INPUTS.values() for declaration in names.values() if declaration.since
}
"""Inputs that came after the first designs were saved: at their defaults they leave a design's hash as it was."""

OUTDATED: dict[str, tuple[str, str]] = {
    "processing.leg_before": ("lb", "the smoother starts from the settled filter [P-3]")
}
"""Inputs that files, links and commands of before may have, without effect: short name in links, and why."""

RENAMED: dict[str, str] = {
    "motion.imu_bandwidth": "imu.bandwidth",
    "receiver.velocity_noise": "gnss.velocity_noise",
    **{f"receiver.lever_{way}": f"gnss.lever_{way}" for way in ("forward", "right", "down")},
}
"""Names of before for inputs, in files, commands and links -> their keys."""

PRESET_KEYS = tuple(f"{part.section}.preset" for part in PARTS if "preset" in part.param)
"""Keys that name an entry of the catalogue."""

TOP_KEYS = ("name", "description")
"""Keys above the sections: plain text."""

LONGEST_ORIGIN = 1000
"""Characters of a value's origin, which is one line."""


def declaration_of(key: str) -> Input:
    """The declaration of the input under a dotted key.

    Raises
    ------
    KeyError
        If there is none.
    """
    section, _, name = key.rpartition(".")
    return INPUTS[section][name]


def quantity(key: str) -> BaseQuantity[Any]:
    """The declaration of a numeric input.

    Raises
    ------
    InputError
        If there is no such input or it is not a number.
    """
    try:
        declaration = declaration_of(key)
    except KeyError as error:
        raise InputError(key, "unknown key") from error
    if not isinstance(declaration, BaseQuantity):
        raise InputError(key, "is a choice or a table, not a number")
    return declaration


def labelled(error: InputError) -> InputError:
    """The error under the label of its input, as a page names it, with the row and the column of a table."""
    key, *place = re.split(r"\[(\d+)\]\.?", error.key)
    section, _, name = key.rpartition(".")
    if name not in INPUTS.get(section, {}):
        return error
    row = [f"row {place[0]}", *filter(None, place[1:])] if place else []
    return error.under(", ".join([str(INPUTS[section][name].label), *row]))


def all_keys() -> list[str]:
    """Every dotted key of an input, in the order of the file."""
    return [f"{section}.{name}" for section, names in INPUTS.items() for name in names]

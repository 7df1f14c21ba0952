"""The inputs on the left: a row of the sheet per declaration of a design, derived from it."""

from collections.abc import Iterable
from typing import Any

from app.dashboard.controls.biases import BiasInput
from app.dashboard.controls.design_input import ChoiceInput, DesignInput, TableInput
from app.dashboard.controls.preset import PresetInput, SheetChoice
from app.dashboard.controls.quantity import QuantityInput
from app.session import Session
from app.ui.input_sheet import Group
from nav_model.design.declaration import Choice
from nav_model.design.parts import INPUTS, PARTS, PRESET_KEYS
from nav_model.design.table import Table

_MAIN = ("gnss.preset", "gnss.position_noise", "gnss.interval", "gnss.velocity_noise")

_BANDWIDTH = "imu.bandwidth"
"""It acts on vibration alone, and stands there: the inputs that are tried together are in view together."""


def design_groups(session: Session, opened: Iterable[str]) -> list[Group]:
    """Every input of the design by section, in the order of the design file but for IMU and GNSS, which come first,
    with the receiver's main ones; which sections are open at first."""
    groups = []
    for part in sorted(PARTS, key=lambda part: part.section not in ("imu", "gnss")):
        section = part.section
        catalogue = [key for key in PRESET_KEYS if key == f"{section}.preset"]
        keys = [*catalogue, *(f"{section}.{name}" for name in INPUTS[section])]
        if section == "imu":
            keys.remove(_BANDWIDTH)
        if section == "motion":
            keys.insert(0, _BANDWIDTH)
        if section == "gnss":
            keys.sort(key=lambda key: key not in _MAIN)
        inputs = [input_of(session, key) for key in keys]
        if section == "imu":
            first = keys.index("imu.accelerometer_bias")
            inputs.insert(first, BiasInput(session, "imu.residual_bias", None))
        groups.append(Group(part.title, inputs, section in opened, section == "radar"))
    return groups


def input_of(session: Session, key: str) -> DesignInput[Any]:
    """The input under a dotted key."""
    section, _, name = key.partition(".")
    if name == "preset":
        return PresetInput(session, key, None)
    match INPUTS[section][name]:
        case Table() as table:
            return TableInput(session, key, table)
        case Choice() as choice if key == "imu.sheet":
            return SheetChoice(session, key, choice)
        case Choice() as choice:
            return ChoiceInput(session, key, choice)
        case quantity:
            return QuantityInput(session, key, quantity)

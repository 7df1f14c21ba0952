"""The inputs on the left: one control per declaration of a design, derived from it.

Invalid text shows its message at the box; the last valid value is kept.
"""

from __future__ import annotations

from collections.abc import Callable

from app.dashboard.controls.choice import ChoiceControl
from app.dashboard.controls.preset import PresetControl
from app.dashboard.controls.quantity import QuantityControl
from app.dashboard.controls.rows import RowsControl
from app.session import Session
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.parts import INPUTS, PARTS
from nav_model.design.rows import Rows

Control = QuantityControl | ChoiceControl | RowsControl | PresetControl

SECTION_TITLES = {part.section: part.title for part in PARTS}


_KINDS: dict[type, Callable[[Session, str], Control]] = {
    BaseQuantity: QuantityControl,
    Rows: RowsControl,
    Choice: ChoiceControl,
}


def section_controls(session: Session, section: str) -> list[Control]:
    """The controls of one section, in the order of the design file."""
    controls = [control_of(session, f"{section}.preset")] if section in {"imu", "radar"} else []
    return [*controls, *(control_of(session, f"{section}.{name}") for name in INPUTS[section])]


def control_of(session: Session, key: str) -> Control:
    """The control of one input, by its dotted key."""
    section, _, name = key.partition(".")
    if name == "preset":
        return PresetControl(session, section)
    make = next(control for kind, control in _KINDS.items() if isinstance(INPUTS[section][name], kind))
    return make(session, key)

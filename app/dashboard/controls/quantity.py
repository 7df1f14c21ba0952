"""The control of one number: a box for a data-sheet string, a choice of unit, and for some a slider on a log
scale."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
import param

from app.session import Session
from app.ui.input_box import InputBox, slider_of
from app.upstream.prompt_input import PromptInput
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.units import format_quantity, with_point
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import declaration_of
from nav_model.design.presets import entry_of, preset_of

# The whole label is at the edge of the box, whether the box is empty or not: within an empty one it would be cut.
_LABEL = {
    "& .MuiInputLabel-root": {
        "letterSpacing": 0,
        "transform": "translate(14px, -9px) scale(0.75)",
        "maxWidth": "calc(133% - 20px)",
        "fontSize": "0.875rem",
    },
    "& fieldset": {"fontSize": "0.875rem", "letterSpacing": 0},
    "& fieldset legend": {"maxWidth": "100%"},
    "& label[data-shrink=false] + .MuiInputBase-formControl .MuiInputBase-input::placeholder": {
        "opacity": "0.75 !important",
    },
}


# The chooser takes no more than its unit, so that the box beside it has room for its label.
_CLOSE = {
    "& .MuiSelect-select": {"paddingLeft": "10px", "paddingRight": "22px !important"},
    "& .MuiSelect-icon": {"right": "2px"},
}


class QuantityControl(InputBox):
    """Box, unit and perhaps slider of one quantity."""

    explained = param.Boolean(default=False, doc="Whether the whole help line is shown.")

    def __init__(self, session: Session, key: str) -> None:
        declaration = declaration_of(key)
        assert isinstance(declaration, BaseQuantity)
        self._session = session
        self._declaration = declaration
        box = PromptInput(
            label=str(declaration.label),
            placeholder=declaration.when_empty if declaration.allow_None else "",
            margin=(10, 4, 0, 10),
            sizing_mode="stretch_width",
            # Help may run on under the unit chooser: the box alone is too narrow to read in.
            sx={"& .MuiFormHelperText-root": {"marginRight": "-100px" if declaration.dimension else "0"}, **_LABEL},
        )
        slider, value = None, session.design[key]
        if declaration.slider:
            assert isinstance(value, float | int)
            slider = slider_of(declaration, float(value))
        super().__init__(key, box, slider)
        self.unit: pmui.Select | None = None
        if declaration.dimension:
            self.unit = pmui.Select(
                label="unit",
                options=list(DIMENSIONS[declaration.dimension].units),
                value=session.design.unit(key),
                width=94,
                margin=(10, 10, 0, 0),
                sx=_CLOSE,
            )
            self.unit.param.watch(self._unit_chosen, "value")
        self.listen()

    def __panel__(self) -> pn.viewable.Viewable:
        row = pn.Row(self.box, self.unit) if self.unit else self.box
        return pn.Column(row, self.slider) if self.slider else row

    def differs(self, old: Design, new: Design) -> bool:
        """Whether anything shown here has changed; most controls have no work at a slider's step."""
        part = self.key.partition(".")[0]
        same = getattr(old, part) is getattr(new, part) and old.written is new.written and old.origins is new.origins
        return not same and self._seen(old) != self._seen(new)

    def _seen(self, design: Design) -> tuple[object, ...]:
        section = self.key.partition(".")[0]
        return design[self.key], design.unit(self.key), preset_of(design, section), design.origins.get(self.key)

    def show(self, design: Design) -> None:
        """Follow the current design."""
        self.follow()

    def follow(self) -> None:
        """Show the current value and its unit."""
        if self.unit is not None and self.unit.value != (unit := self._session.design.unit(self.key)):
            self.unit.value = unit
        super().follow()

    def value(self) -> Value:
        """The current value, SI."""
        return self._session.design[self.key]

    def text(self) -> str:
        """The current value in its unit."""
        value = self.value()
        if value is None:
            return ""
        assert isinstance(value, float | int)
        dimension = self._declaration.dimension
        return format_quantity(value, self._session.design.unit(self.key), dimension) if dimension else f"{value:g}"

    def size(self) -> float | None:
        """The current value, SI."""
        value = self.value()
        return float(value) if isinstance(value, float | int) else None

    def help(self) -> str:
        """Where the value came from, and the declaration's help if it is asked for."""
        said = (_origin(self._session.design, self.key, self.explained), self._full_help() if self.explained else "")
        return " ".join(part for part in said if part)

    @param.depends("explained", watch=True)
    def _explain(self) -> None:
        self.say()

    def _full_help(self) -> str:
        d = self._declaration
        typical = f"Typical: {d.typical}."
        sheet = d.datasheet if d.datasheet.startswith("Not ") else f"Data sheet: {d.datasheet}"
        return " ".join(part for part in (str(d.doc), sheet, typical) if part)

    def _change(self, value: Value, unit: str) -> InputError | None:
        return self._session.change({self.key: value}, {self.key: unit} if unit else None)

    def take(self, text: str) -> InputError | None:
        """Apply a text; a bare number takes the unit beside the box."""
        text = text.strip()
        if not text and self._declaration.allow_None:
            return self._change(None, "")
        value, unit = self._declaration.read(_with_unit(text, self.unit.value if self.unit else ""))
        return self._change(value, unit)

    def take_size(self) -> InputError | None:
        """Apply the slider's value, in the current unit."""
        assert self.slider is not None
        unit = self._session.design.unit(self.key)
        return self._change(self.slider.amount(unit, self._declaration.dimension), unit)

    def _unit_chosen(self, event: param.parameterized.Event) -> None:
        if event.new != self._session.design.unit(self.key):
            self.put(lambda: self._change(self.value(), event.new))


def _with_unit(text: str, unit: str) -> str:
    """A bare number takes the unit beside the box."""
    try:
        float(with_point(text).replace("−", "-"))
    except ValueError:
        return text
    return f"{text} {unit}".strip()


def _origin(design: Design, key: str, whole: bool) -> str:
    """Where a value came from, if the design or a preset states it."""
    section, _, name = key.rpartition(".")
    if whole and key in design.origins:
        return f"From: {design.origins[key]}."
    entry = entry_of(design, section)
    if entry is None:
        return ""
    sheet = entry.extra.get(name)
    if sheet is not None:
        return f"{entry.name}'s sheet: {sheet.text} {sheet.kind}, not the residual." if whole else ""
    item = entry.values.get(name)
    if item is None:
        missing = section == "imu" and name.endswith("random_walk")
        return f"Not on {entry.name}'s sheet: your value." if missing else ""
    if design[key] != item.value:
        return f"≠ {entry.name}: {item.text}"
    source = f": {item.source}." if whole else ""
    return source.lstrip(": ") if item.confirmed else f"⚠ {item.status} source{source}"

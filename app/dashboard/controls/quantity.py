"""One number of a design: a box that takes a data-sheet string, a chooser of its unit, and where a range is explored
by hand a slider on a log scale."""

from __future__ import annotations

import math
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.models import CustomJSTickFormatter

from app.session import Session
from app.upstream.prompt_slider import PromptSlider
from nav_model.catalogue import find
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.file import preset_of
from nav_model.design.parts import declaration_of
from nav_model.errors import InputError
from nav_model.units import DIMENSIONS, format_quantity, from_si, to_si

_SLIDERS = {
    "imu.velocity_random_walk",
    "imu.angle_random_walk",
    "imu.accelerometer_bias",
    "imu.gyro_bias",
    "imu.vibration_factor",
    "gnss.position_noise",
    "gnss.interval",
    "flight.speed",
    "coast.duration",
    "coast.before_aperture",
    "radar.slant_range",
    "radar.azimuth_resolution",
}
_STEP = 0.02  # decades: 4.7 % a key press
_EMPTY: dict[str, str] = {
    "gnss.vertical_position_noise": "as horizontal",
    "radar.aperture_time": "from the resolution",
}


class QuantityControl:
    """Box, unit and perhaps slider of one quantity."""

    def __init__(self, session: Session, key: str) -> None:
        declaration = declaration_of(key)
        assert isinstance(declaration, BaseQuantity)
        self.key = key
        self._session = session
        self._declaration = declaration
        self._writing = False
        self._explained = False
        self._error = ""
        self._shown: Value = None
        self.box = pmui.TextInput(
            label=str(declaration.label),
            description="",
            placeholder=_EMPTY.get(key, "not checked" if declaration.allow_None else ""),
            size="small",
            margin=(10, 4, 0, 10),
            sizing_mode="stretch_width",
            # Help may run on under the unit chooser: the box alone is too narrow to read in.
            sx={"& .MuiFormHelperText-root": {"marginRight": "-100px" if declaration.dimension else "0"}},
        )
        self.box.param.watch(self._typed, "value")
        self.unit: pmui.Select | None = None
        if declaration.dimension:
            self.unit = pmui.Select(
                label="unit",
                description="",
                options=list(DIMENSIONS[declaration.dimension].units),
                size="small",
                width=104,
                margin=(10, 10, 0, 0),
            )
            self.unit.param.watch(self._unit_chosen, "value")
        self.slider: PromptSlider | None = None
        if key in _SLIDERS:
            self.slider = self._make_slider()
            self.slider.param.watch(self._slid, "value")
        self.show(session.design)

    def _make_slider(self) -> PromptSlider:
        low, high = self._declaration.softbounds  # type: ignore[misc]
        self._low = math.log10(low)
        start = self._low - (10 * _STEP if self._takes_zero else 0)
        return PromptSlider(
            label=str(self._declaration.label),
            description="",
            show_value=False,
            format=self._spoken(),
            start=start,
            end=math.log10(high),
            step=_STEP,
            value=start,
            size="small",
            margin=(0, 16, 2, 16),
            sizing_mode="stretch_width",
            sx={"& > .MuiFormLabel-root": {"display": "none"}},  # the box above names it; screen readers still do
        )

    def _spoken(self) -> CustomJSTickFormatter:
        """What the thumb's bubble and a screen reader say: the value, not its logarithm."""
        d = self._declaration
        factor = to_si(1.0, d.unit, d.dimension) if d.dimension else 1.0
        zero = f'if (tick < {self._low - _STEP / 2}) return "0 {d.unit}";' if self._takes_zero else ""
        return CustomJSTickFormatter(
            code=f'{zero} return String(Number((10 ** tick / {factor!r}).toPrecision(3))) + " {d.unit}"'
        )

    @property
    def _takes_zero(self) -> bool:
        return self._declaration.limits[0] == 0 and self._declaration.inclusive_bounds[0]

    @property
    def view(self) -> pn.viewable.Viewable:
        """The control as it stands in the column."""
        row = pn.Row(self.box, self.unit, margin=0, sizing_mode="stretch_width") if self.unit else self.box
        return pn.Column(row, self.slider, margin=0, sizing_mode="stretch_width") if self.slider else row

    def differs(self, old: Design, new: Design) -> bool:
        """Whether anything shown here is another: most controls sleep through a slider's step."""
        section = self.key.partition(".")[0]
        return (old[self.key], old.unit(self.key), preset_of(old, section)) != (
            new[self.key], new.unit(self.key), preset_of(new, section)
        )  # fmt: skip

    def show(self, design: Design) -> None:
        """Follow the design in force."""
        self._writing = True
        value = design[self.key]
        if value != self._shown:
            self._shown, self._error = value, ""
        text = ""
        if value is not None:
            assert isinstance(value, float | int)
            unit = design.unit(self.key)
            text = (
                format_quantity(value, unit, self._declaration.dimension)
                if self._declaration.dimension
                else f"{value:g}"
            )
            if self.unit is not None and self.unit.value != unit:
                self.unit.value = unit
            if self.slider is not None:
                place = self._place(float(value))
                if abs(place - self.slider.value) > _STEP / 2:
                    self.slider.value = place
        elif self.unit is not None and self.unit.value != design.unit(self.key):
            self.unit.value = design.unit(self.key)
        if self.box.value != text and not self._error:
            self.box.value = text
        self._help(design)
        self._writing = False

    def explain(self, explained: bool) -> None:
        """Show the whole help line, or the short one."""
        self._explained = explained
        self._help(self._session.design)

    def _help(self, design: Design) -> None:
        said = (_origin(design, self.key, self._explained), self._full_help() if self._explained else "")
        text = self._error or " ".join(part for part in said if part)
        if (self.box.helper_text, self.box.error_state) != (text, bool(self._error)):
            # In one message: a second one could undo what is typed between the two.
            self.box.param.update(helper_text=text, error_state=bool(self._error))

    def _full_help(self) -> str:
        d = self._declaration
        typical = f"Typical: {d.typical}."
        sheet = d.datasheet if d.datasheet.startswith("Not ") else f"Data sheet: {d.datasheet}"
        return " ".join(part for part in (str(d.doc), sheet, typical) if part)

    def _place(self, value: float) -> float:
        assert self.slider is not None
        if value <= 0:
            return float(self.slider.start)
        return min(max(math.log10(value), self._low), float(self.slider.end))

    def _put(self, value: Value, unit: str = "") -> None:
        error = self._session.change({self.key: value}, {self.key: unit} if unit else None)
        self._error = "" if error is None else _message(error, self.key)
        self.show(self._session.design)

    def _typed(self, event: Any) -> None:
        if self._writing:
            return
        text = event.new.strip()
        if not text and self._declaration.allow_None:
            self._put(None)
            return
        try:
            value, unit = self._declaration.read(_with_unit(text, self.unit.value if self.unit else ""))
        except InputError as error:
            self._error = error.reason
            self._help(self._session.design)
            return
        self._error = ""
        self._put(value, unit)

    def _unit_chosen(self, event: Any) -> None:
        if self._writing or self.unit is None:
            return
        self._error = ""
        self._put(self._session.design[self.key], event.new)

    def _slid(self, event: Any) -> None:
        if self._writing:
            return
        self._error = ""
        if self._takes_zero and event.new < self._low - _STEP / 2:
            self._put(0.0)
            return
        unit, dimension = self._session.design.unit(self.key), self._declaration.dimension
        number = 10**event.new
        if dimension:  # three digits in the unit shown: a value one can quote
            value = to_si(float(f"{from_si(number, unit, dimension):.3g}"), unit, dimension)
        else:
            value = float(f"{number:.3g}")
        self._put(value, unit)


def _with_unit(text: str, unit: str) -> str:
    """A bare number takes the unit beside the box."""
    try:
        float(text.replace("−", "-"))
    except ValueError:
        return text
    return f"{text} {unit}".strip()


def _message(error: InputError, key: str) -> str:
    return error.reason if error.key == key else str(error)


def _origin(design: Design, key: str, whole: bool) -> str:
    """Where a value came from, when a preset has something to say about it."""
    section, _, name = key.rpartition(".")
    preset = preset_of(design, section)
    if preset is None:
        return ""
    entry = find("imu" if section == "imu" else "radar", preset)
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

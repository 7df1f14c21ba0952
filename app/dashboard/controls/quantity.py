"""One number of a design: a box that takes a data-sheet string, a chooser of its unit, and where a range is explored
by hand a slider on a log scale."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
import param

from app.session import Session
from app.ui.log_slider import LogSlider
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import declaration_of
from nav_model.design.presets import entry_of, preset_of
from nav_model.errors import InputError
from nav_model.units import DIMENSIONS, format_quantity

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
_EMPTY: dict[str, str] = {
    "gnss.vertical_position_noise": "as horizontal",
    "radar.aperture_time": "from the resolution",
}


class QuantityControl(pn.viewable.Viewer):
    """Box, unit and perhaps slider of one quantity.

    What the widgets say is compared with the design in force: a widget that only follows it changes nothing.
    """

    explained: bool = param.Boolean(default=False, doc="Whether the whole help line is shown.")
    error: str = param.String(doc="Why what was typed last is refused; empty if it was taken.")

    def __init__(self, session: Session, key: str) -> None:
        super().__init__()
        declaration = declaration_of(key)
        assert isinstance(declaration, BaseQuantity)
        self.key = key
        self._session = session
        self._declaration = declaration
        self._shown: Value = None
        self.box = pmui.TextInput(
            label=str(declaration.label),
            placeholder=_EMPTY.get(key, "not checked" if declaration.allow_None else ""),
            margin=(10, 4, 0, 10),
            sizing_mode="stretch_width",
            # Help may run on under the unit chooser: the box alone is too narrow to read in.
            sx={"& .MuiFormHelperText-root": {"marginRight": "-100px" if declaration.dimension else "0"}},
        )
        self.unit: pmui.Select | None = None
        if declaration.dimension:
            self.unit = pmui.Select(
                label="unit",
                options=list(DIMENSIONS[declaration.dimension].units),
                width=104,
                margin=(10, 10, 0, 0),
            )
        self.slider = self._make_slider() if key in _SLIDERS else None
        self.show(session.design)
        self.box.param.watch(self._typed, "value")
        if self.unit is not None:
            self.unit.param.watch(self._unit_chosen, "value")
        if self.slider is not None:
            self.slider.param.watch(self._slid, "value")

    def _make_slider(self) -> LogSlider:
        d = self._declaration
        low, high = d.softbounds  # type: ignore[misc]
        zero = d.limits[0] == 0 and d.inclusive_bounds[0]
        value = self._session.design[self.key]
        assert isinstance(value, float | int)
        return LogSlider(str(d.label), low, high, d.unit, d.dimension, zero, float(value))

    def __panel__(self) -> pn.viewable.Viewable:
        row = pn.Row(self.box, self.unit, margin=0, sizing_mode="stretch_width") if self.unit else self.box
        return pn.Column(row, self.slider, margin=0, sizing_mode="stretch_width") if self.slider else row

    def differs(self, old: Design, new: Design) -> bool:
        """Whether anything shown here is another: most controls sleep through a slider's step."""
        return self._seen(old) != self._seen(new)

    def _seen(self, design: Design) -> tuple[object, ...]:
        section = self.key.partition(".")[0]
        return design[self.key], design.unit(self.key), preset_of(design, section), design.origins.get(self.key)

    def show(self, design: Design) -> None:
        """Follow the design in force."""
        value = design[self.key]
        if value != self._shown:
            self._shown, self.error = value, ""
        if self.unit is not None:
            self.unit.value = design.unit(self.key)
        if self.slider is not None and value is not None:
            self.slider.follow(float(value))
        if not self.error:
            self.box.value = self._text(design)
        self._help()

    def _text(self, design: Design) -> str:
        value = design[self.key]
        if value is None:
            return ""
        assert isinstance(value, float | int)
        dimension = self._declaration.dimension
        return format_quantity(value, design.unit(self.key), dimension) if dimension else f"{value:g}"

    @param.depends("explained", watch=True)
    def _help(self) -> None:
        design = self._session.design
        said = (_origin(design, self.key, self.explained), self._full_help() if self.explained else "")
        text = self.error or " ".join(part for part in said if part)
        if (self.box.helper_text, self.box.error_state) != (text, bool(self.error)):
            # In one message: a second one could undo what is typed between the two.
            self.box.param.update(helper_text=text, error_state=bool(self.error))

    def _full_help(self) -> str:
        d = self._declaration
        typical = f"Typical: {d.typical}."
        sheet = d.datasheet if d.datasheet.startswith("Not ") else f"Data sheet: {d.datasheet}"
        return " ".join(part for part in (str(d.doc), sheet, typical) if part)

    def _put(self, value: Value, unit: str = "") -> None:
        refused = self._session.change({self.key: value}, {self.key: unit} if unit else None)
        self.error = "" if refused is None else refused.reason if refused.key == self.key else str(refused)
        self.show(self._session.design)

    def _typed(self, event: param.parameterized.Event) -> None:
        if event.new == self._text(self._session.design):
            self.error = ""
            self._help()
            return
        text = event.new.strip()
        if not text and self._declaration.allow_None:
            self._put(None)
            return
        try:
            value, unit = self._declaration.read(_with_unit(text, self.unit.value if self.unit else ""))
        except InputError as error:
            self.error = error.reason
            self._help()
            return
        self._put(value, unit)

    def _unit_chosen(self, event: param.parameterized.Event) -> None:
        if event.new != self._session.design.unit(self.key):
            self._put(self._session.design[self.key], event.new)

    def _slid(self, _: param.parameterized.Event) -> None:
        assert self.slider is not None
        design = self._session.design
        value = design[self.key]
        if value is None or not self.slider.shows(float(value)):
            unit = design.unit(self.key)
            self._put(self.slider.amount(unit, self._declaration.dimension), unit)


def _with_unit(text: str, unit: str) -> str:
    """A bare number takes the unit beside the box."""
    try:
        float(text.replace("−", "-"))
    except ValueError:
        return text
    return f"{text} {unit}".strip()


def _origin(design: Design, key: str, whole: bool) -> str:
    """Where a value came from, when the design or a preset has something to say about it."""
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

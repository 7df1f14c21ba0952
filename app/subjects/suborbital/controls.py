"""The inputs of the suborbital study on its page: one control per `Setting`, derived from it.

A box takes text with units (three axes separated by commas); where a range is explored by hand a slider on a log
scale moves the size, keeping the ratio of the axes. Text that is refused shows its message at the box and leaves
the last good value in force.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.ui.log_slider import spoken
from app.upstream.prompt_slider import PromptSlider
from nav_model.errors import InputError
from nav_model.suborbital.input_table import SETTINGS
from nav_model.suborbital.setting import Setting, Value
from nav_model.suborbital.settings import Settings
from nav_model.units import from_si, to_si

_STEP = 0.02  # decades: 4.7 % a key press

Put = Callable[[str, Value], InputError | None]


class SettingControl:
    """Box or select of one input, and perhaps a slider. `put` changes the study and says what is wrong, if
    anything."""

    def __init__(self, setting: Setting, settings: Settings, put: Put) -> None:
        self.setting = setting
        self._put_value = put
        self._writing = False
        self._shown: Value = settings[setting.key]
        look: dict[str, Any] = {
            "label": setting.label,
            "description": "",
            "size": "small",
            "margin": (9, 10, 0, 10),
            "sizing_mode": "stretch_width",
        }
        if setting.kind == "choice":
            self.box: Any = pmui.Select(options=list(setting.choices), value=settings[setting.key], **look)
        else:
            self.box = pmui.TextInput(
                value=_text(setting, settings[setting.key]),
                placeholder="from lift-off" if setting.optional else "none",
                **look,
            )
        self.box.param.watch(self._typed, "value")
        self.slider = self._make_slider() if setting.small is not None else None
        self._help(settings)

    def _make_slider(self) -> PromptSlider:
        setting = self.setting
        assert setting.small is not None
        self._low = math.log10(setting.small)
        start = self._low - (10 * _STEP if self._takes_zero else 0.0)
        factor = to_si(1.0, setting.unit, setting.dimension)
        slider = PromptSlider(
            label=setting.label,
            description="",
            show_value=False,
            format=spoken(self._low - _STEP / 2 if self._takes_zero else -math.inf, factor, setting.unit),
            start=start,
            end=math.log10(setting.high),
            step=_STEP,
            value=self._place(self._shown, start),
            size="small",
            margin=(0, 16, 2, 16),
            sizing_mode="stretch_width",
            sx={"& > .MuiFormLabel-root": {"display": "none"}},  # the box above names it
        )
        slider.param.watch(self._slid, "value")
        return slider

    @property
    def _takes_zero(self) -> bool:
        return self.setting.low == 0

    @property
    def view(self) -> pn.viewable.Viewable:
        """The control as it stands in the column."""
        if self.slider is None:
            return self.box
        return pn.Column(self.box, self.slider, margin=0, sizing_mode="stretch_width")

    def show(self, settings: Settings) -> None:
        """Follow the settings in force."""
        self._writing = True
        self._shown = settings[self.setting.key]
        text = self._shown if self.setting.kind == "choice" else _text(self.setting, self._shown)
        if self.box.value != text:
            self.box.value = text
        if self.slider is not None:
            place = self._place(self._shown, float(self.slider.start))
            if abs(place - self.slider.value) > _STEP / 2:
                self.slider.value = place
        self._help(settings)
        self._writing = False

    def _help(self, settings: Settings, error: str = "") -> None:
        changed = settings[self.setting.key] != self.setting.default
        default = self.setting.show(self.setting.default) or "none"
        origin = settings.origin[self.setting.key]
        source = f" ({origin})" if origin.startswith("design") else ""
        text = error or (f"≠ GP-1: {default}{source}" if changed else self.setting.doc)
        if getattr(self.box, "helper_text", None) != text:
            self.box.helper_text = text
        if self.setting.kind != "choice" and self.box.error_state != bool(error):
            self.box.error_state = bool(error)

    def _place(self, value: Value, start: float) -> float:
        size = _size(value)
        return start if size <= 0 else min(max(math.log10(size), self._low), math.log10(self.setting.high))

    def _typed(self, event: Any) -> None:
        if self._writing:
            return
        try:
            value = self.setting.read(event.new, self.setting.unit)
        except InputError as error:
            self._refuse(error)
            return
        self._put(value)

    def _slid(self, event: Any) -> None:
        if self._writing:
            return
        setting = self.setting
        if self._takes_zero and event.new < self._low - _STEP / 2:
            size = 0.0
        else:  # three digits in the unit shown: a value one can quote
            number = from_si(10**event.new, setting.unit, setting.dimension)
            size = to_si(float(f"{number:.3g}"), setting.unit, setting.dimension)
        if setting.grid is not None:
            size = setting.grid * max(1, round(size / setting.grid))
        if setting.kind != "axes":
            self._put(size)
            return
        assert isinstance(setting.default, tuple)
        pattern = self._shown if _size(self._shown) > 0 else setting.default
        if _size(pattern) == 0:
            pattern = (1.0,) * len(setting.default)
        assert isinstance(pattern, tuple)
        self._put(tuple(float(p) * size / _size(pattern) for p in pattern))  # type: ignore[arg-type]

    def _put(self, value: Value) -> None:
        error = self._put_value(self.setting.key, value)
        if error is not None:
            self._refuse(error)

    def _refuse(self, error: InputError) -> None:
        self.box.helper_text = error.reason if error.key == self.setting.key else str(error)
        if self.setting.kind != "choice":
            self.box.error_state = True


def _text(setting: Setting, value: Value) -> str:
    return "" if value is None else setting.show(value)


def _size(value: Value) -> float:
    """Size of a value for a slider: of the largest axis."""
    if value is None:
        return 0.0
    return float(np.max(np.abs(np.asarray(value, dtype=np.float64))))


def setting_controls(keys: list[str], settings: Settings, put: Put) -> list[SettingControl]:
    """Controls of some inputs, in order."""
    return [SettingControl(SETTINGS[key], settings, put) for key in keys]

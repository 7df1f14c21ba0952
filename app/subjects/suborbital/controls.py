"""The inputs of the suborbital study on its page: one control per declaration, derived from it.

A box takes text with units (three axes separated by commas); where a range is explored by hand a slider on a log
scale moves the size, keeping the ratio of the axes. Text that is refused shows its message at the box and leaves
the last good value in force.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.ui.log_slider import LogSlider
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.several import Axes
from nav_model.errors import InputError
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, Settings, Value, read_value

Slid = BaseQuantity | Axes
Put = Callable[[str, Value], InputError | None]


class InputControl:
    """Box or select of one input, and perhaps a slider. `put` changes the study and says what is wrong, if
    anything."""

    def __init__(self, key: str, settings: Settings, put: Put) -> None:
        self.key = key
        self._declared = declared = INPUTS[key]
        self._put_value = put
        self._writing = False
        self._shown: Value = settings[key]
        look: dict[str, Any] = {
            "label": str(declared.label),
            "description": "",
            "size": "small",
            "margin": (9, 10, 0, 10),
            "sizing_mode": "stretch_width",
        }
        if isinstance(declared, Choice):
            self.box: Any = pmui.Select(options=list(declared.objects), value=settings[key], **look)
        else:
            optional = isinstance(declared, BaseQuantity) and declared.allow_None
            self.box = pmui.TextInput(
                value=_text(settings, key), placeholder="from lift-off" if optional else "none", **look
            )
        self.box.param.watch(self._typed, "value")
        self.slider: LogSlider | None = None
        # A slider where a narrower range than the bounds is declared for one.
        if isinstance(declared, Slid) and declared.softbounds != declared.limits:
            self.slider = LogSlider(
                str(declared.label), *declared.softbounds, declared.unit, declared.dimension,
                zero=declared.limits[0] == 0, value=_size(self._shown),
            )  # fmt: skip
            self.slider.param.watch(self._slid, "value")
        self._help(settings)

    @property
    def view(self) -> pn.viewable.Viewable:
        """The control as it stands in the column."""
        if self.slider is None:
            return self.box
        return pn.Column(self.box, self.slider, margin=0, sizing_mode="stretch_width")

    def show(self, settings: Settings) -> None:
        """Follow the settings in force."""
        self._writing = True
        self._shown = settings[self.key]
        text = _text(settings, self.key)
        if self.box.value != text:
            self.box.value = text
        if self.slider is not None:
            self.slider.follow(_size(self._shown))
        self._help(settings)
        self._writing = False

    def _help(self, settings: Settings, error: str = "") -> None:
        changed = settings[self.key] != DEFAULTS[self.key]
        default = DEFAULTS.show(self.key) or "none"
        origin = settings.origin[self.key]
        source = f" ({origin})" if origin.startswith("design") else ""
        text = error or (f"≠ GP-1: {default}{source}" if changed else str(self._declared.doc))
        if getattr(self.box, "helper_text", None) != text:
            self.box.helper_text = text
        if not isinstance(self._declared, Choice) and self.box.error_state != bool(error):
            self.box.error_state = bool(error)

    def _typed(self, event: Any) -> None:
        if self._writing:
            return
        try:
            value = read_value(self.key, event.new, getattr(self._declared, "unit", ""))
        except InputError as error:
            self._refuse(error)
            return
        self._put(value)

    def _slid(self, event: Any) -> None:
        if self._writing:
            return
        declared = self._declared
        assert isinstance(declared, Slid)
        assert self.slider is not None
        size = self.slider.amount(declared.unit, declared.dimension)
        if not isinstance(declared, Axes):
            self._put(declared.step * max(1, round(size / declared.step)) if declared.step else size)
            return
        pattern = self._shown if _size(self._shown) > 0 else declared.default
        if _size(pattern) == 0:
            pattern = (1.0,) * len(declared.default)
        assert isinstance(pattern, tuple)
        self._put(tuple(float(p) * size / _size(pattern) for p in pattern))  # type: ignore[arg-type]

    def _put(self, value: Value) -> None:
        error = self._put_value(self.key, value)
        if error is not None:
            self._refuse(error)

    def _refuse(self, error: InputError) -> None:
        self.box.helper_text = error.reason if error.key == self.key else str(error)
        if not isinstance(self._declared, Choice):
            self.box.error_state = True


def _text(settings: Settings, key: str) -> str:
    return "" if settings[key] is None else settings.show(key)


def _size(value: Value) -> float:
    """Size of a value for a slider: of the largest axis."""
    if value is None:
        return 0.0
    return float(np.max(np.abs(np.asarray(value, dtype=np.float64))))


def input_controls(keys: list[str], settings: Settings, put: Put) -> list[InputControl]:
    """Controls of some inputs, in order."""
    return [InputControl(key, settings, put) for key in keys]

"""One input of the suborbital study on its page, derived from its declaration.

A box takes text with units (three axes separated by commas); where a range is explored by hand a slider on a log
scale moves the size, keeping the ratio of the axes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.ui.input_box import InputBox, slider_of
from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.several import Axes
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, GP1, Settings, Value, read_value

_EMPTY = {"tracker.from_height": "from lift-off", "camera.focal_length": "from the field of view"}

Put = Callable[[str, Value], InputError | None]


class InputControl(InputBox):
    """Box or select of one input, and perhaps a slider.

    Parameters
    ----------
    key : str
        Dotted key of the input.
    settings : callable
        The settings in force.
    put : callable
        Puts a value in force, or says why not.
    """

    def __init__(self, key: str, settings: Callable[[], Settings], put: Put) -> None:
        self._settings, self._put_value = settings, put
        self._declared = declared = INPUTS[key]
        look = {"label": str(declared.label), "margin": (9, 10, 0, 10), "sizing_mode": "stretch_width"}
        box: pmui.Select | pmui.TextInput
        if isinstance(declared, Choice):
            box = pmui.Select(options=list(declared.objects), value=settings()[key], **look)
        else:
            box = pmui.TextInput(placeholder=_EMPTY.get(key, "none"), **look)
        slider = None
        # A slider where a narrower range than the bounds is declared for one.
        if isinstance(declared, BaseQuantity | Axes) and declared.softbounds != declared.limits:
            slider = slider_of(declared, _size(settings()[key]))
        super().__init__(key, box, slider)
        self.listen()

    def __panel__(self) -> pn.viewable.Viewable:
        return self.box if self.slider is None else pn.Column(self.box, self.slider)

    def value(self) -> Value:
        """The current value, SI."""
        return self._settings()[self.key]

    def text(self) -> str:
        """The current value in its usual unit."""
        return "" if self.value() is None else self._settings().show(self.key)

    def size(self) -> float:
        """Size of the largest axis in force, SI."""
        return _size(self.value())

    def help(self) -> str:
        """What the input is, or what GP-1 has and where this value came from."""
        settings = self._settings()
        if self.value() == DEFAULTS[self.key]:
            return str(self._declared.doc)
        origin = settings.origin[self.key]
        source = f" ({origin})" if origin.startswith("design") else ""
        return f"≠ {GP1}: {DEFAULTS.show(self.key) or 'none'}{source}"

    def take(self, text: str) -> InputError | None:
        """Put a text in force; a number without a unit takes the usual one."""
        return self._put_value(self.key, read_value(self.key, text, getattr(self._declared, "unit", "")))

    def take_size(self) -> InputError | None:
        """Put the slider's size in force: in whole steps, or with the ratio of the axes kept."""
        declared = self._declared
        assert self.slider is not None
        assert isinstance(declared, BaseQuantity | Axes)
        size = self.slider.amount(declared.unit, declared.dimension)
        if isinstance(declared, BaseQuantity):
            step = declared.step
            return self._put_value(self.key, step * max(1, round(size / step)) if step else size)
        ratios = (np.asarray(axes, dtype=np.float64) for axes in (self.value(), declared.default))
        ratio = next((axes for axes in ratios if axes.any()), np.ones(len(declared.default)))
        return self._put_value(self.key, tuple(map(float, ratio * size / _size(ratio))))


def _size(value: Any) -> float:
    """Size of a value for a slider: of the largest axis."""
    return 0.0 if value is None else float(np.max(np.abs(np.asarray(value, dtype=np.float64))))

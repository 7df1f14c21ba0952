"""One input of the suborbital study on its page, derived from its declaration.

A box takes text with units (three axes separated by commas); where a range is explored by hand a slider on a log
scale moves the size, keeping the ratio of the axes.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from app.ui.input_sheet import Row, SheetInput, choice_row, text_row
from app.ui.log_scale import LogScale, scale_of
from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.several import Axes
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, GP1, Settings, Value, read_value

_EMPTY = {"tracker.from_height": "from lift-off", "camera.focal_length": "from the field of view"}

Put = Callable[[str, Value], InputError | None]


class StudyInput(SheetInput):
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
        super().__init__(key)
        self._settings, self._put_value = settings, put
        self._declared = declared = INPUTS[key]
        # A slider where a narrower range than the bounds is declared for one.
        self._scale: LogScale | None = None
        if isinstance(declared, BaseQuantity | Axes) and declared.softbounds != declared.limits:
            self._scale = scale_of(declared)

    def row(self) -> Row:
        """Label, help, unit or options, and the scale of the slider."""
        declared = self._declared
        label, text = str(declared.label), str(declared.doc)
        if isinstance(declared, Choice):
            return choice_row(label, text, [(str(option), str(option)) for option in declared.objects])
        dimension, unit = getattr(declared, "dimension", ""), getattr(declared, "unit", "")
        empty = _EMPTY.get(self.key, "none")
        several = isinstance(declared, Axes)
        return text_row(label, text, dimension, unit=unit, empty=empty, scale=self._scale, of_axes=several)

    def value(self) -> Value:
        """The current value, SI."""
        return self._settings()[self.key]

    def current(self) -> Row:
        """The value in its usual unit, and what GP-1 has where it is another."""
        settings, value = self._settings(), self.value()
        row: Row = {"text": "" if value is None else settings.show(self.key)}
        if value != DEFAULTS[self.key]:
            origin = settings.origin[self.key]
            source = f" ({origin})" if origin.startswith("design") else ""
            row |= {"mark": "≠", "note": f"≠ {GP1}: {DEFAULTS.show(self.key) or 'none'}{source}"}
        if self._scale is not None:
            size = _size(value)
            row |= {"place": self._scale.place(size), "size": size, "unit": getattr(self._declared, "unit", "")}
        return row

    def take(self, text: str) -> InputError | None:
        """Put a text in force; a number without a unit takes the usual one."""
        return self._put_value(self.key, read_value(self.key, text, getattr(self._declared, "unit", "")))

    def slide(self, place: float) -> InputError | None:
        """Put the slider's size in force: in whole steps, or with the ratio of the axes kept."""
        declared = self._declared
        assert self._scale is not None
        assert isinstance(declared, BaseQuantity | Axes)
        size = self._scale.amount(place, declared.unit, declared.dimension)
        if isinstance(declared, BaseQuantity):
            step = declared.step
            return self._put_value(self.key, step * max(1, round(size / step)) if step else size)
        ratios = (np.asarray(axes, dtype=np.float64) for axes in (self.value(), declared.default))
        ratio = next((axes for axes in ratios if axes.any()), np.ones(len(declared.default)))
        return self._put_value(self.key, tuple(map(float, ratio * size / _size(ratio))))


def _size(value: Any) -> float:
    """Size of a value for a slider: of the largest axis."""
    return 0.0 if value is None else float(np.max(np.abs(np.asarray(value, dtype=np.float64))))

"""A slider on a log scale: steps of 4.7 %; the far left may be zero."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

from bokeh.models import CustomJSTickFormatter

from app.upstream.prompt_slider import PromptSlider
from nav_model.base.units import from_si, to_si

_STEP = 0.02  # decades: 4.7 % a key press
_ZERO = 10 * _STEP  # how far below the lowest value zero lies
_SPOKEN = Path(__file__).with_suffix(".js").read_text("utf-8")


def spoken(lowest: float, factor: float, unit: str) -> CustomJSTickFormatter:
    """The text of a log slider's thumb: `factor` is the unit in SI; zero below the place `lowest`."""
    return CustomJSTickFormatter(code=_SPOKEN, args={"lowest": lowest, "factor": factor, "unit": unit})


class LogSlider(PromptSlider):
    """A slider on a log scale.

    Parameters
    ----------
    label : str
        What a screen reader calls it; a box above it shows it to everybody else.
    low, high : float
        Range [SI], `low` above zero.
    unit, dimension : str
        What the thumb's bubble shows the value in; empty for a plain number.
    zero : bool
        Whether the far left means zero.
    value : float
        Where to start [SI].
    """

    def __init__(
        self, label: str, low: float, high: float, unit: str, dimension: str, zero: bool, value: float
    ) -> None:
        self._lowest = math.log10(low)
        start = self._lowest - (_ZERO if zero else 0.0)
        factor = to_si(1.0, unit, dimension) if dimension else 1.0
        look: dict[str, Any] = {"& > .MuiFormLabel-root": {"display": "none"}}
        super().__init__(
            label=label,
            description="",
            show_value=False,
            format=spoken(self._lowest - _STEP / 2 if zero else -math.inf, factor, unit),
            start=start,
            end=math.log10(high),
            step=_STEP,
            value=self._place_of(value, start, math.log10(high)),
            size="small",
            margin=(0, 16, 2, 16),
            sizing_mode="stretch_width",
            sx=look,
        )

    def _place_of(self, value: float, start: float, end: float) -> float:
        return start if value <= 0 else min(max(math.log10(value), self._lowest), end)

    def shows(self, value: float) -> bool:
        """Whether the thumb is within half a step of a value [SI]."""
        place = self._place_of(value, float(self.start), float(self.end))
        return abs(place - float(self.value)) <= _STEP / 2

    def follow(self, value: float) -> None:
        """Move the thumb to a value [SI], unless it is there already."""
        if not self.shows(value):
            self.value = self._place_of(value, float(self.start), float(self.end))

    def amount(self, unit: str, dimension: str) -> float:
        """The value [SI] at the thumb, to three digits in a unit: one that can be quoted."""
        if self.value < self._lowest - _STEP / 2:
            return 0.0
        number = 10.0**self.value
        if not dimension:
            return float(f"{number:.3g}")
        return to_si(Fraction(f"{from_si(number, unit, dimension):.3g}"), unit, dimension)

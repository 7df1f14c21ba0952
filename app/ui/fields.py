"""Fields for text, cut on the server, and the numbers typed into them.

The component library keeps `max_length` in the browser alone; its number widgets have buttons without names.
"""

import math
from typing import Any

import panel_material_ui as pmui

from nav_model.base.errors import InputError


class TextInput(pmui.TextInput):
    """A line of text of at most `max_length` characters."""

    def _process_property_change(self, props: dict[str, Any]) -> dict[str, Any]:
        return _cut(super()._process_property_change(props), self.max_length)


class TextArea(pmui.TextAreaInput):
    """Lines of text of at most `max_length` characters."""

    def _process_property_change(self, props: dict[str, Any]) -> dict[str, Any]:
        return _cut(super()._process_property_change(props), self.max_length)


def _cut(props: dict[str, Any], most: int) -> dict[str, Any]:
    return {name: value[:most] if isinstance(value, str) else value for name, value in props.items()}


def whole_number(name: str, text: str, low: int, high: int) -> int:
    """The whole number in `text`, or an InputError that names the field and what is allowed."""
    if not (text.strip().isdecimal() and int(text) >= low):
        raise InputError(name, f"{text[:30]!r} is not a whole number from {low} to {high}.")
    if int(text) > high:
        raise InputError(name, f"must be at most {high}, not {text.strip()[:30]}.")
    return int(text)


def number(name: str, text: str, low: float, high: float) -> float:
    """The number in `text`, or an InputError that names the field and what is allowed."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise InputError(name, f"{text[:30]!r} is not a number from {low:g} to {high:g}.")
    return value

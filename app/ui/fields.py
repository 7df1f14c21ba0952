"""Numbers typed into a plain field: the number widgets of the component library have buttons without names."""

import math

from nav_model.base.errors import InputError


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

"""Names of designs, chapters and shares."""

import re
import unicodedata
from collections.abc import Mapping
from typing import cast

from app.document.numbers import number, show_in
from nav_model.base.units import format_quantity
from nav_model.design import Design
from nav_model.design.catalogue import find
from nav_model.design.declaration import BASE_LINE, BaseQuantity, Choice
from nav_model.design.parts import declaration_of, quantity
from nav_model.design.presets import deviations, preset_of
from nav_model.design.table import Table

DETRENDED = {1: "linear detrend", 2: "quadratic detrend", 3: "cubic detrend"}
"""Parts removed from the phase before its residual is measured, by the order of the autofocus."""

MOMENTS: dict[str, str] = dict(cast(Choice, declaration_of("requirements.steady_state")).options)
"""Points of the fix cycle, in words."""

_TYPED = 12  # digits of a text: what a sum of floats adds beyond is nothing that anybody typed


def best_of(shares: Mapping[str, float]) -> tuple[str, float]:
    """The largest share and its source."""
    source = max(shares, key=lambda name: shares[name])
    return source, shares[source]


def title_of(design: Design) -> str:
    """Name of a design, as a title."""
    return printable(design.name).strip() or "Untitled design"


def input_in_words(design: Design, key: str, value: float, *, given: bool = True) -> str:
    """A value [SI] of an input in the unit that the design has it in; not ``given``: a computed one."""
    dimension = quantity(key).dimension
    return show_in(value, design.unit(key), dimension, given=given) if dimension else number(value, given=given)


def box_text(design: Design, key: str, value: float, digits: int = 4) -> str:
    """A value [SI] of an input as a person types it, in the unit that the design has it in."""
    dimension = quantity(key).dimension
    return format_quantity(value, design.unit(key), dimension, digits) if dimension else f"{value:.{digits}g}"


def entered(design: Design, key: str) -> str:
    """An input as a person types it, in the unit in force; empty where it is not given."""
    declared, value = declaration_of(key), design[key]
    if isinstance(declared, Table):
        return declared.show(value)
    if value is None:
        return ""
    assert isinstance(declared, BaseQuantity)
    assert isinstance(value, float | int)
    if not declared.dimension:
        return f"{value:.{_TYPED}g}"
    scale = design.scale(key)
    baseline = (design.baseline or 0.0) if " + " in scale else 0.0
    return format_quantity(value, scale, declared.dimension, _TYPED, baseline=baseline)


def preset_name(design: Design, section: str) -> str:
    """Name of a section's values: an edited preset is no longer what the catalogue has."""
    name = preset_of(design, section)
    if name is None:
        return "own values"
    if section == "gnss":
        distance = design.baseline if "baseline" in find("gnss", name).values else None
        name += " class" if distance is None else f" class, {input_in_words(design, BASE_LINE, distance)} base"
    return f"Custom, based on {name}" if deviations(design, section) else name


def slug(name: str) -> str:
    """A name as the stem of a file, in letters every file system takes."""
    return re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower()[:60] or "design"


def identified(design: Design) -> str:
    """A design by its name and the beginning of its hash."""
    return f"{title_of(design)} ({design.content_hash[:12]})"


def printable(text: str) -> str:
    """A text without control characters and byte-order marks, which no font can show; line breaks stay."""
    signs = (" " if unicodedata.category(sign) == "Cc" and sign != "\n" else sign for sign in text)
    return "".join(signs).replace("\ufeff", "")


def shortened(name: str, length: int = 70) -> str:
    """A name that fits the head of a page."""
    return name if len(name) <= length else f"{name[: length - 1].rstrip()}…"


def labelled(label: str, name: str) -> str:
    """A name with its label in a comparison."""
    return f"{label}: {name}" if label else name


def design_labels(count: int) -> list[str]:
    """Labels of designs in a comparison; a single design has none."""
    return [""] if count == 1 else [f"D{i}" for i in range(1, count + 1)]


def chapter_key(label: str) -> str:
    """Start of the keys of a design's sections; its label is empty for one design alone."""
    return label.lower() or "d"

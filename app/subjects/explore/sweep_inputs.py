"""Inputs that a sweep on the page varies: a row for each, and the equivalent sweep file."""

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

import tomli_w

from app.document.wording import box_text
from app.ui.row_editor import Field, Rows
from nav_model.budget.inputs import VARIABLES
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import Choice
from nav_model.design.file import format_design
from nav_model.design.parts import INPUTS, PARTS, PRESET_KEYS, declaration_of, quantity
from nav_model.design.presets import kind_of
from nav_model.design.several import with_unit
from nav_model.explore.margins import usual_range
from nav_model.explore.trade_map import is_log

_TITLES = {part.section: part.title for part in PARTS}
_CHOICES = tuple(
    f"{section}.{name}"
    for section, inputs in INPUTS.items()
    for name, declared in inputs.items()
    if isinstance(declared, Choice) and section not in ("requirements", "trajectory")
)
_BETWEEN = "; "  # names of a row
EXAMPLE = ("imu.angle_random_walk", "gnss.position_noise")
"""The inputs of an empty page."""


def input_labels() -> dict[str, str]:
    """Label -> dotted key, for every input that a figure depends on as a number."""
    return {f"{_TITLES[key.partition('.')[0]]}: {quantity(key).label}": key for key in VARIABLES}


def _all_labels() -> dict[str, str]:
    choices = {f"{_TITLES[key.partition('.')[0]]}: {declaration_of(key).label}": key for key in _CHOICES}
    presets = {f"{_TITLES[key.partition('.')[0]]}: catalogue": key for key in PRESET_KEYS}
    return {**input_labels(), **choices, **presets}


FIELDS = (
    Field("input", "Input", choices=tuple((key, label) for label, key in _all_labels().items()), needed=True),
    Field("from", "From (or list)"),
    Field("to", "To"),
    Field("points", "Points"),
    Field("spacing", "Spacing", choices=(("", "none"), ("log", "log"), ("linear", "linear"))),
)


def usual_row(key: str, design: Design) -> dict[str, str]:
    """The row of an input that was just chosen: its usual range, or all its names."""
    if key not in VARIABLES:
        return {"input": key, "from": _BETWEEN.join(_names(key))}
    low, high = (box_text(design, key, value, 3) for value in usual_range(key))
    spacing = "log" if is_log(key) and usual_range(key)[0] > 0 else "linear"
    return {"input": key, "from": low, "to": high, "points": "20", "spacing": spacing}


def chosen_rows(rows: Rows, before: Rows, design: Design) -> Rows:
    """Rows with those filled in whose input was just chosen."""
    known = [row["input"] for row in before] if len(before) == len(rows) else [row["input"] for row in rows]
    return [
        row if row.get("from") and row["input"] == key else usual_row(row["input"], design)
        for row, key in zip(rows, known, strict=True)
    ]


def _names(key: str) -> dict[str, Any]:
    """Options of an input that is no number, by their text."""
    if key in PRESET_KEYS:
        return {name: name for name in catalogue(kind_of(key.partition(".")[0]))}
    declared = declaration_of(key)
    assert isinstance(declared, Choice)
    return {str(name): name for name in declared.objects}


def _spec(row: Mapping[str, str], design: Design) -> Any:
    """Entry of a sweep file for an input."""
    key = row["input"]
    if key not in VARIABLES:
        names = _names(key)
        return [names.get(name.strip(), name.strip()) for name in row["from"].split(_BETWEEN.strip())]
    low, high = (with_unit(row.get(end, "").strip(), design.unit(key)) for end in ("from", "to"))
    points = row.get("points", "").strip()
    points_spec = int(points) if points.isdecimal() else points
    return {"from": low, "to": high, "points": points_spec, "spacing": row.get("spacing", "linear")}


def sweep_file(design: Design, rows: Sequence[Mapping[str, str]]) -> str:
    """The sweep file of what the rows vary, as `navbudget sweep` takes it."""
    vary = {row["input"]: _spec(row, design) for row in rows}
    return tomli_w.dumps({"design": tomllib.loads(format_design(design)), "vary": vary})

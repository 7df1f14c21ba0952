"""Inputs of a sweep: a row for each, and the equivalent sweep file."""

import tomllib
from collections.abc import Callable, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
import tomli_w

from app.document.wording import box_text
from app.ui.view import View
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

NONE = "none"
_TITLES = {part.section: part.title for part in PARTS}
_CHOICES = tuple(
    f"{section}.{name}"
    for section, inputs in INPUTS.items()
    for name, declared in inputs.items()
    if isinstance(declared, Choice) and section not in ("requirements", "trajectory")
)


def input_labels() -> dict[str, str]:
    """What people read -> dotted key, for every input that a figure depends on as a number."""
    return {f"{_TITLES[key.partition('.')[0]]}: {quantity(key).label}": key for key in VARIABLES}


def _all_labels() -> dict[str, str]:
    choices = {f"{_TITLES[key.partition('.')[0]]}: {declaration_of(key).label}": key for key in _CHOICES}
    presets = {f"{_TITLES[key.partition('.')[0]]}: catalogue": key for key in PRESET_KEYS}
    return {NONE: NONE, **input_labels(), **choices, **presets}


class SweepRow(View):
    """One input: its range, or the names it takes."""

    changed = param.Event(doc="Something was chosen or typed.")

    def __init__(self, key: str, design: Callable[[], Design]) -> None:
        super().__init__()
        self._design = design
        look: dict[str, Any] = {"size": "small", "margin": (9, 2, 0, 4)}
        self.input = pmui.Select(label="Input", options=_LABELS, value=key, width=320, **look)
        self.low = pmui.TextInput(label="From", width=96, **look)
        self.high = pmui.TextInput(label="To", width=90, **look)
        self.points = pmui.TextInput(label="Points", value="20", width=64, **look)
        self.spacing = pmui.Select(label="Spacing", options=["log", "linear"], width=92, **look)
        self.names = pmui.MultiChoice(label="Values", options=[], width=350, visible=False, margin=(9, 2, 0, 4))
        self._fill()
        self.input.param.watch(lambda _: self._fill(), "value")
        for box in (self.low, self.high, self.points, self.spacing, self.names):
            box.param.watch(lambda _: self.param.trigger("changed"), "value")
        span = pn.FlexBox(self.low, self.high, self.points, self.spacing)  # stays together, beside or below the name
        self._view = pn.FlexBox(self.input, span, self.names)

    @property
    def key(self) -> str:
        """Dotted key of the input, or `NONE`."""
        return str(self.input.value)

    @property
    def numeric(self) -> bool:
        """Whether the input runs through a range."""
        return self.key in VARIABLES

    def _fill(self) -> None:
        """The usual range of an input, or all its names."""
        key = self.key
        for box in (self.low, self.high, self.points, self.spacing):
            box.visible = self.numeric
        self.names.visible = key != NONE and not self.numeric
        with param.parameterized.discard_events(self):
            if self.numeric:
                for box, value in zip((self.low, self.high), usual_range(key), strict=True):
                    box.value = box_text(self._design(), key, value, 3)
                self.spacing.value = "log" if is_log(key) and usual_range(key)[0] > 0 else "linear"
            elif key != NONE:
                names = _names(key)
                self.names.param.update(options=names, value=names)
        self.param.trigger("changed")

    def spec(self) -> Any:
        """What a sweep file says of this input."""
        if not self.numeric:
            return list(self.names.value)
        unit = self._design().unit(self.key)
        low, high = (with_unit(box.value.strip(), unit) for box in (self.low, self.high))
        points = self.points.value.strip()
        return {
            "from": low,
            "to": high,
            "points": int(points) if points.isdecimal() else points,
            "spacing": self.spacing.value,
        }


def _names(key: str) -> list[str]:
    if key in PRESET_KEYS:
        return list(catalogue(kind_of(key.partition(".")[0])))
    declared = declaration_of(key)
    assert isinstance(declared, Choice)
    return list(declared.objects)


def sweep_file(design: Design, rows: Sequence[SweepRow]) -> str:
    """The sweep file of what the rows vary, as `navbudget sweep` takes it."""
    vary = {row.key: row.spec() for row in rows if row.key != NONE}
    return tomli_w.dumps({"design": tomllib.loads(format_design(design)), "vary": vary})


_LABELS = _all_labels()

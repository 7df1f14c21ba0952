"""The theme of the product: one accent colour, quiet surfaces, light and dark."""

import tomllib
from pathlib import Path
from typing import Any

from app.document.bars import ROWS_SHEET


def _sheet(name: str) -> str:
    return Path(__file__).with_name(f"{name}.css").read_text("utf-8")


_FACES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))

_SAME = {"typography": _FACES["typography"], "components": _FACES["components"]}
LIGHT: dict[str, Any] = {**_FACES["light"], **_SAME}
DARK: dict[str, Any] = {
    **_FACES["dark"],
    **_SAME,
    "components": {**_FACES["components"], **_FACES["dark"]["components"]},
}

FRAME = {
    "border": "1px solid color-mix(in srgb, currentColor 22%, transparent)",
    "border-radius": "6px",
}
"""Around a chart; follows the page's text colour, so it holds in the dark."""

FULL_HEIGHT = {"max-height": "none"}
"""Styles of the page's main column, and of a column of several parts in one that scrolls: it may be taller than the
window, where Bokeh keeps it within."""

BASE = _sheet("base")
"""Face, buttons, fields and focus of every component of our own."""

NARROW = _sheet("narrow")
"""Sheet of a part: on a narrow window what is in it is as high as it wants."""

ON_A_PHONE = _sheet("on_a_phone")
"""Sheet of what holds a figure that fills its place: on a phone the figure is high enough for its labels."""

STACK_ON_A_PHONE = _sheet("stack_on_a_phone")
"""Sheet of what holds figures under one another: on a narrow window as high as the names of their axes."""

PRINT_NOTHING = _sheet("print_nothing")
"""Sheet of what has no place on paper: tools, tabs, fields."""

PRINT_PAGE = _sheet("print_page")
"""Sheet of the frame: on paper the page alone; a dark one is turned over, and its hues turned back."""

PRINT_WHOLE = _sheet("print_whole")
"""Sheet of what must not be torn by a page's end."""

SWITCH = _sheet("switch")
"""Sheet of a switch: its name is for screen readers, and its choices stand in one line as they are written."""

# Panes of our own HTML live in shadow roots: each carries this sheet. Colours follow the page's theme through
# currentColor, so there is one sheet for light and dark.
SHEET = BASE + ROWS_SHEET + _sheet("sheet")

FIND = Path(__file__).with_name("find.js").read_text("utf-8")
"""Before a script that looks for parts of the page."""

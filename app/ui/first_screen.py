"""A page's first screen: it fills the window, so that the answer and what decides it are seen at once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import panel as pn

from app.ui.theme import FRAME

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")

_ABOUT = 800  # pixels


def first_screen(*top: Any, left: Sequence[Any], right: Sequence[Any], bottom: Any = None) -> pn.Column:
    """Rows across the top, and below them two halves that fill the rest of the window; ``bottom``: a row under them.

    Each half has one part, or two on top of each other. On a narrow window everything stands in one column and as
    high as it wants.

    Examples
    --------
    >>> first_screen(strip, tiles, left=[timelines], right=[phase, response])
    """
    rows = len(top)
    parts = [pn.Column(part, styles={"grid-area": f"{row} / 1 / auto / span 2"}) for row, part in enumerate(top, 1)]
    for column, half in enumerate((left, right), 1):
        for place, part in enumerate(half):
            span = 2 if len(half) == 1 else 1
            where = {"grid-area": f"{rows + 1 + place} / {column} / span {span} / auto"}
            parts.append(pn.Column(part, styles=where | FRAME, sizing_mode="stretch_both"))
    if bottom is not None:
        parts.append(pn.Column(bottom, styles={"grid-area": f"{rows + 3} / 1 / auto / span 2"} | FRAME))
    # With a height the page around it stays as high as its content, and scrolls; the sheet says how high this is.
    return pn.Column(*parts, height=_ABOUT, stylesheets=[_SHEET.replace("TOP", str(max(rows, 1)))])

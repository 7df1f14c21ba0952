"""A page's first screen: it fills the window with the answer and its main figures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import panel as pn

from app.ui.theme import FRAME, NARROW

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")
_VIEWS = Path(__file__).with_name("screen_of_views.css").read_text("utf-8")

_ABOUT = 800  # pixels


def first_screen(
    *top: Any,
    left: Sequence[Any],
    right: Sequence[Any] = (),
    bottom: Any = None,
    height: str = "calc(100dvh - 104px)",
    fitted: bool = False,
) -> pn.Column:
    """Rows across the top, and below them two halves, or one whole, that fill the window under bar and strip.

    ``bottom`` is a row under them.

    Each half has one part, or two on top of each other. On a narrow window everything is in one column at its natural
    height, the second part of the left half below the right one. A ``height`` of "100%" fills a place within the
    window, such as a view of `screen_of_views`. ``fitted``: the upper right part is as high as its content, at most
    half, and scrolls beyond.

    Examples
    --------
    >>> first_screen(strip, tiles, left=[timelines], right=[phase, response])
    """
    rows = len(top)
    parts = [pn.Column(part, styles={"grid-area": f"{row} / 1 / auto / span 2"}) for row, part in enumerate(top, 1)]
    for column, half in enumerate((left, right), 1):
        for place, part in enumerate(half):
            order = "1" if place and column == 1 else "0"  # places count where there are two columns
            span, wide = 2 if len(half) == 1 else 1, "auto" if right else "span 2"
            where = {"grid-area": f"{rows + 1 + place} / {column} / span {span} / {wide}", "order": order}
            mode = "stretch_both"
            if fitted and column == 2 and not place:
                where, mode = where | {"overflow": "auto"}, "stretch_width"
            parts.append(pn.Column(part, styles=where | FRAME, sizing_mode=mode, stylesheets=[NARROW]))
    if bottom is not None:
        where = {"grid-area": f"{rows + 3} / 1 / auto / span 2", "order": "1"}
        parts.append(pn.Column(bottom, styles=where | FRAME))
    within = height == "100%"
    sheet = _SHEET.replace("TOP", rows * "max-content ").replace("HEIGHT", height)
    sheet = sheet.replace("ROWS", f"{'fit-content(50%)' if fitted else 'minmax(LEAST, 1fr)'} minmax(LEAST, 1fr)")
    # Two parts on top of each other in a view may need more than a low window leaves them: the view then scrolls.
    scrolls = within and max(len(left), len(right)) > 1
    sheet = sheet.replace("SIDES", "0" if within else "10px")
    sheet = sheet.replace("LEAST", "225px" if scrolls else "0")
    sheet = sheet.replace("FLEX", "1 1 0" if within else "none").replace(
        "OVERFLOW", "auto" if scrolls else "clip" if within else "visible"
    )
    # With a height the page around it stays as high as its content, and scrolls; the sheet says how high this is.
    return pn.Column(*parts, height=None if within else _ABOUT, stylesheets=[sheet], css_classes=["first-screen"])


def screen_of_views(strip: Any, *parts: Any) -> pn.Column:
    """A page with one view at a time: the strip, and parts of which the chosen view takes the rest of the window."""
    return pn.Column(strip, pn.Column(*parts, height=_ABOUT, stylesheets=[_VIEWS, NARROW]))

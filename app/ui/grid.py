"""Parts beside each other on a wide screen, under each other on a narrow one.

A CSS grid: each cell of the component library's grid is a component, and pages with many of them took twice as long
to load.
"""

from pathlib import Path
from typing import Any

import panel as pn

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")


def cell(columns: int, *content: Any, **params: Any) -> pn.Column:
    """A place in a `grid`, so many of its twelve columns wide; it may be filled later."""
    return pn.Column(*content, styles={"grid-column": f"span {columns}"}, **params)


def grid(*cells: pn.Column, beside: int = 1200, margin: tuple[int, int] = (4, 10)) -> pn.Column:
    """Cells in rows of twelve columns, on windows at least `beside` pixels wide; else one a row."""
    return pn.Column(*cells, stylesheets=[_SHEET.replace("BESIDE", f"{beside - 1}px")], margin=margin)

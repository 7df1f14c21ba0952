"""Parts beside each other on a wide screen, under each other on a narrow one.

A grid of the browser's own: each cell of the component library's is a component with a life of its own, and pages
with many of them took twice as long to stand.
"""

from __future__ import annotations

from typing import Any

import panel as pn

_SHEET = """
:host { display: grid; grid-template-columns: repeat(12, minmax(0, 1fr)); grid-auto-rows: max-content; gap: 12px; }
@media (max-width: %dpx) { div { grid-column: 1 / -1 !important; } }
"""


def cell(columns: int, *content: Any, **params: Any) -> pn.Column:
    """A place in a `grid`, so many of its twelve columns wide; it may be filled later."""
    return pn.Column(
        *content, sizing_mode="stretch_width", margin=0, styles={"grid-column": f"span {columns}"}, **params
    )


def grid(*cells: pn.Column, beside: int = 1200, margin: tuple[int, int] = (4, 10)) -> pn.Column:
    """Cells in rows of twelve columns, on windows at least `beside` pixels wide; else one a row."""
    return pn.Column(*cells, stylesheets=[_SHEET % (beside - 1)], sizing_mode="stretch_width", margin=margin)

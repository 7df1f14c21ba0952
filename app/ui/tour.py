"""A tour of the product for who opens it the first time.

All of it happens in the browser: it is offered once, never stands in the way, and whoever has taken or declined it
is not asked again on that browser.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from app.ui.theme import PRINT_NOTHING

STEPS: tuple[dict[str, str], ...] = (
    {
        "title": "Your design",
        "text": "Inertial unit, receiver, flight, radar, limits. Start from the catalogue, then type values as they "
        "stand on a data sheet, such as 0.09 °/√h, or move a slider. “Explain every input” says what each one is.",
        "at": ".sidebar",
    },
    {
        "title": "The answer",
        "text": "Whether the design closes, by how much, and what dominates. It follows every change at once.",
        "at": ".strip[role=status]",
    },
    {
        "title": "Why",
        "text": "The charts below explain the answer. Under each stands how we know; a mark such as [T-17] leads to "
        "its equation and to what it was checked against.",
        "at": ".know",
    },
    {
        "title": "What next",
        "text": "Explore says what would close the design, SAR what the image looks like, Simulate whether the "
        "closed forms hold, and Review compares and signs off with your team.",
        "at": "[role=tablist]",
    },
    {
        "title": "Keep and share",
        "text": "Undo takes any change back. Save writes a file, Link an address, and the reports a document. "
        "Examples has designs to start from.",
        "at": ".tools",
    },
)


class Tour(JSComponent):
    """The button that starts the tour, the offer on a first visit, and the card that walks through the steps."""

    steps = param.List(default=list[Any](STEPS))

    _stylesheets: ClassVar[list[str]] = [PRINT_NOTHING, Path(__file__).with_suffix(".css").read_text("utf-8")]

    _esm = Path(__file__).with_suffix(".js").read_text("utf-8")

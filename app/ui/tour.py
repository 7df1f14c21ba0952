"""A tour of the product for first-time users.

It runs in the browser and is offered once: not again in a browser where it was taken or declined.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param

from app.ui.theme import FIND, PRINT_NOTHING
from app.upstream.plain_script import PlainScript

STEPS: tuple[dict[str, str], ...] = (
    {
        "title": "Your design",
        "text": "IMU, receiver, flight, radar and limits. Start from the catalogue, then type values as a "
        "data sheet prints them, such as 0.09 °/√h, or move a slider. “Show help for all inputs” says what "
        "each one is.",
        "at": ".sidebar",
    },
    {
        "title": "The answer",
        "text": "Pass or fail, margin and main error source. Updates as you type. “What would close it” lists values "
        "and sensors that meet the requirements.",
        "at": ".strip[role=status]",
    },
    {
        "title": "Why",
        "text": "Navigation errors on the left, SAR phase errors on the right, on one screen. Faint curves and "
        "outlined bars show the design before the last change. The (i) of a chart has its source and method.",
        "at": ".head",
    },
    {
        "title": "What next",
        "text": "Explore finds what would close the design, SAR shows the image, Simulate checks the formulas, and "
        "Review compares designs and signs them off with your team.",
        "at": "[role=tablist]",
    },
    {
        "title": "Keep and share",
        "text": "You can undo any change. Save writes a file, Share gives a link, Report writes a document. "
        "Open has examples "
        "to start from.",
        "at": "[role=toolbar]",
    },
)


class Tour(PlainScript):
    """The offer on a first visit, and the card that walks through the steps; the bar's button starts it too."""

    steps = param.List(default=list[Any](STEPS))
    offers = param.Boolean(default=True, doc="Whether the page in view has room for the offer, which floats over it.")

    _stylesheets: ClassVar[list[str]] = [PRINT_NOTHING, Path(__file__).with_suffix(".css").read_text("utf-8")]

    _esm = FIND + Path(__file__).with_suffix(".js").read_text("utf-8")

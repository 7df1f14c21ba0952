"""A tour of the product for first-time users.

It runs in the browser and is offered once: not again in a browser where it was taken or declined.
"""

import json
from pathlib import Path
from typing import Any, ClassVar

import param

from app.ui.theme import BASE, FIND, PRINT_NOTHING
from app.upstream.plain_script import PlainScript

_STEPS: list[Any] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))


class Tour(PlainScript):
    """The offer on a first visit, and the card that walks through the steps; the bar's button starts it too."""

    steps = param.List(default=_STEPS, doc="Title, text and place of each.")
    offers = param.Boolean(default=True, doc="Whether the page in view has room for the offer, which floats over it.")

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]
    _before = FIND

"""A switch whose words change with every step of a slider, in the frame in which the text beside it does."""

from typing import ClassVar

import param

from app.ui.theme import PRINT_NOTHING
from app.upstream.plain_script import PlainScript


class VerdictSwitch(PlainScript):
    """Buttons of which one is on.

    Examples
    --------
    >>> VerdictSwitch(label="Processing", options={"Real time ✓ +6 %": "real time"}, value="real time").value
    'real time'
    """

    label = param.String(default="", constant=True, doc="Name of the whole, for screen readers.")
    options = param.Dict(default={}, doc="What each button says -> its value.")
    value = param.String(default="", doc="Value of the one that is on.")

    _stylesheets: ClassVar[list[str]] = [PRINT_NOTHING]

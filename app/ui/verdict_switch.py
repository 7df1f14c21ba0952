"""A switch that changes in the frame in which the text beside it does, whether a slider moves or it is pressed."""

from collections.abc import Callable
from typing import Any, ClassVar

import panel as pn
import param

from app.ui.theme import BASE, PRINT_NOTHING
from app.upstream.plain_script import PlainScript


class VerdictSwitch(PlainScript):
    """A row of buttons. Pressing one calls `choose`; which one is lit follows `value`.

    Examples
    --------
    >>> VerdictSwitch(print, label="Processing", options={"Real time ✓ +6 %": "real time"})._handle_msg("real time")
    real time
    """

    label = param.String(default="", constant=True, doc="Name of the whole, for screen readers.")
    options = param.Dict(default={}, doc="What each button says -> its value.")
    value = param.String(default="", doc="Value of the one that is on.")

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]

    def __init__(self, choose: Callable[[str], object], **params: Any) -> None:
        super().__init__(**params)
        self._choose = choose

    def _handle_msg(self, msg: Any) -> None:
        if msg in self.options.values():
            with pn.io.hold():
                self._choose(msg)

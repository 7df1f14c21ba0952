"""The first question of an empty start: the user's task, its inputs, and the page that answers."""

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import param

from app.ui.theme import PRINT_NOTHING, SHEET
from app.upstream.plain_script import PlainScript


class Start(NamedTuple):
    """A task of the user: the page with its answer, one sentence of instruction, and the sections of its inputs."""

    address: str
    says: str
    sections: tuple[str, ...] = ()


PASTED = "My IMU"
"""The task that has a box for the rows of a data sheet."""
STARTS = {
    "My radar": Start(
        "budget",
        "Type your radar, flight and receiver. The verdict follows; Close it ranks the IMUs that pass.",
        ("Radar", "Flight", "GNSS"),
    ),
    PASTED: Start("budget", "Paste rows of its data sheet, or choose and type below. The verdict follows.", ("IMU",)),
    "My log": Start("sensors-log", "Choose a log of your IMU. One press puts its noise into the design."),
    "My flight": Start("flight-plan", "Open your plan, or choose lines. The verdict is then of the lines."),
    "A flown flight": Start("flown", "Choose its solution and a second one. The page says if it met the budget."),
}
_MOST = 5000  # characters of a data sheet


class StartChoice(PlainScript):
    """A group of buttons; ``chosen`` is the name of the one pressed last."""

    names = param.List(default=list(STARTS))
    chosen = param.String(default="", doc="Empty: none.")
    says = param.String(default="", doc="What to do next.")
    pasted = param.String(default=PASTED, constant=True, doc="The one with a box for rows.")
    answer = param.String(default="", doc="HTML of what became of the rows.")

    _stylesheets: ClassVar[list[str]] = [SHEET, PRINT_NOTHING]

    def __init__(self, fill_in: Callable[[str], str], **params: Any) -> None:
        """fill_in: takes the text that was pasted, returns what to show."""
        super().__init__(**params)
        self._fill_in = fill_in

    def _handle_msg(self, msg: Any) -> None:
        if isinstance(msg, dict) and isinstance(msg.get("rows"), str):
            self.answer = self._fill_in(msg["rows"][:_MOST])
        if isinstance(msg, str) and msg in STARTS:
            self.says = STARTS[msg].says
            # Pressed again, it leads there again; but once, as a second selection would swallow what is typed.
            if self.chosen == msg:
                self.param.trigger("chosen")
            else:
                self.chosen = msg

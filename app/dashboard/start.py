"""The first question of an empty start: the user's task, its inputs, and the page that answers."""

from typing import Any, ClassVar, NamedTuple

import param

from app.ui.theme import BASE, PRINT_NOTHING
from app.upstream.plain_script import PlainScript


class Start(NamedTuple):
    """A task of the user: the page with its answer, one sentence of instruction, and the sections of its inputs."""

    address: str
    says: str
    sections: tuple[str, ...] = ()


STARTS = {
    "My radar": Start(
        "close-sensors",
        "Type your radar, flight and receiver. The list ranks the IMUs that pass with this receiver.",
        ("Radar", "Flight", "GNSS"),
    ),
    "My IMU": Start(
        "budget",
        "Choose your IMU, type the values of its data sheet, or paste its rows under Sensors, IMUs. The verdict "
        "follows every change.",
        ("IMU",),
    ),
    "My log": Start("sensors-log", "Choose a log of your IMU. One press puts its noise into the design."),
}  # fmt: skip


class StartChoice(PlainScript):
    """One line of buttons; ``chosen`` is the name of the one pressed last."""

    names = param.List(default=list(STARTS))
    chosen = param.String(default="", doc="Empty: none.")
    says = param.String(default="", doc="What to do next.")

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]

    def _handle_msg(self, msg: Any) -> None:
        if isinstance(msg, str) and msg in STARTS:
            self.says = STARTS[msg].says
            self.chosen = msg
            self.param.trigger("chosen")  # pressed again, it leads there again

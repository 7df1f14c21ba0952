"""The design on the left: the comparison, and its inputs by section."""

from collections.abc import Callable

import panel as pn
import param

from app.dashboard.comparison import ComparisonChoice
from app.dashboard.controls import design_groups
from app.dashboard.geometry import geometry_sketch
from app.dashboard.start import PASTED, STARTS, StartChoice
from app.declared import required
from app.session import Session
from app.ui.input_sheet import InputSheet
from nav_model.budget import Budget

_FIRST_OPEN = ("imu", "gnss")  # the question most people come with


class Sidebar(pn.viewable.Viewer):
    """Every input of the current design.

    Parameters
    ----------
    lead_to : callable
        Turns to the page of an address such as "close-sensors".
    empty : bool
        Whether the address names no design: the first question is asked then.
    """

    session = required(Session)

    def __init__(self, session: Session, lead_to: Callable[[str], object], empty: bool) -> None:
        super().__init__(session=session)
        self._lead_to = lead_to
        self._start = StartChoice(self._fill_in, visible=empty, sizing_mode="stretch_width", margin=(8, 10, 0, 10))
        self._start.param.watch(self._begin, "chosen")
        self._sheet = InputSheet(design_groups(session, _FIRST_OPEN), heading="Design")
        self._sheet.param.watch(lambda event: session.refuse("input", event.new), "invalid")
        self._sheet.picture = geometry_sketch(session.budget)
        self.parts = [self._start, ComparisonChoice(session), self._sheet]

    def __panel__(self) -> pn.Column:
        return pn.Column(*self.parts)

    def _begin(self, event: param.parameterized.Event) -> None:
        """Open the inputs that the first question takes, and turn to the page that answers it."""
        start = STARTS[event.new]
        self._sheet.unfold(*start.sections, enter=event.new != PASTED)
        self._lead_to(start.address)

    def _fill_in(self, rows: str) -> str:
        """Take the rows of a data sheet."""
        from app.subjects.sensors.data_sheet import fill_in

        return fill_in(self.session, rows)

    @param.depends("session.adopted", watch=True)
    def _forget_invalid(self) -> None:
        """Clear invalid boxes and hide the first question after a whole design was replaced."""
        self._start.visible = False
        self._sheet.forget_refusals()

    def show(self, _: Budget) -> None:
        """Follow the current budget: its inputs, and the geometry above those of the radar."""
        self._sheet.follow()
        self._sheet.picture = geometry_sketch(self.session.budget)

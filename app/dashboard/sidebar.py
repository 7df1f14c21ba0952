"""The design on the left: the comparison, and its inputs by section."""

from collections.abc import Callable
from typing import Any

import panel as pn
import param

from app.dashboard.comparison import ComparisonChoice
from app.dashboard.controls import design_groups, input_of
from app.dashboard.geometry import geometry_sketch
from app.dashboard.start import STARTS, StartChoice
from app.declared import required
from app.session import Session
from app.ui.input_sheet import Group, InputSheet
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
        self._start = StartChoice(visible=empty, sizing_mode="stretch_width", margin=(8, 10, 0, 10))
        self._start.param.watch(self._begin, "chosen")
        self._asked = pn.Column()
        self._sheet = self._follow(InputSheet(design_groups(session, _FIRST_OPEN), heading="Design"))
        self._sheets = [self._sheet]  # all that is shown
        self._sketch()
        self.parts = [self._start, self._asked, ComparisonChoice(session), self._sheet]

    def __panel__(self) -> pn.Column:
        return pn.Column(*self.parts)

    def _follow(self, sheet: InputSheet) -> InputSheet:
        sheet.param.watch(self._count_invalid, "invalid")
        return sheet

    def _begin(self, event: param.parameterized.Event) -> None:
        """Show the inputs that the first question takes, and turn to the page that answers it."""
        start = STARTS[event.new]
        self._sheet.fold()
        if event.old != event.new:
            inputs = [input_of(self.session, key) for key in start.keys]
            pictured = any(key.startswith("radar.") for key in start.keys)
            asked = [self._follow(InputSheet([Group("", inputs, pictured=pictured)]))] if inputs else []
            self._asked.objects, self._sheets = list(asked), [self._sheet, *asked]
            self._sketch()
            self._count_invalid()
        self._lead_to(start.address)

    def _count_invalid(self, *_: Any) -> None:
        """Tell the pages how many boxes hold an invalid text."""
        self.session.invalid = sum(sheet.invalid for sheet in self._sheets)

    @param.depends("session.adopted", watch=True)
    def _forget_invalid(self) -> None:
        """Clear invalid boxes and hide the first question after a whole design was replaced."""
        self._start.visible = self._asked.visible = False
        for sheet in self._sheets:
            sheet.forget_refusals()

    def _sketch(self) -> None:
        """The geometry, above inputs of the radar."""
        picture = geometry_sketch(self.session.budget)
        for sheet in self._sheets:
            sheet.picture = picture

    def show(self, _: Budget) -> None:
        """Follow the current budget."""
        for sheet in self._sheets:
            sheet.follow()
        self._sketch()

"""The design on the left: the comparison, and its inputs by section."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.dashboard.comparison import ComparisonChoice
from app.dashboard.controls import SECTION_TITLES, Control, control_of, section_controls
from app.dashboard.geometry import geometry_sketch
from app.dashboard.start import STARTS, StartChoice
from app.declared import held
from app.session import Session
from app.ui.html_pane import html_pane
from app.ui.input_box import InputBox
from app.ui.turns import once_loaded
from app.upstream.plain_titles import WordedAccordion
from app.upstream.text_pane import TextPane
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.parts import INPUTS

_FIRST_OPEN = (0, 1)  # IMU and GNSS: the question most people come with. The second is below the first screen.


class Sidebar(pn.viewable.Viewer):
    """Every input of the current design; a section's controls are made when it is first opened.

    Parameters
    ----------
    lead_to : callable
        Turns to the page of an address such as "explore-which".
    empty : bool
        Whether the address names no design: the first question is asked then.
    """

    session = held(Session)
    explained = param.Boolean(default=False, label="Explain every input")

    def __init__(self, session: Session, lead_to: Callable[[str], object], empty: bool) -> None:
        super().__init__(session=session)
        self._lead_to = lead_to
        self._start = StartChoice(visible=empty, sizing_mode="stretch_width", margin=(8, 10, 0, 10))
        self._start.param.watch(self._begin, "chosen")
        self._asked = pn.Column()
        self._asking: list[Control] = []  # the inputs that the first question takes
        self._controls: list[Control] = []
        self._sketches: list[TextPane] = []
        self._shown: Design = session.design
        self._sections = [pn.Column() for _ in INPUTS]
        self._comparison = ComparisonChoice(session)
        self._accordion = accordion = WordedAccordion(
            *zip((SECTION_TITLES[section] for section in INPUTS), self._sections, strict=True),
            active=list(_FIRST_OPEN),
            toggle=False,
            disable_gutters=True,
            title_variant="body1",
            sizing_mode="stretch_width",
            margin=0,
        )
        self._fill(_FIRST_OPEN[0])
        once_loaded(lambda: self._fill(_FIRST_OPEN[1]))
        accordion.param.watch(self._opened, "active")
        self.parts = [
            html_pane('<h2 class="hidden">Design</h2>', margin=0),
            self._start,
            self._asked,
            self._comparison,
            pmui.Switch.from_param(self.param.explained, margin=(2, 10)),
            accordion,
        ]

    def __panel__(self) -> pn.Column:
        return pn.Column(*self.parts)

    def _opened(self, event: param.parameterized.Event) -> None:
        for index in event.new:
            self._fill(index)

    def _fill(self, index: int) -> None:
        """Make a section's controls when it is first opened: a page of closed sections loads faster."""
        if self._sections[index].objects:
            return
        section = list(INPUTS)[index]
        controls = self._follow(section_controls(self.session, section))
        self._sections[index].objects = [*self._sketch({section}), *controls]

    def _sketch(self, sections: set[str]) -> list[Any]:
        """The geometry, above inputs of the radar."""
        if "radar" not in sections:
            return []
        pane = html_pane(geometry_sketch(self.session.budget), margin=(6, 10, 0, 10))
        self._sketches.append(pane)
        return [pane]

    def _follow(self, controls: Iterable[Control]) -> list[Control]:
        """Have controls follow the design from now on."""
        made = list(controls)
        for control in made:
            control.explained = self.explained
            if isinstance(control, InputBox):
                control.param.watch(self._count_invalid, "error")
        self._controls += made
        return made

    def _begin(self, event: param.parameterized.Event) -> None:
        """Show the inputs that the first question takes, and turn to the page that answers it."""
        start = STARTS[event.new]
        if event.old != event.new:
            self._controls = [control for control in self._controls if control not in self._asking]
            self._asking = self._follow(control_of(self.session, key) for key in start.keys)
            self._asked.objects = [*self._sketch({key.partition(".")[0] for key in start.keys}), *self._asking]
            self._count_invalid()
        self._accordion.active = []
        self._lead_to(start.address)

    def _count_invalid(self, *_: Any) -> None:
        """Tell the pages how many boxes hold an invalid text."""
        self.session.invalid = sum(bool(control.error) for control in self._controls if isinstance(control, InputBox))

    @param.depends("session.adopted", watch=True)
    def _forget_invalid(self) -> None:
        """Clear invalid boxes and hide the first question after a whole design was replaced."""
        self._start.visible = self._asked.visible = False
        for control in self._controls:
            if isinstance(control, InputBox) and control.error:
                control.clear()

    @param.depends("explained", watch=True)
    def _explain(self) -> None:
        with pn.io.hold():
            for control in self._controls:
                control.explained = self.explained

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        before, self._shown = self._shown, budget.design
        for control in self._controls:
            if control.differs(before, self._shown):
                control.show(self._shown)
        for sketch in self._sketches:
            sketch.say(geometry_sketch(budget))

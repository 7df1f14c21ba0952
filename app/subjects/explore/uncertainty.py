"""Uncertainty on the Explore page: inputs as ranges, the verdict as a probability."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import held
from app.document.blocks import Answer
from app.document.pane import html_of
from app.session import Session
from app.subjects.explore.tables import uncertain_blocks
from app.ui.chart_pane import source_note
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from app.work.pool import elsewhere
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.errors import InputError
from nav_model.explore.margins import quantity
from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict
from nav_model.units import format_quantity

_INPUTS = (
    "imu.angle_random_walk",
    "imu.velocity_random_walk",
    "imu.vibration_factor",
    "imu.accelerometer_bias",
    "imu.gyro_bias",
    "gnss.position_noise",
    "gnss.interval",
    "coast.duration",
    "flight.speed",
    "radar.slant_range",
)
_ASSUMED = 1.3  # factor of one standard deviation that the button puts on the noises
_KNOWLEDGE = (
    "10 × 1024 quasi-random samples (scrambled Sobol points) through the formulas of the budget, inputs independent; "
    "95 % confidence interval from the ten, never narrower than three designs in all."
)


class UncertaintyPanel(pn.viewable.Viewer):
    """A box for each input's range, and the answer."""

    session = held(Session)
    run = held(Run)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run())
        self._boxes = {
            key: pmui.TextInput(
                label=f"{quantity(key).label}: range", placeholder="as set", width=300,
                margin=(10, 8, 0, 8),
            )
            for key in _INPUTS
        }  # fmt: skip
        for box in self._boxes.values():
            box.param.watch(lambda _: self._ask(), "value")
        self._answer = html_pane(_EMPTY, margin=(4, 14))

    def __panel__(self) -> pn.Column:
        assume = pmui.Button(
            label=f"Assume a factor of {_ASSUMED} (1σ) on every noise", variant="outlined",
            margin=(8, 8, 8, 14), on_click=lambda _: self._fill(),
        )  # fmt: skip
        clear = pmui.Button(label="Clear", variant="text", margin=(8, 8), on_click=lambda _: self._clear())
        return pn.Column(
            html_pane(_HELP, margin=(10, 14, 0, 14)),
            pn.FlexBox(*self._boxes.values(), margin=(0, 6)),
            pn.FlexBox(assume, clear),
            self._answer,
            html_pane(source_note(_KNOWLEDGE)),
            styles=FRAME,
        )

    def show(self, budget: Budget) -> None:
        """Hold the ranges against the design in force."""
        self._ask()

    def _ranges(self) -> dict[str, str]:
        return {key: box.value.strip() for key, box in self._boxes.items() if box.value.strip()}

    def _fill(self) -> None:
        design = self.session.design
        for key, box in self._boxes.items():
            if key.endswith(("random_walk", "position_noise")):
                value = design[key]
                assert isinstance(value, float)
                box.value = f"{format_quantity(value, design.unit(key), quantity(key).dimension, 4)} */ {_ASSUMED}"

    def _clear(self) -> None:
        for box in self._boxes.values():
            box.value = ""

    def _ask(self) -> None:
        """Have the newest question answered in a worker; one under way is dropped."""
        ranges = self._ranges()
        for key, box in self._boxes.items():
            problem = _problem(key, ranges[key]) if key in ranges else ""
            if box.helper_text != problem:
                box.param.update(helper_text=problem, error_state=bool(problem))
        if not ranges:
            self.run.cancel()
            self._answer.object = _EMPTY
        elif not any(box.error_state for box in self._boxes.values()):
            design, inputs = self.session.design, {key: read_uncertain(key, text) for key, text in ranges.items()}
            pn.state.execute(lambda: self.run.start(lambda _: elsewhere(uncertain_verdict, design, inputs)))

    @param.depends("run.running", watch=True)
    def _tell(self) -> None:
        if not self._ranges() or self.run.running:
            return
        if self.run.message:
            self._answer.object = html_of(Answer("No probability", "warn", (self.run.message,)))
        elif self.run.result is not None:
            self._answer.object = html_of(*uncertain_blocks(self.run.result))


_EMPTY = "<p>No input has a range: the verdict above is for the values as set.</p>"
_HELP = (
    "<h3>How sure is the verdict</h3><p>How to write what a data sheet says. <b>Typical</b> is a middle value, half "
    "the units are worse: <b>TYPICAL */ FACTOR</b> (lognormal about it, one standard deviation a factor). "
    "<b>Maximum</b> is a bound no unit shipped exceeds: <b>LOWEST .. MAXIMUM</b> (uniform; <b>log</b> after it "
    "spreads evenly over the decades), with the best unit you expect as the lowest. Inputs left empty keep their "
    "value.</p>"
)


def _problem(key: str, text: str) -> str:
    try:
        read_uncertain(key, text)
    except InputError as error:
        return error.reason
    return ""

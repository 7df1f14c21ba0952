"""Uncertainty on the Explore page: inputs as ranges, the verdict as a probability."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

import panel as pn
import panel_material_ui as pmui

from app.document.prose import prose
from app.session import Session
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.design.file import format_design, parse_design
from nav_model.errors import InputError
from nav_model.explore.margins import label_of, quantity
from nav_model.explore.uncertainty import Probability, UncertainVerdict, read_uncertain, uncertain_verdict
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
    "Ten independent scramblings of 1024 Sobol points through the closed forms of the budget, inputs independent; "
    "the interval (95 %) is Student's over the ten, and never narrower than three designs in all."
)


def verdict_of_text(design: str, ranges: Mapping[str, str]) -> UncertainVerdict:
    """The uncertain verdict of a design as TOML: what a worker process runs.

    Raises
    ------
    InputError
        As `uncertain_verdict`.
    """
    return uncertain_verdict(parse_design(design), {key: read_uncertain(key, text) for key, text in ranges.items()})


class UncertaintyPanel:
    """A box for each input's range, and the answer."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._busy = False
        self._again = False
        self._boxes = {
            key: pmui.TextInput(
                label=f"{quantity(key).label}: range", description="", placeholder="as set", size="small", width=300,
                margin=(10, 8, 0, 8),
            )
            for key in _INPUTS
        }  # fmt: skip
        for box in self._boxes.values():
            box.param.watch(lambda _: self._ask(), "value")
        assume = pmui.Button(
            label=f"Assume a factor of {_ASSUMED} (1σ) on every noise", size="small", variant="outlined",
            margin=(8, 8, 8, 14),
        )  # fmt: skip
        clear = pmui.Button(label="Clear", size="small", variant="text", margin=(8, 8))
        assume.on_click(lambda _: self._fill())
        clear.on_click(lambda _: self._clear())
        self._answer = html_pane(_EMPTY, margin=(4, 14))
        self.view = pn.Column(
            html_pane("<h3>How sure is the verdict</h3>", margin=(10, 14, 0, 14)),
            html_pane(
                "<p>What a data sheet says, and how to write it: <b>typical</b> is a middle value, half the units "
                "are worse: <b>TYPICAL */ FACTOR</b> (lognormal about it, one standard deviation a factor). "
                "<b>Maximum</b> is a bound no unit shipped exceeds: <b>LOWEST .. MAXIMUM</b> (uniform; "
                "<b>log</b> behind it spreads evenly over the decades), with the best unit you expect as the lowest. "
                "Inputs left empty stay as set.</p>",
                margin=(0, 14),
            ),
            pn.FlexBox(*self._boxes.values(), sizing_mode="stretch_width", margin=(0, 6)),
            pn.FlexBox(assume, clear, sizing_mode="stretch_width"),
            self._answer,
            html_pane(f'<p class="know quiet"><b>How do we know:</b> {prose(_KNOWLEDGE)}</p>'),
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )

    def show(self, budget: Budget) -> None:
        """Hold the ranges against the design in force."""
        self._ask()

    def _ranges(self) -> dict[str, str]:
        return {key: box.value.strip() for key, box in self._boxes.items() if box.value.strip()}

    def _fill(self) -> None:
        design = self._session.design
        for key, box in self._boxes.items():
            if key.endswith(("random_walk", "position_noise")):
                unit = design.unit(key)
                number = format_quantity(float(design[key]), unit, quantity(key).dimension, 4)  # type: ignore[arg-type]
                box.value = f"{number} */ {_ASSUMED}"

    def _clear(self) -> None:
        for box in self._boxes.values():
            box.value = ""

    def _ask(self) -> None:
        for key, box in self._boxes.items():
            problem = _problem(key, box.value.strip())
            if box.helper_text != problem:
                box.param.update(helper_text=problem, error_state=bool(problem))
        if not self._ranges():
            self._answer.object = _EMPTY
        elif self._busy:
            self._again = True
        elif not any(box.error_state for box in self._boxes.values()):
            pn.state.execute(self._run)

    async def _run(self) -> None:
        """The newest question in a worker; one asked meanwhile is answered next, those between not at all."""
        self._busy = True
        try:
            while True:
                self._again = False
                try:
                    found = await elsewhere(verdict_of_text, format_design(self._session.design), self._ranges())
                    self._answer.object = _said(found)
                except InputError as error:
                    self._answer.object = f'<p role="status">{escape(str(error))}</p>'
                if not self._again or not self._ranges():
                    return
        finally:
            self._busy = False


_EMPTY = "<p>No input has a range: the verdict above is for the values as set.</p>"


def _problem(key: str, text: str) -> str:
    if not text:
        return ""
    try:
        read_uncertain(key, text)
    except InputError as error:
        return error.reason
    return ""


def _percent(p: Probability) -> str:
    half = 100 * (p.high - p.low) / 2
    return f"{100 * p.value:.1f} % <span class='quiet'>± {half:.2g}</span>"


def _said(found: UncertainVerdict) -> str:
    low, middle, high = (f"{100 * m:+.0f} %".replace("-", "−") for m in found.margin)
    rows = "".join(
        f"<tr><th scope='row'>{escape(label_of(name))}</th><td class='num'>{_percent(p)}</td>"
        f"<td class='num'>{100 * found.limiting[name]:.0f} %</td></tr>"
        for name, p in found.each.items()
    )
    return (
        f'<div class="strip open" role="status"><h2>Closes with {_percent(found.closes)}</h2>'
        f"<p>Tightest margin: {low} / {middle} / {high} (5, 50, 95 % of {found.designs} designs)</p></div>"
        '<div class="scroll"><table class="checks"><thead><tr><th scope="col">Requirement</th>'
        '<th scope="col" class="num">Met with</th><th scope="col" class="num">Tightest in</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )

"""Uncertainty of the verdict: inputs as ranges, the verdict as a probability."""

from collections.abc import Callable
from dataclasses import replace
from urllib.parse import parse_qsl, urlencode

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import held
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.wording import box_text
from app.session import Session
from app.subjects.explore.charts import margin_chart
from app.subjects.explore.question import NO_LIMIT, Question
from app.subjects.explore.tables import uncertain_answer, uncertain_table
from app.ui.chart_pane import ChartPane, source_note
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.study_settings import StudySettings
from app.ui.theme import NARROW
from app.ui.view import View
from app.work.pool import elsewhere
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.several import with_unit
from nav_model.explore.margins import quantity
from nav_model.explore.uncertainty import UncertainVerdict, read_uncertain, uncertain_verdict

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
_AS_SET, _TYPICAL, _UNIFORM, _LOG = "Fixed", "Typical ×/÷", "Uniform", "Log-uniform"
_LABELS = {_TYPICAL: ("typical", "factor (1σ)"), _UNIFORM: ("lowest", "highest"), _LOG: ("lowest", "highest")}
_EXAMPLE = f"An example: every noise typical ×/÷ {_ASSUMED}. Choose a distribution for any input."
_COMPUTING = Answer("Probability", "open", ("Computing …",))
_KNOWLEDGE = (
    "10 × 1024 quasi-random samples (scrambled Sobol points) through the formulas of the budget, inputs independent; "
    "95 % confidence interval from the ten, never narrower than three designs in all."
)
_HELP = (
    "<p class='quiet fine'><b>Typical ×/÷</b>: a typical data-sheet value; half of the units are worse (log-normal, "
    "the factor is one standard deviation). <b>Uniform</b> and <b>Log-uniform</b>: between the best unit you expect "
    "and the data sheet's maximum.</p>"
)


class RangeRow(View):
    """One input: its distribution, and the two values that this takes."""

    text = param.String(doc="The range as `read_uncertain` takes it; empty: the input is as set.")
    problem = param.String(doc="Why the range cannot be used; empty: it can.")

    def __init__(self, key: str, design: Callable[[], Design]) -> None:
        super().__init__()
        self.key, self._design = key, design
        self._values: tuple[str, ...] = ()
        self.kind = pmui.Select(options=[_AS_SET, *_LABELS], width=230, margin=(9, 4, 0, 8), size="small")
        self.name_value()
        self.kind.param.watch(lambda _: self._choose(), "value")
        self.boxes: list[pmui.TextInput] = []
        self._view = pn.FlexBox(self.kind)

    def name_value(self) -> None:
        """Say the design's value beside the name."""
        self.kind.label = f"{quantity(self.key).label}: {_as_text(self._design(), self.key)}"

    def take(self, text: str) -> None:
        """The range of a link, as `text` has it."""
        body, log, _ = text.partition(" log")
        kind, mark = (_TYPICAL, "*/") if "*/" in text else (_LOG if log else _UNIFORM, "..")
        self.set(kind, *(part.strip() for part in body.split(mark, 1)))

    def set(self, kind: str, *values: str) -> None:
        """Choose a distribution and its values."""
        self._values = values
        self.kind.value = kind
        for box, value in zip(self.boxes, values, strict=False):
            box.value = value

    def _choose(self) -> None:
        kind = self.kind.value
        if kind != _AS_SET and not self.boxes:
            values = self._values or (_as_text(self._design(), self.key), "")  # before a browser has the boxes
            self.boxes = [  # labelled from the start: a label given later is not tied to its box
                pmui.TextInput(label=label, value=text, width=130, margin=(9, 4, 0, 4), size="small")
                for label, text in zip(_LABELS[kind], values, strict=True)
            ]
            for box in self.boxes:
                box.param.watch(lambda _: self._read(), "value")
            self._view.extend(self.boxes)
        for box, label in zip(self.boxes, _LABELS.get(kind, ("", "")), strict=False):
            box.param.update(label=label, visible=kind != _AS_SET)
        if kind != _AS_SET and not self.boxes[0].value:
            self.boxes[0].value = _as_text(self._design(), self.key)
        self._read()

    def _read(self) -> None:
        kind, (first, second) = self.kind.value, [box.value.strip() for box in self.boxes] or ("", "")
        if kind == _AS_SET or not second:
            self._say("")
            self.text = ""
            return
        low, high = (with_unit(text, self._design().unit(self.key)) for text in (first, second))
        text = f"{low} */ {second}" if kind == _TYPICAL else f"{low} .. {high}{' log' if kind == _LOG else ''}"
        try:
            read_uncertain(self.key, text)
        except InputError as error:
            self._say(error.reason)
            return
        self._say("")
        self.text = text

    def _say(self, problem: str) -> None:
        self.problem = problem
        if self.boxes:
            self.boxes[1].param.update(helper_text=problem, error_state=bool(problem))


def _as_text(design: Design, key: str) -> str:
    value = design[key]
    assert isinstance(value, float | int)
    return box_text(design, key, float(value))


class UncertaintyPanel(Question):
    """A row for each input, and what each requirement is met with."""

    run = held(Run)
    ranges = param.String(doc="The ranges as a query of keys and texts.")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run())
        self.rows = [RangeRow(key, lambda: session.design) for key in _INPUTS]
        self._settings = StudySettings(session, "uncertainty", self, ("ranges",), self._recall)
        self._recall()
        for row in self.rows:
            row.param.watch(lambda *_: self._ask(), ["text", "problem"])
        self._table = html_pane("", margin=(4, 14))
        self._chart = ChartPane[UncertainVerdict | None](margin_chart, lambda: self.run.result)

    def __panel__(self) -> pn.Column:
        assume = pmui.Button(
            label=f"Assume ×/÷ {_ASSUMED} (1σ) on every noise", variant="outlined", margin=(8, 8),
            on_click=lambda _: self.assume(),
        )  # fmt: skip
        clear = pmui.Button(label="Clear", variant="text", margin=(8, 8), on_click=lambda _: self._clear())
        scrolls = {"sizing_mode": "stretch_both", "styles": {"overflow": "auto"}, "stylesheets": [NARROW]}
        return first_screen(
            left=[pn.Column(pn.FlexBox(assume, clear), *self.rows, **scrolls)],
            right=[
                self._chart.view,
                pn.Column(self._table, html_pane(_HELP + source_note(_KNOWLEDGE), margin=(4, 14)), **scrolls),
            ],
            height="100%",
        )  # fmt: skip

    def show(self, budget: Budget) -> None:
        """Ask again for the current design."""
        for row in self.rows:
            row.name_value()
        self._ask()

    def _recall(self) -> None:
        """Take the ranges of a link."""
        texts = dict(parse_qsl(self.ranges))
        for row in self.rows:
            if row.key in texts:
                row.take(texts[row.key])
            else:
                row.set(_AS_SET)

    def _assumed(self) -> dict[str, str]:
        """Every noise as typical, with the usual factor."""
        keys = (row.key for row in self.rows if row.key.endswith(("random_walk", "position_noise")))
        return {key: f"{_as_text(self.session.design, key)} */ {_ASSUMED}" for key in keys}

    def assume(self) -> None:
        """Take every noise as typical, with the usual factor."""
        for row in self.rows:
            if text := self._assumed().get(row.key):
                row.take(text)

    def _clear(self) -> None:
        for row in self.rows:
            row.set(_AS_SET)

    def _ask(self) -> None:
        """Have the newest question answered in a worker; one under way is dropped. Without a range an example is."""
        texts = {row.key: row.text for row in self.rows if row.text}
        self.ranges = urlencode(texts)
        if not self.session.budget.verdict.checks:
            self.run.cancel()
            self._table.object, self.answer = "", NO_LIMIT
        elif not any(row.problem for row in self.rows):
            self._table.object, self.answer = "", _COMPUTING
            inputs = {key: read_uncertain(key, text) for key, text in (texts or self._assumed()).items()}
            design = self.session.design
            pn.state.execute(lambda: self.run.start(lambda _: elsewhere(uncertain_verdict, design, inputs)))

    @param.depends("run.running", watch=True)
    def _tell(self) -> None:
        if self.run.running or not self.session.budget.verdict.checks:
            return
        if self.run.message:
            self.answer = Answer("No probability", "warn", (self.run.message,))
        elif self.run.result is not None:
            said = uncertain_answer(self.run.result)
            self.answer = said if self.ranges else replace(said, sentences=(_EXAMPLE, *said.sentences))
            with pn.io.hold():
                self._table.object = html_of(uncertain_table(self.run.result))
                self._chart.show(self.run.result)

"""Uncertainty of the verdict: inputs as ranges, the verdict as a probability."""

from collections.abc import Mapping
from dataclasses import replace
from urllib.parse import parse_qsl, urlencode

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.declared import required
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.wording import box_text
from app.session import Session
from app.subjects.explore.charts import margin_chart
from app.subjects.explore.question import Question, unlimited
from app.subjects.explore.tables import uncertain_answer, uncertain_table
from app.ui.chart_pane import source_note
from app.ui.first_screen import first_screen
from app.ui.follower import Follower
from app.ui.html_pane import html_pane
from app.ui.row_editor import Field, RowEditor, Rows
from app.ui.study_settings import StudySettings
from app.ui.theme import NARROW
from app.work.pool import run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.design.several import with_unit
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
_TYPICAL, _UNIFORM, _LOG = "typical", "uniform", "log-uniform"
_FIELDS = (
    Field("input", "Input", read=True),
    Field("kind", "Distribution", choices=(
        ("", "Fixed"), (_TYPICAL, "Typical ×/÷"), (_UNIFORM, "Uniform"), (_LOG, "Log-uniform"),
    )),
    Field("first", "Typical, or lowest"),
    Field("second", "Factor (1σ), or highest"),
)  # fmt: skip
_EXAMPLE = f"An example: every noise typical ×/÷ {_ASSUMED}. Choose a distribution for any input."
_COMPUTING = Answer("Probability", "open", ("Computing …",))
_KNOWLEDGE = (
    "10 × 1024 quasi-random samples (scrambled Sobol points) through the formulas of the budget, inputs independent; "
    "95 % confidence interval from the ten, at least ± 3 of the 10240 designs (rule of three)."
)
_HELP = (
    "<p class='quiet fine'><b>Typical ×/÷</b>: a typical data-sheet value; half of the units are worse (log-normal, "
    "the factor is one standard deviation). <b>Uniform</b> and <b>Log-uniform</b>: between the best unit you expect "
    "and the data sheet's maximum.</p>"
)


def range_of(row: Mapping[str, str], unit: str) -> str:
    """Text of a row, as `read_uncertain` takes it; empty while it lacks a value, and for an input that is fixed."""
    kind, first, second = (row.get(name, "").strip() for name in ("kind", "first", "second"))
    if not (kind and second):
        return ""
    if kind == _TYPICAL:
        return f"{with_unit(first, unit)} */ {second}"
    return f"{with_unit(first, unit)} .. {with_unit(second, unit)}{' log' if kind == _LOG else ''}"


def row_of(text: str) -> dict[str, str]:
    """The row that says a range."""
    body, log, _ = text.partition(" log")
    kind, mark = (_TYPICAL, "*/") if "*/" in text else (_LOG if log else _UNIFORM, "..")
    first, _, second = body.partition(mark)
    return {"kind": kind, "first": first.strip(), "second": second.strip()}


def _as_text(design: Design, key: str) -> str:
    value = design[key]
    assert isinstance(value, float | int)
    return box_text(design, key, float(value))


class UncertaintyPanel(Question):
    """A row for each input, and what each requirement is met with."""

    run = required(Run)
    ranges = param.String(doc="The ranges as a query of keys and texts.")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run())
        self.rows = RowEditor(_FIELDS, self._take, caption="Ranges")
        self._settings = StudySettings(session, "uncertainty", self, ("ranges",), lambda: self._set(self._texts()))
        self._recall()
        self._verdict = Follower[UncertainVerdict](lambda: self.run.result)
        self._table = self._verdict.text(lambda verdict: html_of(uncertain_table(session.design, verdict)), (4, 14))

    def __panel__(self) -> pn.Column:
        example = pmui.Button(
            label=f"Every noise typical ×/÷ {_ASSUMED} (1σ)", variant="outlined", margin=(8, 8),
            on_click=lambda _: self._set({}),
        )  # fmt: skip
        fills = {"sizing_mode": "stretch_both", "stylesheets": [NARROW]}
        scrolls = {**fills, "styles": {"overflow": "auto"}}
        return first_screen(
            left=[pn.Column(pn.FlexBox(example), self.rows, **scrolls)],
            right=[
                self._verdict.later(lambda: self._verdict.chart(self._histogram), **fills),
                pn.Column(self._table, html_pane(_HELP + source_note(_KNOWLEDGE), margin=(4, 14)), **scrolls),
            ],
            height="100%",
        )  # fmt: skip

    def _histogram(self, verdict: UncertainVerdict) -> Chart:
        return margin_chart(self.session.design, verdict)

    def show(self, budget: Budget) -> None:
        """Ask again for the current design, whose values the example follows."""
        if self.ranges or self.rows.refused:
            self._name(self.rows.rows)
        else:
            self._recall()
        self._ask()

    def _name(self, rows: Rows) -> None:
        """Show rows, each input with its value in the design."""
        design = self.session.design
        self.rows.rows = [
            {**row, "input": f"{quantity(key).label}: {_as_text(design, key)}"}
            for key, row in zip(_INPUTS, rows, strict=True)
        ]

    def _texts(self) -> dict[str, str]:
        return dict(parse_qsl(self.ranges))

    def _recall(self) -> None:
        """Show the ranges in force: without any, those of the example."""
        texts = self._texts() or self._assumed()
        self._name([row_of(texts[key]) if key in texts else {} for key in _INPUTS])
        self.rows.refused = ""

    def _set(self, texts: Mapping[str, str]) -> None:
        """Put ranges in force, and those alone."""
        self.ranges = urlencode(texts)
        self._recall()
        self._ask()

    def _take(self, rows: Rows) -> InputError | None:
        """Take what the rows say; a distribution just chosen begins with the design's value."""
        design, texts = self.session.design, {}
        for key, row in zip(_INPUTS, rows, strict=True):
            if row.get("kind"):
                row.setdefault("first", _as_text(design, key))
            if text := range_of(row, design.unit(key)):
                texts[key] = text
        self._name(rows)
        try:
            for key, text in texts.items():
                read_uncertain(key, text)
        except InputError as refused:
            return refused.under(str(quantity(key).label))
        self.ranges = urlencode(texts)
        self._ask()
        return None

    def _assumed(self) -> dict[str, str]:
        """Every noise as typical, with the usual factor."""
        keys = (key for key in _INPUTS if key.endswith(("random_walk", "position_noise")))
        return {key: f"{_as_text(self.session.design, key)} */ {_ASSUMED}" for key in keys}

    def _ask(self) -> None:
        """Have the newest question answered in a worker; one under way is dropped. Without a range an example is."""
        self._table.object = ""
        if not self.session.budget.straight_leg().checks:
            self.run.cancel()
            self.answer = unlimited(self.session.budget)
            return
        design, texts = self.session.design, self._texts() or self._assumed()
        try:
            inputs = {key: read_uncertain(key, text) for key, text in texts.items()}
        except InputError as refused:  # of a link
            self.answer = Answer("No probability", "warn", (str(refused),))
            return
        self.answer = _COMPUTING
        pn.state.execute(lambda: self.run.start(lambda _: run_in_pool(uncertain_verdict, design, inputs)))

    @param.depends("run.running", watch=True)
    def _tell(self) -> None:
        if self.run.running or not self.session.budget.straight_leg().checks:
            return
        if self.run.message:
            self.answer = Answer("No probability", "warn", (self.run.message,))
        elif self.run.result is not None:
            answer = uncertain_answer(self.run.result)
            self.answer = answer if self.ranges else replace(answer, sentences=(_EXAMPLE, *answer.sentences))
            with pn.io.hold():
                self._verdict.follow()

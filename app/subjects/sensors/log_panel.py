"""A log on the Sensors page: uploaded, analysed in a worker, shown, and offered to the design."""

import html
from collections.abc import Callable, Iterator
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import required
from app.document.blocks import Text
from app.document.pane import html_of
from app.report.supplier import acceptance_blocks
from app.session import Session
from app.subjects.sensors.charts import axis_chart, triad_chart
from app.subjects.sensors.log_study import Study, read_bandwidth, read_options, study_log
from app.subjects.sensors.tables import (
    coefficient_tables,
    motion_answer,
    motion_table,
    offer,
    reading_text,
    remedies,
    warnings,
)
from app.ui.faults import clear_message
from app.ui.fields import TextInput
from app.ui.follower import Follower
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.theme import FULL_HEIGHT
from app.ui.upload import UploadedFile, upload
from app.ui.view import View
from app.work.cancellable import run_alone
from app.work.run import Run
from nav_model.allan.adoption import (
    Adoption,
    adopt_noise,
    adopt_vibration_factor,
    adopt_vibration_spectrum,
    bench_of,
)
from nav_model.allan.log_content import Limits, LogOptions
from nav_model.allan.log_names import units_of
from nav_model.allan.motion import MotionAnalysis, over_bench
from nav_model.allan.result import LogAnalysis, axis_label
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.explore.supplier import frozen, judge_log
from nav_model.explore.supplier import required as required_values

UPLOAD_LIMITS = Limits(file_bytes=150_000_000, unpacked_bytes=500_000_000, rows=5_000_000)
_TITLE = "<h3>Analyse a log</h3>"
_HELP = (
    "<p>A log taken <b>at rest</b>, an hour or more on a solid base, gives quantization, random walk, bias "
    "instability, rate random walk and ramp for every axis. A log taken <b>in motion</b> gives the vibration "
    "factor relative to the design's random walks, and the vibration spectrum. CSV or NPZ, at most "
    f"{UPLOAD_LIMITS.file_bytes / 1e6:.0f} MB and {UPLOAD_LIMITS.rows / 1e6:.0f} million rows; rate, units and "
    "columns are read from the file if it states them. Otherwise, enter them below.</p>"
)
_BOXES = {
    "rate": ("Rate [Hz]", "only if not in the file", 150),
    "gyro_unit": ("Gyro unit", "only if not in the file", 170),
    "accelerometer_unit": ("Accelerometer unit", "only if not in the file", 170),
    "columns": ("Columns of a CSV, in order", "time, gyro_x, …; use - to skip one", 240),
    "arrays": ("Arrays of an NPZ", "gyro=w, accelerometer=f", 220),
    "sensor": ("Sensor", "one of several in the file", 185),
    "bandwidth": ("Bandwidth [Hz]", "of its low pass; empty: the design's", 240),
}

_OF = {"gyro_unit": "gyro", "accelerometer_unit": "accelerometer"}

# What was pressed may be far below: its answer stays at the top of the view.
_IN_SIGHT = {"position": "sticky", "top": "4px", "z-index": "5", "background": "var(--panel-surface-color, Canvas)"}


class LogPanel(pn.viewable.Viewer):
    """Upload, progress, results and offers of the logs of one session.

    The last log at rest and the last in motion both stay in view; a log that is refused changes neither.
    """

    session = required(Session)
    run = required(Run)
    name_of_log = param.String(doc="The file uploaded last, which can be analysed again; empty: none.")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run())
        self._log = UploadedFile()
        self._path: Path | None = None
        self.boxes = {key: _unit_box(key) if key in _OF else TextInput(**_look(*_BOXES[key])) for key in _BOXES}
        # There once a file has several.
        self.boxes["sensor"] = pmui.Select(options=[""], value="", visible=False, **_look(*_BOXES["sensor"]))
        self.counts = {
            key: TextInput(**_look(f"{of.capitalize()} count", "its size, if in counts", 185))
            for key, of in _OF.items()
        }
        for key, box in self.boxes.items():
            box.param.watch(lambda _, key=key: self._mark(key), "value")
        self.motion = pmui.Select(
            label="The log was taken", width=250, margin=(8, 6),
            options={"at rest: noise parameters": "rest", "in motion: vibration factor": "motion"}, value="rest",
        )  # fmt: skip
        self.file = upload(
            "Choose a log", ".csv,.txt,.tsv,.dat,.log,.npz", UPLOAD_LIMITS.file_bytes, self.take,
            lambda reason: self._say(f"Not uploaded: {reason}."), uploaded_label="Choose another log",
            icon=None, variant="contained", margin=(8, 6), disabled=self.run.param.running,
        )  # fmt: skip
        self.message = pmui.Alert(object="", visible=False, closeable=True, margin=(4, 14, 12, 14), styles=_IN_SIGHT)
        self.bar = RunBar(self.run, self.analyse, "Analyse", self.file, self.motion, *self._fields(), align="start")
        self.bar.start.disabled = True
        self._heading = html_pane(_TITLE + _HELP, margin=(10, 14, 0, 14))
        self.static = StaticResult(session, self._adopt)
        self.moving = MotionResult(session, self._adopt)
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self.close())

    def _fields(self) -> Iterator[Any]:
        for key, box in self.boxes.items():
            yield box
            if key in self.counts:
                yield self.counts[key]

    def __panel__(self) -> pn.Column:
        return pn.Column(paper(self._heading, self.bar), self.message, self.static, self.moving, styles=FULL_HEIGHT)

    # --- taking a log in ----------------------------------------------------------------------------------

    async def take(self, name: str, content: bytes) -> None:
        """Keep an uploaded log for as long as the session lasts, and analyse it."""
        try:
            self._path = await self._log.put(content)
        except InputError as error:
            self._say(f"Not uploaded: {error.reason}.")
            return
        self.name_of_log = name
        self.boxes["sensor"].param.update(options=[""], value="", visible=False)
        await self.analyse()

    @param.depends("name_of_log", "run.running", watch=True)
    def _offer(self) -> None:
        self.bar.start.disabled = self.run.running or not self.name_of_log

    async def analyse(self) -> None:
        """Analyse the log that was uploaded last, with the current fields."""
        if self.run.running or not self.name_of_log:
            return
        name = self.name_of_log
        try:
            options = self._options()
            bandwidth_hz = read_bandwidth(self.boxes["bandwidth"].value, self.session.design)
        except InputError as error:
            self._refuse(error)
            self.run.message = ""  # why the log was refused before
            self._say(f"Not analysed. {error.reason}")
            return
        bench = bench_of(self.session.design) if self.motion.value == "motion" else None

        async def study(run: Run) -> Study:
            try:
                return await run_alone(
                    study_log, self._path, options, name, UPLOAD_LIMITS, bench, bandwidth_hz,
                    progress=lambda share, what: run.tell(f"{name}: {what}", share),
                )  # fmt: skip
            except InputError as error:
                if not self._refuse(error):
                    raise
                raise ValueError(error.reason) from error

        for key in self.boxes:
            self._mark(key)
        self._say("")
        await self.run.start(study)
        if not self.run.message:
            clear_message()
            self._show(self.run.result)

    def _refuse(self, error: InputError) -> bool:
        """Mark the boxes to blame, if any; the mark goes when the box is filled in, or with the next try."""
        keys = error.key.split(", ")
        blamed = [key for key in keys if key in self.boxes]
        if "sensor" in blamed and isinstance(error.value, tuple):
            self.boxes["sensor"].param.update(options=["", *error.value], visible=True)
        for key in blamed:
            self._mark(key, error.reason if len(keys) == 1 else "Required: the file does not give it")
        return bool(blamed)

    def _mark(self, key: str, wrong: str = "") -> None:
        self.boxes[key].param.update(error_state=bool(wrong), helper_text=wrong or _BOXES[key][1])

    def _options(self) -> LogOptions:
        texts = {key: box.value.strip() for key, box in self.boxes.items()}
        for key, box in self.counts.items():
            if count := box.value.strip():
                if not texts[key]:
                    raise InputError(key, "choose the unit of the count")
                texts[key] = f"{count} {texts[key]} per count"
        rate = None
        if texts["rate"]:
            try:
                rate = float(texts["rate"].lower().removesuffix("hz"))
            except ValueError as error:
                raise InputError("rate", f"{texts['rate']!r} is not a rate. Enter for example 100 Hz.") from error
        return read_options(rate, *(texts[key] for key in _BOXES if key not in ("rate", "bandwidth")))

    def close(self) -> None:
        """End all work and delete the log when the user has left."""
        self.run.cancel()
        self._log.delete()
        self.name_of_log = ""

    def _say(self, text: str, severity: str = "error") -> None:
        self.message.param.update(object=html.escape(text), severity=severity, visible=bool(text), closed=False)

    # --- what it says, and what of it goes into the design ------------------------------------------------

    def _show(self, study: Study) -> None:
        self._heading.object = _TITLE  # the plots matter more now
        if isinstance(study, MotionAnalysis):
            self.moving.show(study)
        else:
            self.static.show(study)

    def _adopt(self, offer: Callable[[], Adoption]) -> None:
        try:
            adoption = offer()
            # So that a log does not move what it is judged by.
            entries = frozen(self.session.design, date.today().isoformat())
            problem = self.session.change(adoption.changes, adoption.written, adoption.origins, entries)
        except InputError as error:
            problem = error
        self._say(f"Not used. {problem}" if problem else "")  # the strip has the new values and their source


class StaticResult(View):
    """Result of a log at rest."""

    def __init__(self, session: Session, adopt: Callable[[Callable[[], Adoption]], None]) -> None:
        super().__init__()
        self._session = session
        self.analysis: LogAnalysis | None = None
        self._parts = parts = Follower(lambda: self.analysis)
        self.head = parts.text(_static_head, (10, 14, 0, 14))
        self.tables = parts.text(_static_tables, (0, 14, 10, 14))
        self.accepted = parts.text(lambda analysis: _accepted(session.design, analysis), (0, 14, 10, 14))
        self.use = _button("Use these in the design")
        self.use.on_click(lambda _: adopt(lambda: adopt_noise(parts.known())))
        self.axis = pmui.Select(label="Axis", width=220, margin=(8, 14), options=[])
        self.axis.param.watch(lambda event: parts.follow() if event.new else None, "value")
        charts = parts.later(self._charts)
        accepted = paper(self.accepted)
        self._view = pn.Column(paper(self.head, self.use), charts, accepted, paper(self.tables), visible=False)

    def show(self, analysis: LogAnalysis) -> None:
        """Show another log's analysis."""
        self.analysis = analysis
        names = {axis_label(axis.name): axis.name for axis in analysis.axes}
        with pn.io.hold():
            self.use.disabled = not adopt_noise(analysis).changes
            chosen_axis = self.axis.value if self.axis.value in names.values() else next(iter(names.values()))
            self.axis.param.update(options=names, value=chosen_axis)
            self._parts.follow()
            self._view.visible = True

    def follow(self) -> None:
        """Judge the log again by what the design now requires."""
        if self.analysis is not None:
            self.accepted.object = _accepted(self._session.design, self.analysis)

    def _charts(self) -> pn.Column:
        chart = self._parts.chart
        triads = [chart(partial(triad_chart, quantity=quantity), 320) for quantity in ("gyro", "accelerometer")]
        single = chart(lambda analysis: axis_chart(analysis, self.axis.value), 380)
        return grid(*(cell(6, triad) for triad in triads), cell(12, self.axis, single))


def _static_head(analysis: LogAnalysis) -> str:
    return "<h3>Log at rest</h3>" + html_of(reading_text(analysis.provenance), offer(analysis))


def _accepted(design: Design, analysis: LogAnalysis) -> str:
    """The log against what the design requires of its inertial unit, or why that cannot be said."""
    try:
        rows = judge_log(required_values(design, "imu"), analysis)
        return html_of(*acceptance_blocks(design, rows, analysis.provenance.reading))
    except InputError as error:
        return f'<p class="quiet">Not judged by the supplier\'s sheet. {html.escape(str(error))}</p>'


def _static_tables(analysis: LogAnalysis) -> str:
    digest = Text(f"SHA-256 {analysis.provenance.sha256}.")
    return html_of(*coefficient_tables(analysis), *remedies(analysis), *warnings(analysis), digest)


class MotionResult(View):
    """Result of a log in motion."""

    def __init__(self, session: Session, adopt: Callable[[Callable[[], Adoption]], None]) -> None:
        super().__init__()
        self._session = session
        self.analysis: MotionAnalysis | None = None
        self._parts = parts = Follower(lambda: self.analysis)
        self.head = parts.text(_motion_head, (10, 14, 0, 14))
        self.table = parts.text(_motion_table, (0, 14, 10, 14))
        self.use = _button("Use this factor in the design")
        self.use.on_click(lambda _: adopt(lambda: adopt_vibration_factor(session.design, parts.known())))
        self.spectrum = _button("Use its vibration spectrum")
        self.spectrum.on_click(lambda _: adopt(lambda: adopt_vibration_spectrum(parts.known())))
        self._view = paper(self.head, pn.Row(self.use, self.spectrum), self.table, visible=False)

    def show(self, analysis: MotionAnalysis) -> None:
        """Show another log's analysis."""
        self.analysis = analysis
        self.follow()

    def follow(self) -> None:
        """Compare the log, if there is one, with the random walks of the current design."""
        if self.analysis is None:
            return
        self.analysis = analysis = over_bench(self.analysis, bench_of(self._session.design))
        with pn.io.hold():
            self._parts.follow()
            self.use.disabled = analysis.vibration_factor is None
            self.spectrum.disabled = not analysis.spectrum
            self._view.visible = True


def _motion_head(analysis: MotionAnalysis) -> str:
    return "<h3>Log in motion</h3>" + html_of(reading_text(analysis.provenance), motion_answer(analysis))


def _motion_table(analysis: MotionAnalysis) -> str:
    return html_of(motion_table(analysis), Text(f"SHA-256 {analysis.provenance.sha256}."))


def _look(label: str, helper_text: str, width: int) -> dict[str, Any]:
    return {"label": label, "helper_text": helper_text, "width": width, "margin": (8, 6)}


def _unit_box(key: str) -> pmui.Select:
    """A choice of units; those of increments say so."""
    units = {f"{unit} per sample" if summed else unit: unit for unit, summed in units_of(_OF[key]).items()}
    return pmui.Select(options={"as in the file": ""} | units, value="", **_look(*_BOXES[key]))


def _button(label: str) -> pmui.Button:
    return pmui.Button(label=label, variant="contained", margin=(12, 14, 8, 14))


def paper(*content: Any, **params: Any) -> pmui.Paper:
    """A sheet with a border, as wide as its place."""
    return pmui.Paper(
        *content, variant="outlined", elevation=0, sizing_mode="stretch_width", margin=(6, 10), **params
    )

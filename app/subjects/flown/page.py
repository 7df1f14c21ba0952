"""The page As flown: the solution of a real flight against the budget of the design."""

import asyncio
import importlib
import json
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.legend import key_html
from app.charts.screen.timelines import Timelines
from app.declared import chosen
from app.document.blocks import Answer
from app.document.flown import answer, sentence
from app.document.pane import html_of
from app.library.flights import keep_flight
from app.library.place import library
from app.session import Session
from app.subjects.flown.charts import IN_APERTURES, map_chart, receiver_chart, timelines
from app.subjects.flown.run import FlownFlight, hold
from app.subjects.flown.tables import (
    as_csv,
    flight_blocks,
    jump_block,
    main_figure,
    noise_blocks,
    place_blocks,
    receiver_block,
)
from app.ui.author import author_field
from app.ui.chart_pane import described, head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.remembered import login
from app.ui.run_bar import RunBar
from app.ui.study_page import StudyPage
from app.ui.theme import NARROW, PRINT_NOTHING, STACK_ON_A_PHONE
from app.ui.upload import UploadedFile, upload
from app.work.cancellable import run_alone
from app.work.flight import File
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.design.figures import FIGURES

_UPLOAD = 150_000_000  # bytes
_KINDS = ".csv,.txt,.tsv,.dat,.log,.out,.pos,.sbet,.smrmsg,.ulg,.asc,.gps,.nmea"
_RELATIONS = {
    "As the files tell": "",
    "Smoothed, same data": "smoothed",
    "Reverse pass": "reverse",
    "Independent": "independent",
}
_SOLUTIONS = {"As the file tells": "", "Real time": "real-time", "Post-processed": "post-processed"}
_LAGS = {"Remove": True, "Keep": False}
_HEIGHT = "max(100dvh - 104px, 612px)"  # room for four charts above each other
_LOOK: dict[str, Any] = {"margin": (6, 4, 2, 4), "size": "small"}
_KEY = {"solid": "flown", "dotted": "budget", "dashed": "claimed by the file", "limit": "limit"}
_COMING = '<span class="quiet fine">Appears with the first result.</span>'


class SolutionFiles:
    """The file of a solution, and its accuracies where a second file has them."""

    def __init__(self) -> None:
        self._solution, self._accuracies = UploadedFile(), UploadedFile()
        self.files: tuple[File, ...] = ()

    async def take(self, name: str, content: bytes) -> None:
        """Keep a file: accuracies are added to the solution that is there, another file takes the place of both.

        Raises
        ------
        InputError
            Where accuracies have no solution yet, or the disk takes no more.
        """
        from nav_model.trajectory.files.sbet import name_of

        if name_of(content) != "smrmsg":
            self.files = (File(name, await self._solution.put(content)),)
        elif not self.files:
            raise InputError(name, "is smrmsg, the accuracies of an SBET file. Choose the SBET file first")
        else:
            self.files = (self.files[0], File(name, await self._accuracies.put(content)))

    @property
    def names(self) -> str:
        """The names of the files."""
        return " with ".join(file.name for file in self.files)


class FlownPage(StudyPage[FlownFlight]):
    """Everything below the tab."""

    kind = "flown"
    moving = ("files", "relation", "processing", "lag")
    outdated = "Computed before the change of {moved}. Press Start again."
    waiting = Answer(
        "No flight yet",
        "open",
        (
            "Choose the solution of a flight and a second one as its reference, then press Start. An SBET takes its "
            "smrmsg by the same button.",
        ),
    )
    files = param.String(label="Files", doc="The names of what was chosen.")
    relation = chosen("", _RELATIONS, "Relation")
    processing = chosen("", _SOLUTIONS, "The solution is")
    lag = chosen(True, _LAGS, "Lag of the clocks")
    figure = chosen("", {"What decides": "", **{FIGURES[name].label: name for name in IN_APERTURES}}, "By aperture")

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._solution, self._reference = SolutionFiles(), SolutionFiles()
        self._bar = RunBar(self.run, self.begin, "Start", *self._fields(), strip=True)
        self._login = login()
        self._stack = Timelines(timelines(None, "detrended_phase"))
        self._head = html_pane("", margin=(6, 10, 0, 10))
        figures = [pn.pane.Bokeh(plot, sizing_mode="stretch_both") for plot in self._stack.plots]
        for drawn, share in zip(figures, ("1", "1", "1", "1.5"), strict=True):  # the last has the axis
            drawn.styles = {"flex": f"{share} 1 0"}
        curves = pn.Column(
            self._head, *figures, sizing_mode="stretch_both", min_height=430, stylesheets=[STACK_ON_A_PHONE]
        )
        of_flight = self._of_result
        table = of_flight.text(lambda flight: html_of(*flight_blocks(flight)))
        whole: dict[str, Any] = {"sizing_mode": "stretch_both", "stylesheets": [NARROW]}
        lines = pn.Column(table, styles={"overflow": "auto"}, **whole)
        above = of_flight.later(lambda: of_flight.chart(map_chart), **whole)
        self._view = pn.Column(
            self._strip,
            first_screen(self._bar, left=[curves], right=[lines, above], height=_HEIGHT),
            Folded(
                (
                    ("Time and place", lambda: of_flight.text(lambda flight: html_of(*place_blocks(flight)))),
                    ("Jumps", lambda: of_flight.text(lambda flight: html_of(jump_block(flight)))),
                    ("Noise of IMU and receiver", self._receiver),
                    ("Keep and export", lambda: of_flight.later(self._ending)),
                )
            ),
        )
        self._open()

    # --- the parts ------------------------------------------------------------------------------------

    def _fields(self) -> tuple[Any, ...]:
        choices, running = self.param, self.run.param.running

        def button(label: str, to: SolutionFiles) -> Any:
            async def taken(name: str, content: bytes) -> None:
                await self._take(to, name, content)

            return upload(label, _KINDS, _UPLOAD, taken, self._refuse, disabled=running, **_LOOK)

        return (
            button("Solution", self._solution),
            button("Reference", self._reference),
            pmui.Select.from_param(choices.relation, width=175, **_LOOK),
            pmui.Select.from_param(choices.processing, width=150, **_LOOK),
            pmui.Select.from_param(choices.lag, width=115, **_LOOK),
            pmui.Select.from_param(choices.figure, width=160, **_LOOK),
        )

    def _receiver(self) -> pn.Column:
        """The receiver as it was seen, and the button that takes it into the design."""
        of_flight = self._of_result
        use = pmui.Button(label="Use these in the design", variant="contained", margin=(4, 10, 8, 10), disabled=True)
        use.on_click(lambda _: self._adopt())

        def follow(flight: FlownFlight) -> None:
            use.disabled = not self._changes(flight)

        chart = pn.Column()

        def draw(flight: FlownFlight) -> None:
            if not chart.objects and flight.result.receiver.get("lags_s"):
                chart.append(of_flight.chart(receiver_chart, 280))

        of_flight.add(follow)
        tables = of_flight.text(lambda flight: html_of(*noise_blocks(flight), receiver_block(flight)))
        of_flight.add(draw)
        return pn.Column(tables, use, chart)

    def _changes(self, flight: FlownFlight) -> bool:
        from nav_model.flown.noise_fit import adopt_receiver

        return bool(adopt_receiver(flight.result.receiver, flight.name).changes)

    def _adopt(self) -> None:
        """Take the receiver's noise into the design."""
        from nav_model.flown.noise_fit import adopt_receiver

        flight = self._of_result.known()
        adoption = adopt_receiver(flight.result.receiver, flight.name)
        problem = self._session.change(adoption.changes, adoption.written, adoption.origins)
        if problem is not None:
            self._refuse(problem)
        else:
            self._say(f"The receiver of {flight.name} is in the design.")

    def _ending(self) -> pn.Column:
        """Ways to hold on to the result: kept with the saved design, or taken away."""
        keep = pmui.Button(label="Keep with the design", variant="outlined", margin=(6, 6))
        outcome = html_pane("", margin=(2, 10))

        async def pressed(_: Any) -> None:
            outcome.say(f'<p role="status">{escape(await self._keep())}</p>')

        keep.on_click(pressed)
        return pn.Column(
            pn.FlexBox(
                author_field(self._session, self._login),
                keep,
                outcome,
                align_items="center",
                stylesheets=[PRINT_NOTHING],
            ),
            self._exports(),
        )

    async def _keep(self) -> str:
        """Keep verdict, sentence and the files' hashes in the library, with the revision that the design is.

        Returns what came of it, in a sentence.
        """
        flight, base, design = self._of_result.known(), self._session.lineage.base, self._session.design
        if flight.design.input_hash != design.input_hash:
            return "Not kept: the flight was held against other inputs. Press Start again."
        if base is None or base.content_hash != design.content_hash:
            return "Not kept: a flight is kept with a saved design. Save this one under Review first."
        result, author = flight.result, self._login or self._session.author or ""
        files = [(source.name, source.sha256) for source in flight.sources]
        words = sentence(result)
        try:
            await asyncio.to_thread(lambda: keep_flight(library(), base.key, author, result.verdict, words, files))
        except InputError as error:
            return f"Not kept. {error}"
        return f"The flight is kept with revision {base.number} of {base.name}."

    def _exports(self) -> pn.FlexBox:
        known = self._of_result.known
        return pn.FlexBox(
            download("Everything (JSON)", "flown.json", lambda: json.dumps(dict(known().data), allow_nan=False)),
            download("Figures (CSV)", "flown.csv", lambda: as_csv(known())),
            stylesheets=[PRINT_NOTHING],
        )

    @property
    def _shown(self) -> str:
        return self.figure or main_figure(self._of_result.known())

    @param.depends("figure", watch=True)
    def _redraw(self) -> None:
        with pn.io.hold():
            self._write()

    @param.depends("relation", "processing", "lag", "files", watch=True)
    def _chosen(self) -> None:
        self.show_verdict(None)

    def _write(self) -> None:
        super()._write()
        result = self._result
        if result is None:
            self._head.say(head_html("Along the flight", self.coming, _COMING))
            return
        charts = timelines(result, self._shown)
        self._stack.feed(charts)
        description, knowledge = "".join(map(described, charts)), " ".join(chart.knowledge for chart in charts[:2])
        self._head.say(head_html("Along the flight", knowledge, description, key_html(**_KEY)))
        self._of_result.follow()

    def _verdict(self, result: FlownFlight) -> Answer:
        return answer(result.result)

    # --- the run --------------------------------------------------------------------------------------

    async def _take(self, to: SolutionFiles, name: str, content: bytes) -> None:
        """Keep an uploaded file for the next run."""
        try:
            await asyncio.to_thread(importlib.import_module, "nav_model.trajectory.files.sbet")
            await to.take(name, content)
        except InputError as error:
            self._refuse(error)
            return
        both = [f"Solution {self._solution.names}" if self._solution.files else ""]
        both += [f"reference {self._reference.names}" if self._reference.files else ""]
        self.files = "; ".join(filter(None, both))
        self._say(f"{self.files}. Press Start." if self._solution.files else f"{self.files}. Choose a solution.")

    @property
    def _key(self) -> tuple[str, ...] | None:
        return None  # of files, which have no name in a cache

    def _begin_by_itself(self) -> None:
        """A flight is for a person to bring."""

    async def _study(self, run: Run) -> FlownFlight:
        if not self._solution.files:
            raise InputError("Solution", "choose the file of a solution first")
        await asyncio.to_thread(importlib.import_module, "nav_model.flown.study")  # its result is made here too
        flight: FlownFlight = await run_alone(
            hold, self._session.design, self._solution.files, self._reference.files, self.relation, self.processing,
            self.lag, progress=lambda share, what: run.tell(what, share or None),
        )  # fmt: skip
        self._say(f"{self.files}.")
        return flight

"""Sensors that meet the requirements: IMUs that pass with the design's receiver, or pairs of IMU and receiver."""

import asyncio
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import chosen, required
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.wording import preset_name
from app.library.offers import keep_offers, library_files, remove_offers
from app.library.place import library
from app.session import Session
from app.subjects.explore.console import candidate
from app.subjects.explore.question import Question, unlimited
from app.subjects.explore.ranking import Ranking, ranked
from app.subjects.explore.tables import search_answer, search_table
from app.ui.chart_pane import source_note
from app.ui.downloads import download
from app.ui.fields import TextInput
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.sortable_table import WHOLE, SortableTable
from app.ui.study_settings import StudySettings
from app.ui.theme import SWITCH
from app.ui.upload import upload
from app.work.pool import read_in_pool, run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.base.text.csv_text import csv_of
from nav_model.budget import Budget
from nav_model.design.catalogue import Entry, Kind, catalogue
from nav_model.design.offers import KINDS, Offers, merged_offers, named_apart, read_offers
from nav_model.explore.levers import Biases, one_currency
from nav_model.explore.margins import label_of
from nav_model.explore.search import Candidate, check_pairs

MAX_BYTES = 200_000
_MOST_AT_ONCE = 100  # pairs ranked here, in a fifth of a second where they have slow errors; more in a worker
_MOST_NAMES = 20  # in a message
_MOST_ROWS = 200  # of the table on the page
_COMPUTING = Answer("Sensors that pass", "open", ("Computing …",))
_KNOWLEDGE = (
    "Every row is computed with the formulas of the budget. The main error source has the largest share of the "
    "tightest requirement's variance [T-18]. Every IMU has your design's vibration factor, and the residual biases "
    "chosen above: your design's, zero, or the in-run biases of its data sheet; or, with your design's, all that its "
    "sheet prints. Receivers of the catalogue count with their slow error."
)

EXAMPLE = Path(__file__).with_name("sensors.toml").read_text("utf-8")
_BIASES: dict[str, Biases] = {
    "All that sheets print": "sheet",
    "Biases of your design": "design",
    "Biases 0": "zero",
    "In-run biases of data sheets": "in-run",
}


class SearchPanel(Question):
    """IMUs with the design's receiver, or all pairs; the filter, and the user's own sensors."""

    run = required(Run)
    words = param.String(label="Filter")
    own = chosen(True, {"Your receiver": True, "All receivers": False}, "Receiver")
    biases: Biases = chosen("design", _BIASES, "Residual biases")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, run=session.new_run())
        self._opened_file = ("", "")
        self._keep = pmui.Button(label="Save to library", variant="text", disabled=True, on_click=self._keep_file)
        self._of_library = pmui.Select(
            label="File in the library", visible=False, width=180, margin=(8, 8), size="small"
        )
        self._remove = pmui.Button(
            label="Remove from the library",
            variant="text",
            visible=self._of_library.param.visible,
            on_click=self._removed,
        )
        self._ranking = Ranking()
        self._in_worker = False
        self._message = html_pane("", margin=(0, 14))
        self._notes = html_pane("", margin=(0, 14))
        self._table = SortableTable(self._take, margin=(0, 14), stylesheets=[WHOLE])
        self._file = upload(
            "Add your own sensors", ".toml,.csv,.txt,.yaml,.yml", MAX_BYTES, self._opened,
            lambda reason: self._say(f"Not opened: {reason}.", wrong=True), icon=None, variant="text", margin=(6, 8),
            uploaded_label="Add your own sensors",
        )  # fmt: skip
        self._settings = StudySettings(session, "search", self, ("own", "biases"), lambda: None)

    def __panel__(self) -> pn.Column:
        words = TextInput(
            label=self.param.words.label, placeholder="passes fiber", max_length=100, width=180,
            margin=(8, 8), size="small",
        )  # fmt: skip
        words.link(self, value_input="words")
        tools = pn.FlexBox(
            *(
                pmui.RadioButtonGroup.from_param(chosen, margin=(8, 10), stylesheets=[SWITCH])
                for chosen in (self.param.own, self.param.biases)
            ),
            words,
            self._file,
            self._keep,
            pmui.Button(label="Load from library", variant="text", on_click=self._load),
            self._of_library,
            self._remove,
            download("Example file", "sensors.toml", lambda: EXAMPLE),
            download("Table: CSV", "search.csv", self._csv),
            align_items="center",
        )
        content = pn.Column(
            self._message, self._table, self._notes, html_pane(source_note(_KNOWLEDGE), margin=(4, 14)),
            sizing_mode="stretch_both", styles={"overflow": "auto"},
        )  # fmt: skip
        return first_screen(tools, left=[content], height="100%")

    def _entries(self, kind: Kind) -> Mapping[str, Entry]:
        return {**catalogue(kind), **self.session.offers[kind]}

    def show(self, budget: Budget) -> None:
        """Judge every unit or pair again; many of them in a worker."""
        self._in_worker = False
        if not budget.straight_leg().checks:
            self.run.cancel()
            self._show_ranking(Ranking(), unlimited(budget))
            return
        imus, receivers = self._entries("imu"), {} if self.own else self._entries("gnss")
        question = budget.design, imus, receivers, self.biases
        if len(imus) * (1 + len(receivers)) <= _MOST_AT_ONCE:
            self.run.cancel()
            self._show_ranking(ranked(*question))
            return
        self._show_ranking(Ranking(), _COMPUTING)
        self._in_worker = True
        pn.state.execute(lambda: self.run.start(lambda _: run_in_pool(ranked, *question)))

    @param.depends("run.running", watch=True)
    def _ranked(self) -> None:
        """Show what the worker has found, if that is still what is asked."""
        if self.run.running or not self._in_worker:
            return
        if self.run.message:
            self._show_ranking(Ranking(), Answer("Not ranked", "warn", (self.run.message,)))
        elif self.run.result is not None:
            self._show_ranking(self.run.result)

    def _show_ranking(self, ranking: Ranking, answer: Answer | None = None) -> None:
        self._ranking = ranking
        self.answer = answer or search_answer(ranking.rows, self.own, ranking.unbiased)
        self._fill()

    @param.depends("own", "biases", watch=True)
    def _again(self) -> None:
        self.show(self.session.budget)

    @param.depends("words", watch=True)
    def _fill(self) -> None:
        """Show the first rows that hold every word of the filter."""
        words = self.words.lower().split()
        rows = [row for row in self._ranking.rows if _holds(self._text(row), words)]
        yours = f"Your IMU ({preset_name(self.session.design, 'imu')})"
        block = search_table(self.session.design, rows[:_MOST_ROWS], self.own, self._ranking.in_design, yours)
        self._table.html = html_of(block) if self._ranking.rows else ""
        notes = []
        if len(rows) > _MOST_ROWS:
            notes.append(f"The first {_MOST_ROWS} of {len(rows)} rows; the filter finds the others, the CSV has all.")
        if self._ranking.left_out:
            lacking = "; ".join(f"{name} ({lacks})" for name, lacks in self._ranking.left_out.items())
            notes.append(f"Not ranked, data sheet incomplete: {lacking}.")
        self._notes.object = f'<p class="quiet fine">{escape(" ".join(notes))}</p>' if notes else ""

    def _text(self, row: Candidate) -> str:
        """Text by which a filter finds a row."""
        verdict = "passes" if row.closes else "fails"
        receiver = "" if self.own else row.gnss
        parts = (row.imu, receiver, verdict, label_of(row.tightest), row.dominant, *row.doubts)
        return " ".join(parts).lower()

    def _take(self, pair: str) -> None:
        row = next((row for row in self._ranking.rows if row.pair == pair), None)
        if row is None:
            return
        problem = self.session.change(row.changes, row.written)
        what = row.imu if self.own else row.pair
        text = f"{what} was not applied. {problem}" if problem else f"The design now has {what}. You can undo."
        self._say(text, wrong=problem is not None)

    async def _opened(self, name: str, content: bytes) -> None:
        self._keep.disabled = True
        try:
            text = content.decode("utf-8-sig")
            self._add(await read_in_pool(read_offers, text))
            self._opened_file, self._keep.disabled = (name, text), False
        except UnicodeDecodeError as error:
            self._say(f"Not opened. Save the file as UTF-8 text: byte {error.start} is not UTF-8.", wrong=True)
        except InputError as error:
            self._say(f"Not opened. {error}", wrong=True)

    def _add(self, offers: Offers, *notes: str) -> None:
        """Rank these units, too, and say so; one of the same name takes the place of the one before."""
        brought = {kind: {**self.session.offers[kind], **offers[kind]} for kind in KINDS}
        check_pairs(*(len(catalogue(kind)) + len(brought[kind]) for kind in KINDS))
        one_currency(entry for entries in brought.values() for entry in entries.values())
        replaced = [name for kind in KINDS for name in offers[kind] if name in self.session.offers[kind]]
        self.session.offers = brought
        self.show(self.session.budget)
        names = [name for entries in offers.values() for name in entries]
        again = f"Replaced: {_listed(replaced)}." if replaced else ""
        self._say(" ".join(filter(None, (f"Added {_listed(names)}.", again, named_apart(names), *notes))))

    async def _keep_file(self, _: Any) -> None:
        """Keep the file opened last in the library."""
        name, text = self._opened_file
        try:
            await asyncio.to_thread(lambda: keep_offers(library(), name, text))
            self._say(f"{name} is saved in the library.")
        except InputError as error:
            self._say(f"Not saved. {error}", wrong=True)

    async def _load(self, _: Any) -> None:
        """Rank what the library holds."""
        try:
            files = await asyncio.to_thread(lambda: library_files(library()))
            self._list(files)
            offers, damaged, repeated = await run_in_pool(merged_offers, files)
            lost = f"Left out because damaged: {_listed(damaged)}. Remove these files, or save them again."
            if any(offers.values()):
                twice = f"In several files; the one saved last counts: {_listed(repeated)}."
                self._add(offers, lost if damaged else "", twice if repeated else "")
            else:
                self._say(lost if damaged else "The library holds no offers yet. Open a file and save it.")
        except InputError as error:
            self._say(f"Not opened. {error}", wrong=True)

    async def _removed(self, _: Any) -> None:
        """Remove the file that is chosen from the library; what is ranked on this page stays."""
        name = str(self._of_library.value)
        try:
            await asyncio.to_thread(lambda: remove_offers(library(), name))
            self._list(await asyncio.to_thread(lambda: library_files(library())))
            self._say(f"{name} was removed from the library. Its units stay on this page until it is loaded again.")
        except InputError as error:
            self._say(f"Not removed. {error}", wrong=True)

    def _list(self, files: Sequence[tuple[str, str]]) -> None:
        """Offer the library's files for removal."""
        names = [name for name, _ in files]
        self._of_library.param.update(options=names, value=names[-1] if names else None, visible=bool(names))

    def _say(self, text: str, *, wrong: bool = False) -> None:
        kind = 'role="alert" class="tone bad"' if wrong else 'role="status"'
        self._message.object = f"<p {kind}>{escape(text)}</p>"

    def _csv(self) -> str:
        return csv_of(candidate(row, offers=True) for row in self._ranking.rows)


def _holds(text: str, words: Iterable[str]) -> bool:
    return all(word in text for word in words)


def _listed(names: Iterable[str]) -> str:
    """Names in a row; of many the first, and how many more."""
    names = tuple(names)
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    return ", ".join(names[:_MOST_NAMES]) + more

"""Which sensors meet the requirements: IMUs that pass with the design's receiver, or pairs of IMU and receiver."""

import asyncio
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import chosen
from app.document.pane import html_of
from app.library.offers import KINDS, Offers, keep_offers, kept_offers, read_offers
from app.library.place import library
from app.session import Session
from app.subjects.explore.console import candidate
from app.subjects.explore.question import NO_LIMIT, Question
from app.subjects.explore.tables import search_answer, search_table
from app.ui.chart_pane import source_note
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.html_pane import html_pane
from app.ui.sortable_table import WHOLE, SortableTable
from app.ui.study_settings import StudySettings
from app.ui.theme import SWITCH
from app.ui.upload import upload
from nav_model.base.csv_text import csv_of
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design.catalogue import Entry, Kind, catalogue
from nav_model.explore.search import Biases, Candidate, left_out, one_currency, search

MAX_BYTES = 200_000
_KNOWLEDGE = (
    "Every row is computed with the formulas of the budget. The main error source has the largest share of the "
    "tightest requirement's variance [T-18]. Every IMU has your design's vibration factor, and the residual biases "
    "chosen above: your design's, zero, or the in-run biases of its data sheet. Receiver noise is white."
)

EXAMPLE = Path(__file__).with_name("sensors.toml").read_text("utf-8")
_BIASES: dict[str, Biases] = {
    "Biases of your design": "design",
    "Biases 0": "zero",
    "In-run biases of data sheets": "in-run",
}


class SearchPanel(Question):
    """IMUs with the design's receiver, or all pairs; the filter, and the user's own sensors."""

    words = param.String(label="Filter")
    own = chosen(True, {"Your receiver": True, "All receivers": False}, "Receiver")
    biases: Biases = chosen("design", _BIASES, "Residual biases")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._own: Offers = {kind: {} for kind in KINDS}
        self._text = ""
        self._keep = pmui.Button(label="Keep in the library", variant="text", disabled=True, on_click=self._kept)
        self._found: tuple[Candidate, ...] = ()
        self._said = html_pane("", margin=(0, 14))
        self._left_out = html_pane("", margin=(0, 14))
        self._table = SortableTable(self._take, margin=(0, 14), stylesheets=[WHOLE])
        self._file = upload(
            "Add your own sensors (TOML)", ".toml", MAX_BYTES, self._opened,
            lambda reason: self._say(f"Not opened: {reason}."), icon=None, variant="text", margin=(6, 8),
        )  # fmt: skip
        self._settings = StudySettings(session, "search", self, ("own", "biases"), lambda: None)

    def __panel__(self) -> pn.Column:
        words = pmui.TextInput(
            label=self.param.words.label, placeholder="closes fiber", max_length=100, width=180,
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
            pmui.Button(label="Offers of the library", variant="text", on_click=self._load),
            download("Example file", "sensors.toml", lambda: EXAMPLE),
            download("Table: CSV", "search.csv", self._csv),
            align_items="center",
        )
        content = pn.Column(
            self._said, self._table, self._left_out, html_pane(source_note(_KNOWLEDGE), margin=(4, 14)),
            sizing_mode="stretch_both", styles={"overflow": "auto"},
        )  # fmt: skip
        return first_screen(tools, left=[content], height="100%")

    def _entries(self, kind: Kind) -> Mapping[str, Entry]:
        return {**catalogue(kind), **self._own[kind]}

    def show(self, budget: Budget) -> None:
        """Judge every unit or pair again."""
        self._found = ()
        if budget.verdict.checks:
            imus, receivers = self._entries("imu"), {} if self.own else self._entries("gnss")
            self._found = search(budget.design, imus, receivers, self.biases)
            silent = "; ".join(f"{name} ({lacks})" for name, lacks in left_out(imus, self.biases).items())
            self._left_out.object = f'<p class="quiet fine">Not ranked, data sheet incomplete: {escape(silent)}.</p>'
            unbiased = 0
            if self.biases == "design" and not any(row.closes for row in self._found):
                unbiased = sum(row.closes for row in search(budget.design, imus, receivers, "zero"))
            self.answer = search_answer(self._found, self.own, unbiased)
        else:
            self.answer = NO_LIMIT
        self._fill()

    @param.depends("own", "biases", watch=True)
    def _again(self) -> None:
        self.show(self.session.budget)

    @param.depends("words", watch=True)
    def _fill(self) -> None:
        """Show the rows that hold every word of the filter."""
        words = self.words.lower().split()
        whole = search_table(self._found, self.own)
        texts = (" ".join(cell.text for cell in row).lower() for row in whole.rows)
        shown = [row for row, text in zip(self._found, texts, strict=True) if all(word in text for word in words)]
        self._table.html = html_of(search_table(shown, self.own)) if self._found else ""

    def _take(self, pair: str) -> None:
        row = next((row for row in self._found if row.pair == pair), None)
        if row is None:
            return
        changes = dict(row.changes)
        if row.imu in self._own["imu"]:  # a unit of the user's own is no preset of the product
            changes["imu.preset"] = None
        problem = self.session.change(changes, row.written)
        what = row.imu if self.own else row.pair
        self._say(f"{what} was not taken. {problem}" if problem else f"The design now has {what}. You can undo.")

    def _opened(self, _: str, content: bytes) -> None:
        self._keep.disabled = True
        try:
            text = content.decode("utf-8-sig")
            self._add(read_offers(text))
            self._text, self._keep.disabled = text, False
        except UnicodeDecodeError as error:
            self._say(f"Not opened. Save the file as UTF-8 text: byte {error.start} is not UTF-8.")
        except InputError as error:
            self._say(f"Not opened. {error}")

    def _add(self, found: Offers) -> None:
        """Rank these units, too."""
        own = {kind: {**self._own[kind], **found[kind]} for kind in KINDS}
        one_currency(entry for entries in own.values() for entry in entries.values())
        self._own = own
        self.show(self.session.budget)
        self._say(f"Added {', '.join(name for entries in found.values() for name in entries)}.")

    async def _kept(self, _: Any) -> None:
        """Keep the file opened last in the library."""
        try:
            await asyncio.to_thread(lambda: keep_offers(library(), str(self._file.filename), self._text))
            self._say(f"{self._file.filename} is kept in the library.")
        except InputError as error:
            self._say(f"Not kept. {error}")

    async def _load(self, _: Any) -> None:
        """Rank what the library holds."""
        try:
            found, damaged = await asyncio.to_thread(lambda: kept_offers(library()))
            if any(found.values()):
                self._add(found)
            elif not damaged:
                self._say("The library holds no offers yet. Open a file and keep it.")
        except InputError as error:
            self._say(f"Not opened. {error}")
            return
        if damaged:
            self._say(f"Left out, as they are damaged: {', '.join(damaged)}. Keep these files again.")

    def _say(self, text: str) -> None:
        self._said.object = f'<p role="status">{escape(text)}</p>'

    def _csv(self) -> str:
        return csv_of(candidate(row, offers=True) for row in self._found)

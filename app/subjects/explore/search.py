"""Catalogue search on the Explore page: every unit with every receiver class, sortable, and adopted by row."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from html import escape

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import held
from app.document.pane import html_of
from app.session import Session
from app.subjects.explore.tables import pair_name, search_table
from app.ui.chart_pane import source_note
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME
from app.upstream.file_input import LimitedFileInput
from nav_model.budget import Budget
from nav_model.catalogue import Entry, Kind, catalogue, read_catalogue
from nav_model.errors import InputError
from nav_model.explore.search import Candidate, left_out, search

MAX_BYTES = 200_000
_KNOWLEDGE = (
    "The closed forms of the budget for every pair in one evaluation; the dominant source has the largest exact "
    "logarithmic sensitivity, which is its share of the variance [T-18]. Residual biases and the vibration factor "
    "are the design's for every unit, because no data sheet prints them. A receiver's noise is taken as white."
)


EXAMPLE = """\
# Your own sensors, in the format of the product's catalogue. status: confirmed, secondary, assumed or unconfirmed.
[[imu]]
name = "Our inertial unit"
angle_random_walk = { value = "0.05 °/√h", status = "confirmed", source = "bench log of 3 May, unit 7" }
velocity_random_walk = { value = "50 µg/√Hz", status = "secondary", source = "data sheet, typical" }

[[gnss]]
name = "Our receiver"
position_noise = { value = "3 cm", status = "assumed", source = "maker's web page" }
vertical_position_noise = { value = "5 cm", status = "assumed", source = "maker's web page" }
interval = { value = "0.2 s", status = "confirmed", source = "manual" }
"""
_KINDS: tuple[Kind, ...] = ("imu", "gnss")


class SearchPanel(pn.viewable.Viewer):
    """The table, its filter, the user's own sensors, and the button that adopts a row."""

    session = held(Session)
    words = param.String(label="Show only rows with these words")

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._own: dict[Kind, dict[str, Entry]] = {kind: {} for kind in _KINDS}
        self._found: tuple[Candidate, ...] = ()
        self._head = html_pane("", margin=(10, 14, 0, 14))
        self._said = html_pane("", margin=(0, 14))
        self._table = SortableTable(sizing_mode="stretch_width", margin=(4, 14))
        self._file = LimitedFileInput(
            lambda reason: self._say(f"Not opened: {reason}."), label="Your own sensors (TOML)",
            accept=".toml", variant="text", max_file_size=MAX_BYTES, margin=(6, 8),
        )  # fmt: skip
        self._file.param.watch(self._opened, "value")
        self.show(session.budget)

    def __panel__(self) -> pn.Column:
        words = pmui.TextInput(
            label=self.param.words.label, placeholder="closes carrier", max_length=100,
            width=300, margin=(8, 14),
        )  # fmt: skip
        words.link(self, value_input="words")
        adopt = pmui.Button(
            label="Adopt the selected row", variant="outlined", margin=(6, 8, 6, 14),
            disabled=self._table.param.chosen.rx.not_(), on_click=lambda _: self._adopt_selected(),
        )  # fmt: skip
        return pn.Column(
            self._head,
            words,
            self._table,
            pn.FlexBox(
                adopt,
                self._file,
                download("An example of such a file", "sensors.toml", lambda: io.BytesIO(EXAMPLE.encode())),
                download("Search: CSV", "search.csv", self._csv),
            ),
            self._said,
            html_pane(source_note(_KNOWLEDGE)),
            styles=FRAME,
        )

    def _entries(self, kind: Kind) -> Mapping[str, Entry]:
        return {**catalogue(kind), **self._own[kind]}

    def show(self, budget: Budget) -> None:
        """Judge every pair again."""
        title = "<h3>Sensors that meet the requirements</h3>"
        if not budget.verdict.checks:
            self._found = ()
            self._head.object = f"{title}<p>Give a limit under Requirements to search.</p>"
        else:
            imus = self._entries("imu")
            self._found = search(budget.design, imus, self._entries("gnss"))
            good = sum(row.closes for row in self._found)
            silent = "; ".join(f"{name} ({lacks})" for name, lacks in left_out(imus).items())
            self._head.object = (
                f"{title}<p>{good} of {len(self._found)} pairs of inertial unit and receiver close under this radar. "
                f"Not ranked, data sheet incomplete: {escape(silent) or 'none'}.</p>"
            )
        self._fill()

    @param.depends("words", watch=True)
    def _fill(self) -> None:
        """Show the rows that hold every word of the filter."""
        words = self.words.lower().split()
        whole = search_table(list(self._found), len(self._found))
        texts = (" ".join(cell.text for cell in row).lower() for row in whole.rows)
        shown = [row for row, text in zip(self._found, texts, strict=True) if all(word in text for word in words)]
        table = html_of(search_table(shown, len(self._found)))
        if table != self._table.html:
            self._table.html = table
        if self._table.chosen not in map(pair_name, shown):
            self._table.chosen = ""

    def _adopt_selected(self) -> None:
        row = next((row for row in self._found if pair_name(row) == self._table.chosen), None)
        if row is None:
            return
        changes = dict(row.changes)
        if row.imu in self._own["imu"]:  # a unit of the user's own is no preset of the product
            changes["imu.preset"] = None
        problem = self.session.change(changes, row.written)
        self._say(f"Not adopted. {problem}" if problem else f"Adopted {row.imu} with {row.gnss}; You can undo.")

    def _opened(self, event: param.parameterized.Event) -> None:
        if not event.new:
            return
        try:
            text = event.new.decode("utf-8-sig")
            found = {kind: dict(read_catalogue(text, kind)) for kind in _KINDS}
            names = [name for entries in found.values() for name in entries]
            if not names:
                raise InputError("file", "has neither [[imu]] nor [[gnss]] entries")
            self._own = found
            self._say(f"Added {', '.join(names)}.")
        except UnicodeDecodeError as error:
            self._say(f"Not opened. Byte {error.start} is not UTF-8 text.")
        except InputError as error:
            self._say(f"Not opened. {error}")
        self.show(self.session.budget)

    def _say(self, text: str) -> None:
        self._said.object = f'<p role="status">{escape(text)}</p>'

    def _csv(self) -> io.BytesIO:
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        margins = self._found[0].margins if self._found else ()
        writer.writerow(("IMU", "Receiver", "Closes", "Margin", "Tightest", "Dominant source", "Its share",
                         *(f"Margin of {name}" for name in margins), "Not confirmed"))  # fmt: skip
        for row in self._found:
            writer.writerow((row.imu, row.gnss, row.closes, row.margin, row.tightest, row.dominant, row.share,
                             *row.margins.values(), "; ".join(row.doubts)))  # fmt: skip
        return io.BytesIO(text.getvalue().encode())

"""Catalogue search on the Explore page: every unit with every receiver class, sortable, and adopted by row."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Mapping
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.document.prose import prose
from app.session import Session
from app.subjects.explore.map import download
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME
from app.ui.upload import LimitedFileInput
from nav_model.budget import Budget
from nav_model.catalogue import Entry, Kind, catalogue, read_catalogue
from nav_model.errors import InputError
from nav_model.explore.margins import label_of
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


class SearchPanel:
    """The table, its filter, the user's own sensors, and the button that adopts a row."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._own: dict[Kind, dict[str, Entry]] = {kind: {} for kind in _KINDS}
        self._found: tuple[Candidate, ...] = ()
        self._head = html_pane("", margin=(10, 14, 0, 14))
        self._said = html_pane("", margin=(0, 14))
        self._filter = pmui.TextInput(
            label="Show only rows with these words", description="", placeholder="closes carrier", size="small",
            max_length=100, width=300, margin=(8, 14),
        )  # fmt: skip
        self._table = SortableTable(sizing_mode="stretch_width", margin=(4, 14))
        self._adopt = pmui.Button(
            label="Adopt the selected row", size="small", variant="outlined", disabled=True, margin=(6, 8, 6, 14)
        )
        self._file = LimitedFileInput(
            lambda reason: self._say(f"Not opened: {reason}."), label="Your own sensors (TOML)", description="",
            accept=".toml", size="small", variant="text", max_file_size=MAX_BYTES, margin=(6, 8),
        )  # fmt: skip
        self._adopt.on_click(lambda _: self._adopt_selected())
        self._filter.param.watch(lambda _: self._fill(), "value_input")
        self._table.param.watch(self._selected, "chosen")
        self._file.param.watch(self._opened, "value")
        self.view = pn.Column(
            self._head,
            self._filter,
            self._table,
            pn.FlexBox(
                self._adopt, self._file,
                download("An example of such a file", "sensors.toml", lambda: io.BytesIO(EXAMPLE.encode())),
                download("Search: CSV", "search.csv", self._csv),
                sizing_mode="stretch_width",
            ),
            self._said,
            html_pane(f'<p class="know quiet"><b>How do we know:</b> {prose(_KNOWLEDGE)}</p>'),
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )  # fmt: skip
        self.show(session.budget)

    def _entries(self, kind: Kind) -> Mapping[str, Entry]:
        return {**catalogue(kind), **self._own[kind]}

    def show(self, budget: Budget) -> None:
        """Judge every pair again."""
        if not budget.verdict.checks:
            self._found = ()
            self._fill()
            self._head.object = "<h3>Which sensors would do</h3><p>Give a limit under Requirements to search.</p>"
            return
        imus = self._entries("imu")
        self._found = search(budget.design, imus, self._entries("gnss"))
        self._fill()
        good = sum(row.closes for row in self._found)
        silent = "; ".join(f"{name} ({lacks})" for name, lacks in left_out(imus).items())
        self._head.object = (
            f"<h3>Which sensors would do</h3><p>{good} of {len(self._found)} pairs of inertial unit and receiver "
            f"close under this radar. Left out, their sheet being silent: {escape(silent) or 'none'}.</p>"
        )

    def _fill(self) -> None:
        """Show the rows that hold every word of the filter."""
        words = (self._filter.value_input or "").lower().split()
        shown = [row for row in self._found if all(word in " ".join(_cells(row)).lower() for word in words)]
        html = _table(shown, len(self._found))
        if html != self._table.html:
            self._table.html = html
        if self._table.chosen not in {_name(row) for row in shown}:
            self._table.chosen = ""

    def _selected(self, event: Any) -> None:
        self._adopt.disabled = not event.new

    def _adopt_selected(self) -> None:
        row = next((row for row in self._found if _name(row) == self._table.chosen), None)
        if row is None:
            return
        changes = dict(row.changes)
        if row.imu in self._own["imu"]:  # a unit of the user's own is no preset of the product
            changes["imu.preset"] = None
        problem = self._session.change(changes, row.written)
        self._say(f"Not adopted. {problem}" if problem else f"Adopted {row.imu} with {row.gnss}; Undo takes it back.")

    def _opened(self, event: Any) -> None:
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
        self.show(self._session.budget)

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


def _doubts(row: Candidate) -> str:
    """How many values the sources do not confirm, by status."""
    counts = Counter(doubt.rpartition(" ")[2] for doubt in row.doubts)
    return ", ".join(f"{count} {status}" for status, count in counts.items())


_HEADS = ("IMU", "Receiver", "Verdict", "Margin [%]", "Tightest", "Dominant source", "Not confirmed")
_MARGIN = _HEADS.index("Margin [%]")
_NUMBER = " class='num'"


def _cells(row: Candidate) -> tuple[str, ...]:
    return (
        row.imu,
        row.gnss,
        "✓ closes" if row.closes else "✗ does not",
        f"{100 * row.margin:.1f}",
        label_of(row.tightest),
        f"{row.dominant} {100 * row.share:.0f} %",
        _doubts(row),
    )


def _name(row: Candidate) -> str:
    return f"{row.imu} with {row.gnss}"


def _table(rows: list[Candidate], of: int) -> str:
    """The rows for `SortableTable`, each with a radio button; as many as there are, in a box that scrolls."""
    if not rows:
        return f"<p>{'No pair has these words.' if of else ''}</p>"
    head = "".join(
        f"<th scope='col'{_NUMBER if i == _MARGIN else ''}><button>{escape(name)}</button></th>"
        for i, name in enumerate(_HEADS)
    )
    body = "".join(f"<tr>{''.join(_cell(row, i, text) for i, text in enumerate(_cells(row)))}</tr>" for row in rows)
    return (
        '<div class="scroll tall" tabindex="0" role="region" aria-label="Pairs of inertial unit and receiver">'
        f'<table class="checks"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
        f'<p class="quiet" role="status">{len(rows)} of {of} pairs.</p>'
    )


def _cell(row: Candidate, index: int, text: str) -> str:
    if index == 0:
        name = escape(_name(row))
        radio = f'<input type="radio" name="pair" value="{name}" aria-label="{name}">'
        return f'<th scope="row" data-sort="{escape(text)}"><label>{radio} {escape(text)}</label></th>'
    if index == _MARGIN:
        return f'<td class="num" data-sort="{row.margin!r}">{text.replace("-", "−")}</td>'
    return f"<td>{escape(text)}</td>"

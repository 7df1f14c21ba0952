"""Catalogue search on the Explore page: every unit with every receiver class, sortable, and adopted by row."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Mapping
from html import escape
from typing import Any

import pandas as pd
import panel as pn
import panel_material_ui as pmui

from app.chart_view import html_pane, prose
from app.pages.explore_map import download
from app.state import Session
from app.theme import FRAME
from app.upload import LimitedFileInput
from nav_model.budget import Budget
from nav_model.catalogue import Entry, catalogue, read_catalogue
from nav_model.explore.margins import label_of
from nav_model.explore.search import Candidate, left_out, search
from nav_model.inputs import DesignError

MAX_BYTES = 200_000
_KNOWLEDGE = (
    "The closed forms of the budget for every pair in one evaluation; the dominant source has the largest exact "
    "logarithmic sensitivity, which is its share of the variance [T-18]. Residual biases and the vibration factor "
    "are the design's for every unit, because no data sheet prints them. A receiver's noise is taken as white."
)


class SearchPanel:
    """The table, its filter, the user's own sensors, and the button that adopts a row."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._own: dict[str, Entry] = {}
        self._found: tuple[Candidate, ...] = ()
        self._head = html_pane("", margin=(10, 14, 0, 14))
        self._said = html_pane("", margin=(0, 14))
        self._table = pn.widgets.Tabulator(
            pd.DataFrame(),
            show_index=False,
            disabled=True,
            selectable=1,
            pagination="local",
            page_size=12,
            layout="fit_data_stretch",
            widths={
                "IMU": 135,
                "Receiver": 195,
                "Verdict": 95,
                "Margin [%]": 105,
                "Tightest": 155,
                "Dominant source": 175,
            },
            sizing_mode="stretch_width",
            header_filters={"IMU": True, "Receiver": True, "Verdict": True},
            theme="simple",
            stylesheets=[":host .tabulator { font-size: 12.5px; }"],
            margin=(4, 14),
        )
        self._adopt = pmui.Button(
            label="Adopt the selected row", size="small", variant="outlined", disabled=True, margin=(6, 8, 6, 14)
        )
        self._file = LimitedFileInput(
            lambda why: self._say(f"Not used. {why}"),
            label="Your own units (TOML)", description="", accept=".toml", size="small", variant="text",
            max_file_size=MAX_BYTES, margin=(6, 8),
        )  # fmt: skip
        self._adopt.on_click(lambda _: self._adopt_selected())
        self._table.param.watch(self._selected, "selection")
        self._file.param.watch(self._opened, "value")
        self.view = pn.Column(
            self._head,
            self._table,
            pn.FlexBox(
                self._adopt, self._file, download("Search: data (CSV)", "search.csv", self._csv),
                sizing_mode="stretch_width",
            ),
            self._said,
            html_pane(f'<p class="know quiet"><b>How do we know:</b> {prose(_KNOWLEDGE)}</p>'),
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )  # fmt: skip
        self.show(session.budget)

    def _imus(self) -> Mapping[str, Entry]:
        return {**catalogue("imu"), **self._own}

    def show(self, budget: Budget) -> None:
        """Judge every pair again."""
        if not budget.verdict.checks:
            self._found = ()
            self._head.object = "<h3>Which sensors would do</h3><p>Give a limit under Requirements to search.</p>"
            return
        self._found = search(budget.design, self._imus(), catalogue("gnss"))
        frame = _frame(self._found)
        if not frame.equals(self._table.value):
            self._table.selection = []
            self._table.value = frame
        good = sum(row.closes for row in self._found)
        silent = "; ".join(f"{name} ({lacks})" for name, lacks in left_out(self._imus()).items())
        self._head.object = (
            f"<h3>Which sensors would do</h3><p>{good} of {len(self._found)} pairs of inertial unit and receiver "
            f"close under this radar. Left out, their sheet being silent: {escape(silent) or 'none'}.</p>"
        )

    def _selected(self, event: Any) -> None:
        self._adopt.disabled = not event.new

    def _adopt_selected(self) -> None:
        if not self._table.selection:
            return
        row = self._found[self._table.selection[0]]
        changes = dict(row.changes)
        if row.imu in self._own:  # a unit of the user's own is no preset of the product
            changes["imu.preset"] = None
        problem = self._session.change(changes, row.written)
        self._say(f"Not adopted. {problem}" if problem else f"Adopted {row.imu} with {row.gnss}; Undo takes it back.")

    def _opened(self, event: Any) -> None:
        if not event.new:
            return
        try:
            self._own = dict(read_catalogue(event.new.decode("utf-8-sig"), "imu"))
            self._say(f"Added {', '.join(self._own) or 'nothing: the file has no [[imu]] entry'}.")
        except UnicodeDecodeError as error:
            self._say(f"Not opened. Byte {error.start} is not UTF-8 text.")
        except DesignError as error:
            self._say(f"Not opened. {error}")
        self.show(self._session.budget)

    def _say(self, text: str) -> None:
        self._said.object = f'<p role="status">{escape(text)}</p>'

    def _csv(self) -> io.BytesIO:
        frame = _frame(self._found)
        frame["Not confirmed"] = [", ".join(row.doubts) for row in self._found]
        return io.BytesIO(frame.to_csv(index=False).encode())


def _doubts(row: Candidate) -> str:
    """How many values the sources do not confirm, by status."""
    counts = Counter(doubt.rpartition(" ")[2] for doubt in row.doubts)
    return ", ".join(f"{count} {status}" for status, count in counts.items())


def _frame(found: tuple[Candidate, ...]) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "IMU": [row.imu for row in found],
            "Receiver": [row.gnss for row in found],
            "Verdict": ["✓ closes" if row.closes else "✗ does not" for row in found],
            "Margin [%]": [round(100 * row.margin, 1) for row in found],
            "Tightest": [label_of(row.tightest) for row in found],
            "Dominant source": [f"{row.dominant} {100 * row.share:.0f} %" for row in found],
            "Not confirmed": [_doubts(row) for row in found],
        }
    )

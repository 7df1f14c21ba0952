"""A table of texts that a person types, pastes from a spreadsheet, or removes row by row."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import param

from app.ui.theme import PRINT_NOTHING, SHEET
from app.upstream.plain_script import PlainScript


class EditTable(PlainScript):
    """Rows of texts under named columns; ``told`` is called with all rows after each change, empty ones left out.

    What was typed stays in the browser until `rows` has others, so a refusal, `error`, loses nothing.
    """

    caption = param.String()
    columns = param.List(default=[], doc="Names of the columns, with units.")
    rows = param.List(default=[], doc="Lists of as many texts.")
    error = param.String(doc="Why the rows that are seen are not used; empty if they are.")

    _stylesheets: ClassVar[list[str]] = [SHEET, PRINT_NOTHING, Path(__file__).with_suffix(".css").read_text("utf-8")]

    _esm = Path(__file__).with_suffix(".js").read_text("utf-8")

    def __init__(self, told: Callable[[list[list[str]]], None], **params: Any) -> None:
        super().__init__(**params)
        self._told = told

    def _handle_msg(self, msg: Any) -> None:
        rows = msg.get("rows") if isinstance(msg, dict) else None
        if isinstance(rows, list) and all(isinstance(row, list) and len(row) == len(self.columns) for row in rows):
            self._told([[str(cell)[:200] for cell in row] for row in rows])

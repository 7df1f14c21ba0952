"""A table that a person fills in: a row a thing, each cell a box, a choice or a text to read."""

import re
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import param

from app.ui.theme import SHEET
from app.upstream.plain_script import PlainScript
from nav_model.base.errors import InputError

Rows = list[dict[str, str]]
_PLACE = re.compile(r"\w+\[(.*)\](?:\.(\w+))?", re.DOTALL)  # in a design file: table[name of the row].column


class Field(NamedTuple):
    """A column: a box, or a choice among pairs of value and label; `read` is not edited, `needed` never empty."""

    key: str
    label: str
    example: str = ""
    choices: tuple[tuple[str, str], ...] = ()
    read: bool = False
    needed: bool = False


class RowEditor(PlainScript):
    """The rows in force; ``on_change`` is called with all rows that have what they need whenever one changes.

    It returns why they are refused, or nothing. What was typed stays in the boxes either way.
    """

    caption = param.String()
    columns = param.List(default=[], doc="Of `Field`, as dicts.")
    rows = param.List(default=[], doc="Dicts of key to text.")
    noun = param.String(doc="What the button adds; empty: rows are neither added nor removed.")
    ordered = param.Boolean(doc="Whether rows follow each other: inserted between others, pasted from a spreadsheet.")
    refused = param.String()

    _stylesheets: ClassVar[list[str]] = [SHEET]

    def __init__(self, fields: tuple[Field, ...], on_change: Callable[[Rows], object], **params: Any) -> None:
        columns = [field._asdict() for field in fields]
        super().__init__(columns=columns, **{"sizing_mode": "stretch_width", "margin": (4, 10), **params})
        self._on_change = on_change

    def _handle_msg(self, msg: Any) -> None:
        rows = msg.get("rows") if isinstance(msg, dict) else None
        if isinstance(rows, list) and all(isinstance(row, dict) for row in rows):
            self.put(rows)

    @param.depends("rows", watch=True)
    def _forget(self) -> None:
        """Take a refused text out of its box once there are other rows."""
        self.refused = ""

    def put(self, rows: Rows) -> None:
        """Put rows in force, or say why not; empty texts are left out."""
        keys = {column["key"] for column in self.columns if not column["read"]}
        given = [{key: str(text) for key, text in row.items() if key in keys and str(text).strip()} for row in rows]
        refused = self._on_change(given)
        if isinstance(refused, InputError) and (place := _PLACE.fullmatch(refused.key)):
            labels = {column["key"]: column["label"] for column in self.columns}
            refused = refused.under(", ".join(filter(None, (place[1], labels.get(place[2])))))
        self.refused = str(refused or "")

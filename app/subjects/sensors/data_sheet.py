"""Rows of a data sheet, pasted on the page: their values go into the design, and each is told with its text."""

import panel as pn
import panel_material_ui as pmui

from app.declared import required
from app.document.blocks import Block, Bullets, Column, Text, numbers, table
from app.document.pane import html_of
from app.document.wording import entered, input_in_words
from app.session import Session
from app.ui.fields import TextArea
from app.ui.html_pane import html_pane
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.design.data_sheet import SheetValues, read_data_sheet
from nav_model.design.parts import declaration_of

_EXAMPLE = "Angle random walk 0.15 °/√h, bias instability 0.5 °/h, velocity random walk 0.06 m/s/√h"


class DataSheetBox(View):
    """A box for the rows, a button, and what was made of them."""

    session = required(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self.rows = TextArea(
            label="My IMU: rows of its data sheet", placeholder=_EXAMPLE, rows=3, max_length=5000,
            sizing_mode="stretch_width", margin=(12, 14, 4, 14),
        )  # fmt: skip
        self.fill = pmui.Button(label="Fill in", variant="contained", margin=(4, 14, 8, 14))
        self.fill.on_click(lambda _: self._take())
        self.answer = html_pane("", margin=(0, 14, 10, 14))
        self._view = pn.Column(self.rows, self.fill, self.answer)

    def _take(self) -> None:
        self.answer.object = fill_in(self.session, self.rows.value_input or self.rows.value or "")


def fill_in(session: Session, text: str) -> str:
    """Put the values of a data sheet's rows into the design; HTML of what was taken, and what was not understood."""
    try:
        values = read_data_sheet(text)
        problem = session.change(values.changes, values.written, values.origins) if values.changes else None
    except InputError as error:
        problem, values = error, SheetValues({}, {}, {}, ())
    return html_of(*([Text(f"Not filled in. {problem}")] if problem else _blocks(session, values)))


def _blocks(session: Session, values: SheetValues) -> list[Block]:
    blocks: list[Block] = []
    if values.changes:
        rows = (
            (str(declaration_of(key).label), entered(session.design, key),
             input_in_words(session.design, key, value), values.origins[key].partition(": ")[2])
            for key, value in values.changes.items()
        )  # fmt: skip
        heads = [Column("Input"), *numbers("As printed", "1σ per axis"), Column("From")]
        blocks.append(table("data-sheet", "Filled in. Undo reverts.", heads, rows))
    if values.rest or not values.changes:
        rest = values.rest or ("The text has no row with a name and a number.",)
        blocks.append(Bullets(rest, "Not understood"))
    return blocks

"""The control of one table: a box with its rows, such as "20 Hz 0.1 g; 80 Hz 0.02 g"."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
import param

from app.session import Session
from app.ui.input_box import InputBox
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.parts import declaration_of
from nav_model.design.rows import Rows


class RowsControl(InputBox):
    """The box of one table; empty, the table is not given."""

    explained = param.Boolean(default=False, doc="Whether the whole help line is shown.")

    def __init__(self, session: Session, key: str) -> None:
        declaration = declaration_of(key)
        assert isinstance(declaration, Rows)
        self._session, self._declaration = session, declaration
        box = pmui.TextInput(
            label=str(declaration.label),
            placeholder=declaration.example,
            margin=(10, 10, 0, 10),
            sizing_mode="stretch_width",
        )
        super().__init__(key, box)
        self.listen()

    def __panel__(self) -> pn.viewable.Viewable:
        return self.box

    def differs(self, old: Design, new: Design) -> bool:
        """Whether the table or its origin has changed."""
        return (old[self.key], old.origins.get(self.key)) != (new[self.key], new.origins.get(self.key))

    def show(self, design: Design) -> None:
        """Follow the current design."""
        self.follow()

    def value(self) -> object:
        """The current table."""
        return self._session.design[self.key]

    def text(self) -> str:
        """The current table as text."""
        return self._declaration.show(self._session.design[self.key])  # type: ignore[arg-type]

    def help(self) -> str:
        """Where the table came from and the declaration's help, if asked for."""
        if not self.explained:
            return ""
        origin = self._session.design.origins.get(self.key)
        return f"From: {origin}. {self._declaration.doc}" if origin else str(self._declaration.doc)

    @param.depends("explained", watch=True)
    def _explain(self) -> None:
        self.say()

    def take(self, text: str) -> InputError | None:
        """Put a text in force."""
        return self._session.change({self.key: self._declaration.read(text)})

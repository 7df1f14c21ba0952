"""Base of the design's inputs, and the plain ones: a choice and a table."""

from typing import Generic, TypeVar

from app.document.wording import entered
from app.session import Session
from app.ui.input_sheet import Row, SheetInput, choice_row, text_row
from nav_model.base.errors import InputError
from nav_model.design.declaration import Choice
from nav_model.design.table import Table

_D = TypeVar("_D")  # what declares the input


class DesignInput(SheetInput, Generic[_D]):
    """A row that shows an input of the session's design and changes it."""

    def __init__(self, session: Session, key: str, declared: _D) -> None:
        super().__init__(key)
        self.session, self._declared = session, declared

    def value(self) -> object:
        """The current value."""
        return self.session.design[self.key]

    def take(self, text: str) -> InputError | None:
        """Put a text in force."""
        return self.session.enter(self.key, text)


class ChoiceInput(DesignInput[Choice]):
    """A select, or a switch, for one choice."""

    def row(self) -> Row:
        """Its options; none for a switch."""
        declared = self._declared
        switch = isinstance(declared.default, bool)
        options = [] if switch else [(str(option), label) for option, label in declared.options.items()]
        return choice_row(str(declared.label), str(declared.doc), options)

    def current(self) -> Row:
        """The option in force, as the row's options have it."""
        value = self.value()
        return {"text": str(value).lower() if isinstance(value, bool) else str(value)}


class TableInput(DesignInput[Table]):
    """A box with the rows of one table, such as "20 Hz 0.1 g; 80 Hz 0.02 g"; empty, the table is not given."""

    def row(self) -> Row:
        """A box as wide as the sheet."""
        declared = self._declared
        return text_row(str(declared.label), str(declared.doc), empty=declared.example, wide=True)

    def current(self) -> Row:
        """The table as text, and where it came from."""
        design = self.session.design
        origin = design.origins.get(self.key)
        return {"text": entered(design, self.key), "note": f"From: {origin}." if origin else ""}

"""What the inputs of the design have in common, and the plain ones: a choice and a table."""

from abc import abstractmethod
from typing import Generic, TypeVar

from app.document.wording import entered
from app.session import Session
from app.ui.input_sheet import Row, SheetInput, choice_row, text_row
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import Choice
from nav_model.design.table import Table

_D = TypeVar("_D")  # what declares the input


class DesignInput(SheetInput, Generic[_D]):
    """A row that is told anew only when something in it has changed: at most steps of a slider nothing has."""

    def __init__(self, session: Session, key: str, declared: _D) -> None:
        super().__init__(key)
        self.session, self._declared = session, declared
        self._seen: object = None
        self._told: Row = {}

    @abstractmethod
    def seen(self, design: Design) -> object:
        """All of a design that the row shows."""

    @abstractmethod
    def told(self, design: Design) -> Row:
        """What the row shows of a design."""

    def value(self) -> object:
        """The current value."""
        return self.session.design[self.key]

    def shown(self) -> Row:
        """What the row shows now."""
        design = self.session.design
        if (seen := self.seen(design)) != self._seen:
            self._seen, self._told = seen, self.told(design)
        return self._told

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

    def seen(self, design: Design) -> object:
        """The option in force."""
        return design[self.key]

    def told(self, design: Design) -> Row:
        """The option in force, as the row's options have it."""
        value = design[self.key]
        return {"text": str(value).lower() if isinstance(value, bool) else str(value)}


class TableInput(DesignInput[Table]):
    """A box with the rows of one table, such as "20 Hz 0.1 g; 80 Hz 0.02 g"; empty, the table is not given."""

    def row(self) -> Row:
        """A box as wide as the sheet."""
        declared = self._declared
        return text_row(str(declared.label), str(declared.doc), empty=declared.example, wide=True)

    def seen(self, design: Design) -> object:
        """The table and its origin."""
        return design[self.key], design.origins.get(self.key)

    def told(self, design: Design) -> Row:
        """The table as text, and where it came from."""
        origin = design.origins.get(self.key)
        return {"text": entered(design, self.key), "note": f"From: {origin}." if origin else ""}

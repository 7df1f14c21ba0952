"""What every input of the design has in common: it follows the session's design, and puts changes into it."""

from abc import abstractmethod
from typing import Generic, TypeVar

from app.session import Session
from app.ui.input_sheet import Row, SheetInput
from nav_model.design import Design

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

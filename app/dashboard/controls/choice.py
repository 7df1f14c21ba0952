"""One choice of a design: a select, or a switch."""

from app.dashboard.controls.design_input import DesignInput
from app.ui.input_sheet import Row, choice_row
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import Choice


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

    def take(self, text: str) -> InputError | None:
        """Choose another."""
        return self.session.change({self.key: self._declared.read(text)})

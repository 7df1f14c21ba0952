"""One table of a design: a box with its rows, such as "20 Hz 0.1 g; 80 Hz 0.02 g"."""

from app.dashboard.controls.design_input import DesignInput
from app.ui.input_sheet import Row, text_row
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.table import Table


class TableInput(DesignInput[Table]):
    """The box of one table; empty, the table is not given."""

    def row(self) -> Row:
        """A box as wide as the sheet."""
        declared = self._declared
        return text_row(str(declared.label), str(declared.doc), empty=declared.example, wide=True)

    def seen(self, design: Design) -> object:
        """The table and its origin."""
        return design[self.key], design.origins.get(self.key)

    def told(self, design: Design) -> Row:
        """The table as text, and where it came from."""
        value, origin = design[self.key], design.origins.get(self.key)
        assert isinstance(value, tuple)
        return {"text": self._declared.show(value), "note": f"From: {origin}." if origin else ""}

    def take(self, text: str) -> InputError | None:
        """Put a text in force."""
        return self.session.change({self.key: self._declared.read(text)})

"""One number of a design: a data-sheet string, the same in other units, and for some a slider."""

from typing import Any

from app.dashboard.controls.design_input import DesignInput
from app.document.wording import entered
from app.session import Session
from app.ui.input_sheet import Row, text_row
from app.ui.log_scale import scale_of
from nav_model.base.errors import InputError
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.presets import entry_of, sheet_of


class QuantityInput(DesignInput[BaseQuantity[Any]]):
    """Box, units and perhaps slider of one quantity."""

    def __init__(self, session: Session, key: str, declared: BaseQuantity[Any]) -> None:
        super().__init__(session, key, declared)
        self._scale = scale_of(declared) if declared.slider else None

    def row(self) -> Row:
        """Label, help, units and the scale of the slider."""
        declared = self._declared
        sheet = declared.datasheet if declared.datasheet.startswith("Not ") else f"Data sheet: {declared.datasheet}"
        text = " ".join(part for part in (str(declared.doc), sheet, f"Typical: {declared.typical}.") if part)
        empty = declared.when_empty if declared.allow_None else ""
        return text_row(str(declared.label), text, declared.dimension, empty=empty, scale=self._scale)

    def current(self) -> Row:
        """The value in its unit, and where it came from."""
        design = self.session.design
        value, unit = design[self.key], design.unit(self.key)
        assert value is None or isinstance(value, float | int)
        mark, note = _source(design, self.key)
        row: Row = {"text": entered(design, self.key), "size": value, "unit": unit, "mark": mark, "note": note}
        if value is not None and (
            made := self._declared.conversion(value, design.written.get(self.key, ""), design.baseline)
        ):
            row |= {"note": f"{made}. {note}".strip(), "converted": True}
        if self._scale is not None:
            row["place"] = self._scale.ends[not self._scale.zero] if value is None else self._scale.place(value)
        return row

    def slide(self, place: float) -> InputError | None:
        """Apply a place of the slider, in the current unit."""
        assert self._scale is not None
        unit = self.session.design.unit(self.key)
        return self._change(self._scale.amount(place, unit, self._declared.dimension), unit)

    def turn_to(self, unit: str) -> InputError | None:
        """Show the value in another unit."""
        return self._change(self.session.design[self.key], unit)

    def _change(self, value: Value, unit: str) -> InputError | None:
        return self.session.change({self.key: value}, {self.key: unit} if unit else None)


def _source(design: Design, key: str) -> tuple[str, str]:
    """Where a value came from: a mark if there is something to heed, and the words."""
    mark, note = _against_catalogue(design, key)
    origin = f"From: {design.origins[key]}." if key in design.origins else ""
    return mark, f"{origin} {note}".strip()


def _against_catalogue(design: Design, key: str) -> tuple[str, str]:
    """Value of an input in the section's catalogue entry."""
    section, _, name = key.rpartition(".")
    entry = entry_of(design, section)
    if entry is None:
        return "", ""
    sheet = entry.extra.get(name)
    if sheet is not None:
        return "", f"{entry.name}'s sheet: {sheet.text} {sheet.kind}, not the residual."
    item = sheet_of(design, section).get(name)
    if item is None:
        missing = section == "imu" and name.endswith("random_walk")
        return ("?", f"Not on {entry.name}'s sheet: your value.") if missing else ("", "")
    if design[key] != item.value:
        return "≠", f"≠ {entry.name}: {item.text}"
    doubt = f"⚠ {item.status}{' source' if item.status == 'secondary' else ''}: "
    return ("", f"{item.source}.") if item.confirmed else ("⚠", f"{doubt}{item.source}.")

"""A catalogue unit or radar as the source of a section's values."""

from app.dashboard.controls.design_input import ChoiceInput, DesignInput
from app.document.wording import preset_name
from app.ui.input_sheet import Row, choice_row
from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry, catalogue, find
from nav_model.design.parts import declaration_of
from nav_model.design.presets import (
    SHEET_KEYS,
    deviations,
    entry_of,
    kind_of,
    preset_fill,
    preset_of,
    sheet_filled,
    sheet_origins,
    without_class,
)


class PresetInput(DesignInput[None]):
    """The catalogue, first in its section, with a button that restores the entry's values."""

    @property
    def section(self) -> str:
        """The section that it fills."""
        return self.key.partition(".")[0]

    def row(self) -> Row:
        """The entries of the catalogue."""
        entries = catalogue(kind_of(self.section)).values()
        options = [("", "none"), *((entry.name, _label(entry)) for entry in entries)]
        return {
            **choice_row(
                "Receiver class" if self.section == "gnss" else "From the catalogue", "", options, wide=True
            ),
            "restore": "Restore catalogue values",
        }

    def current(self) -> Row:
        """The entry; once edited it is no longer what the catalogue has."""
        design = self.session.design
        name, changed = preset_of(design, self.section) or "", len(deviations(design, self.section))
        entry = entry_of(design, self.section)
        return {
            "text": name,
            "named": preset_name(design, self.section) if changed else "",
            "said": f"{changed} value{'s' if changed > 1 else ''} changed." if changed else "",
            "note": entry.note if entry else "",
        }

    def take(self, text: str) -> InputError | None:
        """Fill the section from an entry, or leave its values without one; a receiver class goes with its values.

        Another IMU comes with its whole sheet, also where the one before was without.
        """
        if not text and self.section == "gnss":
            changes = without_class(self.session.design)
            return self.session.change(changes, dict.fromkeys(changes, ""))
        if not text:
            return self.session.change({self.key: None})
        design, origins = self.session.design, {}
        whole = design.imu.sheet or text != preset_of(design, "imu")
        values, units = preset_fill(self.section, text, design.baseline, sheet=whole)
        if self.section == "imu" and whole:
            values["imu.sheet"], origins = True, sheet_origins(find("imu", text))
        if self.section == "radar":
            extra = find("radar", text).extra
            values |= {f"flight.{key}": item.value for key, item in extra.items()}
            units |= {f"flight.{key}": item.unit for key, item in extra.items()}
        return self.session.change(values, units, origins)


class SheetChoice(ChoiceInput):
    """The switch that has the catalogue's unit fill the sensors' further errors; they go with it."""

    def take(self, text: str) -> InputError | None:
        """Fill them, or leave none."""
        whole, entry = self._declared.read(text), entry_of(self.session.design, "imu")
        if whole and entry is None:
            return InputError(self.key, "choose an IMU from the catalogue first")
        if not whole or entry is None:
            nothing = {key: declaration_of(key).default for key in SHEET_KEYS}
            return self.session.change({self.key: False, **nothing})
        values, units = sheet_filled(entry)
        return self.session.change({self.key: True, **values}, units, sheet_origins(entry))


def _label(entry: Entry) -> str:
    doubtful = "" if all(item.confirmed for item in entry.values.values()) else " ⚠"
    return f"{entry.name}{', ' + entry.grade if entry.grade else ''}{doubtful}"

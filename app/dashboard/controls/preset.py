"""The control for a catalogue unit or radar as source of a section's values."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
import param

from app.document.wording import preset_name
from app.session import Session
from nav_model.design import Design
from nav_model.design.catalogue import Entry, catalogue, find
from nav_model.design.presets import deviations, kind_of, preset_fill, preset_of


class PresetControl(pn.viewable.Viewer):
    """The catalogue, first in its section, with a button that restores the entry's values."""

    explained = param.Boolean(default=False, doc="Whether the catalogue's note is shown.")

    def __init__(self, session: Session, section: str) -> None:
        super().__init__()
        self._session = session
        self.section = section
        self.key = f"{section}.preset"
        entries = catalogue(kind_of(section))
        self._options: dict[str, str] = {"none": ""}
        self._options |= {_preset_label(entry): entry.name for entry in entries.values()}
        self.select = pmui.Select(
            label="From the catalogue", options=self._options, margin=(10, 10, 0, 10), sizing_mode="stretch_width"
        )
        self.restore = pmui.Button(
            label="Take the catalogue's values", variant="text", margin=(2, 10, 0, 10), visible=False
        )
        self.restore.on_click(lambda _: self._fill(preset_of(self._session.design, self.section) or ""))
        self.show(session.design)
        self.select.param.watch(self._chosen, "value")

    def __panel__(self) -> pn.Column:
        return pn.Column(self.select, self.restore)

    def differs(self, old: Design, new: Design) -> bool:
        """Whether the entry or the values that differ from it have changed."""
        return preset_of(old, self.section) != preset_of(new, self.section) or (
            deviations(old, self.section) != deviations(new, self.section)
        )

    def show(self, design: Design) -> None:
        """Follow the current design."""
        name = preset_of(design, self.section) or ""
        changed = len(deviations(design, self.section))
        entry = find("imu" if self.section == "imu" else "radar", name) if name else None
        options = self._options
        if changed:  # what was edited is no longer what the catalogue has
            options = {
                preset_name(design, self.section) if own == name else said: own for said, own in options.items()
            }
        if self.select.options != options:
            self.select.param.update(options=options, value=name)
            self.select.param.trigger("value")  # the browser knows the value by its label, which is another now
        self.select.value = name
        self.restore.visible = bool(changed)
        self.select.helper_text = _entry_help(entry, changed, self.explained) if entry else ""

    @param.depends("explained", watch=True)
    def _explain(self) -> None:
        self.show(self._session.design)

    def _chosen(self, event: param.parameterized.Event) -> None:
        if event.new != (preset_of(self._session.design, self.section) or ""):
            self._fill(event.new)

    def _fill(self, name: str) -> None:
        if not name:
            self._session.change({self.key: None})
            return
        values, units = preset_fill(self.section, name)
        if self.section == "radar":
            extra = find("radar", name).extra
            values |= {f"flight.{key}": item.value for key, item in extra.items()}
            units |= {f"flight.{key}": item.unit for key, item in extra.items()}
        self._session.change(values, units)


def _preset_label(entry: Entry) -> str:
    doubtful = "" if all(item.confirmed for item in entry.values.values()) else " ⚠"
    return f"{entry.name}{', ' + entry.grade if entry.grade else ''}{doubtful}"


def _entry_help(entry: Entry, changed: int, whole: bool) -> str:
    said = [f"{changed} value{'s' if changed > 1 else ''} changed." if changed else "", entry.note if whole else ""]
    return " ".join(part for part in said if part)

"""Additional inputs of a study on the Simulate page: one box per declaration, with units, folded.

Invalid text shows its message at the box; the last valid value is kept.
"""

from __future__ import annotations

from contextlib import suppress
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared
from app.document.blocks import Text
from app.document.pane import html_of
from app.ui.html_pane import html_pane
from nav_model.base.errors import InputError
from nav_model.simulation.study_inputs import STUDY_KEYS, STUDY_PARTS, SimulationInputs, read_study_inputs


class StudyControls(pn.viewable.Viewer):
    """The boxes; `texts` has the current values, which a line shows while the boxes are folded."""

    texts: dict[str, str] = declared(
        param.Dict(default={}, doc="Key -> text, of every box the last one that was good.")
    )

    def __init__(self) -> None:
        super().__init__()
        self.boxes: dict[str, pmui.TextInput] = {}
        self.given = html_pane("", margin=(0, 10))

    def __panel__(self) -> pn.Column:
        """The boxes, made when they are first looked at."""
        self.boxes = {key: self._box(key) for key in STUDY_KEYS}
        sections: list[Any] = []
        for part in STUDY_PARTS:
            own = [box for key, box in self.boxes.items() if key.startswith(f"{part.section}.")]
            sections += [html_pane(f"<h3>{escape(part.title)}</h3>", margin=(6, 8, 0, 8)), pn.FlexBox(*own)]
        return pn.Column(*sections)

    @property
    def inputs(self) -> SimulationInputs:
        """What is in force."""
        return read_study_inputs(self.texts)

    def take(self, texts: dict[str, str]) -> None:
        """Put texts in force, such as those of a link; what is not allowed stays out."""
        taken = {}
        for key, text in texts.items():
            with suppress(InputError):
                read_study_inputs({key: text})
                taken[key] = text
        if taken != self.texts:
            self.texts = taken
            for key, box in self.boxes.items():
                box.value = taken.get(key, "")

    def _box(self, key: str) -> pmui.TextInput:
        declared = STUDY_KEYS[key]
        box = pmui.TextInput(
            label=str(declared.label),
            value=self.texts.get(key, ""),
            placeholder="none" if declared.default is None else declared.show(declared.default),
            helper_text=str(declared.doc),
            margin=(8, 8, 2, 8),
            width=230,
        )
        box.param.watch(lambda event: self._typed(key, event.new), "value")
        return box

    def _typed(self, key: str, text: str) -> None:
        box, error = self.boxes[key], ""
        try:
            read_study_inputs({key: text})
        except InputError as refused:
            kept = self.texts.get(key, "") or box.placeholder
            error = f"{refused.reason}; still {kept}"
        else:
            others = {name: kept for name, kept in self.texts.items() if name != key}
            self.texts = {**others, key: text.strip()} if text.strip() else others
        box.error_state = bool(error)
        box.helper_text = error or str(STUDY_KEYS[key].doc)

    @param.depends("texts", watch=True)
    def _say(self) -> None:
        listed = ", ".join(
            f"{part.title.lower()}: {str(STUDY_KEYS[key].label).lower()} {text}"
            for part in STUDY_PARTS
            for key, text in self.texts.items()
            if text and key.startswith(f"{part.section}.")
        )
        self.given.object = html_of(Text(f"Added to the design: {listed}.")) if listed else ""

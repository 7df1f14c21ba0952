"""Additional inputs of a study on the Simulate page: a row per declaration, folded."""

from __future__ import annotations

from contextlib import suppress

import param

from app.declared import declared
from app.document.blocks import Text
from app.document.pane import html_of
from app.ui.html_pane import html_pane
from app.ui.input_sheet import Group, InputSheet, Row, SheetInput, text_row
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.simulation.study_inputs import STUDY_KEYS, STUDY_PARTS, SimulationInputs, read_study_inputs


class RunInput(SheetInput):
    """One input; an empty box means its default."""

    def __init__(self, controls: StudyControls, key: str) -> None:
        super().__init__(key)
        self._controls, self._declared = controls, STUDY_KEYS[key]

    def row(self) -> Row:
        """Label, help, and what an empty box means."""
        label, text = str(self._declared.label), str(self._declared.doc)
        return text_row(label, text, empty=self._usual)

    @property
    def _usual(self) -> str:
        default = self._declared.default
        return "none" if default is None else self._declared.show(default)

    def value(self) -> str:
        """The text in force."""
        return self._controls.texts.get(self.key, "")

    def current(self) -> Row:
        """The text in force."""
        return {"text": self.value()}

    def take(self, text: str) -> InputError | None:
        """Put a text in force."""
        try:
            read_study_inputs({self.key: text})
        except InputError as refused:
            return InputError(self.key, f"{refused.reason}; still {self.value() or self._usual}", text)
        others = {key: value for key, value in self._controls.texts.items() if key != self.key}
        self._controls.texts = {**others, self.key: text.strip()} if text.strip() else others
        return None


class StudyControls(View):
    """The sheet; `texts` has the current values, which a line shows while it is folded."""

    texts: dict[str, str] = declared(
        param.Dict(default={}, doc="Key -> text, of every box the last one that was good.")
    )

    def __init__(self) -> None:
        super().__init__()
        inputs = [RunInput(self, key) for key in STUDY_KEYS]
        self._view = self.sheet = InputSheet(
            [
                Group(part.title, [each for each in inputs if each.key.startswith(f"{part.section}.")])
                for part in STUDY_PARTS
            ],
            explained=True,
        )
        self.given = html_pane("", margin=(0, 10))

    @property
    def inputs(self) -> SimulationInputs:
        """Inputs in force."""
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

    @param.depends("texts", watch=True)
    def _say(self) -> None:
        listed = ", ".join(
            f"{part.title.lower()}: {str(STUDY_KEYS[key].label).lower()} {text}"
            for part in STUDY_PARTS
            for key, text in self.texts.items()
            if text and key.startswith(f"{part.section}.")
        )
        self.given.object = html_of(Text(f"Added to the design: {listed}.")) if listed else ""
        self.sheet.follow()

"""A box follows a value without lifting the write protection of every parameter they have.

panel-material-ui copies "value" to "value_input", which it protects, and to write that makes all fifty parameters
writable and protects them again: a twentieth of a slider's step.
Panel asks for each change whether and how the page may be told, which is known while changes are held: another.

Written for: Panel 1.9.4, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-23
Needless when: tests/app/upstream/test_prompt_input.py::test_as_shipped_every_parameter_is_touched fails
"""

from __future__ import annotations

import panel_material_ui as pmui
import param
from panel.io.state import state


class PromptInput(pmui.TextInput):
    """A box for text that a slider beside it may change."""

    value_input = param.String(
        default="", allow_None=True, readonly=False, constant=False, doc="The text as it is typed."
    )

    @param.depends("value", watch=True, on_init=True)
    def _sync_value_input(self) -> None:
        self.value_input = self.value  # type: ignore[has-type]

    def follow(self, text: str) -> None:
        """Show a text; in a hold only the browser is notified, not the watchers of the box."""
        if self.value == text:  # type: ignore[has-type]
            return
        document = state.curdoc
        if document is None or not document.callbacks.hold_value:
            with param.parameterized.batch_call_watchers(self):
                self.value = self.value_input = text
            return
        with param.parameterized.discard_events(self):
            self.value = self.value_input = text
        for ref, (model, _) in self._models.items():
            self._set_on_model({"value": text, "value_input": text}, state._views[ref][1], model.data)

"""A box and a switch follow a value without lifting the write protection of every parameter they have.

panel-material-ui copies "value" to "value_input" of a box, and its place to "active" of a switch. Both it protects,
and to write them makes all fifty parameters writable and protects them again: a twentieth of a slider's step each.
Panel asks for each change whether and how the page may be told, which is known while changes are held: another.

Written for: Panel 1.9.4, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-23
Needless when: tests/app/upstream/test_prompt_input.py::test_as_shipped_every_parameter_is_touched fails
"""

from __future__ import annotations

from typing import Any

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


class PromptSwitch(pmui.RadioButtonGroup):
    """A switch whose words may change with every step of a slider.

    The browser knows the value by its words, so it is told the value again with new ones.
    """

    active = param.Integer(default=None, readonly=False, constant=False, doc="Place of the value among the options.")

    @param.depends("value", "options", watch=True, on_init=True)
    def _sync_active(self) -> None:
        values = self.values
        self.active = values.index(self.value) if self.value in values else None

    def _process_param_change(self, params: dict[str, Any]) -> dict[str, Any]:
        again = {"value": self.value} if "options" in params else {}
        changed: dict[str, Any] = super()._process_param_change({**params, **again})
        return changed

"""A slider's steps reach the server at once, and once.

Panel waits 50 ms with each change, hears every step twice (as "value" and as "value_throttled"), and turns the busy
flag of the whole server on and off for it, which nothing here shows.

Written for: Panel 1.9.4, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_prompt_slider.py::test_as_shipped_a_step_waits_and_comes_twice fails
"""

from __future__ import annotations

from typing import ClassVar

import panel_material_ui as pmui


class PromptSlider(pmui.FloatSlider):
    """A slider that is followed step by step."""

    _priority_changes: ClassVar[list[str]] = ["value"]
    _busy__ignore: ClassVar[list[str]] = ["value"]

    @property
    def _linked_properties(self) -> tuple[str, ...]:
        """What is heard of the browser."""
        return ("value",)

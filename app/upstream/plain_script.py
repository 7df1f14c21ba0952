"""A component's script is sent to the browser as it is written, and its messages are dealt with alone.

Panel compiles every script there as if it were TypeScript: half a second of an opening page, for plain JavaScript.
What it takes for a bundle it leaves alone. And for each message it turns the busy flag of the whole server on and
off, which nothing here shows, and makes every parameter writable for as long: a seventh of a slider's step.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_plain_script.py::test_as_shipped_a_script_is_compiled_in_the_browser fails
"""

from __future__ import annotations

import hashlib
from typing import Any

from panel.custom import JSComponent
from panel.io.state import set_curdoc


class PlainScript(JSComponent):
    """A component whose ``_esm`` is plain JavaScript."""

    def _get_properties(self, doc: Any) -> dict[str, Any]:
        found: dict[str, Any] = super()._get_properties(doc)
        return {**found, "bundle": hashlib.sha256(found["esm"].encode()).hexdigest()}

    def _process_bokeh_event(self, doc: Any, event: Any) -> None:
        with set_curdoc(doc):
            self._process_event(event)

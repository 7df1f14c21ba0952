"""A component's script is sent to the browser as it is written, and its messages are dealt with alone.

What Panel takes for a bundle it does not compile in the browser.

Reports to send upstream, versions and ends: docs/upstream/plain_script.md
"""

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

"""A component's script is sent to the browser as it is written.

What Panel takes for a bundle it does not compile in the browser.

Reports to send upstream, versions and ends: docs/upstream/plain_script.md
"""

import hashlib
import inspect
from pathlib import Path
from typing import Any, ClassVar

from panel.custom import JSComponent


class PlainScript(JSComponent):
    """A component whose script is the file beside its module, and so is its style sheet, where there is one."""

    _before: ClassVar[str] = ""
    """Goes before the script."""
    _stylesheets: ClassVar[list[str]] = []
    """Go before its own."""

    def __init_subclass__(cls) -> None:
        script = Path(inspect.getfile(cls)).with_suffix(".js")
        if script.exists():
            cls._esm = cls._before + script.read_text("utf-8")
        if (sheet := script.with_suffix(".css")).exists():
            cls._stylesheets = [*cls._stylesheets, sheet.read_text("utf-8")]

    def _get_properties(self, doc: Any) -> dict[str, Any]:
        properties: dict[str, Any] = super()._get_properties(doc)
        return {**properties, "bundle": hashlib.sha256(properties["esm"].encode()).hexdigest()}

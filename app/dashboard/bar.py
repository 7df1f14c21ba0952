"""The bar on top of the page, drawn by the browser: name, design, tabs, tools. `app.dashboard.toolbar` handles its
buttons.

It is one custom component: with widgets of the component library it took a third of the time to the first view.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import param

from app.ui.theme import BASE, FIND, PRINT_NOTHING
from app.upstream.plain_script import PlainScript

_KINDS = {
    "toml": "application/toml",
    "html": "text/html",
    "pdf": "application/pdf",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
}


class HeaderBar(PlainScript):
    """The bar; ``on_event`` takes each action of the user, with a dict that has the action's name under "do"."""

    named = param.String(doc="Name of the design, which a person can change here.")
    description = param.String(doc="What its author says of the design, which a person can change here.")
    tabs = param.List(default=[], doc="Group, title and address of each tab.")
    active = param.Integer(default=0, doc="Index of the tab in view.")
    can_undo = param.Boolean(default=False)
    can_redo = param.Boolean(default=False)
    link = param.String(doc="The design in force and the study beside it, as a link's query.")
    examples = param.List(default=[], doc="Key, name and description of each design to start from.")
    most = param.Integer(default=0, doc="Bytes of the largest design file that is taken.")
    studies = param.List(default=[], doc="Dicts of kind, label, ticked: the finished studies a report may hold.")
    left_out = param.String(doc="What a report written now would lack.")
    writing = param.String(doc="What is being written; empty: nothing.")
    display = param.String(doc='How figures are told, such as "95.si"; empty: as usual.')

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]
    _before = FIND

    def __init__(self, on_event: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(**params)
        self._on_event = on_event

    def give(self, name: str, data: bytes) -> None:
        """Have the browser save a file."""
        self._send_msg({"file": name, "kind": _KINDS.get(name.rpartition(".")[2], "text/plain"), "data": data})

    def _handle_msg(self, msg: Any) -> None:
        if isinstance(msg, dict) and isinstance(msg.get("do"), str):
            self._on_event(msg)

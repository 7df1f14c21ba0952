"""The choice of comparison: the value before the last change, a saved design, a file, or nothing."""

import asyncio
from functools import partial
from typing import Any, ClassVar

import panel as pn
import param

from app.document.wording import shortened
from app.report.inputs import input_text
from app.session import Compared, Session
from app.ui.theme import BASE, PRINT_NOTHING
from app.upstream.plain_script import PlainScript
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.file import MAX_BYTES, parse_design
from nav_model.design.parts import INPUTS

_MOST = 100  # designs offered, the last saved first


class ComparisonChoice(PlainScript):
    """The line with the compared design, a button to clear it, and others to choose."""

    compared = param.String(doc="Name of what is compared; empty: nothing.")
    saved = param.List(default=[], doc="Pairs of key and name of the saved designs.")
    problem = param.String(doc="Why the last choice was not taken.")
    most = param.Integer(default=MAX_BYTES, doc="Bytes of the largest file.")

    _stylesheets: ClassVar[list[str]] = [BASE, PRINT_NOTHING]

    def __init__(self, session: Session) -> None:
        super().__init__(sizing_mode="stretch_width", margin=(8, 10, 0, 10))
        self._session = session
        session.param.watch(self._follow, "compared")

    def _follow(self, event: Any) -> None:
        name = event.new.name or _before(event.new.budget.design, self._session.design) if event.new else ""
        if self.compared != name:
            self.compared = name

    def _handle_msg(self, msg: Any) -> None:
        deed = msg.get("do") if isinstance(msg, dict) else None
        self.problem = ""
        match deed:
            case "clear":
                self._session.compare(None)
            case "changes":
                self._session.compare_with_changes()
            case "list":
                pn.state.execute(self._list)
            case "saved":
                pn.state.execute(partial(self._take_saved, str(msg.get("key"))))
            case "file":
                self._take_file(msg.get("data"), str(msg.get("name", "file")))

    async def _list(self) -> None:
        from app.library.place import library

        try:
            designs = await asyncio.to_thread(lambda: library().designs())
        except InputError as error:
            self.problem = str(error)
            return
        self.saved = [(design.key, design.name) for design in designs[:_MOST]]

    async def _take_saved(self, key: str) -> None:
        from app.library.place import library
        from app.library.store import fly_ahead

        try:
            revision = await asyncio.to_thread(lambda: library().revision(key))
            await fly_ahead((revision,))
            self._session.compare(Compared(revision.budget(), revision.name))
        except InputError as error:
            self.problem = f"Not compared. {error}"

    def _take_file(self, data: Any, name: str) -> None:
        if not isinstance(data, bytes) or len(data) > MAX_BYTES:
            self.problem = f"Not compared. {name} is too large for a design file."
            return
        try:
            design = parse_design(data, name)
            self._session.compare(Compared(analyse(design), design.name or name))
        except InputError as error:
            self.problem = f"Not compared. {error}"


def _before(old: Design, new: Design) -> str:
    """Name of a design before a change: the value of the one input that is another now."""
    changed = [
        (part, name)
        for part, names in INPUTS.items()
        for name in names
        if old[f"{part}.{name}"] != new[f"{part}.{name}"]
    ]
    if len(changed) != 1:
        return "the previous version"
    ((section, name),) = changed
    return shortened(f"{INPUTS[section][name].label} {input_text(old, section, name) or 'not given'}", 100)

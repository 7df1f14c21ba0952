"""What the three parts of the Review page share: the library, who is at the desk, what they picked."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from html import escape
from typing import Any, TypeVar

import panel as pn
import panel_material_ui as pmui
import param

from app.library.place import library
from app.library.reviews import MAX_ITEMS
from app.library.store import Library, Revision
from app.session import Session
from app.ui.html_pane import html_pane
from nav_model.errors import InputError

_T = TypeVar("_T")

LOOK: dict[str, Any] = {"description": "", "size": "small", "margin": (4, 6)}
"""Of every field."""
BUTTON: dict[str, Any] = {"description": "", "size": "small", "variant": "outlined", "margin": (6, 6)}
"""Of every button."""


class Desk(param.Parameterized):
    """``picked`` are revisions in the order they were picked, at most `MAX_ITEMS`; ``base`` is the revision that
    the design in force came from, if any."""

    picked: tuple[Revision, ...] = param.ClassSelector(class_=tuple, default=())
    base: Revision | None = param.ClassSelector(class_=Revision, default=None)

    def __init__(self, session: Session) -> None:
        super().__init__(base=session.lineage.base)
        self.session = session
        user = pn.state.user
        known = user if user and user != "guest" else ""
        self._known = known
        self.author = pmui.TextInput(
            label="Your name",
            value=known,
            disabled=bool(known),
            max_length=100,
            width=260,
            **{**LOOK, "margin": (14, 10, 4, 10)},
        )
        self._said = html_pane("", margin=(2, 10))
        # A revision is the base of its own changes only: another design put in force, by undo as well, has another.
        session.param.watch(lambda event: setattr(self, "base", event.new.base), "lineage")
        self.param.watch(lambda event: session.came_from(event.new), "base")
        self.notice = self._said

    @property
    def who(self) -> str:
        """The name to write under what is done here: of whoever is logged in, else as typed.

        Never the field's value where there is a login: a browser can change a field that is shown disabled.
        """
        return self._known or self.author.value or ""

    def say(self, message: str, *, wrong: bool = False) -> None:
        """Tell the person at the desk; read aloud by screen readers."""
        css, mark = ("bad", "✗") if wrong else ("good", "✓")
        said = f'<p><span aria-hidden="true">{mark}</span> {escape(message)}</p>'
        self._said.object = f'<div class="strip {css}" role="status">{said}</div>' if message else ""

    async def ask(self, work: Callable[[Library], _T], before: str = "") -> _T | None:
        """Do something with the library outside the event loop, which must not wait for a database; what is wrong is
        said, with ``before`` in front, and None comes back."""
        try:
            return await asyncio.to_thread(lambda: work(library()))
        except InputError as error:
            self.say(f"{before}{error}", wrong=True)
            return None

    def pick(self, revision: Revision) -> None:
        """Pick a revision, unless as many are as go side by side."""
        left = self._without(revision.key)
        if len(left) >= MAX_ITEMS:
            self.say(f"At most {MAX_ITEMS} revisions go side by side; put one back first.", wrong=True)
            return
        self.picked = (*left, revision)

    def put_back(self, key: str) -> None:
        """Put a picked revision back."""
        self.picked = self._without(key)

    def _without(self, key: str) -> tuple[Revision, ...]:
        return tuple(own for own in self.picked if own.key != key)


def button(label: str, action: Callable[[], Awaitable[None]], **params: Any) -> pmui.Button:
    """A button that does something in its own time."""

    async def clicked(_: Any) -> None:
        await action()

    made = pmui.Button(label=label, **{**BUTTON, **params})
    made.on_click(clicked)
    return made

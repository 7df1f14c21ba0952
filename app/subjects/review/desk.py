"""Shared state of the three parts of the Review page: library, user, and picked revisions."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from typing import Any, TypeVar

import panel_material_ui as pmui
import param

from app.declared import declared, required
from app.document.blocks import Answer, Bullets
from app.document.pane import html_of
from app.document.wording import shortened
from app.library.place import library
from app.library.reviews import MAX_ITEMS
from app.library.store import Library, Revision
from app.library.texts import LIMITS
from app.session import Session
from app.ui.author import author_field
from app.ui.downloads import download, run_download
from app.ui.html_pane import html_pane
from app.ui.remembered import NAME_COOKIE, Remembered, login
from nav_model.base.errors import InputError

_T = TypeVar("_T")

LOOK: dict[str, Any] = {"margin": (4, 6)}
"""Of every field."""
BUTTON: dict[str, Any] = {"variant": "outlined", "margin": (6, 6)}
"""Of every button."""


_SPOKEN = {"review", *LIMITS}
"""Keys of messages that need no key in front: they name what they are about."""


class Desk(param.Parameterized):
    """The user, the chosen revisions, and messages."""

    session = required(Session)
    picked: tuple[Revision, ...] = declared(
        param.ClassSelector(
            class_=tuple, default=(), doc=f"Revisions in the order they were picked, at most {MAX_ITEMS}."
        )
    )

    def __init__(self, session: Session) -> None:
        self._login = login()
        super().__init__(session=session)
        self.memory = Remembered(NAME_COOKIE, "" if self._login else session.param.author)
        self.name_field = author_field(session, self._login, **{**LOOK, "margin": (14, 10, 4, 10)})
        self.notice = html_pane("", margin=(2, 10))

    @property
    def base(self) -> Revision | None:
        """The revision that the design in force came from, if any; another design, by undo as well, has another."""
        base: Revision | None = self.session.lineage.base
        return base

    @property
    def who(self) -> str:
        """The user's name for records: of the login, otherwise as typed.

        Never the field's value where there is a login: a browser can change a field that is shown disabled.
        """
        return self._login or self.session.author or ""

    def say(self, message: str, *, wrong: bool = False) -> None:
        """Show a message; screen readers read it aloud."""
        answer = Answer("", "bad" if wrong else "open", (f"{'✗' if wrong else '✓'} {message}",))
        self.notice.object = html_of(answer) if message else ""

    async def ask(self, work: Callable[[Library], _T], before: str = "") -> _T | None:
        """Do something with the library outside the event loop, which must not wait for a database; what is wrong is
        said, with ``before`` in front, and None comes back."""
        try:
            return await asyncio.to_thread(lambda: work(library()))
        except InputError as error:
            reason = f"{error.reason[:1].upper()}{error.reason[1:]}" if error.key in _SPOKEN else str(error)
            self.say(f"{before}{reason}", wrong=True)
            return None

    def pick(self, wanted: Sequence[Revision]) -> None:
        """Pick revisions in this order, no more than go side by side."""
        if len(wanted) > MAX_ITEMS:
            self.say(f"At most {MAX_ITEMS} revisions fit side by side. Clear one first.", wrong=True)
        self.picked = tuple(wanted[:MAX_ITEMS])

    def report_buttons(
        self, stem: str, label: str, write: Callable[[str], Awaitable[bytes]], **params: Any
    ) -> tuple[pmui.FileDownload, ...]:
        """Buttons for a report in either kind of file; `write` makes its bytes for a suffix such as ``.pdf``."""
        return tuple(
            download(
                f"{label} ({suffix[1:].upper()})",
                f"{stem}{suffix}",
                run_download(self.session.new_run(), partial(write, suffix)),
                **BUTTON | params,
            )
            for suffix in (".html", ".pdf")
        )


def button(label: str, action: Callable[[], Awaitable[None]], **params: Any) -> pmui.Button:
    """A button with an asynchronous action; one pressed too late, when it is disabled, does nothing."""

    async def clicked(pressed: Any) -> None:
        if not pressed.obj.disabled:
            await action()

    return pmui.Button(label=label, on_click=clicked, **{**BUTTON, **params})


def listed(revisions: tuple[Revision, ...], caption: str) -> str:
    """HTML of revisions side by side, each under the label it has there."""
    items = (f"D{i}: {shortened(r.name, 60)}, revision {r.number}, by {r.author}" for i, r in enumerate(revisions, 1))
    return html_of(Bullets(tuple(items), caption))

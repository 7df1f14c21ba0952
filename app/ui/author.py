"""The name of whoever saves, signs and keeps: typed once for all pages, where no login gives it."""

from typing import Any

from app.session import Session
from app.ui.fields import TextInput


def author_field(session: Session, login: str, **look: Any) -> TextInput:
    """The field of the name; of a login it is shown alone."""
    return TextInput.from_param(
        session.param.author,
        label="Your name",
        description="",
        disabled=bool(login),
        max_length=100,
        width=260,
        **look,
    )

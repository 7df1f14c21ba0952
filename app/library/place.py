"""The library of this process. It is opened at the first use, as a visitor who only looks at a budget needs none."""

import threading
from pathlib import Path

from app.library.store import Library

_lock = threading.Lock()
_address = ""
_library: Library | None = None


def default_address() -> Path:
    """The default library: a file in the user's data folder."""
    from platformdirs import user_data_path

    return user_data_path("navbudget", appauthor=False) / "library.db"


def use_library(address: str) -> None:
    """Use the library at a path or database URL from now on; the empty address is the default."""
    global _address, _library
    with _lock:
        if _library is not None:
            _library.close()
        _address, _library = address, None


def look_at(address: str) -> str:
    """A caution about a library before its first use: that it is read-only; empty if there is none.

    The default address is checked only if a file exists, so that nothing is written before it is needed.

    Raises
    ------
    InputError
        If it cannot be opened.
    """
    if not address and not default_address().exists():
        return ""
    opened = Library(address or default_address())
    try:
        return "the library is read-only: its file or folder cannot be written" if opened.read_only else ""
    finally:
        opened.close()


def library() -> Library:
    """The library in use, opened at the first call.

    Raises
    ------
    InputError
        If it cannot be opened; the next call tries again.
    """
    global _library
    with _lock:
        if _library is None:
            _library = Library(_address or default_address())
        return _library

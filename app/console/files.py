"""Atomic writing of files: a reader sees the old file or the new one, never half of it."""

import argparse
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from app.console.ending import is_of_surroundings
from nav_model.base.errors import InputError


@contextmanager
def whole_file(target: Path) -> Iterator[BinaryIO]:
    """A temporary file beside `target` that replaces it if the block succeeds, and is deleted otherwise.

    Where `target` is a link, its target is replaced. A device or a pipe, such as /dev/null, is written to.

    Raises
    ------
    InputError
        Under ``-o``, when the folder is missing or refuses, or `target` is a folder. The folder is tried first,
        before the work inside the block is done.
    OSError
        For a fault of the surroundings, such as a full disk.
    """
    if not target.parent.is_dir():
        raise InputError("-o", f"{str(target.parent)!r} is not a folder; the file cannot be written there")
    if target.is_dir():
        raise InputError("-o", f"{str(target)!r} is a folder; name a file in it")
    if target.exists() and not target.is_file():
        with _converted(target), target.open("wb") as device:
            yield device
        return
    target = target.resolve()
    draft = target.parent / f".{target.name[:100]}.{secrets.token_hex(6)}.part"
    with _converted(target):
        try:
            with draft.open("xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            draft.replace(target)
        finally:
            draft.unlink(missing_ok=True)


def spare_what_is_read(options: argparse.Namespace) -> None:
    """Refuse to write the result over a file that any other argument of the command names, or standard input is.

    Raises
    ------
    InputError
        Under ``-o`` or ``--save``.
    """
    given = vars(options)
    for option, name in (("-o", "output"), ("--save", "save")):
        target = Path(given.get(name) or "")
        words = [
            "/dev/stdin" if word == "-" else word
            for other, value in given.items()
            if other != name
            for word in (value if isinstance(value, list | tuple) else [value])
        ]
        if target.is_file() and any(
            isinstance(word, str | Path) and Path(word).is_file() and target.samefile(word) for word in words
        ):
            raise InputError(option, f"{str(target)!r} is the file that was read; name another")


@contextmanager
def _converted(target: Path) -> Iterator[None]:
    """Convert faults of writing to the errors of `whole_file`."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        if is_of_surroundings(error):
            error.filename = error.filename or str(target)
            raise
        raise InputError("-o", f"{str(target)!r} cannot be written: {error.strerror or error}") from error

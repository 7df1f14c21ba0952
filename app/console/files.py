"""Atomic writing of files: a reader sees the old file or the new one, never half of it."""

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
        with _told_of(target), target.open("wb") as device:
            yield device
        return
    target = target.resolve()
    draft = target.parent / f".{target.name[:100]}.{secrets.token_hex(6)}.part"
    with _told_of(target):
        try:
            with draft.open("xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            draft.replace(target)
        finally:
            draft.unlink(missing_ok=True)


def spare(source: str, target: Path | None, option: str) -> None:
    """Refuse to write the result over the file that it is made from; InputError under the option."""
    if target is not None and target.exists() and Path(source).exists() and target.samefile(source):
        raise InputError(option, f"{str(target)!r} is the file that was read; name another")


@contextmanager
def _told_of(target: Path) -> Iterator[None]:
    """Convert faults of writing to the errors of `whole_file`."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        if is_of_surroundings(error):
            raise
        raise InputError("-o", f"{str(target)!r} cannot be written: {error.strerror or error}") from error


def put_file(target: Path, data: bytes) -> None:
    """Write `data` to `target`, completely or not at all; raises as `whole_file`."""
    with whole_file(target) as file:
        file.write(data)

"""A file that is there whole or not at all."""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from nav_model.inputs import DesignError


@contextmanager
def whole_file(target: Path, option: str = "-o") -> Iterator[BinaryIO]:
    """Open a draft beside `target`; it takes the target's place when the block ends without an error.

    The draft is opened at once, so that a folder that refuses is known before the work is done.

    Raises
    ------
    DesignError
        Under `option`, when the file cannot be written.
    """
    folder = target.parent
    if not folder.is_dir():
        raise DesignError(option, f"{str(folder)!r} is not a folder; nothing can be written there")
    if target.is_dir():
        raise DesignError(option, f"{str(target)!r} is a folder; name a file in it")
    draft = folder / f".{target.name[:100]}.{secrets.token_hex(6)}.part"
    try:
        with draft.open("xb") as file:
            yield file
        draft.replace(target)
    except OSError as error:
        raise DesignError(option, f"{str(target)!r} cannot be written: {error.strerror or error}") from error
    finally:
        draft.unlink(missing_ok=True)

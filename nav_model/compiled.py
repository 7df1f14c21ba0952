"""One decorator for every compiled kernel."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_ROOMS = ("earth", "simulation", "suborbital")  # whose kernels call each other across files


@cache
def room_digest() -> str:
    """SHA-256 over the constants and every file whose kernels call each other: the identity of the compiled code."""
    digest = hashlib.sha256()
    here = Path(__file__)
    rooms = (path for room in _ROOMS for path in sorted((here.parent / room).glob("*.py")))
    for path in (here, here.with_name("constants.py"), *rooms):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def kernel(function: F) -> F:
    """Compile `function` with Numba: cached on disk, without the interpreter lock, IEEE arithmetic.

    Numba invalidates a cached kernel when its own file changes, but not when a kernel it calls (in
    another file) does. Stamping every kernel with the digest of these rooms closes that hole.
    Where no directory is writable the kernel is compiled for this process only.
    """
    try:
        compiled: Any = njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
        return cast(F, njit(nogil=True, error_model="numpy")(function))
    index = compiled._cache._cache_file
    index._source_stamp = (index._source_stamp, room_digest())
    return cast(F, compiled)

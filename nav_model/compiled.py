"""One decorator for every compiled kernel.

Numba compiles a cached kernel again when its own file has changed, but not when a kernel that it calls, in another
file, has: results would come from code that no longer exists. Each kernel here carries the digest of all their files,
through two private names of Numba's.

Written for: numba 0.68.1
Upstream: numba/numba#8396 (open), numba/numba#1833
Needless when: tests/nav_model/test_compiled.py::test_as_shipped_a_changed_callee_goes_unnoticed fails
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

_ROOMS = ("earth", "simulation")  # whose kernels call each other across files


@cache
def room_digest() -> str:
    """SHA-256 over every source file whose kernels call each other: the identity of the compiled code."""
    digest = hashlib.sha256()
    here = Path(__file__)
    for path in (here, *(path for room in _ROOMS for path in sorted((here.parent / room).glob("*.py")))):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def kernel(function: F) -> F:
    """Compile `function` with Numba: cached on disk, without the interpreter lock, IEEE arithmetic.

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

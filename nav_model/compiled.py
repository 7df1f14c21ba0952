"""Two decorators for compiled code: `kernel` for what Python calls, `part` for what only kernels call.

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

import numba

F = TypeVar("F", bound=Callable[..., Any])

_njit: Any = numba.njit  # Numba's types know not all of its options
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
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
    """Compile `function` with Numba for calls from Python: cached on disk, no interpreter lock, IEEE arithmetic.

    Where no directory is writable the kernel is compiled for this process only.
    """
    try:
        compiled: Any = _njit(cache=True, nogil=True, **_OPTIONS)(function)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
        return cast(F, _njit(nogil=True, **_OPTIONS)(function))
    index = compiled._cache._cache_file
    index._source_stamp = (index._source_stamp, room_digest())
    return cast(F, compiled)


def part(function: F) -> F:
    """Compile `function` for kernels alone to call: it becomes part of theirs, in memory and on disk.

    Python cannot call it. Without the code that would let it, and without a file, it compiles in half the time.
    """
    return cast(F, _njit(no_cpython_wrapper=True, **_OPTIONS)(function))

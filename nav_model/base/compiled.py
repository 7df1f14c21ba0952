"""Two decorators for compiled code: `kernel` for functions that Python calls, `part` for those that only kernels
call.

Numba compiles a cached kernel again when its own file has changed, but not when a kernel that it calls, in another
file, has: results would come from code that no longer exists. Each kernel here carries the digest of all their files,
through two private names of Numba's. And processes that need the same kernel at once would each compile it: here one
does, while the others wait and then load what it wrote. The lock is `flock`'s, which the system releases even where a
process dies; Windows has none and is not supported. A file that is damaged (Numba does not wait for the disk, so one
may be empty after a loss of power) is removed and written anew; where the disk takes nothing it stays in memory.

Report to send upstream, version and end: docs/upstream/compiled.md
"""

import fcntl
import hashlib
import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock

from nav_model.base import numba_typing

F = TypeVar("F", bound=Callable[..., Any])

_njit: Any = numba.njit  # Numba's types know not all of its options
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
_DAMAGED = (
    EOFError, pickle.UnpicklingError, AttributeError, ImportError, IndexError, KeyError, TypeError, ValueError
)  # fmt: skip
"""Exceptions of reading a pickle that is cut off or overwritten."""
_locked: set[Path] = set()  # directories that this process is compiling into
_ROOMS = ("earth", "simulation", "suborbital")  # whose kernels call each other across files


numba_typing.remember()


@cache
def room_digest() -> str:
    """SHA-256 over the constants and every file whose kernels call each other: the identity of the compiled code."""
    digest = hashlib.sha256()
    here = Path(__file__)
    rooms = (path for room in _ROOMS for path in sorted((here.parents[1] / room).glob("*.py")))
    for path in (here, here.with_name("constants.py"), *rooms):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


class _KernelCache(FunctionCache):
    """Numba's cache of one kernel on the disk, stamped with the digest of all kernels' files."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file._source_stamp = (self._cache_file._source_stamp, room_digest())

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Load the code compiled for a signature; None where there is none; a damaged index is removed."""
        try:
            return super().load_overload(signature, target)  # type: ignore[no-untyped-call]
        except _DAMAGED:
            with suppress(OSError):  # a folder that others own
                Path(self._cache_file._index_path).unlink()
            return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep what was compiled, where the disk takes it."""
        with suppress(OSError, *_DAMAGED):
            super().save_overload(signature, compiled)  # type: ignore[no-untyped-call]


def _one_process_at_a_time(compile_: Callable[..., Any], directory: Path) -> Callable[..., Any]:
    """`compile_`, which loads from `directory` or compiles into it, behind a lock on a file there.

    The lock of this process is taken first, always in this order. It may be held already: a kernel is compiled while
    a caller of it in the same directory is, whose lock on the file then serves both.
    """

    @wraps(compile_)
    def locked(signature: Any) -> Any:
        with global_compiler_lock:
            if directory in _locked:
                return compile_(signature)
            try:
                directory.mkdir(parents=True, exist_ok=True)
                file = (directory / "compiling.lock").open("w")
            except OSError:  # a full disk: nothing will be kept there either
                return compile_(signature)
            with file:
                fcntl.flock(file, fcntl.LOCK_EX)  # released as the file is closed
                _locked.add(directory)
                try:
                    return compile_(signature)
                finally:
                    _locked.remove(directory)

    return locked


def kernel(function: F) -> F:
    """Compile `function` with Numba for calls from Python: cached on disk, no interpreter lock, IEEE arithmetic.

    Where no directory is writable the kernel is compiled for this process only.
    """
    compiled: Any = _njit(nogil=True, **_OPTIONS)(function)
    try:
        compiled._cache = _KernelCache(function)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
        return cast(F, compiled)
    compiled.compile = _one_process_at_a_time(compiled.compile, Path(compiled.stats.cache_path))
    return cast(F, compiled)


def part(function: F) -> F:
    """Compile `function` for kernels to call: it becomes part of theirs, in memory and on disk, and has no file."""
    return cast(F, _njit(**_OPTIONS)(function))

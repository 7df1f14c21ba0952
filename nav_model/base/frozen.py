"""Mappings that cannot be changed and that pickle; values computed on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Generic, TypeVar

_T = TypeVar("_T")
_K = TypeVar("_K")
_V = TypeVar("_V")


class FrozenMapping(Mapping[_K, _V]):
    """A copy of `content` that can be read only.

    As `types.MappingProxyType`, but it pickles, and its content cannot be changed through another name.

    >>> shares = FrozenMapping({"gyro noise": 1.0})
    >>> shares["gyro noise"]
    1.0
    >>> shares == {"gyro noise": 1.0}
    True
    """

    __slots__ = ("_content",)

    def __init__(self, content: Mapping[_K, _V]) -> None:
        self._content = dict(content)

    def __getitem__(self, key: _K) -> _V:
        return self._content[key]

    def __iter__(self) -> Iterator[_K]:
        return iter(self._content)

    def __len__(self) -> int:
        return len(self._content)

    def __repr__(self) -> str:
        return f"FrozenMapping({self._content!r})"


class Once(Generic[_T]):
    """A value that is computed once, at the first call. Unlike `functools.cache`, it pickles.

    >>> once = Once(lambda: print("worked out"))
    >>> once()
    worked out
    >>> once()
    """

    def __init__(self, work_out: Callable[[], _T]) -> None:
        self._work_out = work_out

    @cached_property
    def _found(self) -> _T:
        return self._work_out()

    def __call__(self) -> _T:
        return self._found


class Later(FrozenMapping[_K, _V]):
    """A `FrozenMapping` that is computed when it is first read; pickling computes it too.

    Parameters
    ----------
    work_out : callable
        To the content; called once at most.

    Examples
    --------
    >>> shares = Later(lambda: {"gyro noise": 1.0})
    >>> shares["gyro noise"]
    1.0
    >>> shares == {"gyro noise": 1.0}
    True
    """

    def __init__(self, work_out: Callable[[], Mapping[_K, _V]]) -> None:
        self._work_out = work_out

    @cached_property
    def _content(self) -> dict[_K, _V]:  # type: ignore[override]  # in place of the slot
        return dict(self._work_out())

    def __reduce__(self) -> tuple[type[FrozenMapping[_K, _V]], tuple[dict[_K, _V]]]:
        return FrozenMapping, (dict(self),)

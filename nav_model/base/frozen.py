"""Mappings that cannot be changed and that pickle."""

from collections.abc import Iterator, Mapping
from typing import TypeVar

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

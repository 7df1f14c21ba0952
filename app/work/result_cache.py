"""A cache of results by design and settings, for a reloaded page and for others with the same question."""

from collections import OrderedDict
from typing import Any

_MOST = 16
_results: OrderedDict[tuple[str, ...], Any] = OrderedDict()


def keep(result: Any, kind: str, *asked: str, most: int = _MOST) -> None:
    """Keep a result, with the last few of its kind: ``asked`` is its key, all that it depends on, such as design and
    settings. ``most``: how many to keep, fewer of large ones."""
    _results.pop((kind, *asked), None)
    _results[kind, *asked] = result
    for key in [key for key in _results if key[0] == kind][:-most]:
        del _results[key]


def cached(kind: str, *asked: str) -> Any:
    """The result with the same key; None if there is none."""
    if (kind, *asked) in _results:
        _results.move_to_end((kind, *asked))
    return _results.get((kind, *asked))

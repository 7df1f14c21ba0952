"""Results that this server still has, of the same design and settings: for a page that is loaded again, and for
whoever asks the same."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

_MOST = 16
_kept: OrderedDict[tuple[str, ...], Any] = OrderedDict()


def keep(result: Any, kind: str, *asked: str, most: int = _MOST) -> None:
    """Keep a result, the last few of its kind, whoever they are of: ``asked`` is all that it follows from, such as
    design and settings. ``most``: how many, fewer of what is large."""
    _kept.pop((kind, *asked), None)
    _kept[kind, *asked] = result
    for key in [key for key in _kept if key[0] == kind][:-most]:
        del _kept[key]


def kept(kind: str, *asked: str) -> Any:
    """What was kept under the same words; None: nothing, or no longer."""
    if (kind, *asked) in _kept:
        _kept.move_to_end((kind, *asked))
    return _kept.get((kind, *asked))

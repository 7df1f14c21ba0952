"""Results that this server still has, for a page that is loaded again: those of the same design and settings."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

_MOST = 16
_kept: OrderedDict[tuple[str, ...], Any] = OrderedDict()


def keep(result: Any, *asked: str) -> None:
    """Keep a result, the last few of everybody: ``asked`` is all that it follows from, such as kind and design."""
    _kept.pop(asked, None)
    _kept[asked] = result
    while len(_kept) > _MOST:
        _kept.popitem(last=False)


def kept(*asked: str) -> Any:
    """What was kept under the same words; None: nothing, or no longer."""
    return _kept.get(asked)

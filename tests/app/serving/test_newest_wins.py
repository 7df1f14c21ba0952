"""A page that sends values faster than they are worked off is answered the newest; those before it are dropped."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from open_page import Tab
from waiting import PATIENCE

_VALUES = 50
_SLIDER = "Angle random walk"


async def _page(address: str) -> tuple[Tab, dict[str, Any]]:
    tab = await Tab.open(address)
    return tab, await tab.until(name=_SLIDER, label=_SLIDER, show_value=False)


def _said(tab: Tab) -> tuple[str, str]:
    """The text of the slider's box, and the answer above the page."""
    boxes = (model["attributes"] for model in tab.objects if model["attributes"].get("label") == _SLIDER)
    texts = (str(model["attributes"].get("text", "")) for model in tab.objects)
    return next(box["value"] for box in boxes if "value_input" in box), next(x for x in texts if "bare strip" in x)


def test_fifty_values_at_once_are_not_fifty_computations(serving: Callable[..., Any]) -> None:
    async def run(served: Any) -> float:
        address = f"http://127.0.0.1:{served.port}"
        (alone, slider), (hurried, moved) = await _page(address), await _page(address)
        start = float(slider["attributes"]["value"])
        last = start - 0.02 * _VALUES
        before = _said(alone)
        async with asyncio.timeout(PATIENCE):
            await alone.set(slider["id"], value=last)
            while _said(alone)[0] == before[0]:
                await alone.pull()
            one = (await asyncio.to_thread(served.metrics))["navbudget_events_total"]
            for number in range(_VALUES):  # none of the answers is read in between
                await hurried.set(moved["id"], value=start - 0.02 * (1 + number))
            while _said(hurried) != _said(alone):
                await hurried.pull()
        computed = (await asyncio.to_thread(served.metrics))["navbudget_events_total"] - one
        await alone.close()
        await hurried.close()
        return computed

    with serving("--processes", "1") as served:
        assert 1 <= asyncio.run(run(served)) < _VALUES / 5

"""One person's slider while another flies a Monte Carlo: key to changed data, before and during, on one server.

No test fails on a clock; run it on a quiet machine: `make bench`, or this file with pytest and `-s`.
"""

import re
from typing import Any

from playwright.sync_api import Browser, Page, expect

from benchmarks.test_browser import _STEPS, _WATCH, _WHOLE, _open, browser, server

__all__ = ["browser", "server"]  # fixtures, found by their names here


def _steps(page: Page, count: int) -> list[float]:
    """Milliseconds from arrow key to the last of three charts' data, `count` times."""
    page.get_by_role("slider", name="Angle random walk").focus()
    waits: list[float] = []
    for place in range(count):
        seen = page.evaluate("() => window.__changes.length")
        page.keyboard.press("ArrowRight" if place < count / 2 else "ArrowLeft")
        page.wait_for_function("(n) => window.__changes.length >= n + 3", arg=seen)
        waits.append(page.evaluate("() => window.__changes.at(-1) - window.__keys.at(-1)"))
        page.wait_for_timeout(100)
    return sorted(waits)


def test_sliders_of_others_during_a_monte_carlo(benchmark: Any, browser: Browser, server: str) -> None:
    """Two browser contexts are two sessions; the second moves a slider while 2000 runs of the first are flown."""
    flying, sliding = _open(browser, server), _open(browser, server)
    sliding.wait_for_function(_WHOLE, timeout=60_000)
    sliding.wait_for_timeout(1000)
    sliding.evaluate(_WATCH)
    before = _steps(sliding, _STEPS)
    flying.get_by_role("tab", name="Flight", exact=True).click()
    flying.get_by_role("tab", name="Simulate", exact=True).click()
    start = flying.get_by_role("button", name="Start", exact=True)
    expect(start).to_be_enabled(timeout=60_000)
    for label, text in (("Runs", "2000"), ("Length [s]", "1000")):
        flying.get_by_role("textbox", name=label, exact=True).fill(text)
        flying.get_by_role("textbox", name=label, exact=True).press("Enter")
    start.click()
    progress = flying.get_by_text(re.compile(r"[1-9]\d* of 2000 runs, \d+ s left"))
    expect(progress).to_be_visible(timeout=180_000)
    during: list[float] = []
    benchmark.pedantic(lambda: during.extend(_steps(sliding, _STEPS)), rounds=1, iterations=1)
    expect(progress).to_be_visible()  # still flying
    for name, waits in (("before", before), ("during", during)):
        benchmark.extra_info[f"key to data {name}, ms: median"] = round(waits[len(waits) // 2], 1)
        benchmark.extra_info[f"key to data {name}, ms: p95"] = round(waits[int(0.95 * len(waits))], 1)
    print(benchmark.extra_info)

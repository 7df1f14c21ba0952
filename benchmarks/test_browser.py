"""Slider key to changed data, and first view, in a real browser against the served product.

No test fails on a clock; the figures are printed with the benchmark. The wait between keys lets one step
finish before the next.
"""

import shutil
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

_IDLE = "() => window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle)"
_WHOLE = """() => [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "Figure").length >= 4
  && Bokeh.documents.every(d => d.is_idle)"""
_WATCH = """() => {
  window.__keys = []; window.__changes = []
  document.addEventListener("keydown", () => window.__keys.push(performance.now()), true)
  const wanted = ["timelines", "response lines 0"]
  for (const model of Bokeh.documents[0]._all_models.values())
    if (model.type === "ColumnDataSource" && wanted.includes(model.name))
      model.change.connect(() => window.__changes.push(performance.now()))
}"""
_STEPS = 50


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    command = [sys.executable, "-m", "app", "serve", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process.stdout.readline().split()[-1]
        process.terminate()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        path = shutil.which("chromium") or shutil.which("chromium-browser")
        yield playwright.chromium.launch(
            executable_path=path,
            args=["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"],
        )


def _open(browser: Browser, server: str) -> Page:
    page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
    page.goto(server)
    page.wait_for_function(_IDLE, timeout=60_000)
    return page


def test_first_view(benchmark: Any, browser: Browser, server: str) -> None:
    """Navigation to a first screen that stands still, a new browser context each time.

    Each page is closed only when it is whole: else the server would still be making its charts while the next opens.
    """

    def fresh() -> tuple[tuple[Page], dict[str, Any]]:
        for context in browser.contexts:
            for page in context.pages:
                page.wait_for_function(_WHOLE, timeout=60_000)
            context.close()
        return (browser.new_context(viewport={"width": 1440, "height": 900}).new_page(),), {}

    def view(page: Page) -> None:
        page.goto(server)
        page.wait_for_function(_IDLE, timeout=60_000)

    benchmark.pedantic(view, setup=fresh, rounds=7, iterations=1)


def test_whole_page(benchmark: Any, browser: Browser, server: str) -> None:
    """A page until the charts below the first screen stand as well."""

    def open_() -> None:
        page = _open(browser, server)
        page.wait_for_function(_WHOLE, timeout=60_000)
        page.context.close()

    benchmark.pedantic(open_, rounds=7, iterations=1)


def test_slider_step_to_changed_curves(benchmark: Any, browser: Browser, server: str) -> None:
    """Arrow key on the angle-random-walk slider until timelines and impulse response have their new data."""
    page = _open(browser, server)
    page.wait_for_function(_WHOLE, timeout=60_000)
    page.wait_for_timeout(1000)
    page.evaluate(_WATCH)
    page.get_by_role("slider", name="Angle random walk").focus()
    waits: list[float] = []

    def step() -> None:
        seen = page.evaluate("() => window.__changes.length")
        page.keyboard.press("ArrowRight" if len(waits) < _STEPS / 2 else "ArrowLeft")
        page.wait_for_function("(n) => window.__changes.length >= n + 2", arg=seen)
        waits.append(page.evaluate("() => window.__changes.at(-1) - window.__keys.at(-1)"))
        page.wait_for_timeout(100)

    benchmark.pedantic(step, rounds=_STEPS, iterations=1)
    ordered = sorted(waits)
    benchmark.extra_info["key to data, ms: median"] = round(ordered[len(ordered) // 2], 1)
    benchmark.extra_info["key to data, ms: p95"] = round(ordered[int(0.95 * len(ordered))], 1)
    print(benchmark.extra_info)

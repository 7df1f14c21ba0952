"""The real product in a real browser: `navbudget serve` as a process, Debian's chromium in front of it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

_FLAGS = [
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
_IDLE = "() => window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle)"


_STILL = """() => {
  const roots = [document]
  for (const root of roots)
    for (const element of root.querySelectorAll("*")) if (element.shadowRoot) roots.push(element.shadowRoot)
  return Bokeh.documents.every(d => d.is_idle)
    && roots.every(root => root.getAnimations().every(animation => animation.playState !== "running"))
}"""

# What the cards say; boxes and curves change in the same turn.
_SAYS = """() => {
  const said = [], roots = [document]
  for (const root of roots)
    for (const element of root.querySelectorAll("*")) {
      if (element.shadowRoot) roots.push(element.shadowRoot)
      if (element.matches(".card .big")) said.push(element.innerText)
    }
  return said.join(" | ")
}"""


expect.set_options(timeout=20_000)  # a loaded machine is slow, not wrong


@pytest.fixture(scope="session")
def browser_type_launch_args(browser_type_launch_args: dict[str, Any]) -> dict[str, Any]:
    path = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "no chromium: `make test` installs it"
    root = ["--no-sandbox"] if os.geteuid() == 0 else []
    return {**browser_type_launch_args, "executable_path": path, "args": [*_FLAGS, *root]}


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a running `navbudget serve`."""
    library = tmp_path_factory.mktemp("library") / "library.db"
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--library", str(library)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("NavBudget on http://"), line
        yield line.split()[-1]
        process.terminate()
        assert process.wait(timeout=20) is not None


@contextmanager
def _watched(page: Page, server: str) -> Iterator[Callable[..., Page]]:
    """Open the product at a path and wait until it stands still.

    Afterwards nothing must have been asked of any other host, and no script may have failed.
    """
    elsewhere: list[str] = []
    errors: list[str] = []
    page.on(
        "request",
        lambda r: (
            None
            if r.url.startswith((server, server.replace("http", "ws"), "data:", "blob:"))
            else elsewhere.append(r.url)
        ),
    )
    page.on("pageerror", lambda error: errors.append(str(error)))

    def open_(path: str = "/", **size: int) -> Page:
        page.set_viewport_size({"width": size.get("width", 1440), "height": size.get("height", 900)})
        page.goto(server + path)
        page.wait_for_function(_IDLE, timeout=60_000)
        page.get_by_role("status").first.wait_for(timeout=60_000)
        return page

    yield open_
    assert not elsewhere, elsewhere
    assert not errors, errors


@pytest.fixture
def visit(page: Page, server: str) -> Iterator[Callable[..., Page]]:
    """Opens the product, as `_watched` says."""
    with _watched(page, server) as open_:
        yield open_


@pytest.fixture(scope="session")
def plain(browser: Browser, server: str) -> Iterator[Page]:
    """The first design's page, for tests that change nothing on it: opening one takes seconds."""
    page = browser.new_page()
    with _watched(page, server) as open_:
        yield open_()
    page.close()


@pytest.fixture
def desk(plain: Page) -> Iterator[Page]:
    """The same, for tests that change the design and nothing else; it is reset after them."""
    said = plain.evaluate(_SAYS)
    yield plain
    plain.get_by_role("button", name="Reset").click()
    plain.wait_for_function(f"said => ({_SAYS})() === said", arg=said)


@pytest.fixture
def settled() -> Callable[[Page], None]:
    """Wait until nothing moves: while colours fade over, nothing has its contrast."""

    def wait(page: Page) -> None:
        page.wait_for_timeout(300)
        page.wait_for_function(_STILL, timeout=60_000)
        page.wait_for_timeout(100)

    return wait

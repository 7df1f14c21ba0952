"""The real product in a real browser: `navbudget serve` as a process, Debian's chromium in front of it."""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from on_page import IDLE
from playwright.sync_api import Browser, Page, expect
from served import serving
from waiting import PATIENCE

_FLAGS = [
    "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip


_STILL = """() => {
  const roots = [document]
  for (const root of roots)
    for (const element of root.querySelectorAll("*")) if (element.shadowRoot) roots.push(element.shadowRoot)
  return Bokeh.documents.every(d => d.is_idle)
    && roots.every(root => root.getAnimations().every(animation => animation.playState !== "running"))
}"""

_TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"

# The verdict and the margins, as values keep the units of what they are compared with; boxes and curves change in the
# same turn.
_SAYS = """() => {
  const said = [], roots = [document]
  for (const root of roots)
    for (const element of root.querySelectorAll("*")) {
      if (element.shadowRoot) roots.push(element.shadowRoot)
      if (element.matches(".strip p, .card .mark")) said.push(element.innerText)
    }
  return said.join(" | ")
}"""


_MS = 1e3 * PATIENCE
_EVERY = 100  # ms between two looks over a whole page: one in every frame keeps the page busy
expect.set_options(timeout=_MS)


@pytest.fixture(scope="session")
def browser_type_launch_args(browser_type_launch_args: dict[str, Any]) -> dict[str, Any]:
    path = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "no chromium: `make test` installs it"
    root = ["--no-sandbox"] if os.geteuid() == 0 else []
    return {**browser_type_launch_args, "executable_path": path, "args": [*_FLAGS, *root]}


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a running `navbudget serve`."""
    with serving("--library", str(tmp_path_factory.mktemp("library") / "library.db")) as (address, _):
        yield address


@pytest.fixture(scope="session")
def _opener(browser: Browser, server: str) -> Iterator[Page]:
    """Opens the windows of all tests: of one process, they have the product's script loaded and compiled once."""
    page = browser.new_context(reduced_motion="reduce").new_page()  # a bar that runs is drawn anew in every frame
    page.context.set_default_timeout(_MS)  # whatever is waited for is waited for patiently
    page.goto(server + "/favicon.ico")
    yield page
    page.context.close()


def _window(opener: Page) -> Page:
    with opener.expect_popup() as opened:
        opener.evaluate("() => { window.open('about:blank') }")
    return opened.value


@pytest.fixture
def page(_opener: Page) -> Iterator[Page]:
    """A window in a browser that nobody used before."""
    _opener.context.clear_cookies()
    _opener.context.clear_permissions()
    _opener.evaluate("() => localStorage.clear()")
    page = _window(_opener)
    yield page
    page.close()


@contextmanager
def _watched(page: Page, server: str) -> Iterator[Callable[..., Page]]:
    """Open the product at a path and wait until it stands still.

    Afterwards nothing must have been asked of any other host, and no script may have failed.
    """
    elsewhere: list[str] = []
    errors: list[str] = []
    ours = (server, server.replace("http", "ws"), "data:", "blob:")
    page.on("request", lambda asked: None if asked.url.startswith(ours) else elsewhere.append(asked.url))
    page.on("pageerror", lambda error: errors.append(str(error)))

    def open_(path: str = "/", **size: int) -> Page:
        page.set_viewport_size({"width": size.get("width", 1440), "height": size.get("height", 900)})
        page.goto(server + path)
        page.wait_for_function(IDLE)
        page.get_by_role("tablist").first.wait_for()
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
def plain(_opener: Page, server: str) -> Iterator[Page]:
    """The first design's page, for tests that change nothing on it: opening one takes seconds.

    Its console must not have warned of anything by the end.
    """
    page = _window(_opener)
    warnings: list[str] = []
    page.on("console", lambda m: warnings.append(m.text) if m.type in {"warning", "error"} else None)
    with _watched(page, server) as open_:
        open_()
        expect(page.locator(".bk-Figure:visible")).to_have_count(4)
        yield page
    page.close()
    assert not warnings, warnings


@pytest.fixture
def desk(plain: Page) -> Iterator[Page]:
    """The same, for tests that change the design and nothing else; it is reset after them."""
    plain.locator(".main-content").evaluate("e => e.scrollTo(0, 0)")  # another test may have gone down to a fold
    text = plain.evaluate(_SAYS)
    name = plain.get_by_role("textbox", name="Design", exact=True)
    called = name.input_value()
    yield plain
    # A name that only the reset takes away: what it undoes otherwise may look the same before and after.
    name.fill("To be reset")
    name.press("Enter")
    plain.get_by_role("button", name="Open", exact=True).click()
    plain.get_by_role("button", name="Reset").click()
    expect(name).to_have_value(called)
    plain.wait_for_function(f"said => ({_SAYS})() === said", arg=text, polling=_EVERY)


@pytest.fixture(scope="session")
def settled() -> Callable[[Page], None]:
    """Wait until the page has answered and nothing on it moves."""

    def wait(page: Page) -> None:
        page.evaluate(_TWO_FRAMES)  # what was asked for has begun
        page.wait_for_function(_STILL, polling=_EVERY)

    return wait


@pytest.fixture(scope="session")
def accessible(settled: Callable[[Page], None]) -> Callable[..., None]:
    """Nothing that axe finds serious is left (``every``: nothing it finds at all; ``advice``: good
    practice counts too); `where` says of what page.

    While colours fade over, nothing has its contrast: a finding counts that is there when the page has come to rest.
    """

    def look(page: Page, every: bool, advice: bool) -> list[tuple[str, str]]:
        settled(page)
        rules = ["wcag2a", "wcag2aa", *(["best-practice"] if advice else [])]
        # Of what is in order it need not tell every part, and what it loads beforehand no rule of these asks for.
        options = {"runOnly": rules, "resultTypes": ["violations"], "preload": False}
        faults = Axe().run(page, options=options).response["violations"]
        return [(v["id"], v["nodes"][0]["html"]) for v in faults if every or v["impact"] in {"serious", "critical"}]

    def check(page: Page, where: str = "", *, every: bool = False, advice: bool = False) -> None:
        for _ in range(10):
            if not (faults := look(page, every, advice)):
                return
            page.wait_for_timeout(500)
        pytest.fail(f"{where}: {faults}")

    return check


@pytest.fixture(scope="session")
def fits(settled: Callable[[Page], None]) -> Callable[[Page, int], None]:
    """Make the window so wide, or leave it; nothing of the page is wider."""

    def check(page: Page, width: int) -> None:
        if page.viewport_size and page.viewport_size["width"] != width:
            page.set_viewport_size({"width": width, "height": 844})
        settled(page)
        page.wait_for_function("width => document.documentElement.scrollWidth <= width", arg=width)

    return check

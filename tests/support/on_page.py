"""The dashboard as a person finds and uses it, for tests in the browser."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import Download, Locator, Page

from app.subjects import TABS

Visit = Callable[..., Page]
Check = Callable[..., None]
IDLE = "() => window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle)"


def box(page: Page, label: str) -> Locator:
    """The text box of an input (its slider and unit carry other roles)."""
    return page.get_by_role("textbox", name=label, exact=True)


def card(page: Page, label: str) -> Locator:
    """The value of a key figure."""
    return page.locator(":is(.tiles, .others) .card").filter(has=page.get_by_text(label, exact=True)).locator(".big")


def turn(page: Page, title: str) -> None:
    """Turn to the page of this title, by the first tab of its group where that is closed."""
    tab = page.get_by_role("tab", name=title, exact=True)
    if not tab.is_visible():
        group = next(each.group for each in TABS if each.title == title)
        page.get_by_role("tab", name=group, exact=True).click()
    tab.click()


def section(page: Page, title: str) -> None:
    """Open or close a section of the design."""
    page.get_by_role("button", name=title, exact=True).click()


def enter(field: Locator, text: str) -> None:
    """Type a text into a box."""
    field.fill(text)
    field.press("Enter")


def content(download: Download) -> bytes:
    """The bytes of a file that was downloaded."""
    path = download.path()
    return Path(path).read_bytes()


COLUMNS = """(name) => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const data = sources.find(m => m.name === name)?.data ?? {}
  const pairs = [...(data instanceof Map ? data : Object.entries(data))]
  return Object.fromEntries(pairs.map(([key, values]) => [key, [...values]]))
}"""


def columns(page: Page, name: str) -> dict[str, list[Any]]:
    """Columns that the curves of a chart are drawn from."""
    result: dict[str, list[Any]] = page.evaluate(COLUMNS, name)
    return result

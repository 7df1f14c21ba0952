"""One scale of type, one heading, and a strip that stays: on every page, counted from computed styles."""

from collections.abc import Callable

import pytest
from on_page import Visit, turn
from playwright.sync_api import Page, expect

from app.subjects import TABS

_SCALE = {"12px", "13px", "14px", "16px", "20px"}
_WEIGHTS = {"400", "600"}

# Sizes and weights of every text that is seen, but for equations, which set their indices by themselves.
_TEXTS = """() => {
  const sizes = {}, weights = {}
  let headings = 0
  const walk = (root) => {
    for (const element of root.querySelectorAll("*")) {
      if (element.shadowRoot) walk(element.shadowRoot)
      if (element.tagName === "H1") headings++
      const { width, height } = element.getBoundingClientRect()
      const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim())
      if (!own || width < 2 || height < 2 || element.closest("math") || element.tagName === "STYLE") continue
      if (!element.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue
      const style = getComputedStyle(element)
      sizes[style.fontSize] ??= element.textContent.trim().slice(0, 40)
      weights[style.fontWeight] ??= element.textContent.trim().slice(0, 40)
    }
  }
  walk(document)
  return { sizes, weights, headings }
}"""


@pytest.mark.long
def test_every_page_keeps_to_one_scale(visit: Visit, settled: Callable[[Page], None]) -> None:
    page = visit()
    beyond = {}
    for tab in TABS:
        turn(page, tab.title)
        expect(page.locator(".strip:visible").first).to_be_visible()
        settled(page)
        texts = page.evaluate(_TEXTS)
        beyond[tab.title] = {size: text for size, text in texts["sizes"].items() if size not in _SCALE}
        beyond[tab.title] |= {weight: text for weight, text in texts["weights"].items() if weight not in _WEIGHTS}
        assert texts["headings"] == 1, tab.title
    assert not any(beyond.values()), beyond


@pytest.mark.long
def test_the_strip_stays_and_a_page_begins_at_its_top(visit: Visit, settled: Callable[[Page], None]) -> None:
    page = visit()
    main = page.locator(".main-content")
    main.evaluate("e => e.scrollTo(0, 500)")
    strip = page.locator(".strip[role=status]:visible").first
    expect(strip).to_be_in_viewport()
    turn(page, "Image")
    settled(page)
    assert main.evaluate("e => e.scrollTop") == 0
    main.evaluate("e => e.scrollTo(0, 400)")
    turn(page, "Budget")
    settled(page)
    assert main.evaluate("e => e.scrollTop") == 0
    expect(strip).to_be_in_viewport()

"""Every page for everybody: axe in light and dark, twice the zoom, keyboard alone, and on paper."""

import io
import itertools
from collections.abc import Callable

import pypdf
import pytest
from on_page import IDLE, Check, Visit, turn
from playwright.sync_api import Page, expect

from app.subjects import TABS

_FOCUSED = """() => {
  let at = document.activeElement
  while (at?.shadowRoot?.activeElement) at = at.shadowRoot.activeElement
  const named = at?.getAttribute("aria-label") || at?.labels?.[0]?.innerText || at?.innerText || ""
  return [at?.getAttribute("role") || at?.type || "", named.split("\\n")[0]]
}"""


_UNFOLD = """() => {
  const walk = (root) => { for (const element of root.querySelectorAll("*")) {
    if (element.tagName === "DETAILS") element.open = true
    if (element.shadowRoot) walk(element.shadowRoot)
  } }
  walk(document)
}"""


@pytest.mark.slow
def test_axe_finds_nothing_on_any_page_light_or_dark_and_the_console_stays_empty(
    visit: Visit, accessible: Check
) -> None:
    page = visit()
    messages: list[str] = []
    page.on("console", lambda m: messages.append(m.text) if m.type in {"warning", "error"} else None)
    page.get_by_role("button", name="No, thanks").click()
    page.get_by_role("tab", name="Review").click()
    page.get_by_label("Your name").fill("Ann")
    page.get_by_role("button", name="Save as new design").click()
    page.get_by_role("checkbox", name="MEMS IMU").first.check()
    page.get_by_role("button", name="Reviews", exact=True).click()
    page.get_by_label("Title of a new review").fill("For everybody")
    page.get_by_role("button", name="Start review of selected designs").click()
    expect(page.get_by_role("region", name="Requirements and decisions")).to_be_visible()
    for theme in ("light", "dark"):
        if theme == "dark":
            page.get_by_role("button", name="theme").click()
        for name in (tab.title for tab in TABS):
            turn(page, name)
            if name == "Theory":
                expect(page.locator("#validation")).to_be_visible()
            if name == "Flight" and theme == "light":
                page.get_by_role("button", name="Plan", exact=True).click()  # the drawer, which stays open
            page.evaluate(_UNFOLD)
            accessible(page, f"{name}, {theme}", every=True, advice=True)
    assert not messages


@pytest.mark.slow
def test_no_page_loses_anything_at_twice_the_zoom(visit: Visit, settled: Callable[[Page], None]) -> None:
    page = visit(width=720, height=450)  # what a 1440 px screen leaves at 200 %
    for name in (tab.title for tab in TABS):
        turn(page, name)
        settled(page)
        assert page.evaluate("() => document.documentElement.scrollWidth") <= 720, name
        main = page.locator(".main-content").bounding_box()
        assert main["width"] >= 360, name  # the page itself still has room beside or under the design
    tiles = page.locator(".tile dd:visible")  # of the last page, Suborbital, when its study has come
    expect(tiles.first).to_be_visible()
    assert not tiles.evaluate_all("each => each.filter(e => e.scrollWidth > e.clientWidth + 1).map(e => e.innerText)")


def _to(page: Page, role: str, name: str, key: str = "Tab") -> None:
    """Wait for something to be on the page, then press a key until it has the focus."""
    wanted = page.get_by_label(name, exact=True) if role == "text" else page.get_by_role(role, name=name, exact=True)
    expect(wanted.first).to_be_visible()
    for _ in range(150):
        if page.evaluate(_FOCUSED) == [role, name]:
            return
        page.keyboard.press(key)
    pytest.fail(f"{role} {name!r} is not reached by {key}")


def test_the_main_job_by_keyboard_alone(visit: Visit) -> None:
    page = visit()
    page.wait_for_function(IDLE)
    _to(page, "text", "Design")
    page.keyboard.press("Control+A")
    page.keyboard.type("By keyboard")
    page.keyboard.press("Enter")
    _to(page, "text", "Angle random walk")
    page.keyboard.press("Control+A")
    page.keyboard.type("0.01 °/√h")
    page.keyboard.press("Enter")
    expect(page.get_by_role("status").first).to_contain_text("Closes")
    _to(page, "tab", "Budget")
    _to(page, "tab", "Review", "ArrowRight")
    page.keyboard.press("Enter")
    _to(page, "text", "Your name")
    page.keyboard.type("Ann")
    _to(page, "button", "Save as new design")
    page.keyboard.press("Enter")
    expect(page.get_by_role("status").filter(has_text="Saved: revision 1")).to_be_visible()


def test_a_term_says_what_it_means_to_a_keyboard(visit: Visit) -> None:
    page = visit()
    for term, meaning in (
        ("Does not close", "A design closes when every requirement is met."),
        ("Detrended phase", "Rms after a line is removed"),
        ("Horizontal position", "before a fix, where the error is largest"),
    ):
        said = page.locator("details.term").filter(has_text=term).filter(has_text=meaning)
        expect(said.get_by_text(meaning)).to_be_hidden()
        said.locator("summary").focus()
        page.keyboard.press("Enter")
        expect(said.get_by_text(meaning)).to_be_visible()
        page.keyboard.press("Enter")
        expect(said.get_by_text(meaning)).to_be_hidden()


def test_the_first_result_is_near_and_the_page_has_one_outline(visit: Visit) -> None:
    """One stop from the top of the page to the answer; one h1; headings go down by one level at a time."""
    page = visit()
    page.wait_for_function(IDLE)
    page.keyboard.press("Tab")
    assert page.evaluate(_FOCUSED) == ["button", "Skip to the result"]
    page.keyboard.press("Enter")
    text = page.evaluate("""() => {
      let at = document.activeElement
      while (at?.shadowRoot?.activeElement) at = at.shadowRoot.activeElement
      return at.innerText
    }""")
    assert "Does not close" in text
    levels = page.evaluate("""() => {
      const found = []
      const walk = (root) => { for (const element of root.children) {
        if (element.matches("h1, h2, h3, h4, h5, h6") && element.getClientRects().length && element.innerText.trim())
          found.push(Number(element.tagName[1]))
        if (element.shadowRoot) walk(element.shadowRoot)
        walk(element)
      } }
      walk(document.body)
      return found
    }""")
    assert levels.count(1) == 1
    assert levels[0] == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels)), levels


@pytest.mark.slow
def test_charts_say_what_they_show(visit: Visit) -> None:
    page = visit()
    description = page.get_by_text("What the chart shows: Curves of position, 1σ in m")
    expect(description).to_contain_text("horizontal: 0.404 at −20 to 17.1 at 100.")
    expect(description).to_contain_text("Limit on horizontal position")


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.slow
def test_the_page_prints_without_its_tools(visit: Visit, settled: Callable[[Page], None], dark: bool) -> None:
    page = visit()
    page.get_by_role("button", name="Requirements and cautions").click()
    expect(page.get_by_text("Main error source")).to_be_visible()
    if dark:
        page.get_by_role("button", name="theme").click()
        page.mouse.move(700, 500)
        settled(page)
    sheets = pypdf.PdfReader(io.BytesIO(page.pdf(format="A4"))).pages
    text = [" ".join(sheet.extract_text().split()) for sheet in sheets]
    assert 1 <= len(sheets) <= 4
    assert page.locator(".bk-Figure:visible").first.evaluate("e => e.style.zoom") == ""  # as it was
    page.emulate_media(media="print")
    expect(page.get_by_role("button", name="Requirements and cautions")).to_be_visible()
    expect(page.get_by_role("button", name="Paired echoes")).to_be_hidden()  # a fold that is closed
    if dark:  # turned over as a picture
        assert "invert" in page.locator(".page").evaluate("e => getComputedStyle(e).filter")
        return
    for words in ("Does not close", "Detrended phase", "initial tilt", "Point target in azimuth"):
        assert words in text[0], words  # verdict, tiles and both phase figures on one sheet
    assert any("Main error source" in sheet for sheet in text)
    for tool in ("Show help for all inputs", "PDF report", "Suborbital", "SICD XML"):
        assert not any(tool in sheet for sheet in text), tool

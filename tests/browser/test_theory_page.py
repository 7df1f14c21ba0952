"""The Theory page in the browser: every equation is there, marks lead to it, and nothing is fetched for it."""

from collections.abc import Callable

import pytest
from on_page import Visit, turn
from playwright.sync_api import Page, expect

from nav_model.equations import ALL_EQUATIONS

_IN_VIEW = "e => { const b = e.getBoundingClientRect(); return b.top >= 0 && b.top < innerHeight / 2 }"

_COUNT = """() => {
  const [proto, shipped] = [Element.prototype, Element.prototype.scrollIntoView]
  window.gone = 0
  proto.scrollIntoView = function (...how) { window.gone++; return shipped.apply(this, how) }
}"""


def test_every_equation_is_set_offline_and_a_mark_leads_to_its_equation_and_back(
    visit: Visit, fits: Callable[[Page, int], None]
) -> None:
    page = visit()
    turn(page, "Theory")
    expect(page.locator("section.equation math")).to_have_count(len(ALL_EQUATIONS))
    expect(page.locator("#T-2")).to_contain_text("√")
    expect(page.get_by_role("status").first).to_contain_text("checked against independent references")
    chapters = page.locator("details:has(> summary > h2)")
    expect(chapters.and_(page.locator("[open]"))).to_have_attribute("id", "part-T")  # the other chapters are folded
    for chapter in ("Validation", "Where values differ"):
        page.get_by_role("heading", name=chapter).click()
    expect(page.get_by_role("region", name="Results and what each was compared with")).to_contain_text("SciPy")
    expect(page.get_by_role("region", name="Values from elsewhere that differ from ours")).to_contain_text("0.900 m")
    fits(page, 1440)
    fits(page, 390)
    page.set_viewport_size({"width": 1440, "height": 900})
    budget = page.get_by_role("tab", name="Budget", exact=True)
    budget.click()
    source = page.get_by_label("Source and method: Position, velocity, attitude")
    expect(source).to_be_visible()  # before that no key reaches it
    source.press("Enter")
    mark = page.locator("details.how").get_by_role("link", name="[T-17]").first
    mark.click()
    equation = page.locator("#T-17")
    expect(equation).to_be_focused()
    assert equation.evaluate(_IN_VIEW)
    assert page.evaluate("() => location.hash") == "#theory-T-17"
    page.go_back()
    expect(budget).to_have_attribute("aria-selected", "true")
    page.go_forward()
    expect(equation).to_be_focused()
    equation.get_by_role("link", name="[T-8]").first.click()
    expect(page.locator("#T-8")).to_be_focused()
    budget.click()
    expect(budget).to_have_attribute("aria-selected", "true")
    page.wait_for_function("() => location.hash === '#budget'")
    mark.press("Enter")
    expect(equation).to_be_focused()
    page.go_back()
    expect(budget).to_have_attribute("aria-selected", "true")
    assert page.evaluate("() => location.hash") == "#budget"


@pytest.mark.slow
def test_a_place_is_gone_to_once(visit: Visit) -> None:
    """Were it gone to again when the server answers, whoever has moved on in between would be pulled back."""
    page = visit("/#theory-T-17")
    expect(page.locator("#T-17")).to_be_focused()
    page.evaluate(_COUNT)
    link = page.locator("#T-17").get_by_role("link").first
    place = str(link.get_attribute("href")).removeprefix("#theory-")
    for times in (1, 2):  # the second time the address stands already
        link.evaluate("link => link.click()")
        page.wait_for_function("times => window.gone >= times", arg=times)
        page.wait_for_timeout(1500)
        assert page.evaluate("() => window.gone") == times
        expect(page.locator(f"#{place}")).to_be_focused()


@pytest.mark.slow
def test_the_address_of_an_equation_opens_there(visit: Visit, server: str) -> None:
    page = visit()
    page.goto("about:blank")
    page.goto(server + "/#theory-S-5")
    expect(page.locator("#S-5")).to_be_focused()
    assert page.locator("#S-5").evaluate(_IN_VIEW)
    for nowhere in ("#theory-<img src=x>", "#nonsense:S-5", "#theory-"):
        page.evaluate("hash => { location.hash = hash }", nowhere)
    page.evaluate("() => { location.hash = '#theory-T-1' }")
    expect(page.locator("#T-1")).to_be_focused()

"""The Theory page in the browser: every equation is there, and nothing is fetched for it."""

from collections.abc import Callable

from playwright.sync_api import Page, expect

from app.report.equations import ALL_EQUATIONS


def test_every_equation_is_set_offline(visit: Callable[..., Page]) -> None:
    page = visit()
    page.get_by_text("Theory", exact=True).first.click()
    expect(page.locator("section.equation math")).to_have_count(len(ALL_EQUATIONS))
    expect(page.locator("#T-2")).to_contain_text("√")
    expect(page.get_by_role("region", name="Validation")).to_contain_text("SciPy")
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 1440

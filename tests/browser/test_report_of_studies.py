"""A study run on a page is in the report downloaded from the toolbar, until the design changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

Visit = Callable[..., Page]


def downloaded(page: Page) -> str:
    """The HTML report as the button gives it."""
    report = page.get_by_role("button", name="HTML report")
    if report.is_hidden():
        page.get_by_role("button", name="Report", exact=True).click()
    with page.expect_download() as waiting:
        report.click()
    expect(report).to_be_enabled()
    return Path(waiting.value.path()).read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_runs_on_the_sar_page_are_in_the_report_while_the_design_stays(visit: Visit) -> None:
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("The runs match the design.")).to_be_visible()
    page.get_by_role("button", name="Why, and what would change it").click()
    sentence = page.get_by_text("By the runs: Over 50 runs").inner_text().removeprefix("By the runs: ")
    page.get_by_role("button", name="Report", exact=True).click()
    box = page.get_by_role("checkbox", name="SAR")
    expect(box).to_be_checked()
    report = downloaded(page)
    assert "SAR: which strategy to use" in report
    assert sentence.partition(" [")[0] in report  # equations are links there
    page.get_by_role("slider", name="Angle random walk").focus()
    page.keyboard.press("PageDown")
    if page.get_by_role("button", name="HTML report").is_hidden():
        page.get_by_role("button", name="Report", exact=True).click()
    expect(page.get_by_text("Not in the report, because they belong to another design: SAR.")).to_be_visible()
    report = downloaded(page)
    assert "SAR: which strategy to use" not in report
    assert "the last study belongs to another design" in report

"""The first five minutes: the tour, the examples, the explanations, and the main job by keyboard alone."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

Visit = Callable[..., Page]


def test_the_tour_is_offered_once_and_goes_by_keyboard(visit: Visit) -> None:
    page = visit()
    card = page.get_by_role("dialog")
    expect(card).to_be_hidden()  # offered, not thrust upon
    page.get_by_role("button", name="New here? Take the tour").press("Enter")
    titles = []
    for _ in range(5):
        expect(card.get_by_role("heading")).to_be_focused()
        titles.append(card.get_by_role("heading").inner_text())
        assert page.locator(".frame").evaluate("e => !e.hidden && e.offsetWidth > 100"), titles
        card.get_by_role("button", name="Done" if len(titles) == 5 else "Next").press("Enter")
    assert len(set(titles)) == 5
    expect(card).to_be_hidden()
    page.reload()
    page.get_by_role("status").first.wait_for()
    page.get_by_role("button", name="Tour", exact=True).click()  # no longer offered, still there
    page.get_by_role("slider", name="Angle random walk").press("ArrowLeft")  # nothing is blocked meanwhile
    expect(page.get_by_role("button", name="Undo")).to_be_enabled()
    card.get_by_role("button", name="Next").press("Escape")
    expect(card).to_be_hidden()


def test_an_example_is_opened_and_undone(visit: Visit) -> None:
    page = visit()
    page.get_by_role("button", name="No, thanks").click()
    page.get_by_role("button", name="Open", exact=True).click()
    page.get_by_role("button", name="Examples").click()
    page.get_by_role("button", name="Open L band from a jet").click()
    expect(page.get_by_role("textbox", name="Design", exact=True)).to_have_value("L band from a jet")
    expect(page.get_by_role("button", name="Open L band from a jet")).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("textbox", name="Design", exact=True)).to_have_value("MEMS IMU at X band")


@pytest.mark.slow
def test_every_open_input_is_explained(visit: Visit) -> None:
    page = visit()
    page.get_by_role("switch", name="Explain every input").check()
    for said in ("White noise of the gyros, per axis.", "Typical: navigation 0.002", "state augmentation"):
        expect(page.get_by_text(said).first).to_be_visible()
    page.get_by_role("switch", name="Explain every input").uncheck()
    expect(page.get_by_text("White noise of the gyros")).to_have_count(0)

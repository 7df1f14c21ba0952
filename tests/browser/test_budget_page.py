"""The Budget page as a person uses it."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Page, expect

Visit = Callable[..., Page]


def test_first_screen_gives_the_answer(visit: Visit) -> None:
    page = visit()
    expect(page.get_by_role("status").first).to_contain_text("Does not close")
    expect(page.get_by_role("status").first).to_contain_text("gyro noise")
    expect(page.get_by_text("How do we know:").first).to_be_visible()


def test_slider_moves_curve_verdict_and_box_together(visit: Visit) -> None:
    page = visit()
    before = page.get_by_label("Angle random walk").first.input_value()
    slider = page.get_by_role("slider", name="Angle random walk")
    slider.focus()
    for _ in range(5):
        page.keyboard.press("PageDown")
    expect(page.get_by_label("Angle random walk").first).not_to_have_value(before)

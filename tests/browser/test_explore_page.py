"""The Explore page as a person uses it."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Page, expect

Visit = Callable[..., Page]


def _open(visit: Visit, **size: int) -> Page:
    page = visit(**size)
    if size:
        page.keyboard.press("Escape")  # the drawer, open over a narrow page
        page.wait_for_timeout(400)
    page.get_by_role("tab", name="Explore").click()
    expect(page.get_by_text("Which sensors would do")).to_be_visible(timeout=20_000)
    return page


def test_answer_first_then_a_slider_moves_it(visit: Visit) -> None:
    page = _open(visit)
    answer = page.get_by_role("status").first
    expect(answer).to_contain_text("Largest gyro noise (angle random walk) that closes: 0.036 °/√h")
    expect(answer).to_contain_text("You have 0.15 °/√h")
    slider = page.get_by_role("slider", name="Angle random walk")
    slider.focus()
    page.keyboard.press("ArrowLeft")
    expect(answer).not_to_contain_text("You have 0.15 °/√h")
    expect(answer).to_contain_text("0.036 °/√h")  # the others are held: the largest value does not move


def test_click_on_the_map_adopts_a_point(visit: Visit) -> None:
    page = _open(visit)
    box = page.get_by_label("Angle random walk").first
    before = box.input_value()
    page.wait_for_function(
        "() => [...Bokeh.documents[0]._all_models.values()].some(m => m.name === 'map image')", timeout=20_000
    )
    canvas = page.locator(".bk-Figure:visible").first
    canvas.evaluate("element => element.scrollIntoView({block: 'center'})")
    page.wait_for_timeout(1000)
    place = canvas.bounding_box()
    assert place is not None
    page.mouse.click(place["x"] + 0.3 * place["width"], place["y"] + 0.7 * place["height"])
    expect(box).not_to_have_value(before)


def test_a_pair_is_found_chosen_and_adopted_by_keyboard(visit: Visit) -> None:
    page = _open(visit)
    page.get_by_label("Show only rows with these words").fill("closes carrier HG9900")
    pairs = page.get_by_role("region", name="Pairs of inertial unit and receiver")
    expect(pairs.get_by_role("radio")).to_have_count(0)  # its sheet is silent on the accelerometers
    page.get_by_label("Show only rows with these words").fill("ln-100 closes")
    expect(pairs.get_by_role("radio")).not_to_have_count(0)
    pairs.get_by_role("radio").first.focus()
    page.keyboard.press("Space")
    adopt = page.get_by_role("button", name="Adopt the selected row")
    expect(adopt).to_be_enabled()
    adopt.press("Enter")
    expect(page.get_by_text("Adopted LN-100 with")).to_be_visible()
    expect(page.get_by_label("Angle random walk").first).to_have_value("0.001 °/√h")
    pairs.get_by_role("button", name="Margin [%]").press("Enter")
    expect(pairs.get_by_role("columnheader", name="Margin [%]")).to_have_attribute("aria-sort", "ascending")


def test_uncertain_inputs_give_a_probability(visit: Visit) -> None:
    page = _open(visit)
    page.get_by_label("Angle random walk: range").fill("0.02 °/√h .. 0.06 °/√h")
    page.keyboard.press("Enter")
    expect(page.get_by_text("Closes with")).to_contain_text("40.1 %", timeout=30_000)


def test_nothing_overflows_a_phone(visit: Visit) -> None:
    page = _open(visit, width=390, height=844)
    strip = page.get_by_role("status").first.bounding_box()
    assert strip is not None
    assert strip["x"] + strip["width"] <= 391

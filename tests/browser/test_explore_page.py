"""The Explore page as a person uses it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from app.subjects.budget.page import _LAYOUT

Visit = Callable[..., Page]
Check = Callable[..., None]

_SOURCE = """(name) => {
  const out = {}
  for (const d of Bokeh.documents) for (const m of d._all_models.values())
    if (m.type === "ColumnDataSource" && m.name === name)
      for (const [key, value] of (m.data.entries ? m.data.entries() : Object.entries(m.data))) out[key] = [...value]
  return out
}"""


_FIGURES = """() => [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "Figure").length"""


def _open(visit: Visit, **size: int) -> Page:
    page = visit(**size)
    # Nobody turns the page before the first one's charts have all come, as a script on a busy machine would.
    page.wait_for_function(f"(count) => ({_FIGURES})() >= count", arg=len(_LAYOUT))
    if size:
        page.keyboard.press("Escape")  # the drawer, open over a narrow page
    page.get_by_role("tab", name="Explore").click()
    expect(page.get_by_text("Sensors that meet the requirements")).to_be_visible()
    return page


def _cross(page: Page) -> list[float]:
    data = page.evaluate(_SOURCE, "map design")
    return [data["x"][0], data["y"][0]]


@pytest.mark.slow
def test_answer_first_then_a_slider_moves_it_and_the_cross(visit: Visit) -> None:
    page = _open(visit)
    answer = page.get_by_role("status").first
    expect(answer).to_contain_text("Largest gyro noise (angle random walk) that closes: 0.036 °/√h")
    expect(answer).to_contain_text("You have 0.15 °/√h")
    page.wait_for_function(f"() => ({_SOURCE})('map design').x")
    before = _cross(page)
    slider = page.get_by_role("slider", name="Angle random walk")
    slider.focus()
    page.keyboard.press("ArrowLeft")
    expect(answer).not_to_contain_text("You have 0.15 °/√h")
    expect(answer).to_contain_text("0.036 °/√h")  # the others are held: the largest value does not move
    page.wait_for_function(f"(x) => ({_SOURCE})('map design').x[0] < x", arg=before[0])
    assert _cross(page)[1] == before[1]
    catalogue = page.evaluate(_SOURCE, "map catalogue")
    said = dict(zip(catalogue["unit"], catalogue["said"], strict=True))
    assert said["LN-100"].startswith("meets the limit, margin +")
    assert said["MPU-9250"].startswith("does not meet the limit, margin −")


def test_click_on_the_map_adopts_the_point_clicked(visit: Visit) -> None:
    page = _open(visit)
    page.wait_for_function(f"() => ({_SOURCE})('map design').x")
    canvas = page.locator(".bk-Figure:visible").first
    canvas.evaluate("element => element.scrollIntoView({block: 'center'})")
    canvas.click(trial=True)  # once it has come to rest
    place = canvas.bounding_box()
    assert place is not None
    before = _cross(page)
    page.mouse.click(place["x"] + 0.3 * place["width"], place["y"] + 0.7 * place["height"])
    page.wait_for_function(f"(x) => ({_SOURCE})('map design').x[0] !== x", arg=before[0])
    x, y = _cross(page)
    expect(page.get_by_label("Angle random walk").first).to_have_value(f"{x:.3g} °/√h")
    expect(page.get_by_label("Velocity random walk").first).to_have_value(f"{y:.3g} m/s/√h")


@pytest.mark.slow
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
    pairs.get_by_role("button", name="Margin").press("Enter")
    expect(pairs.get_by_role("columnheader", name="Margin")).to_have_attribute("aria-sort", "ascending")


@pytest.mark.slow
def test_uncertain_inputs_then_own_units_found_and_nothing_axe_minds(
    visit: Visit, tmp_path: Path, accessible: Check
) -> None:
    page = _open(visit)
    page.get_by_label("Angle random walk: range").fill("0.02 °/√h .. 0.06 °/√h")
    page.keyboard.press("Enter")
    expect(page.get_by_text("Closes with")).to_contain_text("40.1 %")

    own = tmp_path / "own.toml"
    own.write_text(
        '[[imu]]\nname = "Ours"\n'
        'angle_random_walk = { value = "0.011 °/√h", status = "confirmed", source = "bench" }\n'
        'velocity_random_walk = { value = "0.012 m/s/√h", status = "confirmed", source = "bench" }\n',
        encoding="utf-8",
    )
    page.locator(
        "input[type=file][accept='.toml']:below(:text('Sensors that meet the requirements'))"
    ).first.set_input_files(own)
    expect(page.get_by_text("Added Ours.")).to_be_visible()
    page.get_by_label("Show only rows with these words").fill("ours design")
    pairs = page.get_by_role("region", name="Pairs of inertial unit and receiver")
    expect(pairs.get_by_role("radio")).to_have_count(1)
    accessible(page)


@pytest.mark.slow
def test_nothing_overflows_a_phone(visit: Visit, fits: Check) -> None:
    page = _open(visit, width=390, height=844)
    strip = page.get_by_role("status").first.bounding_box()
    assert strip is not None
    assert strip["x"] + strip["width"] <= 391
    fits(page, 390)

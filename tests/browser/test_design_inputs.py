"""The design on the left as a person uses it: typed values, catalogue, undo, links, files."""

import re
from pathlib import Path

import pytest
from known_designs import L_BAND
from on_page import Visit, box, card, content, enter, section
from playwright.sync_api import Page, expect

from app.examples import example
from nav_model.design.file import parse_design
from nav_model.design.link import from_query


def test_an_invalid_text_is_said_in_the_verdict_and_goes_with_reset(desk: Page) -> None:
    arw = box(desk, "Angle random walk")
    expect(arw).to_have_value("0.15 °/√h")  # the reset after another test has reached the box
    enter(arw, "5 kg")
    expect(desk.get_by_role("status").first).to_contain_text("1 input is invalid: last valid values used.")
    desk.get_by_role("button", name="Open", exact=True).click()
    desk.get_by_role("button", name="Reset").click()
    expect(arw).to_have_value("0.15 °/√h")
    expect(desk.get_by_role("status").first).not_to_contain_text("invalid")
    enter(box(desk, "Fix interval"), "5 Hz")
    expect(box(desk, "Fix interval")).to_have_value("0.2 s")
    enter(arw, "0,5")
    expect(arw).to_have_value("0.5 °/√h")


def test_typed_value_unit_and_refusal(desk: Page) -> None:
    arw = box(desk, "Angle random walk")
    enter(arw, "9 deg/h/sqrt(Hz)")  # = 0.15 °/√h
    expect(arw).to_have_value("9 °/h/√Hz")
    expect(card(desk, "Quadratic phase")).to_have_text("182°")
    enter(arw, "0.3")  # a bare number takes the unit beside the box: 0.3 °/h/√Hz
    expect(arw).to_have_value("0.3 °/h/√Hz")
    expect(card(desk, "Quadratic phase")).not_to_have_text("182°")
    before = card(desk, "Quadratic phase").inner_text()
    for wrong, message in (
        ("5 kg", "not a unit of angle random walk"),
        ("-1 °/√h", "must be at least"),
        ("nan °/√h", "is not an angle random walk. Try 0.5 °/√h."),
    ):
        enter(arw, wrong)
        expect(desk.get_by_text(message).first).to_be_visible()
        expect(card(desk, "Quadratic phase")).to_have_text(before)
    enter(arw, "0.15 °/√h")
    expect(card(desk, "Quadratic phase")).to_have_text("182°")


def test_all_of_a_row_is_there_for_a_screen_reader(desk: Page) -> None:
    noise = box(desk, "Angle random walk")
    slider = desk.get_by_role("slider", name="Angle random walk")
    expect(slider).to_have_attribute("aria-valuetext", "0.15 °/√h")
    noise.focus()
    expect(noise).to_have_accessible_description(re.compile("White noise of the gyros, per axis"))
    enter(noise, "5 kg")
    expect(noise).to_have_attribute("aria-invalid", "true")
    expect(noise).to_have_accessible_description(re.compile("not a unit of angle random walk"))
    noise.press("Escape")  # what was refused is taken back
    expect(noise).to_have_value("0.15 °/√h")
    expect(noise).to_have_attribute("aria-invalid", "false")
    slider.press("ArrowRight")
    expect(slider).to_have_attribute("aria-valuetext", "0.157 °/√h")
    expect(noise).to_have_value("0.157 °/√h")
    slider.press("PageDown")
    expect(noise).to_have_value("0.0991 °/√h")
    expect(desk.get_by_role("slider", name="Velocity noise")).to_have_attribute("aria-valuetext", "no velocity")


# Of the rows that are in view: how high each is.
_HEIGHTS = """() => {
  const found = [], walk = (root) => { for (const element of root.querySelectorAll("*")) {
    if (element.matches(".row:has(label)")) found.push(element.getBoundingClientRect().height)
    if (element.shadowRoot) walk(element.shadowRoot)
  } }
  walk(document)
  return found
}"""


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720)])
def test_the_sliders_that_are_tried_together_are_in_view_together(plain: Page, width: int, height: int) -> None:
    plain.set_viewport_size({"width": width, "height": height})
    plain.locator(".sidebar").evaluate("e => e.scrollTo(0, 0)")
    for name in ("Velocity random walk", "Angle random walk", "Position noise", "Fix interval", "Velocity noise"):
        place = plain.get_by_role("slider", name=name, exact=True).bounding_box()
        assert place["y"] + place["height"] <= height, name
    rows = plain.evaluate(_HEIGHTS)
    assert len(rows) > 15
    assert max(rows) <= 44
    plain.set_viewport_size({"width": 1440, "height": 900})


def test_undo_redo_reset_by_keyboard(desk: Page) -> None:
    enter(box(desk, "Position noise"), "2 cm")
    expect(card(desk, "Horizontal position")).not_to_have_text("0.404 m")
    changed = card(desk, "Horizontal position").inner_text()
    expect(desk.get_by_role("button", name="Undo")).to_be_enabled()
    desk.get_by_role("button", name="Undo").focus()
    desk.keyboard.press("Enter")
    expect(card(desk, "Horizontal position")).to_have_text("0.404 m")
    expect(box(desk, "Position noise")).to_have_value("1 m")
    expect(desk.get_by_role("button", name="Redo")).to_be_enabled()
    desk.get_by_role("button", name="Redo").focus()
    desk.keyboard.press("Enter")
    expect(card(desk, "Horizontal position")).to_have_text(changed)
    desk.get_by_role("button", name="Open", exact=True).press("Enter")
    desk.get_by_role("button", name="Reset").press("Enter")
    expect(card(desk, "Horizontal position")).to_have_text("0.404 m")


def test_what_is_done_after_a_slider_is_not_overtaken_by_it(desk: Page) -> None:
    """Sliders tell their newest place when the last has been answered; Reset right after must not come before it."""
    slider = desk.get_by_role("slider", name="Angle random walk").element_handle()
    desk.get_by_role("button", name="Open", exact=True).click()
    reset = desk.get_by_role("button", name="Reset").element_handle()
    desk.evaluate(
        """([slider, reset]) => {
          slider.focus()
          for (const times of [1, 2, 3]) {
            slider.value = slider.valueAsNumber + times / 10
            slider.dispatchEvent(new Event("input"))
          }
          slider.blur()
          reset.click()
        }""",
        [slider, reset],
    )
    name = desk.get_by_role("textbox", name="Design", exact=True)
    enter(name, "Told after the reset")
    expect(desk.get_by_role("button", name="Redo")).to_be_disabled()
    expect(box(desk, "Angle random walk")).to_have_value("0.15 °/√h")
    expect(card(desk, "Horizontal position")).to_have_text("0.404 m")


@pytest.mark.slow
def test_preset_deviation_is_marked_and_taken_back(visit: Visit) -> None:
    page = visit()
    noise, source = box(page, "Angle random walk"), page.get_by_role("combobox", name="From the catalogue").first
    mark = page.get_by_label("Source of Angle random walk")
    expect(mark).to_have_text("⚠")
    expect(noise).to_have_accessible_description(re.compile("secondary source"))
    enter(noise, "0.2 °/√h")
    expect(mark).to_have_text("≠")
    expect(mark).to_have_attribute("title", "≠ STIM300: 0.15 °/√h")
    expect(source.locator("option:checked")).to_have_attribute("label", "Custom, based on STIM300")
    mark.click()
    expect(page.get_by_text("≠ STIM300: 0.15 °/√h")).to_be_visible()
    page.get_by_role("button", name="Restore catalogue values").first.click()
    expect(noise).to_have_value("0.15 °/√h")
    source.select_option("LN-100")
    expect(box(page, "Angle random walk")).to_have_value("0.001 °/√h")
    expect(page.get_by_role("status").first).to_contain_text("Closes")


def test_link_reproduces_the_design(desk: Page, visit: Visit, server: str) -> None:
    page = desk
    enter(box(page, "Position noise"), "7 cm")
    expect(card(page, "Horizontal position")).not_to_have_text("0.404 m")
    figure = card(page, "Horizontal position").inner_text()
    page.get_by_role("button", name="Share").click()
    address = page.get_by_role("textbox", name="Link to this design and page")
    expect(address).to_have_value(re.compile("gn=7cm"))
    link = address.input_value()
    assert link.startswith(f"{server}/?")
    assert link.endswith("#budget")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_text("Copied.")).to_be_visible()
    assert page.evaluate("() => navigator.clipboard.readText()") == link
    query = link.removeprefix(f"{server}/").removesuffix("#budget")
    assert from_query(query).gnss.position_noise == 0.07
    again = visit(f"/{query}")
    expect(card(again, "Horizontal position")).to_have_text(figure)


@pytest.mark.parametrize(
    "query",
    [
        "?imu=<script>alert(1)</script>",
        *(
            pytest.param(q, marks=pytest.mark.slow)
            for q in ("?arw=5kg", "?nonsense=1", "?f=1e999GHz", "?%ff", "?ta=3600s&arw=&&")
        ),
    ],
)
def test_forged_link_is_said_and_harms_nothing(visit: Visit, query: str) -> None:
    page = visit(f"/{query}")
    expect(page.get_by_text("The link was not used.").first).to_be_visible()
    expect(card(page, "Horizontal position")).to_have_text("0.404 m")


def test_save_open_and_refuse(desk: Page, tmp_path: Path) -> None:
    page = desk
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save", exact=True).click()
    saved = parse_design(content(waiting.value))
    assert waiting.value.suggested_filename == "mems-imu-at-x-band.toml"
    assert saved == example("mems_x_band")
    chooser = page.locator("input[type=file]").first
    chooser.set_input_files(L_BAND)
    expect(page.get_by_role("status").first).to_contain_text("Closes")
    expect(box(page, "Design")).to_have_value("L band from a jet")
    expect(box(page, "Angle random walk")).to_have_value("0.125 °/√h")
    bad = tmp_path / "bad.toml"
    bad.write_bytes(b'[imu]\nangle_random_walk = "5 kg"\n')
    chooser.set_input_files(bad)
    expect(page.get_by_text("Not opened. imu.angle_random_walk")).to_be_visible()
    expect(page.get_by_role("status").first).to_contain_text("Closes")
    (tmp_path / "binary.toml").write_bytes(bytes(range(256)))
    chooser.set_input_files(tmp_path / "binary.toml")
    expect(page.get_by_text("not a text file")).to_be_visible()


def test_an_impossible_aperture_is_refused_at_its_field(desk: Page) -> None:
    section(desk, "Radar")
    before = card(desk, "Quadratic phase").inner_text()
    enter(box(desk, "Slant range"), "2000 km")
    enter(box(desk, "Azimuth resolution"), "1 mm")
    expect(desk.get_by_text(re.compile("needs an aperture of")).first).to_be_visible()
    enter(box(desk, "Slant range"), "7 km")
    expect(card(desk, "Quadratic phase")).to_have_text(before)


def test_a_long_value_is_whole_in_its_box(desk: Page) -> None:
    """As an accuracy that grows with the baseline, which a receiver class fills in."""
    desk.get_by_role("combobox", name="Receiver class", exact=True).select_option("RTK")
    noise = box(desk, "Position noise")
    expect(noise).to_have_value("8 mm + 1 ppm DRMS")
    assert noise.evaluate("e => e.scrollWidth <= e.clientWidth")

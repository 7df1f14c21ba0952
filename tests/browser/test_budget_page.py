"""The Budget page as a person uses it."""

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from known_designs import MEMS
from on_page import Check, Visit, box, card, columns, content, enter, section, turn
from playwright.sync_api import Locator, Page, expect
from waiting import until

from app.examples import example
from nav_model.budget import analyse
from nav_model.design.file import parse_design
from nav_model.design.other_filters import noise_for


def test_first_screen_gives_the_answer(plain: Page) -> None:
    budget = analyse(example("mems_x_band"))
    status = plain.get_by_role("status").first
    expect(status).to_contain_text("Does not close")
    expect(status).to_contain_text("gyro noise")
    assert not budget.verdict.closes
    expect(card(plain, "Horizontal position")).to_have_text(
        f"{budget.steady_state.prior['horizontal_position']:.3g} m"
    )
    plain.get_by_label("Source and method: SAR phase error by source").click()
    expect(plain.get_by_text("Formulas along the line of sight as it turns [S-8]").first).to_be_visible()
    plain.get_by_label("Source and method: SAR phase error by source").click()


# What the strip says in each frame in which the switch has changed.
_TOLD = """([group, status]) => {
  const strip = status.getRootNode()
  window.told = []
  const look = () => requestAnimationFrame(() => told.push(strip.querySelector(".strip").innerText))
  new MutationObserver(look).observe(group, { attributes: true, subtree: true })
}"""


def test_both_processings_are_told_and_the_chosen_one_decides(desk: Page) -> None:
    """The worked example smoothed, 73.8° and 22.8° against 90° and 20°; its parts as processing.md prints them."""
    expect(desk.get_by_role("button", name="Real time ✗ 2.73 ×")).to_have_attribute("aria-pressed", "true")
    smoothed = desk.get_by_role("button", name="Post-processed ✗ 1.14 ×")
    parts = desk.get_by_role("group", name="Processing"), desk.get_by_role("status").first
    desk.evaluate(_TOLD, [part.element_handle() for part in parts])
    smoothed.click()
    expect(smoothed).to_have_attribute("aria-pressed", "true")
    texts = desk.wait_for_function("() => told.length && told").json_value()
    assert all("22.8°, limit 20°" in text for text in texts), texts
    expect(card(desk, "Quadratic phase")).to_have_text("73.8°")
    expect(card(desk, "Detrended phase")).to_have_text("22.8°")
    bars = desk.locator("table.bars")
    expect(bars.locator("tr.total")).to_contain_text("73.8°")
    expect(bars.get_by_role("row", name=re.compile("^line of sight"))).to_contain_text("70.6°")
    expect(desk.get_by_role("status").first).to_contain_text("22.8°, limit 20°")
    noise = desk.get_by_role("textbox", name="Position noise", exact=True)
    noise.fill("30 cm")
    noise.press("Enter")
    expect(smoothed).to_be_hidden()  # its margin is another
    chosen = desk.get_by_role("button", name="Post-processed", pressed=True)
    expect(chosen).to_have_count(1)


# For each figure in view: how much of its width its frame has, and how high that is.
_FRAMES = """() => {
  const figures = (view) => [...(view.model.type === "Figure" && view.is_displayed ? [view] : []),
    ...[...(view.child_views ?? [])].flatMap(figures)]
  return Bokeh.index.roots.flatMap(figures)
    .map(({ frame, bbox }) => [frame.bbox.width / bbox.width, frame.bbox.height])
}"""


def test_unfolded_charts_are_drawn_as_wide_as_their_place(visit: Visit) -> None:
    page = visit()
    page.get_by_role("button", name="What limits horizontal position").click()
    page.wait_for_function(f"() => ({_FRAMES})().length === 5")
    page.wait_for_function(f"() => ({_FRAMES})().every(([share, high]) => share > 0.75 && high > 50)")


# Boxes of what must be seen at once, and how many of each there are.
_BOXES = """() => {
  const kinds = {
    ".strip": "verdict", ".tile": "tile", ".others": "other", ".bk-Figure": "chart", "table.bars": "phase",
  }
  const found = [], roots = [document]
  for (const root of roots)
    for (const element of root.querySelectorAll("*")) {
      if (element.shadowRoot) roots.push(element.shadowRoot)
      const kind = Object.keys(kinds).find(selector => element.matches(selector))
      if (!kind || !element.getClientRects().length) continue
      const { left, top, right, bottom } = element.getBoundingClientRect()
      found.push([kinds[kind], left, top, right, bottom])
    }
  return found
}"""
_SEEN = {"verdict": 1, "tile": 4, "other": 1, "chart": 4, "phase": 1}


def test_the_answer_and_what_moves_it_are_on_one_screen(plain: Page) -> None:
    """Verdict, all tiles, the three sigma charts, phase by source and point target, with the design beside them."""
    expect(plain.locator(".bk-Figure:visible")).to_have_count(4)
    expect(box(plain, "Angle random walk")).to_be_visible()
    for width, height in ((1440, 900), (1920, 1080), (1280, 720)):
        plain.set_viewport_size({"width": width, "height": height})

        def inside(width: int = width, height: int = height) -> bool:
            boxes = plain.evaluate(_BOXES)
            counted = {kind: sum(entry[0] == kind for entry in boxes) for kind in _SEEN}
            fits = all(
                0 <= left < right <= width and 0 <= top < bottom <= height for _, left, top, right, bottom in boxes
            )
            return counted == _SEEN and fits

        until(inside, f"everything inside a window of {width} x {height}")
    plain.set_viewport_size({"width": 1440, "height": 900})


def _curves(page: Page) -> dict[str, float]:
    """Where each ends."""
    return {name: values[-1] for name, values in columns(page, "timelines").items() if name != "x"}


def test_one_step_of_a_slider_changes_all_of_it(desk: Page) -> None:
    """Every sigma that gyro noise moves, tiles, phase bars; and what was before is told beside it, until cleared."""
    curves, bars = _curves(desk), desk.locator("table.bars").inner_text()
    tiles = [card(desk, name).inner_text() for name in ("Tilt", "Quadratic phase", "Detrended phase")]
    assert len(curves) == 11  # five of them for the outage in real time beside a smoothed one
    slider = desk.get_by_role("slider", name="Angle random walk")
    slider.focus()
    for _ in range(3):
        slider.press("ArrowRight")
    # The vertical channel has no gyro in it; nothing is smoothed.
    moved = [name for name in curves if "vertical" not in name and "real time" not in name]

    def moves() -> bool:
        now = _curves(desk)
        return all(now[name] > curves[name] for name in moved)

    until(moves, "the curves")

    def shows_the_box() -> bool:
        changes = [f"imu.angle_random_walk={box(desk, 'Angle random walk').input_value()}"]
        expected = analyse(parse_design(Path(MEMS).read_bytes(), changes=changes))
        outage = list(expected.coast.refined_horizontal)
        curve = columns(desk, "timelines")["position horizontal"][-len(outage) :]  # before it: the steady state
        return bool(curve == pytest.approx(outage, rel=1e-12))

    until(shows_the_box, "the last key press on its way round to the curve")
    expect(desk.locator("table.bars")).not_to_have_text(bars)
    for name, before in zip(("Tilt", "Quadratic phase", "Detrended phase"), tiles, strict=True):
        expect(card(desk, name)).not_to_have_text(before)
    # Steps that reach a busy server one by one are changes of their own: 0.15, 0.153 or 0.157.
    expect(desk.get_by_text(re.compile(r"Compared with: Angle random walk 0\.15\d? °/√h"))).to_be_visible()
    tile = desk.locator(".tile").filter(has=desk.get_by_text("Quadratic phase", exact=True))
    delta = tile.locator(".delta")
    expect(delta).to_contain_text("was ")
    desk.get_by_role("button", name="clear").click()
    expect(delta).to_have_count(0)
    desk.get_by_role("button", name="choose").click()
    desk.get_by_role("button", name="Previous version").click()
    expect(delta).to_be_visible()


_READ_OUT = """() => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const of = (name, column) => {
    const data = sources.find(m => m.name === name).data
    return [...(data instanceof Map ? data.get(column) : data[column])]
  }
  const [time = ""] = of("position read-out", "text"), [text = ""] = of("attitude read-out", "text")
  return [`${time.split("   ")[0]} ${text}`.trim(), of("timelines", "x"), of("timelines", "attitude tilt")]
}"""


def test_the_read_out_says_the_curves_in_the_units_of_their_axes(visit: Visit) -> None:
    """In SI: radians, which the same pointer had said to be degrees."""
    page = visit("/?show=1s.si")
    for unit in ("rad", "°"):
        if unit == "°":
            page.get_by_role("button", name="View", exact=True).click()
            page.get_by_label("Units").select_option("")
            page.keyboard.press("Escape")
        frame = page.locator(".bk-Figure:visible").nth(1)
        pattern = rf"([−\d.]+) s tilt ([\d.e−]+)   heading growth [\d.e−]+ {unit}"
        place = 300

        def hovered(pattern: str = pattern, frame: Locator = frame) -> re.Match[str] | None:
            nonlocal place
            place = 601 - place  # a pointer that does not move is told nothing
            frame.hover(position={"x": place, "y": 60})
            return re.fullmatch(pattern, page.evaluate(_READ_OUT)[0])

        read_out = until(hovered, f"a read-out in {unit}")
        _, times, tilt = page.evaluate(_READ_OUT)
        time, value = (float(part.replace("−", "-")) for part in read_out.groups())
        at = min(range(len(times)), key=lambda i: abs(times[i] - time))
        assert value == pytest.approx(tilt[at], rel=6e-3)
        page.mouse.move(5, 5)
        until(lambda: page.evaluate(_READ_OUT)[0] == "", "no read-out away from the charts")


_WIDTHS = """() => {
  const models = [...Bokeh.documents[0]._all_models.values()], pen = document.createElement("canvas").getContext("2d")
  return models.filter(m => m.type === "GlyphRenderer" && m.data_source.name?.endsWith("read-out")).map(m => {
    pen.font = `${m.glyph.text_font_size.value} ${m.glyph.text_font.value}`
    const [text = ""] = m.data_source.get_array("text")
    const {inner_width} = models.find(p => p.type === "Figure" && p.renderers.includes(m))
    const widest = Math.max(...text.split("\\n").map(line => pen.measureText(line).width))
    return [text.includes("real time"), widest, inner_width]
  })
}"""


def test_a_long_read_out_stays_in_its_chart(visit: Visit) -> None:
    """Post-processed there are four curves with longer names."""
    page = visit("/?proc=post-processed&show=95.si")
    place = 300

    def hovered() -> list[Any] | None:
        nonlocal place
        place = 601 - place
        page.locator(".bk-Figure:visible").nth(1).hover(position={"x": place, "y": 60})
        sizes: list[Any] = page.evaluate(_WIDTHS)
        return sizes if all(labelled for labelled, _, _ in sizes) else None

    widths = until(hovered, "a read-out of all charts")
    assert len(widths) == 3
    assert all(text < frame for _, text, frame in widths)


def test_what_is_folded_opens_and_follows(desk: Page) -> None:
    desk.get_by_role("button", name="Requirements and cautions").click()
    row = desk.get_by_role("row", name=re.compile("^Quadratic phase")).first
    expect(row).to_contain_text("182°")
    enter(box(desk, "Angle random walk"), "0.3")
    expect(row).not_to_contain_text("182°")
    desk.get_by_role("button", name="Requirements and cautions").click()


def test_what_would_close_it_is_one_press_away(desk: Page) -> None:
    desk.get_by_role("button", name="What would close it").click()
    way = desk.get_by_role("button", name=re.compile("^IMU Sagem")).first
    expect(way).to_be_visible()
    desk.keyboard.press("Escape")
    expect(way).to_be_hidden()
    expect(desk.get_by_role("button", name="What would close it")).to_be_focused()
    desk.keyboard.press("Enter")
    way.click()
    expect(desk.get_by_role("status").first).to_contain_text("✓ Closes")
    expect(way).to_be_hidden()  # it has done its work
    expect(desk.get_by_role("button", name="Headroom")).to_be_visible()


def test_image_location_errors_are_taken_away(plain: Page) -> None:
    with plain.expect_download() as waiting:
        plain.get_by_role("button", name="Exports").click()
        plain.get_by_role("button", name="Image location errors: SICD XML").click()
    assert ElementTree.fromstring(content(waiting.value)).tag == "{urn:SICD:1.4.0}ErrorStatistics"


@pytest.mark.parametrize(
    ("button", "magic"),
    [("PDF report", b"%PDF-"), pytest.param("HTML report", b"<!doctype html>", marks=pytest.mark.slow)],
)
def test_report_from_the_page(plain: Page, button: str, magic: bytes) -> None:
    plain.get_by_role("button", name="Report", exact=True).click()
    with plain.expect_download() as waiting:
        plain.get_by_role("button", name=button).click()
        expect(plain.get_by_role("button", name=re.compile("^Writing"))).to_be_visible()
    expect(plain.get_by_role("button", name="Report", exact=True)).to_be_visible()
    plain.get_by_role("button", name=button).press("Escape")
    expect(plain.get_by_role("button", name=button)).to_be_hidden()
    assert content(waiting.value).lower().startswith(magic.lower())


def test_phone_fits_and_the_design_is_a_drawer(visit: Visit, fits: Check) -> None:
    page = visit(width=390, height=844)
    fits(page, 390)
    assert page.evaluate("() => document.documentElement.clientWidth") == 390
    expect(page.get_by_role("status").first).to_contain_text("Does not close")  # nothing lies over it
    page.get_by_role("button", name="Open drawer").click()
    expect(box(page, "Angle random walk")).to_be_visible()
    page.get_by_role("button", name="Close", exact=True).click()
    expect(box(page, "Angle random walk")).to_be_hidden()
    page.get_by_role("tab", name="Budget").click()


def test_no_serious_accessibility_violation_in_light_and_dark(visit: Visit, accessible: Check) -> None:
    page = visit()
    for title in ("Flight", "Outage", "Radar", "Requirements"):
        section(page, title)
    box(page, "Grazing angle").wait_for()
    box(page, "Vertical position after the outage").wait_for()
    accessible(page, "light")
    page.get_by_role("button", name="theme").click()
    accessible(page, "dark")


def test_contributors_are_entered_by_keyboard_and_a_refusal_loses_nothing(visit: Visit, accessible: Check) -> None:
    page = visit("?dpe=20deg")
    turn(page, "Allocate")
    add = page.get_by_role("button", name="Add contributor")
    add.press("Enter")
    page.keyboard.type("lever arm")
    page.keyboard.press("Tab")
    page.keyboard.type("3 kg")
    page.keyboard.press("Tab")  # to the figure it enters, of which a letter chooses one
    expect(page.get_by_role("alert").filter(has_text="lever arm, Value, 1σ: '3 kg' does not fit")).to_be_visible()
    value = page.get_by_role("textbox", name="Value, 1σ: lever arm")
    expect(value).to_have_value("3 kg")
    page.keyboard.type("Detrended")
    value.fill("3 mm")
    value.press("Enter")
    expect(page.get_by_role("alert").filter(has_text="does not fit")).to_have_count(0)
    answer = page.get_by_role("status").first
    expect(answer).to_contain_text("from lever arm")
    expect(
        page.get_by_role("row", name="lever arm").filter(has=page.get_by_label("Locked at: lever arm"))
    ).to_be_visible()
    accessible(page, "light")
    page.get_by_role("button", name="Remove lever arm").press("Enter")
    expect(answer).not_to_contain_text("lever arm")
    expect(add).to_be_focused()


def test_a_contributor_that_a_requirement_limits_stays_in_its_table(visit: Visit) -> None:
    page = visit(
        '?contributors=[{"name":"arm","value":"1 mm","enters":"cubic_phase"}]'
        '&limits=[{"name":"arm known","on":"arm","limit":"2 mm"}]'
    )
    turn(page, "Allocate")
    remove = page.get_by_role("button", name="Remove arm", exact=True)
    remove.press("Enter")
    refused = page.get_by_role("alert").filter(has_text="'arm known' limits 'arm'")
    expect(refused).to_be_visible()
    page.get_by_role("button", name="Remove arm known").press("Enter")
    expect(refused).to_have_count(0)
    remove.press("Enter")
    expect(remove).to_have_count(0)


def test_noise_for_another_filter_is_among_the_reports(plain: Page) -> None:
    plain.get_by_role("button", name="Report").click()
    with plain.expect_download() as waiting:
        plain.get_by_role("button", name="KF-GINS: imunoise").click()
    assert content(waiting.value).decode() == noise_for(example("mems_x_band"), "kf-gins")
    expect(plain.get_by_role("button", name="kalibr: imu.yaml")).to_be_hidden()  # the menu has closed
    plain.get_by_role("button", name="Report").click()
    plain.get_by_role("button", name="kalibr: imu.yaml").click()
    expect(plain.get_by_text("No file for kalibr. Residual gyro bias: kalibr needs")).to_be_visible()


def test_a_vendors_table_is_taken_into_the_design(desk: Page) -> None:
    desk.get_by_role("button", name="Errors as data sheets print them").click()
    expect(desk.get_by_role("cell", name="659 cm")).to_be_visible()
    rows = desk.get_by_label("Vendor's table in real time, one row per line")
    rows.fill(
        "no outage: horizontal 0.4039 m, vertical 0.2140 m, velocity 0.03694 m/s, roll and pitch 0.05986°\n"
        "10 s: horizontal 0.9174 m, vertical 0.5641 m, velocity 0.1146 m/s, tilt 0.06141°, heading 0.01392°\n"
        "60 s: horizontal 20.43 m, vertical 18.01 m, velocity 0.7238 m/s, roll and pitch 0.09316°, heading 0.07143°"
    )
    desk.get_by_role("button", name="Which noise does it imply?").click()
    desk.get_by_role("button", name="Use in the design").click()
    expect(desk.get_by_text("Implied noise and its source copied to the design.")).to_be_visible()


def test_a_notice_moves_nothing_and_goes_and_a_menu_closes_with_escape_and_with_its_page(visit: Visit) -> None:
    page = visit()
    tiles = page.locator(".bk-Figure:visible").first
    place = tiles.bounding_box()
    page.get_by_role("button", name="Open", exact=True).click()
    page.get_by_role("button", name="L band from a jet").click()
    notice = page.get_by_text("is open. Undo brings the last design back.")
    expect(notice).to_be_visible()
    assert tiles.bounding_box() == place
    expect(notice).to_be_hidden(timeout=60_000)
    page.get_by_role("slider", name="Angle random walk").focus()  # no text, whose own undo it would be
    page.keyboard.press("Control+z")
    expect(page.get_by_role("textbox", name="Design", exact=True)).to_have_value("MEMS IMU at X band")
    pdf = page.get_by_role("button", name="PDF report")
    for leave in (lambda: page.keyboard.press("Escape"), lambda: page.get_by_role("tab", name="Review").click()):
        page.get_by_role("button", name="Report", exact=True).click()
        expect(pdf).to_be_visible()
        leave()
        expect(pdf).to_be_hidden()
    page.get_by_role("tab", name="Budget", exact=True).click()
    expect(tiles).to_be_visible()

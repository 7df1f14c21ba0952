"""The Budget page as a person uses it."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Download, Locator, Page, expect
from waiting import until

from nav_model.budget import analyse
from nav_model.design.file import parse_design, read_design
from nav_model.design.link import from_query

Visit = Callable[..., Page]
Check = Callable[..., None]

EXAMPLES = Path(__file__).parents[2] / "examples"
_CURVE = """(name) => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const data = sources.find(m => m.name === name).data
  const columns = data instanceof Map ? data : new Map(Object.entries(data))
  return [...columns.get("position horizontal")]
}"""


def box(page: Page, label: str) -> Locator:
    """The text box of an input (its slider and unit carry other roles)."""
    return page.get_by_role("textbox", name=label, exact=True)


def card(page: Page, label: str) -> Locator:
    return page.locator(".card").filter(has=page.get_by_text(label, exact=True)).locator(".big")


def section(page: Page, title: str) -> None:
    page.get_by_role("button", name=title, exact=True).click()


def enter(field: Locator, text: str) -> None:
    field.fill(text)
    field.press("Enter")


def content(download: Download) -> bytes:
    path = download.path()
    assert path is not None
    return Path(path).read_bytes()


def test_first_screen_gives_the_answer(plain: Page) -> None:
    budget = analyse(read_design(EXAMPLES / "mems_x_band.toml"))
    status = plain.get_by_role("status").first
    expect(status).to_contain_text("Does not close")
    expect(status).to_contain_text("gyro noise")
    assert not budget.verdict.closes
    expect(card(plain, "Position, horizontal")).to_have_text(
        f"{100 * budget.steady_state.prior.position_horizontal:.3g} cm"
    )
    plain.get_by_label("Source and method: SAR phase error by source").click()
    expect(plain.get_by_text("Formulas [S-5]").first).to_be_visible()
    plain.get_by_label("Source and method: SAR phase error by source").click()


def test_both_processings_are_told_and_the_chosen_one_decides(desk: Page) -> None:
    """The worked example's smoothed figures as processing.md prints them: 70.63° and 21.94° against 90° and 20°."""
    expect(desk.get_by_role("button", name="Real time ✗ −144 %")).to_have_attribute("aria-pressed", "true")
    smoothed = desk.get_by_role("button", name="Post-processed ✗ −10 %")
    smoothed.click()
    expect(smoothed).to_have_attribute("aria-pressed", "true")
    expect(card(desk, "Quadratic phase")).to_have_text("70.6°")
    expect(card(desk, "Detrended phase")).to_have_text("21.9°")
    expect(desk.locator("table.bars tr.total")).to_contain_text("70.6°")
    expect(desk.get_by_role("status").first).to_contain_text("21.9°, limit 20°")
    noise = desk.get_by_role("textbox", name="Position noise", exact=True)
    noise.fill("30 cm")
    noise.press("Enter")
    expect(smoothed).to_be_hidden()  # its margin is another
    chosen = desk.get_by_role("button", name="Post-processed", pressed=True)
    expect(chosen).to_have_count(1)


# For each figure in view: how much of its width its frame has.
_FRAMES = """() => {
  const figures = (view) => [...(view.model.type === "Figure" && view.is_displayed ? [view] : []),
    ...[...(view.child_views ?? [])].flatMap(figures)]
  return Bokeh.index.roots.flatMap(figures).map((figure) => figure.frame.bbox.width / figure.bbox.width)
}"""


def test_unfolded_charts_are_drawn_as_wide_as_their_place(visit: Visit) -> None:
    page = visit()
    for title in ("What limits horizontal position", "Growth of the position error"):
        page.get_by_role("button", name=title).click()
    page.wait_for_function(f"() => ({_FRAMES})().length === 6")
    page.wait_for_function(f"() => ({_FRAMES})().every(share => share > 0.8)")


# Boxes of what must be seen at once, and how many of each there are.
_BOXES = """() => {
  const kinds = { ".strip": "verdict", ".tile": "tile", ".bk-Figure": "chart", "table.bars": "phase" }
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
_SEEN = {"verdict": 1, "tile": 8, "chart": 4, "phase": 1}


def test_the_answer_and_what_moves_it_are_on_one_screen(visit: Visit, page: Page) -> None:
    """Verdict, all tiles, the three sigma charts, phase by source and point target, with the design beside them."""
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text) if message.type == "warning" else None)
    visit()
    expect(page.locator(".bk-Figure:visible")).to_have_count(4)
    expect(box(page, "Angle random walk")).to_be_visible()
    for width, height in ((1440, 900), (1920, 1080), (1280, 720)):
        page.set_viewport_size({"width": width, "height": height})

        def inside(width: int = width, height: int = height) -> bool:
            boxes = page.evaluate(_BOXES)
            counted = {kind: sum(found[0] == kind for found in boxes) for kind in _SEEN}
            fits = all(
                0 <= left < right <= width and 0 <= top < bottom <= height for _, left, top, right, bottom in boxes
            )
            return counted == _SEEN and fits

        until(inside, f"everything inside a window of {width} x {height}")
    assert said == []


_ALL_CURVES = """() => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const data = sources.find(m => m.name === "timelines").data
  const columns = data instanceof Map ? data : new Map(Object.entries(data))
  const names = [...columns.keys()].filter(key => key !== "x")
  return Object.fromEntries(names.map(name => [name, [...columns.get(name)].at(-1)]))
}"""


def test_one_step_of_a_slider_changes_all_of_it(desk: Page) -> None:
    """Every sigma that gyro noise moves, tiles, phase bars; and what was before is told beside it, until cleared."""
    curves, bars = desk.evaluate(_ALL_CURVES), desk.locator("table.bars").inner_text()
    tiles = [card(desk, name).inner_text() for name in ("Roll, pitch", "Quadratic phase", "Detrended phase")]
    assert len(curves) == 6
    slider = desk.get_by_role("slider", name="Angle random walk")
    slider.focus()
    for _ in range(3):
        slider.press("ArrowRight")
    moved = [name for name in curves if "vertical" not in name]  # the vertical channel has no gyro in it

    def moves() -> bool:
        now = desk.evaluate(_ALL_CURVES)
        return all(now[name] > curves[name] for name in moved)

    until(moves, "the curves")
    expect(desk.locator("table.bars")).not_to_have_text(bars)
    for name, before in zip(("Roll, pitch", "Quadratic phase", "Detrended phase"), tiles, strict=True):
        expect(card(desk, name)).not_to_have_text(before)
    # Steps that reach a busy server one by one are changes of their own: 0.15, 0.153 or 0.157.
    expect(desk.get_by_text(re.compile(r"Compared with: Angle random walk 0\.15\d? °/√h"))).to_be_visible()
    delta = desk.locator(".tile").filter(has_text="Quadratic phase").locator(".delta")
    expect(delta).to_contain_text("+")
    desk.get_by_role("button", name="clear").click()
    expect(delta).to_have_count(0)
    desk.get_by_role("button", name="choose").click()
    desk.get_by_role("button", name="Value before the last change").click()
    expect(delta).to_be_visible()


def test_what_is_folded_opens_and_follows(desk: Page) -> None:
    desk.get_by_role("button", name="Requirements and cautions").click()
    row = desk.locator("tr").filter(has_text="Quadratic phase").first
    expect(row).to_contain_text("163°")
    enter(box(desk, "Angle random walk"), "0.3")
    expect(row).not_to_contain_text("163°")
    desk.get_by_role("button", name="Requirements and cautions").click()


def test_what_would_close_it_is_one_press_away(desk: Page) -> None:
    desk.get_by_role("button", name="What would close it").click()
    way = desk.get_by_role("button", name=re.compile("^IMU: ")).first
    expect(way).to_be_visible()
    way.click()
    expect(desk.get_by_role("status").first).to_contain_text("✓ Closes")
    expect(way).to_be_hidden()  # it has done its work
    expect(desk.get_by_role("button", name="Largest allowed values")).to_be_visible()


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


def test_slider_moves_box_curve_and_verdict_together(desk: Page) -> None:
    curve = desk.evaluate(_CURVE, "timelines")
    phase = card(desk, "Quadratic phase").inner_text()
    slider = desk.get_by_role("slider", name="Angle random walk")
    slider.focus()
    for _ in range(4):
        desk.keyboard.press("ArrowLeft")
    expect(box(desk, "Angle random walk")).not_to_have_value("0.15 °/√h")
    expect(card(desk, "Quadratic phase")).not_to_have_text(phase)

    def shows() -> bool:
        changes = [f"imu.angle_random_walk={box(desk, 'Angle random walk').input_value()}"]
        expected = analyse(parse_design((EXAMPLES / "mems_x_band.toml").read_bytes(), changes=changes))
        shown = desk.evaluate(_CURVE, "timelines")[2:]
        return bool(shown == pytest.approx(list(expected.coast.refined_horizontal), rel=1e-12))

    until(shows, "the last key press on its way round to the curve")
    assert desk.evaluate(_CURVE, "timelines")[50] != curve[50]


def test_typed_value_unit_and_refusal(desk: Page) -> None:
    arw = box(desk, "Angle random walk")
    enter(arw, "9 deg/h/sqrt(Hz)")  # = 0.15 °/√h
    expect(arw).to_have_value("9 °/h/√Hz")
    expect(card(desk, "Quadratic phase")).to_have_text("163°")
    enter(arw, "0.3")  # a bare number takes the unit beside the box: 0.3 °/h/√Hz
    expect(arw).to_have_value("0.3 °/h/√Hz")
    expect(card(desk, "Quadratic phase")).not_to_have_text("163°")
    kept = card(desk, "Quadratic phase").inner_text()
    for wrong, said in (
        ("5 kg", "not a unit of angle random walk"),
        ("-1 °/√h", "must be at least"),
        ("nan °/√h", "is not an angle random walk. Try 0.5 °/√h."),
    ):
        enter(arw, wrong)
        expect(desk.get_by_text(said).first).to_be_visible()
        expect(card(desk, "Quadratic phase")).to_have_text(kept)
    enter(arw, "0.15 °/√h")
    expect(card(desk, "Quadratic phase")).to_have_text("163°")


@pytest.mark.slow
def test_unit_chooser_converts_without_changing_the_value(visit: Visit) -> None:
    page = visit()
    before = card(page, "Position, horizontal").inner_text()
    page.get_by_role("combobox", name="unit").nth(1).click()
    page.get_by_role("menuitem", name="°/h/√Hz", exact=True).click()
    expect(box(page, "Angle random walk")).to_have_value("9 °/h/√Hz")
    expect(card(page, "Position, horizontal")).to_have_text(before)
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()


def test_undo_redo_reset_by_keyboard(desk: Page) -> None:
    enter(box(desk, "Position noise"), "2 cm")
    expect(card(desk, "Position, horizontal")).not_to_have_text("40.4 cm")
    changed = card(desk, "Position, horizontal").inner_text()
    expect(desk.get_by_role("button", name="Undo")).to_be_enabled()
    desk.get_by_role("button", name="Undo").focus()
    desk.keyboard.press("Enter")
    expect(card(desk, "Position, horizontal")).to_have_text("40.4 cm")
    expect(box(desk, "Position noise")).to_have_value("1 m")
    expect(desk.get_by_role("button", name="Redo")).to_be_enabled()
    desk.get_by_role("button", name="Redo").focus()
    desk.keyboard.press("Enter")
    expect(card(desk, "Position, horizontal")).to_have_text(changed)
    desk.get_by_role("button", name="Open", exact=True).press("Enter")
    desk.get_by_role("button", name="Reset").press("Enter")
    expect(card(desk, "Position, horizontal")).to_have_text("40.4 cm")


@pytest.mark.slow
def test_preset_deviation_is_marked_and_taken_back(visit: Visit) -> None:
    page = visit()
    expect(page.get_by_text("secondary source").first).to_be_visible()
    enter(box(page, "Angle random walk"), "0.2 °/√h")
    expect(page.get_by_text("≠ STIM300: 0.15 °/√h")).to_be_visible()
    page.get_by_role("button", name="Take the catalogue's values").first.click()
    expect(box(page, "Angle random walk")).to_have_value("0.15 °/√h")
    page.get_by_role("combobox", name="From the catalogue").first.click()
    page.get_by_role("menuitem", name=re.compile("^LN-100")).click()
    expect(box(page, "Angle random walk")).to_have_value("0.001 °/√h")
    expect(page.get_by_role("status").first).to_contain_text("Closes")


def test_link_reproduces_the_design(desk: Page, visit: Visit, server: str) -> None:
    page = desk
    enter(box(page, "Position noise"), "7 cm")
    expect(card(page, "Position, horizontal")).not_to_have_text("40.4 cm")
    shown = card(page, "Position, horizontal").inner_text()
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
    expect(card(again, "Position, horizontal")).to_have_text(shown)


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
    expect(card(page, "Position, horizontal")).to_have_text("40.4 cm")


def test_save_open_and_refuse(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Save", exact=True).click()
    saved = parse_design(content(waiting.value))
    assert waiting.value.suggested_filename == "mems-imu-at-x-band.toml"
    assert saved == read_design(EXAMPLES / "mems_x_band.toml")
    chooser = page.locator("input[type=file]").first
    chooser.set_input_files(EXAMPLES / "l_band_jet.toml")
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


@pytest.mark.slow
def test_every_tab_has_an_address(visit: Visit) -> None:
    page = visit("/#sensors")
    expect(page.get_by_role("tab", name="Sensors")).to_have_attribute("aria-selected", "true")
    page.get_by_role("tab", name="Budget").click()
    page.wait_for_function("() => location.hash === '#budget'")


def test_chart_data_to_take_away(plain: Page) -> None:
    with plain.expect_download() as waiting:
        plain.get_by_role("button", name="Exports").click()
        plain.get_by_role("button", name="Position sigma: CSV").click()
    rows = list(csv.reader(io.StringIO(content(waiting.value).decode())))
    budget = analyse(read_design(EXAMPLES / "mems_x_band.toml"))
    refined = [float(row[2]) for row in rows if row[0] == "horizontal, refined"]
    assert refined == pytest.approx(list(budget.coast.refined_horizontal), rel=1e-15)


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
    plain.keyboard.press("Escape")
    assert content(waiting.value).lower().startswith(magic.lower())


def test_an_impossible_aperture_is_refused_at_its_field(desk: Page) -> None:
    section(desk, "Radar")
    kept = card(desk, "Quadratic phase").inner_text()
    enter(box(desk, "Slant range"), "2000 km")
    enter(box(desk, "Azimuth resolution"), "1 mm")
    expect(desk.get_by_text(re.compile("needs an aperture of")).first).to_be_visible()
    enter(box(desk, "Slant range"), "7 km")
    expect(card(desk, "Quadratic phase")).to_have_text(kept)


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
    box(page, "Vertical position at end of outage").wait_for()
    accessible(page, "light")
    page.get_by_role("button", name="theme").click()
    accessible(page, "dark")

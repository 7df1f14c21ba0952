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
  return [...columns.get([...columns.keys()].find(key => key.startsWith("horizontal: ")))]
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
    expect(plain.get_by_text("Source and method:").first).to_be_visible()


_TAKES_CSV = ("Position", "Velocity", "Attitude", "Phase budget", "Azimuth impulse", "What limits")


def test_what_is_below_the_first_screen_follows_and_covers_nothing(desk: Page) -> None:
    """The charts made after the first view: all there, one below or beside the other, fed like the first."""
    expect(desk.locator(".bk-Figure:visible")).to_have_count(6)
    expect(desk.get_by_role("textbox", name="Position noise", exact=True)).to_be_visible()
    for name in _TAKES_CSV:  # a trial click fails where something lies over the button
        desk.get_by_role("button", name=re.compile(f"^{name}.*CSV")).click(trial=True)
    before = desk.evaluate(_CURVE, "velocity lines 0")
    enter(box(desk, "Angle random walk"), "0.5")
    desk.wait_for_function(f"(old) => ({_CURVE})('velocity lines 0')[0] !== old", arg=before[0])


def test_slider_moves_box_curve_and_verdict_together(desk: Page) -> None:
    curve = desk.evaluate(_CURVE, "position lines 0")
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
        shown = desk.evaluate(_CURVE, "position lines 0")[2:]
        return bool(shown == pytest.approx(list(expected.coast.position_horizontal), rel=1e-12))

    until(shows, "the last key press on its way round to the curve")
    assert desk.evaluate(_CURVE, "position lines 0")[50] != curve[50]


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
        ("nan °/√h", "write for example"),
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


def test_link_reproduces_the_design(visit: Visit, server: str) -> None:
    page = visit()
    enter(box(page, "Position noise"), "7 cm")
    expect(card(page, "Position, horizontal")).not_to_have_text("40.4 cm")
    shown = card(page, "Position, horizontal").inner_text()
    page.get_by_role("button", name="Link").click()
    page.wait_for_function("() => location.search.length > 1")
    assert page.evaluate("() => location.pathname") == "/"
    link = page.get_by_role("alert").filter(has_text="in the address bar").get_by_role("link")
    expect(link).to_have_text(page.url)
    expect(link).to_have_attribute("href", page.url)
    query = page.evaluate("() => location.search")
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
        page.get_by_role("button", name="Save").click()
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
    with plain.expect_download() as waiting:
        plain.get_by_role("button", name=button).click()
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


def test_no_serious_accessibility_violation_in_light_and_dark(visit: Visit, accessible: Check) -> None:
    page = visit()
    for title in ("Flight", "Coast", "Radar", "Requirements"):
        section(page, title)
    box(page, "Grazing angle").wait_for()
    box(page, "Coast vertical position").wait_for()
    accessible(page, "light")
    page.get_by_role("button", name="theme").click()
    accessible(page, "dark")

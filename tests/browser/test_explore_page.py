"""The Explore page as a person uses it."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from on_page import COLUMNS, Check, Visit, columns
from playwright.sync_api import Page, expect

from app.subjects.explore.page import QUESTIONS


def _open(visit: Visit, question: str = "What would close it", **size: int) -> Page:
    page = visit("/#explore", **size)
    if size.get("width", 1440) < 1000:
        page.keyboard.press("Escape")  # the drawer, open over a narrow page
    expect(page.get_by_text("Each of these sets closes the design")).to_be_visible()
    page.get_by_role("button", name=question, exact=True).click()
    return page


def _cross(page: Page) -> list[float]:
    data = columns(page, "map design")
    return [data["x"][0], data["y"][0]]


@pytest.mark.slow
def test_every_question_fits_the_window_and_says_nothing_in_the_console(
    visit: Visit, settled: Callable[[Page], None]
) -> None:
    page = _open(visit)
    messages: list[str] = []
    page.on("console", lambda m: messages.append(m.text) if m.type in {"warning", "error"} else None)
    for name in QUESTIONS:
        page.get_by_role("button", name=name, exact=True).click()
        settled(page)
        strip = page.get_by_role("status").first
        expect(strip).to_be_visible()
        assert strip.evaluate("e => e.getBoundingClientRect().top") < 80, name
        assert page.locator(".main-content").evaluate("e => e.scrollHeight - e.clientHeight") <= 1, name
    assert not messages


def test_click_on_the_map_takes_the_point_clicked(visit: Visit) -> None:
    page = _open(visit, "Trade-off map")
    page.wait_for_function(f"() => ({COLUMNS})('map design').x")
    catalogue = columns(page, "map catalogue")
    texts = dict(zip(catalogue["unit"], catalogue["said"], strict=True))
    assert texts["LN-100"].startswith("meets the limit, margin +")
    assert texts["MPU-9250"].startswith("does not meet the limit, 8.3 × the limit")
    canvas = page.locator(".bk-Figure:visible").first
    canvas.click(trial=True)  # once it has come to rest
    place = canvas.bounding_box()
    before = _cross(page)
    page.mouse.click(place["x"] + 0.3 * place["width"], place["y"] + 0.7 * place["height"])
    page.wait_for_function(f"(x) => ({COLUMNS})('map design').x[0] !== x", arg=before[0])
    x, y = _cross(page)
    expect(page.get_by_role("textbox", name="Angle random walk", exact=True)).to_have_value(f"{x:.3g} °/√h")
    expect(page.get_by_role("textbox", name="Velocity random walk", exact=True)).to_have_value(f"{y:.3g} m/s/√h")


@pytest.mark.slow
def test_imus_that_pass_with_my_receiver_come_first_and_one_is_taken_by_keyboard(
    visit: Visit, tmp_path: Path, accessible: Check
) -> None:
    page = _open(visit, "Sensors that pass")
    expect(page.get_by_role("status").first).to_contain_text("IMUs pass with your receiver")
    imus = page.get_by_role("region", name="IMUs with your receiver")
    expect(imus.get_by_role("rowheader").nth(1)).to_have_text("LN-100")  # behind the own unit
    page.get_by_label("Filter").fill("HG9900")
    expect(imus.get_by_role("rowheader")).to_have_count(1)  # the own unit: that sheet is silent on the accelerometers
    page.get_by_label("Filter").fill("ln-100")
    imus.get_by_role("button", name="LN-100").press("Enter")
    expect(page.get_by_text("The design now has LN-100.")).to_be_visible()
    expect(page.get_by_role("textbox", name="Angle random walk", exact=True).first).to_have_value("0.001 °/√h")

    path = tmp_path / "own.toml"
    path.write_text(
        '[[imu]]\nname = "Ours"\n'
        'angle_random_walk = { value = "0.011 °/√h", status = "confirmed", source = "bench" }\n'
        'velocity_random_walk = { value = "0.012 m/s/√h", status = "confirmed", source = "bench" }\n',
        encoding="utf-8",
    )
    page.locator("input[type=file][accept*='.yaml']").set_input_files(path)
    expect(page.get_by_text("Added Ours.")).to_be_visible()
    page.get_by_label("Filter").fill("ours")
    expect(imus.get_by_role("rowheader")).to_have_count(2)
    page.get_by_role("button", name="All receivers").click()
    pairs = page.get_by_role("region", name="Pairs of IMU and receiver")
    expect(pairs.get_by_role("rowheader")).not_to_have_count(1)
    pairs.get_by_role("button", name="Margin").press("Enter")
    expect(pairs.get_by_role("columnheader", name="Margin")).to_have_attribute("aria-sort", "ascending")
    accessible(page, every=True)


@pytest.mark.slow
def test_a_sweep_is_run_taken_away_and_nothing_axe_minds(visit: Visit, accessible: Check) -> None:
    page = _open(visit, "Sweep")
    expect(page.get_by_text("400 designs.")).to_be_visible()
    page.get_by_label("Points: row 1").fill("1e9")
    page.keyboard.press("Enter")
    expect(page.get_by_text("is not a whole number from 2 to")).to_be_visible()
    page.get_by_label("Points: row 1").fill("5")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Run sweep").click()
    expect(page.get_by_role("status").first).to_contain_text("of 100 designs meet all requirements")
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Table: CSV").click()
    rows = list(csv.DictReader(Path(str(waiting.value.path())).read_text().splitlines()))
    assert len(rows) == 100
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Table: Parquet").click()
    assert Path(str(waiting.value.path())).read_bytes().startswith(b"PAR1")
    for question in ("Probability", "What would close it", "Sweep"):
        page.get_by_role("button", name=question, exact=True).click()
        if question == "Probability":
            page.get_by_role("button", name="Every noise typical").click()
            expect(page.get_by_role("status").first).to_contain_text("Probability of closing:")
        accessible(page, question, every=True)
    page.get_by_role("button", name="theme").click()
    accessible(page, "dark", every=True)


@pytest.mark.slow
def test_nothing_overflows_a_phone(visit: Visit, fits: Check) -> None:
    page = _open(visit, "Sensors that pass", width=390, height=844)
    fits(page, 390)


@pytest.mark.slow
def test_on_a_phone_a_sweep_is_above_its_table(visit: Visit, fits: Check) -> None:
    page = _open(visit, "Sweep", width=390, height=844)
    page.get_by_role("button", name="Run sweep").click()
    expect(page.get_by_role("status").first).to_contain_text("of 400 designs meet all requirements")
    row = page.get_by_role("columnheader", name="Angle random walk")
    expect(row).to_be_visible()
    places = [place.bounding_box() for place in (page.get_by_role("button", name="Run sweep"), row)]
    tops = [place["y"] for place in places if place]
    assert len(tops) == 2
    assert tops == sorted(tops)
    fits(page, 390)

"""The Suborbital page as a person uses it."""

import json
import re
from pathlib import Path

import pytest
from on_page import Check, Visit
from playwright.sync_api import expect


@pytest.mark.slow
def test_first_answer_slider_exact_run_stars_file_and_phone(
    visit: Visit, tmp_path: Path, accessible: Check, fits: Check, settled: Check
) -> None:
    page = visit("/?study.seed=1#suborbital")  # the reference case
    status = page.get_by_role("status").first
    expect(status).to_contain_text(
        "The star tracker cuts the final position error from 38.6 km"
    )  # the first compiles
    gyros = page.locator(".tile").filter(has=page.get_by_text("Gyros", exact=True)).locator(".big")
    expect(gyros).to_contain_text("26.7 km")
    settled(page)
    for box in (status.bounding_box(), gyros.bounding_box(), page.locator(".bk-Figure:visible").last.bounding_box()):
        assert box["y"] + box["height"] <= 900
    page.get_by_role("button", name="Inputs", exact=True).click()

    slider = page.get_by_role("slider", name="Gyro bias, constant")
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    expect(status).to_contain_text("Linearised from the last full simulation")
    expect(gyros).not_to_contain_text("26.7 km")
    page.get_by_role("button", name="Run full simulation").click()
    expect(page.get_by_role("button", name="Cancel")).to_be_enabled()
    expect(status).to_contain_text("From the full simulation.")

    box = page.get_by_role("textbox", name="Gyro bias, constant", exact=True)
    box.fill("5 kg")
    box.press("Enter")
    expect(page.get_by_text("is not a unit of angular rate")).to_be_visible()

    page.get_by_role("button", name="Sources", exact=True).click()
    page.get_by_role("button", name="Published values").press("Enter")
    table = page.get_by_role("region", name="Accelerometer errors")
    table.get_by_role("button", name="INS height [m]").click()
    expect(table.get_by_role("rowheader")).to_have_text(
        ["accelerometer instability", "accelerometer total", "accelerometer bias"]
    )
    page.get_by_role("button", name="Attitude", exact=True).click()
    page.get_by_role("button", name="Stars", exact=True).click()
    expect(page.get_by_role("heading", name="Star frame at 100 s")).to_be_visible()
    page.get_by_role("slider", name=re.compile("Star frame at")).focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("heading", name="Star frame at 102 s")).to_be_visible()

    with page.expect_download() as waiting:
        page.get_by_role("button", name="Study (JSON)").click()
    assert json.loads(Path(str(waiting.value.path())).read_bytes())["exact"] is True

    page.get_by_role("button", name="Noise", exact=True).click()
    page.get_by_role("button", name="Camera noise", exact=True).click()
    expect(page.get_by_role("heading", name="Final position error from noise")).to_be_visible()
    accessible(page, "camera noise")

    bad = tmp_path / "mine.csv"
    bad.write_text("a,b\n1,2\n")
    page.get_by_role("button", name="Inputs", exact=True).click()
    page.locator("input[type=file][accept='.csv']").set_input_files(bad)
    expect(page.get_by_text("mine.csv: columns time_s")).to_be_visible()
    expect(status).to_contain_text("From the full simulation.")

    accessible(page)
    fits(page, 390)

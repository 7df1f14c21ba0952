"""The Suborbital page as a person uses it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

Visit = Callable[..., Page]


def test_first_answer_slider_exact_run_stars_file_and_phone(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    page.get_by_role("tab", name="Suborbital").click()
    sentence = page.get_by_text("What the star tracker did and did not repair")
    expect(sentence).to_be_visible(timeout=90_000)  # the first run on a machine compiles
    status = page.get_by_role("status").filter(has=sentence)
    expect(status).to_contain_text("off by 38.6 km")
    expect(status).to_contain_text("does not stabilise the height")
    gyros = page.locator(".card").filter(has=page.get_by_text("Gyros", exact=True)).locator(".big")
    expect(gyros).to_contain_text("26.7 km")

    slider = page.get_by_role("slider", name="Gyro bias, constant")
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    expect(status).to_contain_text("Moved by the linear sensitivity matrix")
    expect(gyros).not_to_contain_text("26.7 km")
    page.get_by_role("button", name="Recompute exactly").click()
    expect(page.get_by_role("button", name="Cancel")).to_be_visible()
    expect(status).to_contain_text("the linear answer was off by", timeout=60_000)

    box = page.get_by_role("textbox", name="Gyro bias, constant", exact=True)
    box.fill("5 kg")
    box.press("Enter")
    expect(page.get_by_text("is not a unit of angular rate")).to_be_visible()

    page.locator(".bk-tab", has_text="Tables").click()
    table = page.get_by_role("region", name="Accelerometer errors")
    table.get_by_role("button", name="INS height [m]").click()
    expect(table.get_by_role("rowheader")).to_have_text(
        ["accelerometer instability", "accelerometer total", "accelerometer bias"]
    )
    page.locator(".bk-tab", has_text="Stars").click()
    expect(page.get_by_role("heading", name="Star frame at 100 s")).to_be_visible()
    page.get_by_role("slider", name=re.compile("Star frame at")).focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("heading", name="Star frame at 102 s")).to_be_visible()

    with page.expect_download() as waiting:
        page.get_by_role("button", name="Study (JSON)").click()
    assert json.loads(Path(str(waiting.value.path())).read_bytes())["exact"] is True

    bad = tmp_path / "mine.csv"
    bad.write_text("a,b\n1,2\n")
    page.locator("input[type=file]").last.set_input_files(bad)
    expect(page.get_by_text("mine.csv: columns time_s")).to_be_visible(timeout=60_000)
    expect(status).to_contain_text("the linear answer was off by")

    found = Axe().run(page, options={"runOnly": ["wcag2a", "wcag2aa"]}).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found if v["impact"] in {"serious", "critical"}] == []

    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_timeout(500)
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390

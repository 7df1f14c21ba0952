"""The Sensors page as a person uses it: a log in, its noise on a chart and in a table, then in the design."""

import re
from pathlib import Path

import bench_log
from on_page import Check, Visit, content
from playwright.sync_api import expect

_CURVE = """() => {
  for (const d of Bokeh.documents) for (const m of d._all_models.values())
    if (m.type === "ColumnDataSource" && (m.name || "").startsWith("allan_gyro lines"))
      return [...(m.data.get ? m.data.get("x") : m.data.x)]
  return []
}"""


def test_log_to_parameters_to_budget(visit: Visit, tmp_path: Path, accessible: Check, fits: Check) -> None:
    log = tmp_path / "bench.csv"
    log.write_bytes(bench_log.log(6000, 3.0))  # 0.9 °/√h

    page = visit()
    before = page.get_by_label("Key figures").inner_text()
    page.get_by_role("tab", name="Sensors").click()
    expect(page.get_by_role("status").first).to_contain_text("Angle random walk 0.15 °/√h: catalogue, STIM300")
    page.get_by_role("button", name="IMUs", exact=True).click()
    units = page.get_by_role("region", name="IMUs")
    expect(units.get_by_role("row").nth(1)).to_contain_text("MPU-9250")
    units.get_by_role("button", name="Angle random walk").click()
    expect(units.get_by_role("row").nth(1)).to_contain_text("LN-100")  # 0.001 °/√h, the smallest

    page.get_by_role("button", name="My log", exact=True).last.click()
    refused = tmp_path / "refused.toml"
    refused.write_text("[imu]\nangle_random_walk = '1 m'\n")
    page.locator("input[type=file][accept*=toml]").first.set_input_files(refused)
    expect(page.get_by_text("Not opened.")).to_be_visible()
    # Typed before the file is chosen: Bokeh cannot send a message of a widget that has just arrived before anything
    # else has been sent ("[object Function] is not serializable"), which only a script is quick enough to meet.
    page.get_by_label("Rate [Hz]").fill("100")
    page.get_by_label("Rate [Hz]").press("Tab")
    page.locator("input[type=file][accept*=npz]").set_input_files(log)
    expect(page.get_by_role("heading", name="Result")).to_be_visible()
    expect(page.get_by_text("Not opened.")).to_be_hidden()
    expect(page.get_by_role("region", name="Gyros: noise coefficients")).to_contain_text("< ")
    page.wait_for_function(f"({_CURVE})().length > 20")
    table = page.get_by_role("region", name="Accelerometers: noise coefficients").bounding_box()
    chart = page.locator(".bk-Figure:visible").first.bounding_box()
    assert chart["y"] + chart["height"] <= table["y"], "the plots come first, and reach into no table"
    assert chart["y"] < 720, "the plots begin in the first screen"

    page.get_by_role("button", name="Use these in the design").click()
    page.locator(".bk-Figure:visible").last.scroll_into_view_if_needed()
    strip = page.locator(".bare.strip:visible")  # which says what the design has now
    expect(strip).to_contain_text("static log bench.csv")
    expect(strip).to_be_in_viewport()
    expect(page.get_by_role("textbox", name="Angle random walk", exact=True)).to_have_value(
        re.compile(r"0\.(8[89]|9[01]).* °/√h")
    )
    accessible(page)
    page.get_by_role("tab", name="Budget").click()
    expect(page.get_by_label("Key figures")).not_to_have_text(before)
    page.get_by_role("tab", name="Sensors").click()
    fits(page, 390)


def test_rows_of_a_data_sheet_fill_the_design(visit: Visit, accessible: Check) -> None:
    page = visit()
    page.get_by_role("tab", name="Sensors").click()
    page.get_by_role("button", name="IMUs", exact=True).click()
    page.get_by_label("My IMU: rows of its data sheet").fill(
        "Angle random walk 0.3 °/√h, bias instability 0.5 °/h, velocity random walk 60 µg/√Hz, scale factor 100 ppm"
    )
    page.get_by_role("button", name="Fill in").click()
    made = page.get_by_role("region", name="Filled in. Undo reverts.")
    expect(made.get_by_role("row").nth(1)).to_contain_text("Angle random walk 0.3 °/√h")
    expect(page.get_by_text("scale factor 100 ppm: not known")).to_be_visible()
    walk = page.get_by_role("textbox", name="Angle random walk", exact=True)
    expect(walk).to_have_value("0.3 °/√h")
    noise = page.get_by_role("textbox", name="Position noise", exact=True)
    noise.fill("0.2 m CEP")
    noise.press("Tab")
    expect(page.get_by_text("0.2 m CEP = 0.170 m, 1σ per axis.").locator("visible=true").first).to_be_visible()
    accessible(page)


def test_a_sheet_that_cannot_be_made_is_told_and_nothing_is_saved(visit: Visit) -> None:
    page = visit("/?arw=0.1deg/sqrt(h)")  # a design without limits
    saved: list[str] = []
    page.on("download", lambda download: saved.append(download.suggested_filename))
    report = page.get_by_role("button", name="Report", exact=True)
    report.click()
    page.get_by_role("button", name="Receiver requirement sheet (HTML)").click()
    expect(page.get_by_text("No requirement sheet for the satellite receiver: none is given")).to_be_visible()
    assert not saved
    visit("/")
    report.click()
    for _ in range(2):  # the same file is saved again
        with page.expect_download() as waiting:
            page.get_by_role("button", name="IMU requirement sheet (HTML)").click()
        assert b"IMU requirements for" in content(waiting.value)
    assert saved == ["imu-required.html"] * 2

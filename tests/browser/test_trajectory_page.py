"""The Trajectory page as a person uses it."""

import math
import re
from pathlib import Path

from on_page import COLUMNS, Check, Visit, turn
from playwright.sync_api import Page, expect

from app.examples import example
from nav_model.design import Design
from nav_model.design.link import to_query

_PLAN = """<gpx><rte><rtept lat="47" lon="8"><ele>3000</ele><name>first</name></rtept>
<rtept lat="47.08" lon="8"><ele>3000</ele></rtept><rtept lat="47.08" lon="8.1"><ele>3000</ele></rtept></rte></gpx>"""


def _choose(page: Page, flight: str) -> None:
    """Choose a flight in the drawer; the sidebar has the same input."""
    page.locator("[role=combobox]").filter(has_text=re.compile("[Ss]traight|lines|aypoints|file")).last.click()
    page.get_by_role("menuitem", name=flight).click()


def test_a_strip_is_judged_line_by_line_and_a_plan_from_a_file_too(
    visit: Visit, page: Page, tmp_path: Path, accessible: Check, fits: Check
) -> None:
    log: list[str] = []
    page.on("console", lambda message: log.append(message.text) if message.type in {"warning", "error"} else None)
    visit("/#trajectory", width=1280, height=720)
    page.keyboard.press("Escape")
    answer = page.get_by_role("status").first
    expect(answer).to_contain_text("No plan: the charts show a straight flight")
    page.get_by_role("button", name="Plan", exact=True).click()
    _choose(page, "Parallel lines")
    expect(answer).to_contain_text(re.compile(r"fails on line \d"))
    # The drawer lies beside the map and the verdicts, which show what it changes.
    close, heading = page.get_by_role("button", name="Close", exact=True), page.get_by_text("Verdict by line")
    ends, begins = close.bounding_box(), heading.bounding_box()
    assert ends["x"] + ends["width"] < begins["x"]
    expect(page.get_by_text("Heading is observed")).to_be_visible()
    page.get_by_role("button", name="Close", exact=True).click()
    # One marker: the pointer on a time chart moves a dot on the map.
    chart = page.locator(".bk-Figure:visible").first
    chart.hover()
    page.wait_for_function(f"() => isFinite(({COLUMNS})('flight marker').x[0])")
    expect(page.get_by_role("button", name="Cancel", exact=True)).to_be_disabled()
    last, undo = page.get_by_role("tab", name="More"), page.get_by_role("button", name="Undo").first
    tab, tool = last.bounding_box(), undo.bounding_box()
    assert tab["x"] + tab["width"] <= tool["x"]  # all tabs have room beside the tools
    expect(page.locator(".bk-Figure:visible")).to_have_count(5)
    page.get_by_role("button", name="Table by line", exact=True).click()
    expect(page.get_by_text("line 4: ")).to_be_visible()
    accessible(page)
    plan = tmp_path / "plan.gpx"
    plan.write_text(_PLAN, encoding="utf-8")
    page.get_by_role("button", name="Plan", exact=True).click()
    page.locator('input[type="file"][accept*=".gpx"]').set_input_files(plan)
    expect(answer).to_contain_text("fails on first")
    latitude = page.get_by_label("Latitude [°]: row 2", exact=True)
    expect(latitude).to_have_value("47.08")
    latitude.fill("97")
    latitude.press("Enter")
    expect(page.get_by_role("alert").first).to_contain_text("Waypoints, row 2, latitude: '97 °' is not allowed")
    expect(page.get_by_role("alert")).to_have_count(1)  # at the table; the strip says it too
    latitude.fill("47.07")
    page.get_by_label("Line: row 2", exact=True).fill("<b>across</b>")
    page.get_by_label("Line: row 2", exact=True).press("Enter")
    lines = page.get_by_role("table").filter(has_text="Verdict by line").locator("tbody tr")
    expect(lines).to_have_count(2)
    page.get_by_role("button", name="Remove row 3", exact=True).click()
    expect(lines).to_have_count(1)
    accessible(page)
    pasted = "47\\t8\\t3000\\tsouth\\n47.05\\t8\\t3 km\\n47.05\\t8.1\\t3000\\teast\\n47.1\\t8.1\\t3000"
    page.get_by_label("Latitude [°]: row 1", exact=True).evaluate(
        f"""field => {{ const clip = new DataTransfer(); clip.setData("text", "{pasted}")
        field.dispatchEvent(new ClipboardEvent("paste", {{clipboardData: clip, cancelable: true}})) }}"""
    )
    expect(lines).to_have_count(3)
    expect(page.get_by_label("Height [m]: row 2", exact=True)).to_have_value("3000")
    assert log == []
    fits(page, 390)


def test_an_option_that_closes_the_flight_is_taken_into_the_plan_and_undone(
    visit: Visit, page: Page, accessible: Check, fits: Check
) -> None:
    design = Design(
        {
            "imu.angle_random_walk": 4e-5, "imu.velocity_random_walk": 1e-3, "gnss.position_noise": 1.0,
            "flight.speed": 90.0, "radar.aperture_time": 5.0, "requirements.heading": math.radians(0.08),
            "trajectory.flight": "lines", "trajectory.lines": 2.0,
        }
    )  # fmt: skip
    visit(f"/?{to_query(design)}#flight")
    page.keyboard.press("Escape")
    answer = page.get_by_role("status").first
    expect(answer).to_contain_text("heading fails on line 1")
    page.get_by_role("button", name="What would close it", exact=True).click()
    expect(page.get_by_role("heading", name="options for line 1")).to_be_visible()
    accessible(page)
    page.get_by_role("button", name=re.compile("^(S-turn|90° turn) before line 1$")).first.click()
    expect(answer).to_contain_text("✓ Closes")
    expect(page.get_by_text("is in the design now. You can undo.")).to_be_visible()
    page.get_by_role("button", name="Undo").first.click()
    expect(answer).to_contain_text("heading fails on line 1")
    fits(page, 390)


def test_what_fails_along_the_plan_is_grey_until_it_is_flown_and_then_red_on_every_page(
    visit: Visit, page: Page
) -> None:
    plan = {"trajectory.flight": "lines", "trajectory.lines": 2.0, "requirements.heading": math.radians(0.05)}
    visit(f"/?{to_query(example('tactical_x_band').replace(plan))}")
    strip, tile = page.locator(".strip:visible").first, page.locator(".tile").filter(has_text="Heading")
    expect(strip).to_contain_text(re.compile("being computed|Does not close"))
    expect(strip).to_contain_text("Heading on line 1")
    expect(tile).to_contain_text("✗")
    expect(tile).to_have_class(re.compile("bad"))
    expect(page.locator(".tile.good")).to_have_count(0)
    expect(page.get_by_role("button", name=re.compile("Real time ✗"))).to_be_visible()
    page.get_by_role("slider", name="Angle random walk").first.press("ArrowRight")
    expect(strip).to_contain_text("The flight is being computed")
    expect(page.locator(".tile .last").first).to_be_visible()
    expect(strip).to_contain_text("Heading on line 1")
    turn(page, "Close it")
    expect(strip).to_contain_text("Before the flight: ")
    expect(strip).to_contain_text("heading fails on line 1")
    turn(page, "Flight")
    expect(strip).to_contain_text("✗ Does not close")
    expect(strip).to_contain_text("heading fails on line 1")

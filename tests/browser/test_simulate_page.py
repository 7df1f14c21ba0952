"""The Simulate page as a person uses it."""

import json
import re
from pathlib import Path

from on_page import Check, Visit, box, enter
from playwright.sync_api import Page, expect

_CURVE = """(column) => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const data = sources.map(m => m.data instanceof Map ? m.data : new Map(Object.entries(m.data)))
  return [...(data.find(columns => columns.has(column) && columns.get(column).length > 2)?.get(column) ?? [])]
}"""


def test_a_small_run_gives_verdict_and_curves_and_another_is_cancelled(
    visit: Visit, page: Page, tmp_path: Path, accessible: Check, fits: Check
) -> None:
    warnings: list[str] = []
    page.on("console", lambda m: warnings.append(m.text) if m.type in {"warning", "error"} else None)
    visit("/#simulate")
    start, cancel = (page.get_by_role("button", name=name, exact=True) for name in ("Start", "Cancel"))
    answer = page.get_by_role("status").first
    # The first settings are flown by themselves.
    expect(answer).to_contain_text(re.compile(r"(Consistent|Optimistic|Pessimistic).*50.runs"))
    expect(page.locator(".bk-Figure:visible")).to_have_count(5)
    enter(box(page, "Outages [s]"), "soon")
    start.click()
    expect(page.get_by_text("Enter the start, for example")).to_be_visible()
    enter(box(page, "Runs"), "20")
    enter(box(page, "Length [s]"), "120")
    enter(box(page, "Outages [s]"), "90,120")
    start.click()
    expect(answer).to_have_text(
        re.compile(r"(Consistent|Optimistic|Pessimistic).*NEES \d+\.?\d* with 9 states, 95.% band .*, 20.runs")
    )
    expect(start).to_be_enabled()
    figures = page.locator(".bk-Figure:visible")
    expect(figures).to_have_count(5)
    page.wait_for_function(f"() => ({_CURVE})('sim-position rms 2').length === 121")
    for figure in [answer, *figures.all()]:  # all of it in the window
        place = figure.bounding_box()
        assert place["y"] >= 0
        assert place["x"] + place["width"] <= 1440
        assert place["y"] + place["height"] <= 900
    page.get_by_role("button", name="Exports", exact=True).click()
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Everything (JSON)").click()
    waiting.value.save_as(tmp_path / "a.json")
    document = json.loads((tmp_path / "a.json").read_text("utf-8"))
    assert document["runs"] == 20
    assert page.evaluate(_CURVE, "sim-position rms 2") == document["position"]["down"]["rms_m"]

    page.reload()  # settings and result are still there
    expect(box(page, "Runs")).to_have_value("20")
    expect(box(page, "Outages [s]")).to_have_value("90,120")
    expect(answer).to_contain_text("20 runs")
    expect(answer).not_to_contain_text("Stale")
    page.get_by_role("slider", name="Angle random walk").press("ArrowRight")
    expect(answer).to_contain_text("The runs are older than")

    enter(box(page, "Runs"), "2000")
    start.click()
    expect(page.get_by_text(re.compile(r"[1-9]\d* of 2000 runs, about \d+ s left"))).to_be_visible()
    cancel.click()
    expect(page.get_by_text(re.compile(r"Cancelled: \d+ of 2000 runs"))).to_be_visible()
    expect(start).to_be_enabled()
    # What was there before, or a part: each says so, and neither reads as a verdict of 2000 runs.
    expect(answer).to_have_text(re.compile(r"Partial: \d+ of 2000 runs|The last run was cancelled"))
    assert not warnings, warnings
    page.get_by_role("button", name="Where formula and simulation differ, and why").click()
    accessible(page, "light", every=True)
    page.get_by_role("button", name="theme").click()
    accessible(page, "dark", every=True)
    fits(page, 390)

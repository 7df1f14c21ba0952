"""The Simulate page as a person uses it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

Visit = Callable[..., Page]
Check = Callable[..., None]

# The names of the ensemble's lines, and whether each stands on a column of its source with some values above zero.
_ENSEMBLE = """() => {
  const figure = [...Bokeh.documents[0]._all_models.values()].find(m => m.name === "sim-ensemble")
  return (figure?.renderers ?? []).filter(r => r.glyph.type === "Line" && r.name).map(r => {
    const data = r.data_source.data
    const column = data instanceof Map ? data.get(r.glyph.y.field) : data[r.glyph.y.field]
    return [r.name, [...(column ?? [])].filter(y => y > 0).length > 20]
  })
}"""
_CURVE = """(name) => {
  const sources = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "ColumnDataSource")
  const data = sources.find(m => m.name === name)?.data
  if (!data) return []
  const columns = data instanceof Map ? data : new Map(Object.entries(data))
  return [...columns.get([...columns.keys()].find(key => key.startsWith("north, simulated")))]
}"""


def field(page: Page, label: str) -> Locator:
    return page.get_by_role("textbox", name=label, exact=True)


def enter(page: Page, label: str, text: str) -> None:
    field(page, label).fill(text)
    field(page, label).press("Enter")


def test_a_small_run_gives_verdict_and_curves_and_another_is_cancelled(
    visit: Visit, tmp_path: Path, accessible: Check, fits: Check
) -> None:
    page = visit()
    page.get_by_text("Simulate", exact=True).click()
    start, cancel = (page.get_by_role("button", name=name, exact=True) for name in ("Start", "Cancel"))
    enter(page, "Outages [s]", "soon")
    start.click()
    expect(page.get_by_text("is not start,stop in seconds")).to_be_visible()
    enter(page, "Runs", "20")
    enter(page, "Length [s]", "120")
    enter(page, "Outages [s]", "90,120")
    start.click()
    expect(page.locator("progress")).to_be_visible()
    expect(page.get_by_role("status").filter(has_text="NEES")).to_have_text(
        re.compile(r"(Consistent|Optimistic|Pessimistic).*NEES \d+\.?\d* with 9 states, 95 % band .*, 20 runs")
    )
    expect(start).to_be_enabled()
    page.wait_for_function(f"() => ({_CURVE})('sim-position-horizontal lines 0').length === 121")
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Everything (JSON)").click()
    waiting.value.save_as(tmp_path / "a.json")
    document = json.loads((tmp_path / "a.json").read_text("utf-8"))
    assert document["runs"] == 20
    assert page.evaluate(_CURVE, "sim-position-horizontal lines 0") == document["position"]["north"]["rms_m"]

    expect(page.get_by_text("stale")).to_have_count(0)
    page.wait_for_function(f"() => ({_ENSEMBLE})().length === 4")
    before = page.evaluate(_ENSEMBLE)
    page.get_by_role("slider", name="Angle random walk").press("ArrowRight")
    expect(page.get_by_text("stale")).to_be_visible()

    enter(page, "Runs", "2000")
    start.click()
    expect(page.get_by_text(re.compile(r"[1-9]\d* of 2000 runs, about \d+ s left"))).to_be_visible()
    cancel.click()
    expect(page.get_by_text(re.compile(r"Cancelled: \d+ of 2000 runs"))).to_be_visible()
    expect(start).to_be_enabled()

    enter(page, "Runs", "20")
    enter(page, "Seed", "2")
    start.click()  # another run is the worst one, and its line is still there
    page.wait_for_function(f"(before) => ({_ENSEMBLE})()[2][0] !== before", arg=before[2][0])
    after = page.evaluate(_ENSEMBLE)
    assert len(after) == 4
    assert all(drawn for _, drawn in after), after
    expect(start).to_be_enabled()

    accessible(page)
    fits(page, 390)

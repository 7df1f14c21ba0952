"""The SAR page as a person uses it: the run that comes by itself, a slider that makes it stale, an upload."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

Visit = Callable[..., Page]
Check = Callable[..., None]
GOTCHA = Path(__file__).parents[3] / "shared/data/sar_gotcha_pass1_az001_HH.npz"


def test_runs_go_stale_with_the_design_and_the_closed_forms_follow(visit: Visit) -> None:
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("Use strategy 2:")).to_be_visible()
    expect(page.get_by_text("The runs match the design.")).to_be_visible()
    expect(page.get_by_role("img", name="8 RTS smoother").first).to_be_visible()
    sentence = page.get_by_text("Use strategy 2:").inner_text()
    page.get_by_role("slider", name="Angle random walk").focus()
    page.keyboard.press("PageDown")
    expect(page.get_by_text("The runs are of an earlier design: run again.")).to_be_visible()
    expect(page.get_by_text("Use strategy 2:")).not_to_have_text(sentence)
    page.get_by_role("combobox", name="Runs").click()
    page.get_by_text("1000", exact=True).click()
    page.get_by_role("button", name="Run the strategies").click()
    expect(page.get_by_text("of 1000 runs, about")).to_be_visible()
    page.get_by_role("button", name="Cancel").first.click()
    expect(page.get_by_text("Cancelled: ")).to_be_visible()


@pytest.mark.slow
def test_a_real_phase_history_is_formed_twice(visit: Visit) -> None:
    if not GOTCHA.exists():
        pytest.skip(f"no real phase history at {GOTCHA}")
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("The runs match the design.")).to_be_visible()
    page.locator("input[type=file][accept='.npz']").set_input_files(GOTCHA)
    expect(page.get_by_role("img", name="without navigation error")).to_be_visible()
    expect(page.get_by_role("img", name="with that of 2 INS")).to_be_visible()


@pytest.mark.slow
def test_every_part_is_accessible_and_pictures_are_taken_away(
    visit: Visit, tmp_path: Path, accessible: Check
) -> None:
    """Axe over the whole page with its results, in a phone's width; then the keyboard alone."""
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("The runs match the design.")).to_be_visible()
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.get_by_role("img", name="8 RTS smoother").first).to_be_visible()
    accessible(page, every=True)
    wider = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wider <= 0  # tables scroll in regions of their own
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Point target: NPZ").press("Enter")
    waiting.value.save_as(tmp_path / "point.npz")
    with np.load(tmp_path / "point.npz") as packed:
        assert packed["power_db"].shape == (9, 61, 121)
    region = page.get_by_role("region", name="Line-of-sight error by strategy")
    region.focus()
    region.press("ArrowRight")
    page.wait_for_function("e => e.scrollLeft > 0", arg=region.element_handle())


@pytest.mark.slow
def test_the_simulator_flies_and_is_cancelled(visit: Visit) -> None:
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("The runs match the design.")).to_be_visible()
    page.get_by_role("combobox", name="Engine").press("ArrowDown")  # the choice by keyboard alone
    expect(page.get_by_role("menuitem", name="Full simulator")).to_be_visible()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.get_by_role("combobox", name="Engine")).to_have_text("Full simulator")
    run, cancel = (page.get_by_role("button", name=name).first for name in ("Run the strategies", "Cancel"))
    run.press("Enter")
    expect(page.get_by_text("of 100 runs, about")).to_be_visible()
    cancel.press("Enter")
    expect(page.get_by_text("Cancelled: ")).to_be_visible()
    expect(page.get_by_text("The runs match the design.")).to_have_count(0)
    expect(page.get_by_text("100 runs of the error model, seed 0. Medians")).to_be_visible()  # the result before
    run.press("Enter")
    expect(page.get_by_text("The two engines beside each other")).to_be_visible()
    expect(page.get_by_text("The runs match the design. 100 flights of the simulator, seed 0.")).to_be_visible()

"""The SAR page as a person uses it: the run that comes by itself, a slider that makes it stale, an upload."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

Visit = Callable[..., Page]
GOTCHA = Path(__file__).parents[3] / "shared/data/sar_gotcha_pass1_az001_HH.npz"


def test_runs_go_stale_with_the_design_and_the_closed_forms_follow(visit: Visit) -> None:
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("Use strategy 2:")).to_be_visible(timeout=20_000)
    expect(page.get_by_text("The runs match the design.")).to_be_visible(timeout=60_000)
    expect(page.get_by_role("img", name="8 RTS smoother").first).to_be_visible()
    sentence = page.get_by_text("Use strategy 2:").inner_text()
    page.get_by_role("slider", name="Angle random walk").focus()
    page.keyboard.press("PageDown")
    expect(page.get_by_text("The runs are of an earlier design: run again.")).to_be_visible()
    expect(page.get_by_text("Use strategy 2:")).not_to_have_text(sentence)
    page.get_by_role("combobox", name="Runs").click()
    page.get_by_text("1000", exact=True).click()
    page.get_by_role("button", name="Run the strategies").click()
    expect(page.get_by_text("of 1000 runs, about")).to_be_visible(timeout=30_000)
    page.get_by_role("button", name="Cancel").click()
    expect(page.get_by_text("Cancelled.")).to_be_visible()


def test_a_real_phase_history_is_formed_twice(visit: Visit) -> None:
    if not GOTCHA.exists():
        pytest.skip(f"no real phase history at {GOTCHA}")
    page = visit()
    page.get_by_role("tab", name="SAR").click()
    expect(page.get_by_text("The runs match the design.")).to_be_visible(timeout=60_000)
    page.locator("input[type=file][accept='.npz']").set_input_files(GOTCHA)
    expect(page.get_by_role("img", name="without navigation error")).to_be_visible(timeout=60_000)
    expect(page.get_by_role("img", name="with that of 2 INS")).to_be_visible()

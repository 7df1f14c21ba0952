"""The page As flown: two files, one press, the verdict in words, the table by line, and the receiver."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from on_page import Check, Visit
from playwright.sync_api import expect

_DESIGN = "/?gn=1m#flown"
_COUNT = 400


def solution(path: Path, step: float, sigma: float) -> Path:
    """A weaving flight northwards at 60 m/s, with white noise on its places."""
    noise = sigma * np.random.default_rng(8).standard_normal((_COUNT * 4, 3))
    lines = ["time [s],latitude [deg],longitude [deg],height [m]"]
    for row in range(int(_COUNT / step)):
        time = row * step
        north, east, down = noise[row]
        latitude = 47.0 + (60.0 * time + north) / 111_170.0
        longitude = 8.0 + (300.0 * math.sin((time / 120.0) ** 2) + east) / 75_900.0
        lines.append(f"{time:.2f},{latitude:.10f},{longitude:.10f},{900.0 - down:.4f}")
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


@pytest.mark.slow
def test_a_flight_is_brought_held_against_the_budget_and_refused_by_name(
    visit: Visit, accessible: Check, tmp_path: Path
) -> None:
    page = visit(_DESIGN)
    messages: list[str] = []
    page.on("console", lambda m: messages.append(m.text) if m.type in {"warning", "error"} else None)
    expect(page.get_by_text("No flight yet")).to_be_visible()
    start = page.get_by_role("button", name="Start", exact=True)
    start.click()
    expect(page.get_by_text("choose the file of a solution first")).to_be_visible()
    fixes, truth = solution(tmp_path / "fixes.csv", 1.0, 0.5), solution(tmp_path / "truth.csv", 0.5, 0.0)
    inputs = page.locator("input[type=file][accept*='.sbet']")
    inputs.nth(0).set_input_files(fixes)
    expect(page.get_by_text("Solution fixes.csv. Press Start.")).to_be_visible()
    inputs.nth(1).set_input_files(truth)
    expect(page.get_by_text("Solution fixes.csv; reference truth.csv. Press Start.")).to_be_visible()
    start.click()
    table = page.get_by_role("table", name=re.compile("^Figures by line, at "))
    expect(table).to_be_visible(timeout=120_000)
    expect(page.get_by_role("heading", name=re.compile("^(✗ Not met|Open|Cannot be told)$"))).to_be_visible()
    expect(page.get_by_text("The reference is another system, with its own errors")).to_be_visible()
    expect(table.get_by_role("rowheader", name="Horizontal position").first).to_be_visible()
    page.get_by_role("button", name="Noise of IMU and receiver").click()
    expect(page.get_by_role("rowheader", name="White noise, horizontal")).to_be_visible()
    accessible(page, "As flown", every=True, advice=True)
    page.get_by_role("button", name="Use these in the design").click()
    noise = page.get_by_role("textbox", name=re.compile("^Position noise"))
    expect(noise).to_have_value(re.compile(r"^(0\.4[5-9]|0\.5)\d* m$"))
    expect(page.get_by_text("Press Start again.")).to_be_visible()
    (tmp_path / "photo.csv").write_bytes(b"\x89PNG\r\n\x1a\n\xff\xfe")
    inputs.nth(0).set_input_files(tmp_path / "photo.csv")
    expect(page.get_by_text("Solution photo.csv; reference truth.csv. Press Start.")).to_be_visible()
    start.click()
    expect(page.get_by_text("photo.csv: is a PNG image.")).to_be_visible(timeout=60_000)
    expect(table).to_be_visible()
    assert not messages

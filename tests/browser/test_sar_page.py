"""The SAR page as a person uses it: one screen, the first run, a slider that makes it stale, an upload."""

import re
from pathlib import Path

import numpy as np
import pytest
from on_page import Check, Visit
from playwright.sync_api import Page, expect
from waiting import until

_MATCH = "The runs match the design."
_ANSWER = re.compile(r"Detrended phase [\d.]+°, limit")


# Pixels by which what is drawn of the map is higher than its place: the texts below it may have grown.
_OVER_THE_EDGE = """() => {
  const high = (part) => part.getBoundingClientRect().height
  const find = (root) => {
    for (const part of root.querySelectorAll("*")) {
      if (part.matches(".bk-Figure") && high(part) > 200) return part
      const found = part.shadowRoot && find(part.shadowRoot)
      if (found) return found
    }
  }
  const figure = find(document)
  return high(figure.shadowRoot.querySelector(".bk-Canvas").shadowRoot.querySelector("canvas")) - high(figure)
}"""


def _open(visit: Visit, **size: int) -> Page:
    page = visit("/#sar", **size)
    expect(page.get_by_text(_MATCH)).to_be_visible()
    return page


def test_what_decides_is_on_one_screen_and_runs_go_stale_with_the_design(visit: Visit, page: Page) -> None:
    """No warning until then; the formulas follow the design at once."""
    warnings: list[str] = []
    page.on("console", lambda m: warnings.append(m.text) if m.type in {"warning", "error"} else None)
    _open(visit)
    for width, height in ((1440, 900), (1920, 1080)):
        page.set_viewport_size({"width": width, "height": height})
        until(
            lambda width=width, height=height: _seen_at_once(page, width, height), f"all of it in {width} x {height}"
        )
        until(lambda: page.evaluate(_OVER_THE_EDGE) <= 1, "a map as high as its card")
    assert page.get_by_role("rowheader").count() == 8
    assert not warnings, warnings
    answer = page.get_by_role("status").filter(has_text=_ANSWER)
    message = answer.inner_text()
    page.get_by_role("slider", name="Angle random walk").focus()
    page.keyboard.press("PageDown")
    expect(answer).to_contain_text("The runs are older than")
    expect(answer).not_to_have_text(message)
    page.get_by_role("combobox", name="Runs").click()
    page.get_by_role("listbox", name="Runs").get_by_text("1000", exact=True).click()
    page.get_by_role("button", name="Run the strategies").click()
    expect(page.get_by_text("of 1000 runs, about")).to_be_visible()
    page.get_by_role("button", name="Cancel").first.click()
    expect(page.get_by_text("Cancelled: ")).to_be_visible()


def _seen_at_once(page: Page, width: int, height: int) -> bool:
    """True where what decides lies inside the window, and the large parts are large."""
    parts = {
        "answer": page.get_by_role("status").filter(has_text=_ANSWER),
        "ranking": page.get_by_role("table", name="Strategies ranked by detrended phase"),
        "map": page.locator(".bk-Figure:visible").first,
        "image": page.get_by_role("img", name="RTS smoother"),
    }
    boxes = {name: part.bounding_box() for name, part in parts.items()}
    return all(
        box is not None
        and box["x"] >= 0
        and box["y"] >= 0
        and box["x"] + box["width"] <= width
        and box["y"] + box["height"] <= height
        and box["height"] > (200 if name in {"ranking", "map"} else 20)
        for name, box in boxes.items()
    )


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_part_is_accessible_and_pictures_are_taken_away(
    visit: Visit, page: Page, tmp_path: Path, accessible: Check, scheme: str
) -> None:
    """Axe over the whole page with its results, wide and in a phone's width; then the keyboard alone."""
    page.emulate_media(color_scheme=scheme)
    _open(visit)
    for title in ("Why, and what would change it", "Errors by strategy", "Exports"):
        page.get_by_role("button", name=title, exact=True).click()
    expect(page.get_by_role("button", name="Point target (NPZ)")).to_be_visible()
    accessible(page, "wide", every=True)
    page.set_viewport_size({"width": 390, "height": 844})
    page.keyboard.press("Escape")  # where the window is narrow the design is a drawer
    accessible(page, "narrow", every=True)
    wider = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wider <= 0  # tables scroll in regions of their own
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Point target (NPZ)").press("Enter")
    waiting.value.save_as(tmp_path / "point.npz")
    with np.load(tmp_path / "point.npz") as packed:
        assert packed["power_db"].shape == (9, 61, 121)
    region = page.get_by_role("region", name="Detrended phase by strategy")
    region.focus()
    region.press("ArrowRight")
    page.wait_for_function("e => e.scrollLeft > 0", arg=region.element_handle())


@pytest.mark.slow
def test_the_simulator_flies_and_is_cancelled(visit: Visit) -> None:
    page = _open(visit)
    page.get_by_role("combobox", name="Engine").press("ArrowDown")  # the choice by keyboard alone
    expect(page.get_by_role("menuitem", name="Full simulator")).to_be_visible()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.get_by_role("combobox", name="Engine")).to_have_text("Full simulator")
    run, cancel = (page.get_by_role("button", name=name).first for name in ("Run the strategies", "Cancel"))
    run.press("Enter")
    expect(page.get_by_text("of 50 runs, about")).to_be_visible()
    expect(cancel).to_be_enabled()
    cancel.press("Enter")
    expect(page.get_by_text("Cancelled: ")).to_be_visible()
    run.press("Enter")
    expect(page.get_by_text(f"{_MATCH} 50 flights of the simulator, seed 0.")).to_be_visible()
    page.get_by_role("button", name="Parts of the error, impulse response in numbers").click()
    expect(page.get_by_text("Simulator and error model compared")).to_be_visible()

"""The Simulate page: flights from a file, results to take away, and nobody left flying."""

import math
import re
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from on_page import Visit, box, enter, turn
from playwright.sync_api import Page, expect
from served import serving
from waiting import until

_HEADER = "time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg"


def open_simulate(visit: Visit) -> Page:
    page = visit()
    turn(page, "Simulate")
    expect(page.get_by_role("button", name="Start", exact=True)).to_be_enabled()
    return page


def flight(path: Path, **spoiled: str) -> Path:
    """A minute northwards at 60 m/s with a gentle weave; `spoiled` puts text into a column of the tenth row."""
    lines = [_HEADER]
    for second in range(61):
        row = {
            "time_s": f"{second}",
            "latitude_deg": f"{47 + 60 * second / 111_170:.9f}",
            "longitude_deg": f"{8 + 2e-5 * math.sin(second / 8):.9f}",
            "height_m": "2500",
            "roll_deg": f"{2 * math.sin(second / 5):.6f}",
            "pitch_deg": "1",
            "yaw_deg": "0",
        }
        lines.append(",".join((row | (spoiled if second == 9 else {})).values()))
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


@pytest.mark.slow
def test_a_flight_from_a_file_is_flown_and_one_that_cannot_be_is_refused_by_name(
    visit: Visit, tmp_path: Path
) -> None:
    page = open_simulate(visit)
    page.get_by_role("combobox", name="Trajectory").click()
    page.get_by_role("menuitem", name="From a file", exact=True).click()
    upload = page.get_by_label("Trajectory file")
    wrong = flight(tmp_path / "glitch.csv", latitude_deg="north")
    upload.set_input_files(wrong)
    expect(page.get_by_text("Not used. glitch.csv: line 11, column 2: 'north' is not a number")).to_be_visible()
    upload.set_input_files(flight(tmp_path / "jump.csv", height_m="9000"))
    expect(page.get_by_text(re.compile(r"jump\.csv: line \d+: the path needs an acceleration of"))).to_be_visible()
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\r\n\x1a\n\xff\xfe")
    upload.set_input_files(tmp_path / "picture.csv")
    expect(page.get_by_text("Not used. picture.csv: is a PNG image.")).to_be_visible()
    upload.set_input_files(flight(tmp_path / "weave.csv"))
    expect(page.get_by_text("weave.csv: a flight of 60 s; trajectory file, 61 rows.")).to_be_visible()
    expect(page.get_by_role("textbox", name="Length [s]")).to_have_value("60.0")
    enter(box(page, "Runs"), "8")
    enter(box(page, "Outages [s]"), "40,60")
    page.get_by_role("button", name="Start", exact=True).click()
    expect(page.get_by_text("8 × 60 s")).to_be_visible()
    page.get_by_role("button", name="Where formula and simulation differ, and why").click()
    expect(page.get_by_text("The flight comes from the file")).to_be_visible()


def heavy_tasks(server: str) -> float:
    with urllib.request.urlopen(server + "/metrics") as answer:
        return float(re.search(r"^navbudget_heavy_tasks (\S+)", answer.read().decode(), re.M)[1])


@pytest.fixture
def forgetful() -> Iterator[str]:
    """A server that keeps a closed page for two seconds only, for a browser that may come back."""
    with serving("--session-lifetime", "2") as (address, _):
        yield address


@pytest.mark.slow
def test_closing_the_page_ends_its_runs(page: Page, forgetful: str) -> None:
    page.goto(forgetful)
    turn(page, "Simulate")
    expect(page.get_by_role("button", name="Start", exact=True)).to_be_enabled()
    enter(box(page, "Runs"), "2000")
    enter(box(page, "Length [s]"), "2000")
    page.get_by_role("button", name="Start", exact=True).click()
    expect(page.get_by_text(re.compile(r"[1-9]\d* of 2000 runs, about \d+ s left"))).to_be_visible()
    assert heavy_tasks(forgetful) > 0
    page.goto("about:blank")
    # The chunk a worker has in hand ends by itself; nothing of the many minutes left is begun.
    until(lambda: heavy_tasks(forgetful) == 0, "the end of the runs of a closed page")

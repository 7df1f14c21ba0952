"""The first five minutes: the tour, the examples, the explanations, and the main job by keyboard alone."""

import math
import re
from collections.abc import Callable

import pytest
from on_page import Visit
from playwright.sync_api import expect

from app.document.verdict import verdict_strip
from app.serving.server import first_design
from nav_model.budget import analyse
from nav_model.design.catalogue import catalogue
from nav_model.design.presets import preset_fill


@pytest.mark.slow
def test_the_tour_is_offered_once_and_goes_by_keyboard(visit: Visit) -> None:
    page = visit()
    card = page.get_by_role("dialog")
    expect(card).to_be_hidden()  # offered, not thrust upon
    page.get_by_role("button", name="New here? Take the tour").press("Enter")
    titles = []
    for _ in range(5):
        expect(card.get_by_role("heading")).to_be_focused()
        titles.append(card.get_by_role("heading").inner_text())
        expect(card).to_have_accessible_description(re.compile(r"\w+ .+\."))
        assert page.locator(".frame").evaluate("e => !e.hidden && e.offsetWidth > 100"), titles
        card.get_by_role("button", name="Done" if len(titles) == 5 else "Next").press("Enter")
    assert len(set(titles)) == 5
    expect(card).to_be_hidden()
    page.reload()
    page.get_by_role("status").first.wait_for()
    page.get_by_role("button", name="Tour", exact=True).click()  # no longer offered, still there
    page.get_by_role("slider", name="Angle random walk").press("ArrowLeft")  # nothing is blocked meanwhile
    expect(page.get_by_role("button", name="Undo")).to_be_enabled()
    card.get_by_role("button", name="Next").press("Escape")
    expect(card).to_be_hidden()


@pytest.mark.slow
def test_every_open_input_is_explained(visit: Visit) -> None:
    page = visit()
    page.get_by_role("switch", name="Show help for all inputs").check()
    for text in (
        "White noise of the gyros, per axis.",
        "Typical: navigation 0.002",
        "the steady state is then solved numerically",
    ):
        expect(page.get_by_text(text).first).to_be_visible()
    page.get_by_role("switch", name="Show help for all inputs").uncheck()
    expect(page.get_by_text("White noise of the gyros")).to_have_count(0)


def test_own_imu_and_own_radar_lead_to_a_verdict_that_never_leaves_the_screen(visit: Visit) -> None:
    """Rows of a data sheet, then five boxes: going to a box is an action, typing in it is not."""
    page = visit()
    verdict = page.get_by_role("status").first
    actions = 0

    def act(action: Callable[[], object]) -> None:
        nonlocal actions
        actions += 1
        action()
        expect(verdict).to_be_in_viewport()

    act(page.get_by_role("button", name="My IMU").click)
    expect(page.get_by_role("textbox", name="Rows of the data sheet")).to_be_focused()
    page.keyboard.type("Angle random walk 0.08 deg/rt-hr\nVelocity random walk 0.03 m/s/rt-hr")
    act(page.get_by_role("button", name="Fill in").click)
    expect(page.get_by_text("Filled in. Undo reverts.")).to_be_visible()
    act(page.get_by_role("button", name="My radar").click)
    expect(page.get_by_role("textbox", name="Frequency", exact=True)).to_be_focused()
    page.keyboard.type("5.4 GHz")
    for box, value in (
        ("Azimuth resolution", "0,3 m"), ("Slant range", "8 km"), ("Speed", "100 m/s"), ("Altitude", "4.2 km"),
    ):  # fmt: skip
        act(page.get_by_role("textbox", name=box, exact=True).click)
        page.keyboard.press("ControlOrMeta+A")
        page.keyboard.type(value)
    act(lambda: page.keyboard.press("Enter"))
    budget = analyse(first_design().replace({
        "imu.angle_random_walk": math.radians(0.08) / 60, "imu.velocity_random_walk": 0.03 / 60,
        "radar.frequency": 5.4e9, "radar.azimuth_resolution": 0.3, "radar.slant_range": 8e3, "flight.speed": 100.0,
        "flight.altitude": 4.2e3,
    }))  # fmt: skip
    expect(verdict).to_contain_text(verdict_strip(budget).sentences[0])
    assert actions <= 8
    page.get_by_role("button", name="My flight").click()
    expect(page.get_by_role("heading", name="Plan")).to_be_visible()
    expect(verdict).to_contain_text("Does not close")


@pytest.mark.slow
def test_from_an_empty_start_to_the_imus_that_pass_for_my_radar(visit: Visit) -> None:
    """C band, 0.3 m, 12 km, 120 m/s, RTK of 3 cm at 5 Hz: going to a box is an action, typing in it is not."""
    page = visit()
    actions = 0

    def act(action: Callable[[], object]) -> None:
        nonlocal actions
        actions += 1
        action()

    act(page.get_by_role("button", name="My radar").click)
    for box, value in (
        ("Frequency", "5.4 GHz"), ("Azimuth resolution", "0,3 m"), ("Slant range", "12 km"), ("Speed", "120 m/s"),
        ("Position noise", "3 cm"), ("Fix interval", "5 Hz"),
    ):  # fmt: skip
        act(page.get_by_role("textbox", name=box, exact=True).click)
        page.keyboard.press("ControlOrMeta+A")
        page.keyboard.type(value)
    act(lambda: page.keyboard.press("Enter"))
    page.evaluate("location.hash = '#close-sensors'")
    design = first_design().replace({
        "radar.frequency": 5.4e9, "radar.azimuth_resolution": 0.3, "radar.slant_range": 12e3, "flight.speed": 120.0,
        "gnss.position_noise": 0.03, "gnss.interval": 0.2,
    })  # fmt: skip
    sheets = {name: preset_fill("imu", name)[0] for name in catalogue("imu")}
    verdicts = {
        name: analyse(design.replace(sheet)).verdict
        for name, sheet in sheets.items()
        if {"imu.angle_random_walk", "imu.velocity_random_walk"} <= sheet.keys()
    }
    margins = {name: verdict.tightest.margin for name, verdict in verdicts.items() if verdict.closes}
    passing = sorted(margins, key=lambda name: -margins[name])
    rows = page.get_by_role("region", name="IMUs with your receiver").get_by_role("row").filter(has_text="✓ +")
    rows = rows.filter(has=page.get_by_role("button"))  # the design's own unit is none to choose
    expect(rows).to_have_count(len(passing))
    expect(rows.get_by_role("button")).to_have_text(passing)
    assert len(passing) > 2
    assert actions <= 9
    page.get_by_role("button", name="All receivers").click()
    expect(page.get_by_role("region", name="Pairs of IMU and receiver")).to_be_visible()


@pytest.mark.slow
def test_an_imu_and_a_log_lead_to_their_answers(visit: Visit) -> None:
    page = visit()
    page.get_by_role("button", name="My IMU").click()
    for section, opened in (("IMU", "true"), ("GNSS", "false")):
        expect(page.get_by_role("button", name=section, exact=True)).to_have_attribute("aria-expanded", opened)
    page.get_by_role("textbox", name="Angle random walk", exact=True).fill("0.01 °/√h")
    page.keyboard.press("Enter")
    expect(page.get_by_role("status").filter(has_text="Closes")).to_be_visible()
    page.get_by_role("button", name="My log").click()
    expect(page.get_by_text("Analyse a log")).to_be_in_viewport()
    page = visit("/?arw=0.01deg/sqrt(h)")  # not an empty start
    expect(page.get_by_role("button", name="My radar")).to_be_hidden()


@pytest.mark.slow
def test_figures_are_told_as_chosen_in_this_browser_and_by_the_link(visit: Visit) -> None:
    page = visit()
    strip = page.get_by_role("status").first
    answer = strip.inner_text()
    tiles = page.get_by_label("Key figures")
    page.get_by_role("button", name="View", exact=True).click()
    page.get_by_label("Values as").select_option("2s")
    expect(tiles).to_contain_text("0.808 m")  # twice 0.404 m
    page.get_by_label("Units").select_option("si")
    expect(tiles).to_contain_text(" rad")
    assert answer.split("\n")[0] in strip.inner_text()
    expect(strip).to_contain_text("1.91 rad, limit 0.698 rad at 2σ")
    page.get_by_role("button", name="Share").click()
    link = page.get_by_label("Link to this design and page")
    expect(link).to_have_value(re.compile(r"&show=2s\.si#budget$"))  # it follows when the settings have come to rest
    assert len(link.input_value()) < 2000  # what mail programs and chats keep whole
    page.get_by_role("button", name="Copy link").click()
    page = visit("/#budget")  # the same browser, another visit
    expect(page.get_by_label("Key figures")).to_contain_text("0.808 m")

"""The Review page as a team uses it."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pypdf
import pytest
from playwright.sync_api import Browser, Download, Locator, Page, expect
from waiting import PATIENCE

Visit = Callable[..., Page]
Check = Callable[..., None]
HOSTILE = "<img src=x onerror=\"document.title='owned'\"><script>document.title='owned'</script>{{7*7}}"


def content(download: Download) -> bytes:
    path = download.path()
    assert path is not None
    return Path(path).read_bytes()


def tab(page: Page, name: str) -> None:
    """A page of the frame, or a part of the Review page."""
    page.get_by_role("tab", name=name, exact=True).click()


def press(page: Page, name: str | re.Pattern[str]) -> None:
    page.get_by_role("button", name=name, exact=isinstance(name, str)).click()


def field(page: Page, label: str) -> Locator:
    return page.get_by_role("textbox", name=label, exact=True)


def said(page: Page, text: str | re.Pattern[str]) -> None:
    expect(page.get_by_role("status").filter(has_text=text).first).to_be_visible()


def save(page: Page, name: str, author: str = "Ann") -> None:
    """Save the design in force under a name, on the Review page."""
    field(page, "Design").first.fill(name)
    field(page, "Design").first.press("Enter")
    if field(page, "Your name").input_value() != author:
        field(page, "Your name").fill(author)
    press(page, "Save as new design")
    expect(page.get_by_role("checkbox", name=name[:40])).to_be_visible()


def begin_review(page: Page, design: str, title: str) -> None:
    """Save the design in force, tick it, and open a review of it."""
    save(page, design)
    page.get_by_role("checkbox", name=design).check()
    expect(page.get_by_label("Picked revisions")).to_contain_text(design)
    tab(page, "Reviews")
    field(page, "Title of a new review").fill(title)
    press(page, "Open a review of the picked")


def test_a_new_user_saves_compares_and_exports_a_pair_in_fifteen_actions(visit: Visit, accessible: Check) -> None:
    page = visit()
    actions = 0

    def act(action: Callable[..., Any], *arguments: Any) -> None:
        nonlocal actions
        actions += 1
        action(*arguments)

    act(tab, page, "Review")
    act(field(page, "Your name").fill, "Ann")
    act(press, page, "Save as new design")
    said(page, "Saved: revision 1")
    act(field(page, "Design").first.fill, "Better gyro")
    act(field(page, "Angle random walk").fill, "0.01 °/√h")
    act(field(page, "Angle random walk").press, "Enter")
    act(press, page, "Save as new design")
    said(page, "Saved: revision 1 of Better gyro")
    act(page.get_by_role("checkbox", name="MEMS IMU at X band").check)
    act(page.get_by_role("checkbox", name="Better gyro").check)
    expect(page.get_by_label("Picked revisions")).to_contain_text("D2")
    act(press, page, "Compare")
    expect(page.get_by_role("region", name=re.compile("Standard deviations"))).to_contain_text("best")
    expect(page.get_by_role("region", name=re.compile("Inputs that are not"))).to_contain_text("0.01 °/√h")
    with page.expect_download() as download:
        act(press, page, re.compile(r"Comparison report \(PDF\)"))
    text = "".join(sheet.extract_text() for sheet in pypdf.PdfReader(io.BytesIO(content(download.value))).pages)
    assert "Better gyro" in text
    assert actions <= 15, actions
    link = field(page, "Link to this comparison").input_value()
    page = visit("/?" + link.partition("?")[2])
    expect(page.get_by_label("Compared")).to_contain_text("Better gyro")
    accessible(page, every=True)


def test_hostile_names_notes_and_comments_are_shown_and_do_nothing(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    field(page, "Note").fill(HOSTILE)
    save(page, HOSTILE, HOSTILE[:100])
    page.get_by_role("checkbox", name=HOSTILE[:40]).first.check()
    expect(page.get_by_label("Picked revisions")).to_contain_text("<img")
    tab(page, "Reviews")
    field(page, "Title of a new review").fill(HOSTILE)
    press(page, "Open a review of the picked")
    expect(page.get_by_role("heading", name=HOSTILE[:40])).to_be_visible()
    field(page, "Comment").fill(HOSTILE)
    press(page, "Add comment")
    expect(page.get_by_role("region", name="Comments", exact=True)).to_contain_text(HOSTILE)
    page.get_by_label("Presenter view").check()
    expect(page.locator(".slide")).to_contain_text("<script>")
    assert page.title() == "NavBudget"
    assert page.locator("img[src=x]").count() == 0


@pytest.mark.slow
def test_a_second_writer_is_told_and_a_review_is_signed_and_exported(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Shared design")
    press(page, re.compile("Save as revision 2"))
    said(page, "revision 2 of Shared design")
    page.get_by_role("button", name="Show 2 revisions").first.click()
    page.get_by_role("checkbox", name="Revision 1: Shared design").check()
    expect(page.get_by_label("Picked revisions")).to_contain_text("revision 1")
    press(page, "Open on the left")
    said(page, "Revision 1 of Shared design is in force")
    press(page, re.compile("Save as revision 2"))
    said(page, re.compile("Ann saved revision 2 .* nothing was overwritten"))
    press(page, re.compile("Save as revision 3"))
    said(page, "Saved: revision 3 of Shared design")

    tab(page, "Reviews")
    field(page, "Title of a new review").fill("PDR")
    press(page, "Open a review of the picked")
    heading = page.locator(".strip").filter(has=page.get_by_role("heading", name="PDR"))
    expect(heading).to_contain_text("5 to decide")
    press(page, "Reject")
    said(page, "reason: is empty")
    press(page, "Sign off")
    said(page, "5 requirements are not decided")
    for left in (4, 3, 2, 1):
        press(page, "Accept")
        expect(heading).to_contain_text(f"{left} to decide")
    press(page, "Accept")
    expect(heading).to_contain_text("can be signed")
    press(page, "Sign off")
    expect(heading).to_contain_text("Signed off by Ann")
    expect(page.get_by_role("button", name="Accept", exact=True)).to_have_count(0)
    with page.expect_download() as download:
        press(page, re.compile(r"Review report \(HTML\)"))
    text = content(download.value).decode()
    assert "Seal (SHA-256)" in text
    assert "✓ accepted" in text
    press(page, "All reviews")
    row = page.get_by_role("region", name="All reviews").get_by_role("row").filter(has_text="PDR")
    expect(row).to_contain_text("Signed off by Ann")
    row.get_by_role("button", name="PDR").click()
    expect(heading).to_contain_text("Signed off by Ann")


@pytest.mark.slow
def test_two_people_decide_on_one_review_and_neither_overrules_the_other_unseen(
    visit: Visit, server: str, browser: Browser
) -> None:
    page = visit()
    tab(page, "Review")
    begin_review(page, "Seen by two", "Both")
    heading = page.locator(".strip").filter(has=page.get_by_role("heading", name="Both"))
    expect(heading).to_contain_text("5 to decide")
    second = browser.new_context().new_page()
    second.set_default_timeout(1e3 * PATIENCE)
    second.goto(server + "/#review")
    tab(second, "Reviews")
    second.get_by_role("region", name="All reviews").get_by_role("button", name="Both").click()
    field(second, "Your name").fill("Bob")
    field(second, "Reason (needed to reject)").fill("no margin left")
    press(second, "Reject")
    expect(second.locator(".strip").filter(has_text="1 requirement rejected")).to_be_visible()
    press(page, "Accept")  # of what still says "open" here
    said(page, re.compile("Bob rejected .no margin left. this after you opened it"))
    expect(heading).to_contain_text("1 requirement rejected")
    field(second, "Comment").fill("and one more thing")
    press(second, "Add comment")
    expect(second.get_by_role("region", name="Comments", exact=True)).to_contain_text("one more thing")
    second.context.close()
    press(page, "Accept")  # now knowingly
    expect(heading).to_contain_text("0 requirements rejected")
    for left in (4, 3, 2, 1):
        expect(heading).to_contain_text(f"{left} to decide")
        press(page, "Accept")
    expect(heading).to_contain_text("can be signed")
    expect(page.get_by_role("region", name="Comments", exact=True)).to_contain_text("one more thing")
    press(page, "Sign off")
    expect(heading).to_contain_text("Signed off by Ann")


@pytest.mark.slow
def test_a_revision_is_the_base_of_its_own_changes_only(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Ours")
    following = page.get_by_role("button", name="Save as revision 2 of Ours")
    expect(following).to_be_visible()
    page.get_by_role("button", name="Open", exact=True).click()
    page.get_by_role("button", name="Examples").click()
    page.get_by_role("button", name="Open L band from a jet").click()
    expect(following).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(following).to_be_visible()
    following.click()
    said(page, "revision 2 of Ours")
    page.get_by_role("button", name="Show 2 revisions").first.click()
    both = page.get_by_role("checkbox", name=re.compile("^Ours|Revision 2: Ours"))
    expect(both).to_have_count(2)
    both.first.check()
    expect(both.last).to_be_checked()
    press(page, "Clear")
    for tick in both.all():
        expect(tick).not_to_be_checked()
    page.get_by_role("tab", name="Library").focus()  # by the keyboard
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    expect(page.get_by_role("tab", name="Compare")).to_have_attribute("aria-selected", "true")
    expect(page.get_by_text("Nothing to compare yet")).to_be_visible()


@pytest.mark.slow
def test_a_library_goes_out_and_comes_in_as_a_zip(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Traveller")
    save(page, "Put away")
    page.get_by_role("checkbox", name="Put away").check()
    press(page, "Archive or restore")
    said(page, "1 design archived")
    with page.expect_download() as download:
        press(page, re.compile("Export"))
    data = content(download.value)
    names = " ".join(zipfile.ZipFile(io.BytesIO(data)).namelist())
    assert "traveller-" in names
    assert "put-away-" in names  # all means the archived as well
    page.locator("input[type=file][accept='.zip']").set_input_files(
        {"name": "../../l.zip", "mimeType": "application/zip", "buffer": data}
    )
    said(page, re.compile("Imported 0 designs.*here already"))
    evil = io.BytesIO()
    with zipfile.ZipFile(evil, "w") as archive:
        archive.writestr("../evil.toml", "x")
    page.locator("input[type=file][accept='.zip']").set_input_files(
        {"name": "evil.zip", "mimeType": "application/zip", "buffer": evil.getvalue()}
    )
    said(page, "not a path inside the archive")


@pytest.mark.slow
def test_forged_links_are_said_so(visit: Visit) -> None:
    for query in ("?compare=../../etc/passwd,%3Cscript%3E", "?review=%27%20OR%201=1", "?compare=" + "0" * 16 + ".1"):
        page = visit("/" + query)
        expect(page.get_by_role("status").first).to_contain_text(re.compile("not used|not in the library"))
        assert page.title() == "NavBudget"


@pytest.mark.slow
def test_the_presenter_view_leaves_the_room_one_decision(visit: Visit) -> None:
    page = visit(width=1920, height=1080)
    tab(page, "Review")
    begin_review(page, "Shown to a room", "In the room")
    said(page, "In the room is open")
    page.get_by_label("Presenter view").check()
    slide = page.locator(".slide")
    expect(slide).to_contain_text("decision 1 of 5")
    for tool in (page.get_by_role("button", name="Report", exact=True), field(page, "Your name"),
                 page.get_by_role("tab", name="Budget"), page.get_by_role("tab", name="Library")):  # fmt: skip
        expect(tool).to_be_hidden()
    assert slide.locator("h2").evaluate("e => parseFloat(getComputedStyle(e).fontSize)") >= 60
    press(page, "Accept")
    expect(slide).to_contain_text("decision 2 of 5")
    page.evaluate("() => { location.hash = '#budget' }")  # the only way out but the switch
    expect(page.get_by_role("tab", name="Budget")).to_be_visible()
    tab(page, "Review")
    expect(field(page, "Your name")).to_be_visible()
    expect(page.get_by_label("Presenter view")).not_to_be_checked()

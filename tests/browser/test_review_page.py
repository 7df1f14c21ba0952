"""The Review page as a team uses it."""

import io
import re
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pypdf
import pytest
from deaf import Deaf
from on_page import Check, Visit, box, content
from playwright.sync_api import Browser, Page, expect
from waiting import PATIENCE

HOSTILE = "<img src=x onerror=\"document.title='owned'\"><script>document.title='owned'</script>{{7*7}}"


class Actions:
    """Does what a person does, and counts."""

    count = 0

    def __call__(self, action: Callable[..., Any], *arguments: Any) -> None:
        self.count += 1
        action(*arguments)


def tab(page: Page, name: str) -> None:
    """A page of the frame, or a part of the Review page."""
    page.get_by_role("tab", name=name, exact=True).or_(page.get_by_role("button", name=name, exact=True)).click()


def press(page: Page, name: str | re.Pattern[str]) -> None:
    page.get_by_role("button", name=name, exact=isinstance(name, str)).click()


def expect_message(page: Page, text: str | re.Pattern[str]) -> None:
    expect(page.get_by_role("status").filter(has_text=text).first).to_be_visible()


def save(page: Page, name: str, author: str = "Ann") -> None:
    """Save the current design under a name, on the Review page."""
    box(page, "Design").first.fill(name)
    box(page, "Design").first.press("Enter")
    if box(page, "Your name").input_value() != author:
        box(page, "Your name").fill(author)
    press(page, "Save as new design")
    expect(page.get_by_role("checkbox", name=name[:40])).to_be_visible()


def begin_review(page: Page, design: str, title: str) -> None:
    """Save the current design, tick it, and open a review of it."""
    save(page, design)
    page.get_by_role("checkbox", name=design).check()
    expect(page.get_by_label("Selected designs")).to_contain_text(design)
    tab(page, "Reviews")
    box(page, "Title of a new review").fill(title)
    press(page, "Start review of selected designs")


def decide(page: Page, requirement: str, press: str = "Accept", reason: str = "") -> None:
    """Decide in the row of a requirement, with a reason where one is asked for."""
    row = page.get_by_role("row").filter(has=page.get_by_role("rowheader", name=requirement, exact=True))
    row.get_by_role("button", name=f"{press}: {requirement}").click()
    if reason:
        row.get_by_role("textbox").fill(reason)
        row.get_by_role("textbox").press("Enter")


@pytest.fixture
def second(browser: Browser, server: str) -> Iterator[Page]:
    """The page of another person."""
    page = browser.new_context().new_page()
    page.set_default_timeout(1e3 * PATIENCE)
    page.goto(server + "/#review")
    page.get_by_role("slider", name="Position noise").wait_for()  # which comes last
    yield page
    page.context.close()


def test_a_new_user_saves_compares_and_exports_a_pair_in_fifteen_actions(visit: Visit, accessible: Check) -> None:
    page = visit()
    act = Actions()
    act(tab, page, "Review")
    act(box(page, "Your name").fill, "Ann")
    act(press, page, "Save as new design")
    expect_message(page, "Saved: revision 1")
    act(box(page, "Design").first.fill, "Better gyro")
    act(box(page, "Angle random walk").fill, "0.01 °/√h")
    act(box(page, "Angle random walk").press, "Enter")
    act(press, page, "Save as new design")
    expect_message(page, "Saved: revision 1 of Better gyro")
    act(page.get_by_role("checkbox", name="MEMS IMU at X band").check)
    act(page.get_by_role("checkbox", name="Better gyro").check)
    expect(page.get_by_label("Selected designs")).to_contain_text("D2")
    act(press, page, "Compare selected")
    expect(page.get_by_role("region", name=re.compile("Errors, 1σ"))).to_contain_text("best")
    expect(page.get_by_role("region", name=re.compile("Inputs that differ"))).to_contain_text("0.01 °/√h")
    with page.expect_download() as download:
        act(press, page, re.compile(r"Comparison report \(PDF\)"))
    text = "".join(sheet.extract_text() for sheet in pypdf.PdfReader(io.BytesIO(content(download.value))).pages)
    assert "Better gyro" in text
    assert act.count <= 15
    link = box(page, "Link to this comparison").input_value()
    page = visit("/?" + link.partition("?")[2])
    expect(page.get_by_label("Compared")).to_contain_text("Better gyro")
    accessible(page, every=True)


def test_two_designs_become_a_signed_review_with_a_waiver_in_twenty_actions(visit: Visit, accessible: Check) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Wide gyro")
    save(page, "Its twin")
    act = Actions()
    act(page.get_by_role("checkbox", name="Wide gyro").check)
    act(page.get_by_role("checkbox", name="Its twin").check)
    expect(page.get_by_label("Selected designs")).to_contain_text("D2")
    act(tab, page, "Reviews")
    act(box(page, "Title of a new review").fill, "CDR")
    act(press, page, "Start review of selected designs")
    act(press, page, "Accept the 4 that are met")
    open_rows = page.get_by_role("row").filter(has_text="open")
    for remaining in (4, 3, 2, 1):
        expect(open_rows).to_have_count(remaining)
        act(open_rows.first.get_by_role("button", name=re.compile("^Accept")).click)
        act(page.get_by_role("textbox", name=re.compile("^Reason")).fill, "autofocus removes it")
        act(page.keyboard.press, "Enter")
    expect(open_rows).to_have_count(0)
    act(press, page, "Sign off")
    expect_message(page, "You wrote 4 of 4 waivers. A signed review never changes.")
    act(press, page, "Sign as Ann (outcome: accepted with 4 waivers)")
    expect(page.locator(".strip").filter(has_text="CDR")).to_contain_text("⚠ Signed by Ann: accepted with 4 waivers")
    assert act.count <= 20
    accessible(page, every=True)
    with page.expect_download() as download:
        press(page, re.compile(r"Review report \(PDF\)"))
    first = pypdf.PdfReader(io.BytesIO(content(download.value))).pages[0].extract_text()
    for said_there in (
        "CDR",
        "Accepted with 4 waivers",
        "Signed off by Ann",
        "autofocus removes it",
        "182° against 90°",
    ):
        assert said_there in first
    again = visit("/#review")  # the same browser, later
    expect(box(again, "Your name")).to_have_value("Ann")


@pytest.mark.slow
def test_hostile_names_notes_and_comments_are_shown_and_do_nothing(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    box(page, "Note").fill(HOSTILE)
    save(page, HOSTILE, HOSTILE[:100])
    page.get_by_role("checkbox", name=HOSTILE[:40]).first.check()
    expect(page.get_by_label("Selected designs")).to_contain_text("<img")
    tab(page, "Reviews")
    box(page, "Title of a new review").fill(HOSTILE)
    press(page, "Start review of selected designs")
    expect(page.get_by_role("heading", name=HOSTILE[:40])).to_be_visible()
    box(page, "Comment").fill(HOSTILE)
    press(page, "Add comment")
    expect(page.get_by_role("region", name="Comments", exact=True)).to_contain_text(HOSTILE)
    assert page.title() == "NavBudget"
    assert page.locator("img[src=x]").count() == 0


@pytest.mark.slow
def test_a_second_writer_is_told_and_a_review_is_signed_and_exported(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Shared design")
    press(page, re.compile("Save as revision 2"))
    expect_message(page, "revision 2 of Shared design")
    page.get_by_role("button", name="Show 2 revisions").first.click()
    page.get_by_role("checkbox", name="Revision 1: Shared design").check()
    expect(page.get_by_label("Selected designs")).to_contain_text("revision 1")
    press(page, "Load into editor")
    expect_message(page, "Revision 1 of Shared design is loaded")
    press(page, re.compile("Save as revision 2"))
    expect_message(page, re.compile("Ann saved revision 2 .* nothing was overwritten"))
    press(page, re.compile("Save as revision 3"))
    expect_message(page, "Saved: revision 3 of Shared design")

    tab(page, "Reviews")
    box(page, "Title of a new review").fill("PDR")
    press(page, "Start review of selected designs")
    heading = page.locator(".strip").filter(has=page.get_by_role("heading", name="PDR"))
    expect(heading).to_contain_text("4 to decide")
    press(page, "Sign off")
    expect_message(page, "4 requirements still need a decision. Next: Quadratic phase (D1).")
    press(page, "Accept the 2 that are met")
    expect(heading).to_contain_text("2 to decide")
    decide(page, "Quadratic phase", "Reject", "too large")
    expect(heading).to_contain_text("1 requirement rejected")
    decide(page, "Detrended phase", "Accept", "autofocus removes it")
    expect(heading).to_contain_text("1 waiver")
    expect(heading).to_contain_text("Ready to sign")
    press(page, "Sign off")
    press(page, "Not yet")
    expect(page.get_by_role("button", name=re.compile("^Sign as Ann"))).to_be_hidden()
    expect(heading).to_contain_text("Ready to sign")
    press(page, "Sign off")
    press(page, "Sign as Ann (outcome: rejected)")
    expect(heading).to_contain_text("✗ Signed by Ann: rejected")
    expect(page.get_by_role("button", name=re.compile("^(Accept|Change)"))).to_have_count(0)
    with page.expect_download() as download:
        press(page, re.compile(r"Review report \(HTML\)"))
    text = content(download.value).decode()
    assert "Seal (SHA-256)" in text
    assert "✓ accepted" in text
    press(page, "All reviews")
    row = page.get_by_role("region", name="All reviews").get_by_role("row").filter(has_text="PDR")
    expect(row).to_contain_text("Signed by Ann: rejected")
    row.get_by_role("button", name="PDR").click()
    expect(heading).to_contain_text("Signed by Ann: rejected")


@pytest.mark.slow
def test_two_people_decide_on_one_review_and_neither_overrules_the_other_unseen(visit: Visit, second: Page) -> None:
    page = visit()
    tab(page, "Review")
    begin_review(page, "Seen by two", "Both")
    heading = page.locator(".strip").filter(has=page.get_by_role("heading", name="Both"))
    expect(heading).to_contain_text("4 to decide")
    tab(second, "Reviews")
    second.get_by_role("region", name="All reviews").get_by_role("button", name="Both").click()
    box(second, "Your name").fill("Bob")
    decide(page, "Detrended phase")  # asks for a reason, which is being written meanwhile
    expect(box(page, "Reason: Detrended phase")).to_be_focused()
    decide(second, "Horizontal position", "Reject", "no margin left")
    expect(second.locator(".strip").filter(has_text="1 requirement rejected")).to_be_visible()
    header = page.get_by_role("rowheader", name="Horizontal position", exact=True)
    row = page.get_by_role("row").filter(has=header)
    expect(row).to_contain_text("rejected by Bob")  # by itself
    expect(row).to_contain_text("no margin left")
    expect(row.get_by_role("button")).to_have_text(["Change"])  # theirs is seen before another takes its place
    expect(box(page, "Reason: Detrended phase")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_text("Enter a reason.")).to_be_visible()
    page.keyboard.type("autofocus removes it")
    decide(second, "Detrended phase", "Reject", "not tried yet")  # first
    detrended = page.get_by_role("row").filter(has_text="Detrended phase")
    expect(detrended).to_contain_text("rejected by Bob")
    expect(detrended).to_contain_text("Your reason was not sent: autofocus removes it")
    expect(detrended.get_by_role("button")).to_have_text(["Change"])
    decide(page, "Detrended phase", "Change")
    decide(page, "Detrended phase")
    expect(box(page, "Reason: Detrended phase")).to_have_value("autofocus removes it")
    page.keyboard.press("Enter")
    expect(heading).to_contain_text("1 waiver")
    box(second, "Comment").fill("and one more thing")
    press(second, "Add comment")
    expect(second.get_by_role("region", name="Comments", exact=True)).to_contain_text("one more thing")
    decide(page, "Horizontal position", "Change")
    decide(page, "Horizontal position")
    expect(heading).to_contain_text("0 requirements rejected")
    decide(page, "Quadratic phase", "Accept", "autofocus removes it")
    decide(page, "Horizontal position after the outage")
    expect(heading).to_contain_text("Ready to sign")
    expect(page.get_by_role("region", name="Comments", exact=True)).to_contain_text("one more thing")
    press(page, "Sign off")
    press(page, "Sign as Ann (outcome: accepted with 2 waivers)")
    expect(heading).to_contain_text("Signed by Ann: accepted with 2 waivers")


def test_a_page_that_still_says_open_does_not_replace_anothers_reject(visit: Visit, page: Page, second: Page) -> None:
    first = Deaf(page)
    visit()
    tab(page, "Review")
    begin_review(page, "Seen too late", "Too late")
    header = page.get_by_role("rowheader", name="Horizontal position", exact=True)
    row = page.get_by_role("row").filter(has=header)
    expect(row).to_contain_text("open")
    tab(second, "Reviews")
    second.get_by_role("region", name="All reviews").get_by_role("button", name="Too late").click()
    box(second, "Your name").fill("Bob")
    first.deaf = True
    decide(second, "Horizontal position", "Reject", "no margin left")
    theirs = second.get_by_role("row").filter(has_text="rejected by Bob")
    expect(theirs).to_have_count(1)
    expect(row).to_contain_text("open")  # still
    decide(page, "Horizontal position")
    first.hear()
    expect_message(page, "Bob rejected (no margin left) this after you opened it. Look again and decide.")
    expect(row).to_contain_text("rejected by Bob")
    expect(theirs).to_have_count(1)


@pytest.mark.slow
def test_a_revision_is_the_base_of_its_own_changes_only(visit: Visit) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Ours")
    following = page.get_by_role("button", name="Save as revision 2 of Ours")
    expect(following).to_be_visible()
    page.get_by_role("button", name="Open", exact=True).click()
    page.get_by_role("button", name="L band from a jet").click()
    expect(following).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(following).to_be_visible()
    following.click()
    expect_message(page, "revision 2 of Ours")
    page.get_by_role("button", name="Show 2 revisions").first.click()
    both = page.get_by_role("checkbox", name=re.compile("^Ours|Revision 2: Ours"))
    expect(both).to_have_count(2)
    both.first.check()
    expect(both.last).to_be_checked()
    press(page, "Clear")
    for tick in both.all():
        expect(tick).not_to_be_checked()
    page.get_by_role("button", name="Library", exact=True).focus()  # by the keyboard
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Compare", exact=True)).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_text("Nothing to compare yet")).to_be_visible()


@pytest.mark.slow
def test_a_library_goes_out_and_comes_in_as_a_zip(visit: Visit, tmp_path: Path) -> None:
    page = visit()
    tab(page, "Review")
    save(page, "Traveller")
    save(page, "Put away")
    page.get_by_role("checkbox", name="Put away").check()
    press(page, "Archive or restore")
    expect_message(page, "1 design archived")
    with page.expect_download() as download:
        press(page, re.compile("Export"))
    data = content(download.value)
    names = " ".join(zipfile.ZipFile(io.BytesIO(data)).namelist())
    assert "traveller-" in names
    assert "put-away-" in names  # all means the archived as well
    page.locator("input[type=file][accept='.zip']").set_input_files(
        {"name": "../../l.zip", "mimeType": "application/zip", "buffer": data}
    )
    expect_message(page, re.compile("Imported 0 designs.*here already"))
    evil = io.BytesIO()
    with zipfile.ZipFile(evil, "w") as archive:
        archive.writestr("../evil.toml", "x")
    page.locator("input[type=file][accept='.zip']").set_input_files(
        {"name": "evil.zip", "mimeType": "application/zip", "buffer": evil.getvalue()}
    )
    expect_message(page, "not a path inside the archive")


def test_the_review_in_view_is_there_again_after_a_reload_and_by_the_link(visit: Visit, second: Page) -> None:
    page = visit("/#review")
    begin_review(page, "Loaded again", "Reload review")
    strip = page.locator(".bare.strip").filter(has_text="Reload review")
    expect(strip).to_be_visible()
    page.reload()
    expect(strip).to_be_visible()
    press(page, "Share")
    link = box(page, "Link to this design and page")
    expect(link).to_have_value(re.compile(r"[?&]review\."))
    second.goto(link.input_value())
    expect(second.locator(".bare.strip").filter(has_text="Reload review")).to_be_visible()
    page.keyboard.press("Escape")
    tab(page, "Library")
    expect(strip).to_be_hidden()
    page.reload()
    expect(page.get_by_role("button", name="Clear", exact=True)).to_be_visible()
    expect(strip).to_be_hidden()


@pytest.mark.slow
def test_forged_links_are_said_so(visit: Visit) -> None:
    for query in ("?compare=../../etc/passwd,%3Cscript%3E", "?review=%27%20OR%201=1", "?compare=" + "0" * 16 + ".1"):
        page = visit("/" + query)
        expect_message(page, re.compile("not used|not in the library"))
        assert page.title() == "NavBudget"

"""The record of a review in the report, and a first page that needs no library."""

import io
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import pypdf
import pytest
from behind_its_back import decided

from app.document.numbers import show
from app.document.pane import html_of
from app.library.place import library, use_library
from app.library.reviews import Review, add_comment, decide, open_review, sign
from app.library.store import Library
from app.report import report_bytes
from app.subjects.review.report import audit_sections, audit_table, front_page, owner_tables, status_table
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.allocation import allocate
from nav_model.design import Design
from nav_model.design.user_entries import read_entries

pytestmark = [pytest.mark.usefixtures("charts_drawn_once"), pytest.mark.long]
HOSTILE = "<script>alert(1)</script> #panic() $x$ {{7*7}}"


@pytest.fixture(scope="module")
def budgets(mems: Budget, tactical: Budget) -> list[Budget]:
    return [mems, tactical]


@pytest.fixture
def signed(tmp_path: Path, budgets: list[Budget]) -> Iterator[Review]:
    place = Library(tmp_path / "library.db")
    keys = [place.save(budget, "Ann", HOSTILE).key for budget in budgets]
    review = open_review(place, HOSTILE, "Ann", keys)
    review = add_comment(place, review.id, 1, "imu.angle_random_walk", "Bob", HOSTILE)
    review = decided(place, review, "1 m against 2 m")
    yield sign(place, review.id, "Chief", review.version)
    place.close()


def test_a_reviews_report_has_outcome_signature_and_conditions_first_and_the_audit_as_text(signed: Review) -> None:
    budgets = [revision.budget() for revision in signed.revisions]
    parts = {"added": audit_sections(signed), "front": front_page(signed)}
    data, page = (report_bytes(budgets, kind, **parts) for kind in (".pdf", ".html"))
    sheets = [sheet.extract_text() for sheet in pypdf.PdfReader(io.BytesIO(data)).pages]
    first = " ".join(sheets[0].split())
    assert "Rejected: 2 requirements" in first
    assert "Signed off by Chief" in first
    assert "163° against 90°" not in first  # the figure as it was decided on is the one that counts
    conditions, _, decisions = first.partition("Requirements and decisions")
    assert conditions.count("1 m against 2 m") == 2
    assert conditions.count("as computed") == 2
    assert "Reviewers Bob" in conditions
    for check in budgets[0].verdict.checks:
        assert check.label in decisions
    page = page.decode()
    assert page.index("Waivers and rejections") < page.index("Inputs that differ")
    assert "<script>alert(1)" not in page
    printed = "".join("".join(sheets).split())
    for text in (signed.seal, *(item.content_hash for item in signed.items), "Chief", "inputanglerandomwalk"):
        assert text in page.replace("input angle random walk", "inputanglerandomwalk")
        assert text in printed
    assert HOSTILE.replace(" ", "") in printed


def test_a_review_of_another_version_says_which_program_worked_out_what(signed: Review) -> None:
    def program(review: Review) -> str:
        (row,) = (row for row in audit_table(review).rows if row[0].text == "Program")
        return row[1].text

    here = version("navbudget")
    assert program(signed) == f"NavBudget {here}"
    assert program(replace(signed, product="0.0.1")).startswith(
        "NavBudget 0.0.1; values here are computed by " + here
    )


def test_status_has_a_row_for_every_requirement_with_its_decision(signed: Review, budgets: list[Budget]) -> None:
    rows = [row for row in status_table(signed).rows if len(row) > 1]
    checks = [check for budget in budgets for check in budget.verdict.checks]
    assert [row[0].text for row in rows] == [check.label for check in checks]
    assert [row[4].text for row in rows] == ["✓ accepted" if check.met else "✗ rejected" for check in checks]


def test_the_library_is_opened_only_when_asked_for_and_a_failure_is_not_final(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    try:
        use_library(str(blocked / "library.db"))  # says nothing: nobody has asked
        with pytest.raises(InputError, match="cannot be used"):
            library()
        blocked.unlink()
        assert library() is library()
        assert (tmp_path / "file" / "library.db").exists()
    finally:
        use_library("")


def test_owners_and_what_changed_between_designs_can_be_seen(tmp_path: Path) -> None:
    """A requirement of one's own is decided on like any other; the record says who answers for what."""
    place = Library(tmp_path / "library.db")
    base = Design({"requirements.detrended_phase": 1.0})
    arm = {"name": "<arm>", "value": "1 mm", "enters": "detrended_phase", "owner": "mechanics", "source": "survey"}
    heading = {"name": "heading", "on": "coast_heading", "limit": "5°"}
    tables = [
        {"contributors": [arm], "limits": [heading]},
        {"contributors": [arm | {"owner": "radar", "value": "2 mm"}], "limits": [heading],
         "allocation": {"reserve": "10 %"}},
    ]  # fmt: skip
    designs = [base.replace({}, entries=read_entries(each)) for each in tables]
    keys = [place.save(analyse(design), "Ann", "").key for design in designs]
    review = open_review(place, "Owners", "Ann", keys)
    assert (2, "heading") in review.open_points()
    review = decide(place, review.id, 2, "heading", True, "Bob", "")
    assert (2, "heading") not in review.open_points()
    html = html_of(*owner_tables(review))
    for block in owner_tables(review):  # what a person writes is given a width, or no room is left on paper
        for cells in zip(block.columns, *block.rows, strict=True):
            assert cells[0].width or all(len(cell.text) < 40 for cell in cells[1:])
    assert "<arm>" not in html
    assert "mechanics, radar" in html
    for design in designs:
        entry = next(line for line in allocate(analyse(design), "detrended_phase").entries if line.source == "<arm>")
        assert f"{show(entry.allocated, 'angle')} ({show(entry.estimated, 'angle')})" in html
    changed = html[html.index("What differs") :].replace("\xa0", " ")
    for text in ("owner mechanics, survey", "owner radar, survey", "2 mm in Detrended phase", "reserve 10 %"):
        assert text in changed
    assert "heading" not in changed
    assert "Allocation and owners" in [section.title for section in audit_sections(review)]
    place.close()

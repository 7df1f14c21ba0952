"""The Theory page's text: nothing of the record is left out, and its head counts what the rows say."""

import re
from collections import Counter

import pytest

from app.subjects.theory.page import theory, validation_answer
from app.subjects.theory.record import INDEPENDENT, OURS, record


@pytest.fixture(scope="module")
def table():
    """Cells of the table of comparisons, row by row, as text."""
    html = theory().partition('id="comparisons"')[2].partition("</table>")[0]
    rows = (re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.split(r"<tr[^>]*>", html)[1:])
    return [[re.sub(r"<[^>]+>", "", cell).strip() for cell in row] for row in rows if len(row) == 6][1:]


def test_every_comparison_has_its_row_with_its_kind(table):
    assert len(table) == len(record().rows)
    kinds = Counter(cells[1] for cells in table)
    assert kinds == Counter(f"– {OURS}" if row.kind == OURS else f"✓ {row.kind}" for row in record().rows)


def test_the_head_counts_the_rows(table):
    ticked = Counter(cells[1].removeprefix("✓ ") for cells in table if cells[1].startswith("✓"))
    answer = validation_answer()
    head = " ".join((answer.word, *answer.sentences))
    assert f"{ticked.total()} of {len(table)} results are checked against independent references" in head
    for kind, count in ticked.items():
        assert f"{count} against {INDEPENDENT[kind]}" in head
    ours = len(table) - ticked.total()
    assert f"{ours} results are compared with our own derivations only" in re.sub(r"<[^>]+>", "", theory())


def test_every_chapter_unfolds_and_every_link_leads_somewhere_on_the_page():
    assert theory().count("<details id=") == theory().count("<summary><h2>") == 8
    places = set(re.findall(r'href="#theory-([\w-]+)"', theory()))
    assert len(places) > 20
    for place in places:
        assert theory().count(f'id="{place}"') == 1

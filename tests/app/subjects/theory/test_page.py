"""The Theory page's text: nothing of the record is left out, and its head counts what the rows say."""

import re
from collections import Counter

import pytest

from app.subjects.theory.page import theory
from app.subjects.theory.record import INDEPENDENT, OURS, record


@pytest.fixture(scope="module")
def table():
    """Cells of the table of comparisons, row by row, as text."""
    html = theory().partition('id="comparisons"')[2].partition("</table>")[0]
    rows = (re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.split(r"<tr[^>]*>", html)[1:])
    return [[re.sub(r"<[^>]+>", "", cell).strip() for cell in row] for row in rows if len(row) == 6][1:]


def test_every_comparison_has_its_row_with_its_kind(table):
    assert len(table) == len(record().rows)
    shown = Counter(cells[1] for cells in table)
    assert shown == Counter(f"– {OURS}" if row.kind == OURS else f"✓ {row.kind}" for row in record().rows)


def test_the_head_counts_the_rows(table):
    ticked = Counter(cells[1].removeprefix("✓ ") for cells in table if cells[1].startswith("✓"))
    head = re.sub(r"<[^>]+>", "", theory())
    assert f"{ticked.total()} of {len(table)} results are checked against independent references" in head
    for kind, count in ticked.items():
        assert f"{count} against {INDEPENDENT[kind]}" in head
    assert f"The other {len(table) - ticked.total()} are compared with our own derivations only" in head


def test_every_place_of_the_contents_is_on_the_page():
    places = re.findall(r'href="#theory-([\w-]+)">(?!\[)', theory().partition("</nav>")[0])
    assert len(places) == 8
    for place in places:
        assert theory().count(f'id="{place}"') == 1

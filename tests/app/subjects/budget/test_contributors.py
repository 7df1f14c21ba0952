"""Contributors on the Budget page: the box, the tables, and the comparison of designs."""

from __future__ import annotations

import re

import pytest

from app.document.html import to_html
from app.report.content import report_of
from app.session import Session
from app.subjects.budget.contributors import Contributors, contributors_html
from nav_model import Design, analyse
from nav_model.budget.allocation import allocate
from nav_model.design.file import parse_contributors

_TEXT = '[[contributors]]\nname = "lever <arm>"\nvalue = "1 mm"\nenters = "detrended_phase"\nowner = "mechanics"\n'
_DESIGN = Design({"requirements.detrended_phase": 0.4, "requirements.tilt": 0.01})


@pytest.fixture
def part() -> Contributors:
    session = Session(_DESIGN)
    part = Contributors(session)
    session.param.watch(lambda event: part.show(event.new), "budget")
    part.show(session.budget)
    return part


def test_what_is_entered_becomes_part_of_the_design_and_can_be_undone(part: Contributors) -> None:
    session, before = part.session, part.session.budget
    part._box.value = _TEXT
    (own,) = session.design.contributors
    assert (own.name, own.value, own.owner) == ("lever <arm>", 1e-3, "mechanics")
    assert session.budget.sar.detrended > before.sar.detrended
    assert parse_contributors(part._box.value) == session.design.contributors
    session.change({"gnss.interval": 0.5})
    assert session.design.contributors == (own,)
    session.undo()
    session.undo()
    assert session.design == before.design
    assert part._box.value == ""
    session.redo()
    part._box.value = " "
    assert session.design == before.design


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (_TEXT.replace("1 mm", "1 m/s"), "contributors[lever &lt;arm&gt;].value"),
        (_TEXT + _TEXT, "contributors[lever &lt;arm&gt;]"),
        ("lever arm 1 mm", "contributors"),
        ('name = "x"', "name"),
        ("[imu]\n", "imu"),
    ],
)
def test_what_is_wrong_is_said_and_leaves_the_design(part: Contributors, text: str, named: str) -> None:
    part._box.value = text
    assert part.session.design == _DESIGN
    assert f"<p role='alert'>{named}: " in part._said.object
    assert part._box.value == text
    part._box.value = _TEXT
    assert part._said.object == ""


def test_the_tables_have_every_entry_and_escape_its_name() -> None:
    budget = analyse(_DESIGN.replace({}, contributors=parse_contributors(_TEXT)))
    text = contributors_html(budget)
    assert "<arm>" not in text
    body = text[text.index("Allocation of Detrended phase") :]
    for entry in allocate(budget).entries:
        assert entry.source.replace("<arm>", "&lt;arm&gt;") in body
    assert "20 %" in body
    assert "nothing to allocate" in contributors_html(analyse(Design()))
    assert "Allocation of ISLR" in contributors_html(analyse(Design({"requirements.islr": 0.1})))


def test_a_comparison_lists_contributors_that_differ() -> None:
    own = parse_contributors(_TEXT)
    same = parse_contributors(_TEXT.replace("lever <arm>", "clock"))
    one, other = _DESIGN.replace({}, contributors=own + same), _DESIGN.replace({}, contributors=same)
    said = to_html(report_of([analyse(one), analyse(other)]))
    row = re.search(r"<tr>(?:(?!</tr>).)*Contributor lever &lt;arm&gt;.*?</tr>", said, re.DOTALL)
    assert row is not None
    assert "1 mm in detrended_phase, random, both" in row[0]
    assert "not given" in row[0]
    assert "Contributor clock" not in said
    assert "The designs have the same inputs." not in said

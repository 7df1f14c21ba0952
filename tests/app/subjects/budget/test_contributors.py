"""Contributors on the Allocate page: the tables that are filled in, the report, and the comparison of designs."""

import math
import re
from typing import Any

import pytest

from app.document.html import to_html
from app.report.content import report_of
from app.session import Session
from app.subjects.budget.allocate import AllocatePage
from nav_model import Design, analyse
from nav_model.budget.allocation import allocate
from nav_model.design.contributors import read_contributors
from nav_model.design.user_entries import UserEntries, read_allocation, read_limits
from nav_model.explore.supplier import frozen

_ROW = {"name": "lever <arm>", "value": "1 mm", "enters": "detrended_phase", "owner": "mechanics"}
_LIMIT = {"name": "heading", "on": "coast_heading", "limit": "1°", "at": "30 s"}
_DESIGN = Design({"requirements.detrended_phase": 0.4, "requirements.tilt": 0.01})


@pytest.fixture
def part() -> AllocatePage:
    session = Session(_DESIGN)
    part = AllocatePage(session)
    session.param.watch(lambda event: part.show(event.new), "budget")
    return part


def test_what_is_entered_becomes_part_of_the_design_and_can_be_undone(part: AllocatePage) -> None:
    session, before = part.session, part.session.budget
    part._contributors.put([_ROW | {"source": " "}])
    (contributor,) = session.design.contributors
    assert (contributor.name, contributor.value, contributor.owner) == ("lever <arm>", 1e-3, "mechanics")
    assert session.budget["detrended_phase", "real time"].sigma > before["detrended_phase", "real time"].sigma
    assert read_contributors(part._contributors.rows) == session.design.contributors
    part._limits.put([_LIMIT])
    assert [check.name for check in session.budget.verdict.checks] == ["detrended_phase", "tilt", "heading"]
    session.change({"gnss.interval": 0.5})
    assert session.design.contributors == (contributor,)
    for _ in range(3):
        session.undo()
    assert session.design == before.design
    assert part._contributors.rows == part._limits.rows == []
    session.redo()
    part._contributors.put([])
    assert session.design == before.design


@pytest.mark.parametrize(
    ("rows", "named"),
    [
        ([_ROW | {"value": "1 m/s"}], "lever <arm>, Value, 1σ"),
        ([_ROW, _ROW], "lever <arm>"),
        ([_ROW | {"allowance": "much"}], "lever <arm>, Allowance"),
    ],
)
def test_what_is_wrong_is_said_and_leaves_the_design(part: AllocatePage, rows: Any, named: str) -> None:
    part._contributors.put(rows)
    assert part.session.design == _DESIGN
    assert part._contributors.refused.startswith(f"{named}: ")
    part._contributors.put([_ROW])
    assert part._contributors.refused == ""
    part._limits.put([_LIMIT | {"on": "lever <arm>", "limit": "2 mm", "at": ""}])
    part._contributors.put([])
    assert part._contributors.refused.startswith("heading: ")
    assert part.session.design.contributors


def test_the_allocation_follows_split_reserve_and_locks(part: AllocatePage) -> None:
    part._requirement.value = "tilt"
    part._reserve.value = "30 %"
    part._split.value = "equal"
    sources = [row["source"] for row in part._entries.rows]
    part._entries.put([{"lock": "0.1°"} if source == "gyro noise" else {} for source in sources])
    plan = part.session.design.allocation
    assert (plan.split, plan.reserve) == ("equal", 0.3)
    assert [(lock.requirement, lock.name, lock.value) for lock in plan.locks] == [
        ("tilt", "gyro noise", pytest.approx(math.radians(0.1)))
    ]
    allocation = allocate(part.session.budget, "tilt")
    assert math.sqrt(sum(entry.allocated**2 for entry in allocation.entries)) == pytest.approx(0.7 * 0.01)
    assert "Split: equal values" in part._outcome.object
    before = part.session.design
    part._entries.put([{"lock": "2 m"} for _ in sources])
    assert part._entries.refused.startswith("gyro noise: ")
    part._reserve.value = "all"
    assert "role='alert'" in part._outcome.object
    assert part.session.design == before
    part._reserve.value = "30 %"
    part._entries.put([{"lock": "20°"} for _ in sources])
    assert "Does not fit" in part._outcome.object
    part.session.change({"requirements.tilt": None})
    assert "Detrended phase" in part._outcome.object
    part._entries.put([{"lock": "2 kg"} for _ in part._entries.rows])
    assert "does not fit Detrended phase" in part._entries.refused
    part.session.change({"gnss.position_noise": 3.0})  # the boxes have other rows now
    assert not part._entries.refused


def test_frozen_values_stay_with_a_changed_plan_and_are_released_by_a_button(part: AllocatePage) -> None:
    session = part.session
    assert not part._release.visible
    session.change({}, entries=frozen(session.design, "2026-11-26"))
    values = session.design.allocation.required
    assert part._release.visible
    assert f"{len(values)} values that were frozen with the design {_DESIGN.content_hash[:12]}, 2026-11-26" in (
        part._frozen.object
    )
    part._reserve.value = "30 %"
    assert (session.design.allocation.reserve, session.design.allocation.required) == (0.3, values)
    part._release.clicks += 1
    assert session.design.allocation.required == ()
    assert session.design.allocation.reserve == 0.3
    assert not part._release.visible
    assert not part._frozen.object
    session.undo()
    assert session.design.allocation.required == values
    assert part._release.visible


def test_the_report_has_an_allocation_of_each_requirement() -> None:
    entries = UserEntries(read_contributors([_ROW]), read_limits([_LIMIT]), read_allocation({"reserve": "10 %"}))
    budget = analyse(_DESIGN.replace({}, entries=entries))
    html = to_html(report_of([budget]))
    assert "<arm>" not in html
    for label in ("Detrended phase", "Tilt", "Heading"):
        assert f"Allocation of {label}" in html
    assert "reserve 10\xa0%" in html
    assert "Allocation of" not in to_html(report_of([analyse(_DESIGN)]))


def test_a_comparison_lists_contributors_that_differ() -> None:
    arm, same = read_contributors([_ROW]), read_contributors([_ROW | {"name": "clock"}])
    both, other = _DESIGN.replace({}, entries=UserEntries(arm + same)), _DESIGN.replace({}, entries=UserEntries(same))
    html = to_html(report_of([analyse(both), analyse(other)]))
    row = re.search(r"<tr>(?:(?!</tr>).)*Contributor lever &lt;arm&gt;.*?</tr>", html, re.DOTALL)
    assert "1\xa0mm in Detrended phase, random, both" in row[0]
    assert "not given" in row[0]
    assert "Contributor clock" not in html
    assert "The designs have the same inputs." not in html


def test_a_ready_made_contributor_asks_for_what_the_design_does_not_have(part: AllocatePage) -> None:
    part._made.value = "time tag, jitter"
    assert [(box.label, box.visible) for box in part._boxes] == [("Jitter, 1σ", True), ("Acceleration, rms", True)]
    part._boxes[0].value = "1 ms"
    part._make()
    assert "role='alert'>Acceleration, rms: " in part._added_note.object
    assert part.session.design == _DESIGN
    part._made.value = "time tag, offset"
    assert [box.visible for box in part._boxes] == [True, False]
    part._boxes[0].value = "1 ms"
    part._make()
    (contributor,) = part.session.design.contributors
    assert (contributor.name, contributor.value, contributor.kind, contributor.enters) == (
        "time tag, offset", pytest.approx(1e-3 * _DESIGN.flight.speed), "systematic", "horizontal_position",
    )  # fmt: skip
    assert part._boxes[0].value == ""

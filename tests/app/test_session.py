"""The session: what a change does, what a refusal leaves alone, and the way back."""

import time

import pytest
from bokeh.document import Document

from app.charts.screen.timelines import Timelines
from app.examples import EXAMPLES, example
from app.session import Session, link_parts
from app.subjects.budget.timelines import all_timelines
from nav_model.design import Design
from nav_model.design.link import from_query


@pytest.fixture
def session() -> Session:
    return Session(Design())


def test_a_change_moves_design_and_budget_together(session: Session) -> None:
    before = session.budget.steady_state.closed["horizontal_position"]
    assert session.change({"gnss.position_noise": 0.02}) is None
    assert session.design.gnss.position_noise == 0.02
    assert session.budget.design is session.design
    assert session.budget.steady_state.closed["horizontal_position"] < before


def test_an_origin_is_shown_at_once_and_comes_back_with_undo(session: Session) -> None:
    key = "gnss.position_noise"
    session.change({key: session.design.gnss.position_noise}, origins={key: "data sheet"})
    assert (dict(session.design.origins), session.can_undo) == ({key: "data sheet"}, False)
    session.change({key: 0.5})
    assert dict(session.design.origins) == {}
    session.undo()
    assert dict(session.budget.design.origins) == {key: "data sheet"}


def test_a_change_that_comes_when_the_page_has_gone_reaches_no_chart(session: Session) -> None:
    document, stack = Document(), Timelines(all_timelines(session.budget))
    for plot in stack.plots:
        document.add_root(plot)
    session.param.watch(lambda event: stack.feed(all_timelines(event.new)), "budget")
    assert session.change({"gnss.position_noise": 0.02}) is None
    document.models.destroy()
    session.close()
    assert session.change({"gnss.position_noise": 0.03}) is None


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"imu.angle_random_walk": -1.0}, "imu.angle_random_walk"),
        ({"imu.angle_random_walk": float("nan")}, "imu.angle_random_walk"),
        ({"imu.nothing": 1.0}, "imu.nothing"),
        ({"radar.window": "square"}, "radar.window"),
        ({"radar.azimuth_resolution": 1e-3, "radar.slant_range": 2e6}, "radar.azimuth_resolution"),
    ],
)
def test_a_refused_change_leaves_everything_as_it_was(session: Session, changes: dict[str, float], key: str) -> None:
    budget = session.budget
    error = session.change(changes)
    assert error.key == key
    assert session.budget is budget
    assert not session.can_undo


def test_undo_and_redo_walk_the_same_path(session: Session) -> None:
    path = [session.design]
    for name, value in (("gnss.interval", 0.5), ("flight.speed", 90.0), ("gnss.interval", 2.0)):
        session.change({name: value})
        path.append(session.design)
    for design in path[-2::-1]:
        session.undo()
        assert session.design == design
    assert not session.can_undo
    for design in path[1:]:
        session.redo()
        assert session.design == design
    assert not session.can_redo
    session.undo()
    session.change({"flight.speed": 80.0})  # forgets the future
    assert not session.can_redo


def test_steps_of_one_slider_are_one_step_back(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    start = session.design
    for value in (0.9, 0.8, 0.7):
        now[0] += 0.1
        session.change({"gnss.position_noise": value})
    now[0] += 5
    session.change({"gnss.position_noise": 0.5})
    session.undo()
    assert session.design.gnss.position_noise == 0.7
    session.undo()
    assert session.design == start


def test_choosing_a_unit_is_not_a_change_to_undo(session: Session) -> None:
    key = "imu.angle_random_walk"
    session.change({key: session.design[key]}, {key: "°/h/√Hz"})
    assert session.design.unit(key) == "°/h/√Hz"
    assert not session.can_undo


def test_reset_returns_to_the_start_and_can_be_undone(session: Session) -> None:
    start = session.design
    session.change({"flight.speed": 55.0})
    session.reset()
    assert session.design == start
    session.undo()
    assert session.design.flight.speed == 55.0


def test_a_lineage_holds_for_a_designs_changes_and_comes_back_with_undo(session: Session) -> None:
    ours = session.lineage
    session.change({"gnss.position_noise": 0.02})
    assert session.lineage is ours
    other = Design().replace({"flight.speed": 200.0, "name": "another"})
    assert session.adopt(other) is None
    theirs = session.lineage
    assert theirs is not ours
    session.change({"gnss.position_noise": 0.5})
    assert session.lineage is theirs
    session.undo()
    session.undo()
    assert session.lineage is ours
    session.redo()
    assert session.lineage is theirs
    assert session.change({"imu.nothing": 1.0}) is not None
    assert session.lineage is theirs


def test_a_link_to_share_keeps_a_description_unless_that_makes_it_long() -> None:
    assert "description" not in Session(example(EXAMPLES[0])).short_link  # everybody has it
    session = Session(Design({"name": "Pod", "description": "Flown over the coast."}))
    assert from_query(link_parts(session.short_link)[0]).description == "Flown over the coast."
    session.change({"description": "x" * 3000})
    assert len(session.short_link) < 2000
    assert "description" not in session.short_link
    assert "description" in session.link

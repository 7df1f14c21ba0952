"""The frame of every page: its parts, and the cost of its busy line for other users."""

import math

import pytest
from bokeh.model import DataModel, Model
from pages import at_once, start_to_the_end

import app.subjects.explore.closing as closing_panel
from app.dashboard.frame import Frame
from app.serving.server import first_design
from app.session import Session
from app.work.run import Run

pytestmark = pytest.mark.long


@pytest.fixture(autouse=True)
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the page Close it works out is worked out in this process, up to the end."""
    monkeypatch.setattr(closing_panel, "run_in_pool", at_once)
    monkeypatch.setattr(Run, "start", start_to_the_end)


def _models(root: Model) -> list[DataModel]:
    return list(root.select({"type": DataModel}))


def test_every_component_is_marked_as_the_pages():
    """By this Panel finds what to clear away with a page, whenever it was made."""
    frame = Frame(Session(first_design()))
    root = frame.__panel__().get_root()
    before = _models(root)
    frame._go_to("explore")
    after = _models(root)
    assert len(after) > len(before) > 10
    assert [model for model in after if f"__ref:{root.ref['id']}" not in model.tags] == []


def test_pages_that_stay_at_one_sigma_say_so():
    session = Session(first_design())
    frame = Frame(session)
    session.display = "95.si"
    assert not frame._note.visible  # the Budget page follows
    frame._go_to("explore")
    assert frame._note.visible
    assert "This page shows 1σ" in frame._note.object
    assert "95 %, SI units" in frame._note.object
    session.display = ""
    assert not frame._note.visible


def test_what_comes_back_from_a_page_loaded_again_is_taken_whole_or_not_at_all():
    session = Session(first_design())
    frame = Frame(session)
    before = session.budget
    good = "arw=0.1deg/sqrt(h)"
    for message in (None, good, {"link": 3, "base": ""}, {"link": good}, {"link": good, "base": []}):
        frame._lifeline._handle_msg(message)
        assert session.budget is before
        assert frame._notice.object == ""
    for link, words in (
        ("arw=5kg", "imu.angle_random_walk"),
        ("nonsense", "link"),
        ("name=" + "x" * 20_000, "longer than"),
        ("arw=0.1deg/sqrt(h)&imu=no-such", "no-such"),
    ):
        frame._lifeline._handle_msg({"link": link, "base": ""})
        assert session.budget is before
        assert words in frame._notice.object
    frame._lifeline._handle_msg({"link": f"{good}&study.gyros.bias=7,8,9deg/h", "base": ""})
    assert session.design["imu.angle_random_walk"] == pytest.approx(math.radians(0.1) / 60, rel=1e-12)
    assert session.study_link == "study.gyros.bias=7,8,9deg/h"
    assert frame._lifeline.link == session.link
    session.undo()
    assert session.design == before.design

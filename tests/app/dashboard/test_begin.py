"""A worker begins while the page that will ask for its result is made."""

import asyncio
from types import SimpleNamespace
from typing import Any

import panel as pn
import pytest

from app.dashboard.frame import Frame
from app.serving.server import first_design


@pytest.mark.parametrize(("link", "ahead", "begins"), [("", True, 1), ("study.seed=2", True, 0), ("", False, 0)])
def test_the_designs_study_begins_as_its_tab_is_turned_to(
    monkeypatch: pytest.MonkeyPatch, link: str, ahead: bool, begins: int
) -> None:
    begun: list[Any] = []

    async def begin(design: Any) -> None:
        begun.append(design)

    monkeypatch.setattr(type(pn.state), "location", property(lambda _: object()))
    monkeypatch.setattr(pn.state, "execute", lambda work: asyncio.run(work()))
    session = SimpleNamespace(design=first_design(), study_link=link)
    subject: Any = SimpleNamespace(ahead="studies:fly_ahead" if ahead else "", load=lambda _: begin)
    Frame._begin(SimpleNamespace(session=session), subject)
    assert begun == [session.design] * begins

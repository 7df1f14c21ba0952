"""The library of the Review page: designs ticked are picked, however fast and in whatever order it answers."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from param import parameterized
from waiting import soon

from app.library.place import library, use_library
from app.serving.server import first_design
from app.session import Session
from app.subjects.review.desk import Desk
from app.subjects.review.library_view import LibraryView
from app.subjects.review.room import ReviewRoom
from nav_model.budget import analyse

pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style'")
_NAMES = "ABCDEFG"


class _Scene:
    """A library page over seven saved designs, which answers when told to."""

    def __init__(self) -> None:
        self.desk = Desk(Session(first_design()))
        self.view = LibraryView(self.desk, lambda: None)
        self.waiting: list[asyncio.Event] = []
        shipped: Any = self.desk.ask

        async def ask(work: Callable[..., Any], before: str = "") -> Any:
            self.waiting.append(asyncio.Event())
            await self.waiting[-1].wait()
            return await shipped(work, before)

        self._ask = ask

    async def list(self) -> None:
        await self.view.refresh()
        self.desk.ask = self._ask  # type: ignore[method-assign,assignment]

    def tick(self, name: str, value: bool = True) -> None:
        next(tick for _, tick in self.view._ticks if tick.label == name).value = value

    async def answer(self, *order: int) -> None:
        await self.still()
        for index in order:
            self.waiting[index].set()
        await self.still()

    async def still(self) -> None:
        """Wait until nothing goes on but waiting for the library."""
        await soon(
            lambda: len(asyncio.all_tasks()) - 1 == sum(not asked.is_set() for asked in self.waiting),
            "what a tick sets off",
        )

    @property
    def ticked(self) -> str:
        return "".join(sorted(tick.label for _, tick in self.view._ticks if tick.value))

    @property
    def picked(self) -> str:
        return "".join(sorted(own.name for own in self.desk.picked))


@pytest.fixture
def play(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[_Scene], Awaitable[None]]], _Scene]:
    use_library(str(tmp_path / "library.db"))
    for name in _NAMES:
        library().save(analyse(first_design().replace({"name": name})), "Ann")

    async def later(work: Callable[[], Awaitable[None]]) -> None:
        await asyncio.sleep(0.05)
        await work()

    def run(story: Callable[[_Scene], Awaitable[None]]) -> _Scene:
        async def told() -> _Scene:
            # As on a server, where what a change calls waits for the document to be free.
            monkeypatch.setattr(parameterized, "async_executor", lambda work: asyncio.ensure_future(later(work)))
            scene = _Scene()
            await scene.list()
            await story(scene)
            await scene.answer(*range(len(scene.waiting)))  # whatever else was asked
            return scene

        return asyncio.run(told())

    return run


def test_an_empty_library_is_said_to_have_no_review(tmp_path: Path) -> None:
    use_library(str(tmp_path / "library.db"))
    room = ReviewRoom(Desk(Session(first_design())))
    asyncio.run(room.refresh())
    assert room.answer.word == "No review yet"


@pytest.mark.parametrize(
    ("order", "at_once"), [((0, 1, 2), True), ((2, 1, 0), True), ((1, 2, 0), True), ((2, 0, 1), False)]
)
def test_all_that_is_ticked_is_picked(play: Any, order: tuple[int, ...], at_once: bool) -> None:
    async def story(scene: _Scene) -> None:
        for name in "ABC":
            scene.tick(name)
        if at_once:
            await scene.answer(*order)
        else:
            for index in order:
                await scene.answer(index)

    scene = play(story)
    assert scene.picked == scene.ticked == "ABC"


def test_a_tick_taken_back_before_the_library_answers_is_not_picked(play: Any) -> None:
    async def story(scene: _Scene) -> None:
        scene.tick("A")
        scene.tick("B")
        await scene.still()
        scene.tick("A", value=False)
        await scene.answer(0, 1)

    scene = play(story)
    assert scene.picked == scene.ticked == "B"


def test_one_more_than_go_side_by_side_is_refused_and_its_tick_goes(play: Any) -> None:
    async def story(scene: _Scene) -> None:
        for name in _NAMES:
            scene.tick(name)
        await scene.answer(*range(7))

    scene = play(story)
    assert len(scene.picked) == 6
    assert scene.ticked == scene.picked
    assert "At most 6 revisions" in scene.desk.notice.object

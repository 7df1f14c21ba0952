"""The library of the Review page: designs ticked are picked."""

import asyncio
import re
from pathlib import Path

import pytest

from app.library.place import library, use_library
from app.serving.server import first_design
from app.session import Session
from app.subjects.review.desk import Desk, button
from app.subjects.review.library_view import LibraryView
from app.subjects.review.room import ReviewRoom
from nav_model.budget import analyse

_NAMES = "ABCDEFG"


class _Scene:
    """A library page over seven saved designs."""

    def __init__(self) -> None:
        self.desk = Desk(Session(first_design()))
        self.view = LibraryView(self.desk, lambda: None)
        asyncio.run(self.view.refresh())

    def tick(self, names: str, value: bool = True) -> None:
        table = self.view._table
        for name in names:
            others = [key for key in table.ticked if self.names[key] != name]
            table.ticked = [*others, *(key for key, label in self.names.items() if label == name and value)]

    @property
    def names(self) -> dict[str, str]:
        """Rows of the list, by the text of their tick."""
        return dict(re.findall(r'<input type="checkbox" value="(.*?)"> <span>(.*?)</span>', self.view._table.html))

    @property
    def ticked(self) -> str:
        return "".join(sorted(self.names[key] for key in self.view._table.ticked))

    @property
    def picked(self) -> str:
        return "".join(sorted(design.name for design in self.desk.picked))


@pytest.fixture
def scene(tmp_path: Path) -> _Scene:
    use_library(str(tmp_path / "library.db"))
    for name in _NAMES:
        library().save(analyse(first_design().replace({"name": name})), "Ann")
    return _Scene()


def test_an_empty_library_is_said_to_have_no_review(tmp_path: Path) -> None:
    use_library(str(tmp_path / "library.db"))
    room = ReviewRoom(Desk(Session(first_design())))
    asyncio.run(room.refresh())
    assert room.answer.word == "No review yet"


def test_a_library_that_cannot_be_opened_is_said_so_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "library.db").write_text("no database")
    use_library(str(tmp_path / "library.db"))
    scene = _Scene()
    assert scene.view.answer.word == "The library cannot be opened"
    assert "file is not a database" in scene.desk.notice.object


def test_all_that_is_ticked_is_picked_and_stays_ticked_in_a_new_list(scene: _Scene) -> None:
    scene.tick("ABC")
    scene.tick("A", value=False)
    assert scene.picked == scene.ticked == "BC"
    library().save(analyse(first_design().replace({"name": "H"})), "Ann")
    asyncio.run(scene.view.refresh())
    assert scene.picked == scene.ticked == "BC"


def test_one_more_than_go_side_by_side_is_refused_and_its_tick_goes(scene: _Scene) -> None:
    scene.tick(_NAMES)
    assert len(scene.picked) == 6
    assert scene.ticked == scene.picked
    assert "At most 6 revisions" in scene.desk.notice.object


async def test_a_press_that_comes_after_its_button_was_disabled_does_nothing() -> None:
    done: list[str] = []

    async def act() -> None:
        done.append("done")

    pressed = button("Act", act)
    pressed.clicks += 1
    await asyncio.sleep(0)
    pressed.disabled = True
    pressed.clicks += 1
    await asyncio.sleep(0)
    assert done == ["done"]

"""What the Reviews tab says before anybody chose a review."""

import asyncio
from pathlib import Path

import pytest

from app.examples import example
from app.library.place import use_library
from app.session import Session
from app.subjects.review.desk import Desk
from app.subjects.review.room import ReviewRoom

pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style'")


def test_an_empty_library_is_said_to_have_no_review(tmp_path: Path) -> None:
    use_library(str(tmp_path / "library.db"))
    room = ReviewRoom(Desk(Session(example("mems_x_band"))))
    asyncio.run(room.refresh())
    assert room.answer.word == "No review yet"

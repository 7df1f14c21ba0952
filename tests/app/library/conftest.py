"""A library in a temporary folder, and designs to put into it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.library.store import Library
from nav_model.budget import Budget, analyse
from nav_model.design_file import read_design

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def library(tmp_path: Path) -> Iterator[Library]:
    opened = Library(tmp_path / "library.db")
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def mems() -> Budget:
    return analyse(read_design(EXAMPLES / "mems_x_band.toml"))


@pytest.fixture(scope="session")
def tactical() -> Budget:
    return analyse(read_design(EXAMPLES / "tactical_x_band.toml"))

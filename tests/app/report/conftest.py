"""Designs to report on, and what a report's tables hold."""

import io
from collections.abc import Callable
from typing import Any

import pypdf
import pytest

from app.document.blocks import Cell, Report, TableBlock
from app.examples import EXAMPLES
from nav_model.budget import Budget


@pytest.fixture(scope="module")
def three(budget_of) -> list[Budget]:
    return [budget_of(name) for name in sorted(EXAMPLES)]


@pytest.fixture(scope="session")
def cells() -> Callable[[Report], list[Cell]]:
    """Every cell of every table."""
    return lambda report: [
        cell for block in report.blocks() if isinstance(block, TableBlock) for row in block.rows for cell in row
    ]


@pytest.fixture(scope="session")
def placed() -> Callable[[bytes], list[tuple[str, float]]]:
    """The text of each page of a PDF, and where the rightmost piece of it begins, in points; without the charts,
    whose curves take long to read."""

    def read(page: pypdf.PageObject) -> tuple[str, float]:
        edges = [0.0]
        page["/Resources"].pop("/XObject", None)

        def see(text: str, cm: list[float], tm: list[float], *_: Any) -> None:
            if text.strip():
                edges.append(tm[4] * cm[0] + cm[4])

        return page.extract_text(visitor_text=see), max(edges)

    return lambda data: [read(page) for page in pypdf.PdfReader(io.BytesIO(data)).pages]

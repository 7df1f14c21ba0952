"""A closed page is freed, checked in the memory of a real server."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from soak import counted_server, visit

pytestmark = pytest.mark.long


def test_closed_pages_are_gone(tmp_path: Path) -> None:
    async def some() -> None:
        for _ in range(4):
            await visit(address)

    with counted_server(tmp_path) as (address, left):
        asyncio.run(some())
        assert left().frames == 0

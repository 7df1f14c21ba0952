"""A page is freed however it ends, checked in the memory of a real server, which is only looked at."""

import asyncio
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from soak import STAGES, USED, counted_server, lose, visit

pytestmark = [pytest.mark.long, pytest.mark.watches("app")]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with counted_server(tmp_path_factory.mktemp("served")) as result:
        yield result


def test_closed_pages_are_gone(server: Any) -> None:
    async def some() -> None:
        for _ in range(2):
            await visit(address)

    address, remaining = server
    asyncio.run(some())
    assert remaining().frames == 0


@pytest.mark.parametrize(
    "stages",
    [(*range(1, 9), *range(USED, STAGES + 1)), pytest.param(range(9, USED), marks=pytest.mark.slow)],
    ids=["but those below", "while each tab is made"],
)
def test_pages_that_lose_their_connection_are_gone(server: Any, stages: Sequence[int]) -> None:
    async def at_every_stage() -> None:
        for stage in stages:
            await lose(address, stage)

    address, remaining = server
    asyncio.run(at_every_stage())
    assert remaining().frames == 0

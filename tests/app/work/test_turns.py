"""Visitors take turns at the places for heavy work."""

import asyncio

import pytest

from app.work import cancellable, pool
from app.work.turns import Turns


class _Tasks:
    """Tasks that hold a place until they are told to leave; `order` has who got one."""

    def __init__(self, turns: Turns) -> None:
        self.turns = turns
        self.order: list[str] = []
        self.ends: dict[str, asyncio.Event] = {}
        self.tasks: dict[str, asyncio.Task[None]] = {}

    async def add(self, name: str) -> None:
        """A task of the visitor that the name begins with."""
        self.ends[name] = asyncio.Event()
        self.tasks[name] = asyncio.create_task(self._hold(name))
        await asyncio.sleep(0)

    async def _hold(self, name: str) -> None:
        async with self.turns.place(name[0]):
            self.order.append(name)
            await self.ends[name].wait()

    async def end(self, *names: str) -> None:
        """Let these leave, one after another."""
        for name in names:
            assert name in self.order
            self.ends[name].set()
            await self.tasks[name]
            await asyncio.sleep(0)


async def test_visitors_take_turns_however_many_tasks_one_of_them_has() -> None:
    tasks = _Tasks(Turns(1, 1))
    for name in ("a1", "a2", "a3", "b1", "c1", "b2"):
        await tasks.add(name)
    await tasks.end("a1", "a2", "b1", "c1", "a3", "b2")
    assert tasks.order == ["a1", "a2", "b1", "c1", "a3", "b2"]
    assert not tasks.turns.must_wait("a")


async def test_a_visitor_holds_no_more_than_a_share_of_the_places() -> None:
    tasks = _Tasks(Turns(3, 2))
    for name in ("a1", "a2", "a3", "b1", "b2"):
        await tasks.add(name)
    assert tasks.order == ["a1", "a2", "b1"]
    assert tasks.turns.must_wait("c")
    await tasks.end("b1")
    assert tasks.order == ["a1", "a2", "b1", "b2"]
    await tasks.end("a2", "b2", "a3", "a1")
    assert tasks.order == ["a1", "a2", "b1", "b2", "a3"]
    assert not any(map(tasks.turns.must_wait, "abc"))


async def test_whoever_gives_up_waiting_takes_no_place() -> None:
    tasks = _Tasks(Turns(1, 1))
    for name in ("a1", "b1", "c1", "c2"):
        await tasks.add(name)
    tasks.tasks["b1"].cancel()
    tasks.ends["a1"].set()
    for _ in range(2):
        await asyncio.sleep(0)
    tasks.tasks["c1"].cancel()  # when it has, or is just being given, the place
    for _ in range(3):
        await asyncio.sleep(0)
    assert tasks.tasks["b1"].cancelled()
    assert tasks.tasks["c1"].cancelled()
    assert tasks.order[-1] == "c2"
    await tasks.end("c2")
    assert not tasks.turns.must_wait("d")


@pytest.mark.parametrize("moment", range(5))
async def test_no_place_is_lost_at_whatever_moment_a_waiting_task_is_cancelled(moment: int) -> None:
    tasks = _Tasks(Turns(1, 1))
    for name in ("a1", "b1"):
        await tasks.add(name)
    tasks.ends["a1"].set()
    for _ in range(moment):
        await asyncio.sleep(0)
    tasks.tasks["b1"].cancel()
    await asyncio.wait(tasks.tasks.values())
    assert not tasks.turns.must_wait("a")


async def test_a_long_run_of_one_visitor_leaves_a_place_for_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "_size", 1)
    cancellable._turns.cache_clear()
    try:
        async with cancellable._turns().place("a"):
            assert cancellable._turns().must_wait("a")
            assert not cancellable._turns().must_wait("b")
    finally:
        cancellable._turns.cache_clear()


def _nothing(*, progress: object = None) -> None:
    """What takes no time."""


async def test_pool_lets_another_visitor_in_before_the_rest_of_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    asking = ["a"]
    monkeypatch.setattr(pool, "_asking", lambda: asking[0])
    monkeypatch.setattr(pool, "_size", 1)
    pool._turns.cache_clear()
    order: list[str] = []

    async def visit(name: str) -> None:
        await pool.run_in_pool(_nothing)
        order.append(name)

    try:
        tasks = []
        for name in ("a1", "a2", "a3", "b1"):
            asking[0] = name[0]
            tasks.append(asyncio.create_task(visit(name)))
            await asyncio.sleep(0)
        await asyncio.gather(*tasks)
        assert order == ["a1", "a2", "b1", "a3"]
    finally:
        pool._turns.cache_clear()
        pool.stop()
        pool.pool.cache_clear()

"""One pool of worker processes per server, so that heavy work never holds up another person's sliders."""

import asyncio
import functools
import math
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar, TypeVarTuple

from app.work.turns import Turns
from nav_model.base.errors import InputError
from nav_model.base.processes import kill_workers, worker_pool

_A = TypeVarTuple("_A")
_T = TypeVar("_T")

_LONGEST_READING = 20.0  # s of a processor; the largest files take some 5
_NICENESS = 10  # of heavy work: a tenth of the share of a slider step, where both want the same core

_size = 0  # 0: nothing was asked for
_begin: Callable[[], None] | None = None
_asking: Callable[[], str] = str
_under_way = 0


def use(
    count: int | None,
    servers: int = 1,
    begin: Callable[[], None] | None = None,
    asking: Callable[[], str] = str,
) -> None:
    """Set how many processes the pools of all ``servers`` have together, before they start; None: one less than the
    cores. Each has one at least, and calls ``begin``, an importable function, first. ``asking`` names the visitor
    whose page asks for work."""
    global _size, _begin, _asking
    _begin, _asking = begin, asking
    _size = math.ceil((count or _spare_cores()) / servers)


def size() -> int:
    """Processes of this pool."""
    return _size or _spare_cores()


def _spare_cores() -> int:
    """One core is left to the pages."""
    return max(1, (os.cpu_count() or 2) - 1)


@functools.cache
def pool() -> ProcessPoolExecutor:
    """The pool; its processes start with the first task."""
    return worker_pool(size(), functools.partial(lower_priority, _begin))


@functools.cache
def _turns() -> Turns:
    """As many tasks at a time as the pool has processes: a queue of its own knows no visitor."""
    return Turns(size(), size())


def visitor() -> str:
    """Who asks for work: visitors take turns. Empty outside a page."""
    return _asking()


def first() -> Callable[[], None] | None:
    """The call that a worker makes first, to be sent to it."""
    return _begin


def lower_priority(begin: Callable[[], None] | None) -> None:
    """Call what is to be called first, and lower this process's priority below the pages', of memory too; every
    worker does it once."""
    if begin is not None:
        begin()
    if hasattr(os, "nice"):  # not on Windows
        os.nice(_NICENESS)
    if (score := Path("/proc/self/oom_score_adj")).exists():  # where memory ends, work ends before pages do
        with suppress(OSError):
            score.write_text("500")


@contextmanager
def counted() -> Iterator[None]:
    """Heavy work that `under_way` counts."""
    global _under_way
    _under_way += 1
    try:
        yield
    finally:
        _under_way -= 1


async def run_in_pool(function: Callable[[*_A], _T], *arguments: *_A) -> _T:
    """Run an importable function in a worker process, when it is the turn of the visitor who asks.

    Raises
    ------
    BrokenProcessPool
        If the worker died; the next call gets a new pool.
    """
    with counted():
        async with _turns().place(visitor()):
            return await _run(function, *arguments)


async def read_in_pool(function: Callable[[*_A], _T], *arguments: *_A) -> _T:
    """Run a reader of a visitor's file as `run_in_pool` does, for `_LONGEST_READING` at most.

    Raises
    ------
    InputError
        Beside what the reader raises, for a file that takes longer.
    """
    return await run_in_pool(_within_bounds, function, *arguments)


def _within_bounds(function: Callable[[*_A], _T], *arguments: *_A) -> _T:
    """Call a function, and end it where it takes too much processor time."""
    if not hasattr(signal, "setitimer"):  # Windows
        return function(*arguments)

    def end(*_: object) -> None:
        raise InputError("file", f"takes more than {_LONGEST_READING:g} s to be read. Give less of it.")

    signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, _LONGEST_READING)
    try:
        return function(*arguments)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


async def _run(function: Callable[[*_A], _T], *arguments: *_A) -> _T:
    try:
        return await asyncio.get_running_loop().run_in_executor(pool(), function, *arguments)
    except BrokenProcessPool:
        pool.cache_clear()
        raise


def under_way() -> int:
    """Tasks waiting or running, in the pool or in separate processes."""
    return _under_way


def stop() -> None:
    """End every worker process now, whatever it is doing."""
    kill_workers()
    if pool.cache_info().currsize:
        pool().shutdown(wait=False, cancel_futures=True)
    for process in multiprocessing.active_children():
        process.join(timeout=5)

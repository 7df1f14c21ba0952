"""A long run in a separate process, with progress, which ends at once when cancelled.

The pool of `app.work.pool` serves short work; its processes cannot be stopped within a task. A process that has done
its run and stayed small waits for the next, with all that it has loaded; there is one such at most.
"""

import asyncio
import logging
import math
import multiprocessing
import os
import sys
import traceback
from collections.abc import Callable, Coroutine
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from app.work import pool as workers
from app.work.turns import Turns
from nav_model.base.errors import InputError
from nav_model.base.processes import end_with_parent

_LOGGER = logging.getLogger("navbudget")
_SMALL = 400_000_000  # bytes: what a suborbital study leaves is half of it, most of that libraries and kernels
WAITING = "waiting for another run to finish"
STARTING = "starting"


class RunLost(Exception):
    """The process ended without an answer: out of memory, or a fault of ours."""


async def run_alone(function: Callable[..., Any], *arguments: Any, progress: Callable[[float, str], None]) -> Any:
    """Run an importable function in a process beside the pages; cancelling the task ends that process at once.

    It begins when it is the turn of the visitor who asks. function is called with ``progress=`` a function of the
    share done and of what is being done, which reaches `progress` here.

    Raises
    ------
    ValueError
        As the function raises it or an ArithmeticError, an InputError with its key: the message is for the person.
    RunLost
        When the process died.
    """
    visitor = workers.visitor()
    waits = _turns().must_wait(visitor)
    if waits:
        progress(0.0, WAITING)
        for task in _unasked:
            task.cancel()
    with workers.counted():
        async with _turns().place(visitor):
            if waits:
                progress(0.0, STARTING)
            process, held = _take(), None
            try:
                await asyncio.to_thread(process.ends.send, (function, arguments))
                while True:
                    kind, *content = await asyncio.to_thread(process.ends.recv)
                    if kind == "progress":
                        progress(*content)
                        continue
                    outcome, held = content
                    if kind == "refused":
                        raise outcome
                    if kind == "fault":
                        held = None  # what it left behind is not known
                        exception, raised = outcome
                        fields = {"exception": exception, "raised": raised}
                        _LOGGER.error("fault in a worker", extra={"fields": fields})
                        raise RunLost("the run ended without an answer: a fault in NavBudget, which the log has")
                    return outcome
            except (EOFError, OSError) as error:
                raise RunLost("the run ended without an answer; it may need more memory") from error
            finally:
                if held is not None and held <= _SMALL and not _waiting:
                    _waiting.append(process)
                else:
                    await process.end()


async def until_asked(work: Coroutine[Any, Any, object]) -> None:
    """Do work that nobody has asked for, and end it as soon as a visitor's run would wait.

    work: awaits `run_alone`; what it raises is raised here.
    """
    task = asyncio.create_task(work)
    _unasked.add(task)
    try:
        await asyncio.wait([task])
        if not task.cancelled():
            task.result()
    finally:
        _unasked.discard(task)
        task.cancel()


class _Process:
    """A process that does one run after another; `ends` is our end of the pipe to it."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.ends, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs, workers.first()), daemon=True)
        self._process.start()
        theirs.close()

    @property
    def lives(self) -> bool:
        return self._process.is_alive()

    async def end(self) -> None:
        self._process.kill()
        await asyncio.to_thread(self._process.join)
        self.ends.close()


_waiting: list[_Process] = []  # for the next run, one at most
_unasked: set[asyncio.Task[object]] = set()


def _take() -> _Process:
    while _waiting:
        if (process := _waiting.pop()).lives:
            return process
    return _Process()


@cache
def _turns() -> Turns:
    """As many runs at a time as the pool has processes, and two at least; half of them for one visitor, as a run may
    take minutes."""
    places = max(2, workers.size())
    return Turns(places, math.ceil(places / 2))


def _work(ends: Connection, begin: Callable[[], None] | None) -> None:
    """Do runs, as they come, until nobody is left to ask."""
    end_with_parent()
    workers.lower_priority(begin)
    while True:
        try:
            function, arguments = ends.recv()
        except EOFError:
            return
        try:
            result = function(*arguments, progress=lambda share, what: ends.send(("progress", share, what)))
        except InputError as error:
            answer: tuple[str, Any] = "refused", error
        except (ValueError, ArithmeticError) as error:
            answer = "refused", ValueError(str(error))  # not every kind of it survives the way
        except Exception as error:  # noqa: BLE001  # for the log: on standard error its text may be a file's
            place = [
                f"{frame.filename}:{frame.lineno} {frame.name}" for frame in traceback.extract_tb(error.__traceback__)
            ]
            answer = "fault", (type(error).__name__, place[-5:])
        else:
            answer = "done", result
            del result
        del function, arguments
        ends.send((*answer, _held_memory()))
        del answer


def _held_memory() -> int:
    """Bytes of memory that this process holds now; where only Linux would tell, too many to be kept."""
    path = Path("/proc/self/statm")
    if not path.exists():
        return sys.maxsize
    return int(path.read_text("ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")

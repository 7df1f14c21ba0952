"""A long run in a separate process, with progress, which ends at once when cancelled.

The pool of `app.work.pool` serves short work; its processes cannot be stopped within a task, and one that has
done something large keeps its memory.
"""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from functools import cache
from multiprocessing.connection import Connection
from typing import Any

from app.work import pool as workers
from nav_model.errors import InputError
from nav_model.processes import end_with_parent

WAITING = "waiting for another run to finish"


class RunLost(Exception):
    """The process ended without an answer: out of memory, or a fault of ours."""


async def run_alone(function: Callable[..., Any], *arguments: Any, progress: Callable[[float, str], None]) -> Any:
    """Run an importable function in a new process; cancelling the task ends the process at once.

    function is called with ``progress=`` a function of the share done and of what is being done, which reaches
    `progress` here.

    Raises
    ------
    ValueError
        As the function raises it, a InputError with its key: the message is for the person.
    RunLost
        When the process died.
    """
    if _places().locked():
        progress(0.0, WAITING)
    with workers.counted():
        async with _places():
            context = multiprocessing.get_context("spawn")
            receiver, sender = context.Pipe(duplex=False)
            process = context.Process(target=_work, args=(sender, function, arguments), daemon=True)
            process.start()
            sender.close()
            try:
                while True:
                    kind, *content = await asyncio.to_thread(receiver.recv)
                    if kind == "progress":
                        progress(*content)
                    elif kind == "refused":
                        raise content[0]
                    else:
                        return content[0]
            except (EOFError, OSError) as error:
                raise RunLost("the run ended without an answer; it may need more memory") from error
            finally:
                process.kill()
                await asyncio.to_thread(process.join)
                receiver.close()


@cache
def _places() -> asyncio.Semaphore:
    """As many runs at a time as the pool has processes."""
    return asyncio.Semaphore(workers.size())


def _work(sender: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    end_with_parent()
    workers.step_back()
    try:
        result = function(*arguments, progress=lambda share, what: sender.send(("progress", share, what)))
    except InputError as error:
        sender.send(("refused", error))
    except ValueError as error:
        sender.send(("refused", ValueError(str(error))))  # not every kind of it survives the way
    else:
        sender.send(("done", result))

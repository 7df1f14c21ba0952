"""A log's study in a process of its own: it says how far it is, can be ended at once, and gives its memory back.

The pool of `app.workers` is not used here: its processes cannot be stopped within a task, and one that has
analysed a large log keeps its memory.
"""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from functools import cache
from multiprocessing.connection import Connection

from app import workers
from app.log_study import LogRequest, Study, study_log
from nav_model.inputs import DesignError

WAITING = "waiting for another log to finish"


class LogJobLost(Exception):
    """The process ended without an answer: out of memory, or a fault of ours."""


async def study_elsewhere(request: LogRequest, progress: Callable[[float, str], None]) -> Study:
    """Run `study_log` in a new process; cancelling the task ends the process at once.

    Raises
    ------
    DesignError
        As `study_log`.
    LogJobLost
        When the process died.
    """
    places = _places()
    if places.locked():
        progress(0.0, WAITING)
    with workers.counted():
        async with places:
            context = multiprocessing.get_context("spawn")
            receiver, sender = context.Pipe(duplex=False)
            process = context.Process(target=_work, args=(sender, request), daemon=True)
            process.start()
            sender.close()
            try:
                while True:
                    kind, *content = await asyncio.to_thread(receiver.recv)
                    if kind == "progress":
                        progress(*content)
                    elif kind == "refused":
                        raise DesignError(*content)
                    else:
                        return content[0]
            except EOFError as error:
                raise LogJobLost("the analysis ended without an answer; the log may need more memory") from error
            finally:
                process.kill()
                await asyncio.to_thread(process.join)


@cache
def _places() -> asyncio.Semaphore:
    """As many logs at a time as the pool has processes."""
    return asyncio.Semaphore(workers.size())


def _work(sender: Connection, request: LogRequest) -> None:
    workers.step_back()
    try:
        study = study_log(request, lambda fraction, what: sender.send(("progress", fraction, what)))
    except DesignError as error:
        sender.send(("refused", error.key, error.reason))
    except OSError as error:
        sender.send(("refused", request.file_name or "log", f"cannot be read: {error.strerror or error}"))
    else:
        sender.send(("done", study))

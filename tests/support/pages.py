"""Parts of a page without a browser: what takes time is done here, and waited for."""

import asyncio
import inspect
from collections.abc import Awaitable, Callable
from typing import Any

from waiting import soon

from app.work.run import Run

_START = Run.start


async def at_once(function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
    """Instead of a worker process."""
    await asyncio.sleep(0)
    return function(*arguments, **options)


def start_to_the_end(run: Run, work: Callable[[Run], Awaitable[Any]]) -> asyncio.Task[None] | None:
    """Instead of `Run.start`, as `_START` has it: where no event loop runs, up to the end of the work."""
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        when_done(lambda: _START(run, work))
        return None
    return _START(run, work)


def when_done(do: Callable[[], Any], *runs: Any) -> None:
    """Do it within an event loop, up to the end of what it gives to wait for and of these runs."""

    async def to_the_end() -> None:
        result = do()
        if inspect.isawaitable(result):
            await result
        await soon(lambda: not any(run.running for run in runs), "the end of the runs")

    asyncio.run(to_the_end())

"""Compiles the simulator once per server, in the background, before the first run needs it."""

import asyncio
import contextvars
import logging
import multiprocessing
from collections.abc import Callable

from app.work.pool import first
from app.work.run import Run
from nav_model.simulation.warm import warm_up

PREPARING = "Preparing the simulator, which its first use compiles"

_prepared: asyncio.Task[None] | None = None


def prepare() -> asyncio.Task[None]:
    """Have the simulator compiled, once per server."""
    global _prepared
    loop = asyncio.get_running_loop()
    if _prepared is None or _prepared.get_loop() is not loop:
        # In a context of its own: that of whoever asks first would keep their page for as long as the task is known.
        _prepared = loop.create_task(_compile(), context=contextvars.Context())
    return _prepared


async def _compile() -> None:
    """In a separate process: the pool's are for users who wait. A failure here is reported by the first run."""
    process = multiprocessing.get_context("spawn").Process(target=_logged, args=(warm_up, first()), daemon=True)
    process.start()
    await asyncio.to_thread(process.join)


def _logged(function: Callable[[], object], begin: Callable[[], None] | None) -> None:
    if begin is not None:
        begin()
    try:
        function()
    except Exception:  # told in full where the server logs: this process has nobody else to tell
        logging.getLogger("navbudget").exception("fault in a worker")


async def made_ready(run: Run) -> None:
    """Wait for the compiled simulator, and say so; everybody waits for the same, also when a run is cancelled."""
    run.tell(PREPARING)
    await asyncio.shield(prepare())

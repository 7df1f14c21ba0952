"""One pool of worker processes per server, so that heavy work never holds up another person's sliders."""

from __future__ import annotations

import asyncio
import functools
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

_P = ParamSpec("_P")
_T = TypeVar("_T")


WORKERS = max(1, (os.cpu_count() or 2) - 1)
"""Processes of the pool: one core is left to the server itself."""


@functools.cache
def pool() -> ProcessPoolExecutor:
    """The pool; its processes start with the first task."""
    return ProcessPoolExecutor(max_workers=WORKERS, mp_context=multiprocessing.get_context("spawn"))


async def elsewhere(function: Callable[_P, _T], *arguments: _P.args) -> _T:
    """Run an importable function in a worker process.

    Raises
    ------
    BrokenProcessPool
        If the worker died; the next call gets a new pool.
    """
    try:
        return await asyncio.get_running_loop().run_in_executor(pool(), function, *arguments)
    except BrokenProcessPool:
        pool.cache_clear()
        raise

"""Worker processes that end with the process that started them, however that one ends."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any


def worker_pool(workers: int, begin: Callable[[], None] | None = None) -> ProcessPoolExecutor:
    """A pool of this machine's processes, spawned, so safe beside threads. Shut it down after use.

    ``begin``, an importable function, is called once in each.

    Raises
    ------
    ValueError
        If ``workers`` is less than 1.
    """
    return ProcessPoolExecutor(
        workers, mp_context=multiprocessing.get_context("spawn"), initializer=_begin, initargs=(begin,)
    )


def end_with_parent() -> None:
    """Have this process end when the one that started it has ended.

    A pool's process waits for work on a pipe that the pool's other processes hold open too: a parent that was killed
    would leave them waiting for ever.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_follow, args=(parent,), daemon=True).start()


def _begin(begin: Callable[[], None] | None) -> None:
    end_with_parent()
    if begin is not None:
        begin()


def _follow(parent: Any) -> None:
    parent.join()
    os._exit(1)

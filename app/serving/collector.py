"""Schedules Python's full garbage collections.

A page is some 50,000 objects, and a full collection looks at all of every open page: two seconds with fifty of
them, in which nobody is answered. Python would do so whenever a quarter of all objects is new. Here the young
generations are collected as usual, and a full collection runs only when nobody is active, or when there is too much
garbage to wait for that.
"""

import asyncio
import ctypes
import gc
import os
import time
from collections.abc import Callable

from app.upstream.neighbours import leave_collecting

_LOOK = 1.0  # seconds between two looks
_QUIET = 2.0  # seconds without a message after which the server counts as idle
_MOST_CLOSED = 25  # pages closed and not yet freed, some 10 MB each
_LONGEST = 900.0  # seconds of work without a pause
_NEVER = 1_000_000  # collections of the middle generation before one of everything


class Collector:
    """Tracks closed pages and the last activity, and collects when due."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._last_activity = self._collected = clock()
        self._closed = 0

    def heard(self) -> None:
        """Note activity: a page sent a message, or was requested."""
        self._last_activity = self._clock()

    def page_closed(self) -> None:
        """A session ended; its objects refer to each other in circles."""
        self._closed += 1

    def due(self) -> bool:
        """True when a full collection is due."""
        now = self._clock()
        idle = self._last_activity > self._collected or self._closed
        return bool(
            (idle and now - self._last_activity >= _QUIET)
            or self._closed >= _MOST_CLOSED
            or (self._last_activity > self._collected and now - self._collected >= _LONGEST)
        )

    def collect(self) -> None:
        """Run a full collection, and give freed memory back to the system where the C library keeps it."""
        gc.collect()
        if trim := getattr(ctypes.CDLL(None) if os.name == "posix" else None, "malloc_trim", None):  # glibc
            trim(0)
        self._collected, self._closed = self._clock(), 0

    async def run(self) -> None:
        """Collect whenever that is due, until cancelled."""
        while True:
            await asyncio.sleep(_LOOK)
            if self.due():
                self.collect()


def settle() -> None:
    """Exclude the objects loaded so far from collection, and leave full collections to `Collector` from now on."""
    gc.collect()
    gc.freeze()
    young, middle, _ = gc.get_threshold()
    gc.set_threshold(young, middle, _NEVER)
    leave_collecting()

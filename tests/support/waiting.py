"""Waiting for an event instead of for a time: a busy machine is slow, not wrong."""

import asyncio
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

T = TypeVar("T")

PATIENCE = 300.0
"""Seconds until something that has not happened is taken never to happen. No verdict depends on the number: what
works is done long before, and what hangs would hang for ever."""


def until(holds: Callable[[], T], what: str) -> T:
    """Wait until a function gives something true, and give that; fails with `what` after `PATIENCE`."""
    deadline = time.monotonic() + PATIENCE
    while not (result := holds()):
        assert time.monotonic() < deadline, f"still waiting: {what}"
        time.sleep(0.02)
    return result


async def soon(holds: Callable[[], T], what: str) -> T:
    """`until`, while the event loop goes on."""
    deadline = time.monotonic() + PATIENCE
    while not (result := holds()):
        assert time.monotonic() < deadline, f"still waiting: {what}"
        await asyncio.sleep(0.005)
    return result


@contextmanager
def refusing_port() -> Iterator[int]:
    """A port of this machine on which nobody listens, kept from everybody else meanwhile."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        yield taken.getsockname()[1]

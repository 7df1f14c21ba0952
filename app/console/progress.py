"""Progress on standard error: one line rewritten on a terminal, a line now and then elsewhere."""

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from app.work.run import Clock

COMPILES = "Compiling the simulator (first use only)"
"""Message of a command before it flies anything."""

_QUIET_SECONDS = 5.0  # between lines where standard error is not a terminal


@contextmanager
def show_progress() -> Iterator[Callable[[str, float], None]]:
    """A function of the activity and the share done (0 to 1), which prints both with the time left."""
    terminal = sys.stderr.isatty()
    clock, last = Clock(), -math.inf

    def show(what: str, share: float) -> None:
        nonlocal last
        now = time.monotonic()
        if not terminal and now - last < _QUIET_SECONDS and share < 1:
            return
        last = now
        line = clock.progress(what, share).words
        # One piece: a command that is stopped reports it on a separate line.
        print(f"\r\x1b[K{line}" if terminal else f"{line}\n", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        if terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


@contextmanager
def count_runs(of: str = "") -> Iterator[Callable[[int, int], None]]:
    """Count runs done of runs in all; ``of`` goes before the count, where several kinds are run."""
    with show_progress() as show:
        yield lambda done, runs: show(f"{of}{done} of {runs} runs", done / runs)

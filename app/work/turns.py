"""Who is next: places for heavy work, which visitors take in turn."""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager


class Turns:
    """A number of places for heavy work, of which one visitor holds ``of_one`` at most.

    Where all are taken, whoever waits is let in by visitor in turn: a visitor with fifty tasks is before another with
    one only once.
    """

    def __init__(self, places: int, of_one: int) -> None:
        self._free, self._of_one = places, of_one
        self._held: Counter[str] = Counter()
        self._waiting: dict[str, list[asyncio.Future[None]]] = {}  # the visitor whose turn is next comes first

    def must_wait(self, visitor: str) -> bool:
        """True if there is no place for this visitor now."""
        return not self._free or self._held[visitor] >= self._of_one

    @asynccontextmanager
    async def place(self, visitor: str) -> AsyncIterator[None]:
        """A place, as soon as it is this visitor's turn."""
        if self.must_wait(visitor):
            turn = asyncio.get_running_loop().create_future()
            self._waiting[visitor] = [*_alive(self._waiting.get(visitor, [])), turn]
            try:
                await turn
            except asyncio.CancelledError:
                if not turn.cancelled():  # the place was given just before
                    self._leave(visitor)
                raise
        else:
            self._enter(visitor)
        try:
            yield
        finally:
            self._leave(visitor)

    def _enter(self, visitor: str) -> None:
        self._free -= 1
        self._held[visitor] += 1

    def _leave(self, visitor: str) -> None:
        self._free += 1
        self._held -= Counter((visitor,))  # whoever holds none is forgotten
        for other in list(self._waiting):
            if self.must_wait(other):
                continue
            turns = _alive(self._waiting.pop(other))
            if turns:
                self._enter(other)
                turns.pop(0).set_result(None)
            if turns:  # behind all others
                self._waiting[other] = turns


def _alive(turns: list[asyncio.Future[None]]) -> list[asyncio.Future[None]]:
    """Without those that were cancelled meanwhile."""
    return [turn for turn in turns if not turn.done()]

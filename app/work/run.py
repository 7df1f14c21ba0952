"""One long run of a user, of any computation: start, progress, cancel, result."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any

import param

from app.declared import declared, optional
from app.work.cancellable import RunLost
from nav_model.base.errors import InputError
from nav_model.design.parts import labelled

_LEAST_SHARE = 0.01  # below it the time spent says little about the time left


@dataclass(frozen=True)
class Progress:
    """Progress of a run.

    Attributes
    ----------
    what : str
        What is being done, in words, such as "100 of 2000 runs".
    share : float or None
        Share done, 0 to 1; None while unknown.
    left : float or None
        Seconds left; None while unknown.
    """

    what: str
    share: float | None = None
    remaining_s: float | None = None

    @property
    def words(self) -> str:
        """The work in hand and the time left, for a page or a terminal.

        >>> Progress("100 of 400 runs", 0.25, 12.3).words
        '100 of 400 runs, about 12 s left'
        """
        return self.what if self.remaining_s is None else f"{self.what}, about {self.remaining_s:.0f} s left"


class Clock:
    """The time left of a run, from the time that its share so far has taken.

    The clock starts again whenever the share is zero or not known: what prepares a run says nothing of its pace.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._began = now()

    def progress(self, what: str, share: float | None = None) -> Progress:
        """Progress at this moment; `share` is from 0 to 1."""
        now = self._now()
        if not share:
            self._began = now
            return Progress(what, share)
        remaining = (now - self._began) * (1 - share) / share if _LEAST_SHARE <= share < 1 else None
        return Progress(what, share, remaining)


class Run(param.Parameterized):
    """A run that can be started again: at most one at a time, the newest wins.

    A view depends on the parameters; `start` and `cancel` are all it calls. The last result stays until there is
    another, whatever happens to the run after it.
    """

    running = param.Boolean(default=False, doc="Whether work is under way.")
    progress = optional(Progress, "How far the work under way is; None between runs.")
    result: Any = declared(
        param.Parameter(default=None, doc="The last result, which may be partial while work is under way.")
    )
    message = param.String(default="", doc="Why the last run ended without a result; empty if it had one.")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self._task: asyncio.Task[None] | None = None
        self._clock = Clock()

    def start(self, work: Callable[[Run], Awaitable[Any]]) -> asyncio.Task[None]:
        """Start `work` in the running event loop; a run under way is cancelled first.

        Parameters
        ----------
        work : callable
            Called with this run, which it may `tell` and `show`; what it returns becomes `result`. A ValueError or
            ArithmeticError it raises becomes the `message`.
        """
        if self._task is not None:
            self._task.cancel()
        self._clock = Clock()
        self.param.update(running=True, progress=None, message="")
        self._task = asyncio.create_task(self._work(work))
        return self._task

    def cancel(self) -> None:
        """Cancel; the worker's task is dropped. The work may still `show` what it has found."""
        if self._task is not None:
            self._task.cancel()

    def drop(self) -> None:
        """Cancel what nobody waits for any more; nothing of it is shown."""
        self.cancel()
        self._task = None

    def take(self, result: Any) -> None:
        """Have a result that exists already; work under way is dropped."""
        self.drop()
        self.param.update(running=False, progress=None, message="", result=result)

    @property
    def cancelled(self) -> bool:
        """True if the last run ended because somebody cancelled it."""
        return self.message.startswith("Cancelled")

    @property
    def mine(self) -> bool:
        """True if the task that asks is the newest of this run, whose result is wanted."""
        return self._task is asyncio.current_task()

    def tell(self, what: str, share: float | None = None) -> None:
        """Report progress: in words, and as a share from 0 to 1 once that is known."""
        self.progress = self._clock.progress(what, share)

    def show(self, partial: Any) -> None:
        """A result before the last."""
        self.result = partial

    async def _work(self, work: Callable[[Run], Awaitable[Any]]) -> None:
        end: dict[str, Any] = {}  # stays empty for a fault of ours, which the loop's handler reports
        try:
            end = {"result": await work(self)}
        except asyncio.CancelledError:
            reached = self.progress
            end = {"message": "Cancelled." if reached is None else f"Cancelled: {reached.what}."}
        except (ValueError, ArithmeticError) as error:
            end = {"message": str(labelled(error) if isinstance(error, InputError) else error)}
        except (BrokenProcessPool, RunLost):
            end = {"message": "The process that did the work ended without an answer. Start again."}
        finally:
            if self.mine:  # one that was replaced leaves the word to its successor; a dropped one has no page left
                self._task = None
                self.param.update(running=False, progress=None, **end)

"""Worker processes that end when the process that started them ends, even if it is killed."""

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError, ProcessPoolExecutor
from contextlib import suppress
from multiprocessing.connection import wait
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

_MOMENT = 0.01  # seconds


def worker_pool(workers: int, begin: Callable[[], None] | None = None) -> ProcessPoolExecutor:
    """A pool of this machine's processes, spawned, so safe beside threads. Shut it down after use.

    ``begin``, an importable function, is called once in each.

    Raises
    ------
    ValueError
        If ``workers`` is less than 1.
    """
    return _Pool(workers, mp_context=_Spawn(), initializer=_begin, initargs=(begin,))


def kill_workers() -> None:
    """End every process that a pool of this process started, whatever it is doing, and so the pools."""
    for process in multiprocessing.active_children():
        process.kill()


class _Pool(ProcessPoolExecutor):
    """A pool that breaks when one of its processes is killed, even with cancelled tasks or a result half sent.

    Python before 3.13 (python/cpython#108974) stops at the first cancelled future while it tells the others that a
    process has ended: with a traceback, and with a thread that writes for ever into a pipe that nobody reads. Every
    Python waits for the rest of a result that a killed process was sending, as this process and the pool's others
    hold that end of the pipe open too, and they in turn for the lock that it held: so each process is watched, and
    when one dies the others are ended and the pipe is closed.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        # The pool forgets both when it is shut down, its threads do not.
        self._results: Any = self._result_queue
        self._started: Any = self._processes
        self._watched: set[int] = set()
        self._closing = threading.Lock()
        self._close_results = self._results.close
        self._results.close = self._close_in_turn  # type: ignore[method-assign]

    def _close_in_turn(self) -> None:
        with self._closing:  # never while a thread that mourns closes one end of the pipe
            self._close_results()

    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        """Submit a task as `ProcessPoolExecutor` does, and watch each process that was started for it."""
        future = super().submit(*arguments, **options)
        future.__class__ = _Outcome
        for number, process in list(self._started.items()):
            if number not in self._watched:
                self._watched.add(number)
                threading.Thread(target=self._mourn, args=(process,), daemon=True).start()
        return future

    def _mourn(self, process: Any) -> None:
        """Wait for a process to end, and end the pool unless it ended well."""
        wait([process.sentinel])
        while process.exitcode is None:  # another thread has just asked, and is told in its place
            time.sleep(_MOMENT)
        if process.exitcode == 0:
            return
        for other in list(self._started.values()):
            other.kill()
        with self._closing:
            self._results._writer.close()


class _Outcome(Future[Any]):
    def set_exception(self, exception: BaseException | None) -> None:
        with suppress(InvalidStateError):  # it is cancelled
            super().set_exception(exception)


class _DeafToCtrlC(SpawnProcess):
    """Ignores Ctrl-C, which a terminal sends to every process of the command: the parent handles it and ends the
    others."""

    def start(self) -> None:
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            super().start()
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # a new process begins with what is set
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Spawn(SpawnContext):
    Process = _DeafToCtrlC


def end_with_parent() -> None:
    """End this process when its parent has ended.

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

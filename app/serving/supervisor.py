"""Several processes that serve pages from the same socket.

A free process takes the next visitor, and a page stays with the process that accepted its connection. The supervisor
only starts them, restarts those that end unexpectedly, and passes on the signal to stop; it does not load the
dashboard.
"""

import logging
import multiprocessing
import os
import secrets
import signal
import socket
import time
from dataclasses import dataclass, field
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

from app.serving.address import SharedSocket, announce, listen
from app.serving.board import BoardRow, SharedMetrics
from app.serving.logs import event, set_up
from app.serving.passwords import read_passwords
from app.serving.rules import Rules
from nav_model.base.processes import end_with_parent

_LOOK = 0.05  # seconds between two looks at what starts
_PAUSE = 1.0  # seconds before a process that ended is started again; twice as long each time
_LONGEST_PAUSE = 60.0
_WELL = 60.0  # seconds after which a process that runs is taken to have started well
_MOST_ENDS = 8  # of one process in a row, none of which started well, after which all is stopped


def supervise(rules: Rules, library: str) -> int:
    """Serve from several processes until stopped by SIGTERM or SIGINT; prints the address once all are up.

    Returns the exit status: 1 if a process could not start, or ended repeatedly.

    Raises
    ------
    InputError
        If the address cannot be listened on, or the password file is wrong.
    """
    if rules.password_file is not None:
        read_passwords(rules.password_file)  # said once, here
    listening, port = listen(rules)
    set_up(rules.log)
    children = _Children(listening, port, rules, library)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, children.on_signal)
    for process in range(rules.page_processes):
        children.start(process)
    if children.all_ready():
        announce(rules, port)
        children.keep()
    status = children.end()
    event("stopped")
    return status


@dataclass
class RestartLimit:
    """Counts how often one process has failed, and when it is started again."""

    count: int = 0
    due: float | None = None
    began: float = 0.0

    def started(self, now: float) -> None:
        """Note that the process has been started, at a time [s]."""
        self.began, self.due = now, None

    def fell(self, now: float) -> bool:
        """Note that it has ended, at a time [s]; whether to start it again, from `due` on."""
        self.count = 1 if now - self.began >= _WELL else self.count + 1
        self.due = now + min(_LONGEST_PAUSE, _PAUSE * 2 ** (self.count - 1))
        return self.count < _MOST_ENDS


@dataclass
class _Children:
    """The processes, by their place on the board."""

    listening: socket.socket
    port: int
    rules: Rules
    library: str
    secret: bytes = field(default_factory=lambda: secrets.token_bytes(32), repr=False)
    stopping: bool = False
    starting: bool = False
    failed: bool = False

    def __post_init__(self) -> None:
        self.board = SharedMetrics(self.rules.page_processes)
        self.members: dict[int, BaseProcess] = {}
        self.limits: dict[int, RestartLimit] = {
            process: RestartLimit() for process in range(self.rules.page_processes)
        }

    def start(self, process: int) -> None:
        """Start one, unless all are being stopped."""
        if self.stopping:
            return
        arguments = (self.listening, self.port, self.rules, self.library, BoardRow(self.board, process), self.secret)
        member = multiprocessing.get_context("spawn").Process(target=_serve_pages, args=arguments)
        self.starting = True
        try:
            member.start()
        finally:
            self.starting = False
        self.members[process] = member
        self.limits[process].started(time.monotonic())
        if self.stopping:  # told in between, by a signal
            self._stop()  # type: ignore[unreachable]

    def on_signal(self, *_: Any) -> None:
        """Hand on a signal: the first lets heavy work end, the second does not wait."""
        self.stopping = True
        if not self.starting:  # the socket is being handed to the new process, and must not be closed under it
            self._stop()

    def _stop(self) -> None:
        self.listening.close()  # or visitors would wait for a process that does not answer
        for member in list(self.members.values()):
            if member.pid is not None and member.exitcode is None:
                os.kill(member.pid, signal.SIGTERM)

    def all_ready(self) -> bool:
        """Wait until every process can take visitors; whether it came to that."""
        while self.board.total("ready") < self.rules.page_processes and not self.stopping:
            for process, member in self.members.items():
                if member.exitcode is not None and not self.stopping:
                    event("page process could not start", logging.ERROR, process=process, exit=member.exitcode)
                    self.failed = True
                    return False
            time.sleep(_LOOK)
        return not self.stopping

    def keep(self) -> None:
        """Start again whatever ends, later each time, until told to stop or one of them ends too often."""
        while not self.stopping:
            now = time.monotonic()
            for process, member in list(self.members.items()):
                if member.exitcode is None or self.stopping:
                    continue
                limit = self.limits[process]
                if limit.due is None:
                    self.board.clear(process)
                    self.failed = not limit.fell(now)
                    event(
                        "page process ended",
                        logging.ERROR,
                        process=process,
                        exit=member.exitcode,
                        in_a_row=limit.count,
                    )
                    if self.failed:
                        event("page processes given up", logging.ERROR, process=process, in_a_row=limit.count)
                        return
                elif now >= limit.due:
                    BoardRow(self.board, process).add("restarts")
                    self.start(process)
            waits = [limit.due - now for limit in self.limits.values() if limit.due is not None]
            # One that has ended since it was looked at above is among them, and ends the waiting at once.
            watched = [
                member.sentinel for process, member in self.members.items() if self.limits[process].due is None
            ]
            wait(watched, timeout=max(_LOOK, min(waits)) if waits else None)

    def end(self) -> int:
        """Wait until all have ended."""
        if self.failed:
            self.on_signal()
        for member in self.members.values():
            member.join()
        return int(self.failed)


def _serve_pages(
    listening: socket.socket, port: int, rules: Rules, library: str, row: BoardRow, secret: bytes
) -> None:
    """Serve pages on an open socket until the parent ends: the whole life of a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent turns a terminal's Ctrl-C into SIGTERM
    end_with_parent()
    set_up(rules.log)
    from app.library.place import use_library
    from app.library.seal import use_key
    from app.serving.server import serve_on

    use_library(library)
    use_key(rules.review_key)
    serve_on(SharedSocket(listening, row), port, rules, row, secret, lambda: row.put("ready", 1))

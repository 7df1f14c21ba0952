"""The server's address: listening, sharing the socket between processes, and host names."""

import errno
import logging
import resource
import socket
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any
from weakref import ref

from tornado.ioloop import IOLoop

from app.serving.board import BoardRow
from app.serving.logs import event
from app.serving.rules import Rules, is_everywhere
from nav_model.base.errors import InputError

_BACKLOG = 128  # visitors that may wait to be let in
_STEP_BACK = 0.015  # seconds: another process needs less, unless it is busy
_ANOTHER = 0.5  # seconds without being asked to accept, after which it is for another visitor
_MOST_WAITING = 500  # connections that have asked for nothing yet, or for no page; each may hold 130 kB
_AT_ONCE = 8  # connections accepted before open pages have their turn
_REST = 0.5  # seconds without accepting when no file can be opened
_QUIET = 60.0  # seconds in which that is logged once


def listen(rules: Rules) -> tuple[socket.socket, int]:
    """A socket that listens where the rules say, and its port.

    Raises
    ------
    InputError
        If that cannot be listened on.
    """
    family = socket.AF_INET6 if ":" in rules.address else socket.AF_INET
    try:
        listening = socket.create_server((rules.address, rules.port), family=family, backlog=_BACKLOG)
    except OSError as error:
        option = "--port" if error.errno in (errno.EADDRINUSE, errno.EACCES) else "--address"
        raise InputError(option, f"cannot listen on {rules.address}:{rules.port}: {error.strerror}") from error
    listening.setblocking(False)
    return listening, int(listening.getsockname()[1])


class SharedSocket(socket.socket):
    """A listening socket that other processes may accept from too.

    A process with more sessions than another waits a moment before it accepts, as a page stays in the process that
    accepted it. Of too many connections that are not a page's, the one that came first gives way: whoever opens them
    by the thousand and asks for nothing keeps nobody out.
    """

    def __init__(self, shared: socket.socket, row: BoardRow) -> None:
        super().__init__(fileno=shared.detach())
        self._row = row
        self._began = self._asked = self._logged = -_QUIET
        self._waiting: list[ref[socket.socket]] = []
        self._in_a_row = 0
        self._most = min(_MOST_WAITING, resource.getrlimit(resource.RLIMIT_NOFILE)[0] // 4)

    def accept(self) -> tuple[socket.socket, Any]:
        """Accept a connection; BlockingIOError, as when nobody is waiting, while another process should accept."""
        board, now = self._row.board, time.monotonic()
        if board.get(self._row.process, "sessions") > board.fewest("sessions"):
            if now - self._asked > _ANOTHER:  # the event loop asks repeatedly while somebody waits
                self._began = now
            self._asked = now
            if now - self._began < _STEP_BACK:
                raise BlockingIOError
        self._in_a_row += 1
        try:
            if self._in_a_row > _AT_ONCE:
                raise BlockingIOError
            accepted, peer = super().accept()
        except OSError as error:
            self._in_a_row = 0
            if error.errno not in (errno.EMFILE, errno.ENFILE):
                raise
            self._rest()
            raise BlockingIOError from error
        self._waiting = [h for h in self._waiting if (open_ := h()) is not None and open_.fileno() >= 0]
        if len(self._waiting) >= self._most and (first := self._waiting.pop(0)()) is not None:
            with suppress(OSError):  # it has just gone
                first.shutdown(socket.SHUT_RDWR)
        self._waiting.append(ref(accepted))
        return accepted, peer

    def keep(self, accepted: socket.socket) -> None:
        """Count an accepted connection no longer among those that wait: it has become a page's."""
        self._waiting = [h for h in self._waiting if h() is not accepted]

    def _rest(self) -> None:
        """No more files can be opened: accept nobody for a moment, or the event loop would ask without end."""
        now, loop = time.monotonic(), IOLoop.current()
        if now - self._logged >= _QUIET:
            self._logged = now
            event("no file left for another connection", logging.ERROR)
        loop.update_handler(self, 0)
        loop.call_later(_REST, lambda: loop.update_handler(self, IOLoop.READ) if self.fileno() >= 0 else None)


def announce(rules: Rules, port: int) -> None:
    """Print that the server is ready, and its address."""
    print(f"NavBudget on http://{_host(rules.address)}:{port}", flush=True)
    event("started", address=rules.address, port=port, protected=rules.protected, processes=rules.page_processes)


def origins(address: str, port: int, allowed: Sequence[str]) -> list[str]:
    """Allowed origins of websocket connections: loopback names always; also an address that is a name of this
    machine."""
    hosts = {"127.0.0.1", "localhost"}
    if not is_everywhere(address):
        hosts.add(_host(address))
    return [*(f"{host}:{port}" for host in sorted(hosts)), *allowed]


def _host(address: str) -> str:
    """An address as written in a URL."""
    return f"[{address}]" if ":" in address else address

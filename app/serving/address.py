"""The server's address: listening, sharing the socket between processes, and host names."""

from __future__ import annotations

import ipaddress
import socket
import time
from collections.abc import Sequence
from typing import Any

from app.serving.board import Row
from app.serving.logs import event
from app.serving.rules import Rules
from nav_model.base.errors import InputError

_BACKLOG = 128  # visitors that may wait to be let in
_STEP_BACK = 0.015  # seconds: another process needs less, unless it is busy
_ANOTHER = 0.5  # seconds without being asked to accept, after which it is for another visitor


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
        raise InputError("--address", f"cannot listen on {rules.address}:{rules.port}: {error.strerror}") from error
    listening.setblocking(False)
    return listening, int(listening.getsockname()[1])


class SharedSocket(socket.socket):
    """A listening socket that other processes accept from too. A process with more sessions than another waits a
    moment before it accepts, as a page stays in the process that accepted it."""

    def __init__(self, shared: socket.socket, row: Row) -> None:
        super().__init__(fileno=shared.detach())
        self._row = row
        self._began = self._asked = -1.0

    def accept(self) -> tuple[socket.socket, Any]:
        """As ever; BlockingIOError, as when nobody is waiting, while another process should accept."""
        board, now = self._row.board, time.monotonic()
        if board.get(self._row.process, "sessions") > board.fewest("sessions"):
            if now - self._asked > _ANOTHER:  # the event loop asks repeatedly while somebody waits
                self._began = now
            self._asked = now
            if now - self._began < _STEP_BACK:
                raise BlockingIOError
        return super().accept()


def announce(rules: Rules, port: int) -> None:
    """Print that the server is ready, and its address."""
    print(f"NavBudget on http://{_host(rules.address)}:{port}", flush=True)
    event("started", address=rules.address, port=port, protected=rules.protected, processes=rules.page_processes)


def origins(address: str, port: int, allowed: Sequence[str]) -> list[str]:
    """Allowed origins of websocket connections: loopback names always; also an address that is a name of this
    machine."""
    hosts = {"127.0.0.1", "localhost"}
    try:
        everywhere = ipaddress.ip_address(address).is_unspecified
    except ValueError:
        everywhere = False
    if not everywhere:
        hosts.add(_host(address))
    return [*(f"{host}:{port}" for host in sorted(hosts)), *allowed]


def _host(address: str) -> str:
    """An address as written in a URL."""
    return f"[{address}]" if ":" in address else address

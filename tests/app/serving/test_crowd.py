"""Connections that ask for nothing, by the hundred: pages and new visitors are served all the same."""

import asyncio
import signal
import socket
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from open_page import Tab
from waiting import PATIENCE, until

from app.serving.address import SharedSocket
from app.serving.board import BoardRow, SharedMetrics

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "app/upstream")]

_CODE = """
import resource, sys
import app.serving.server as server
from app.cli import main
resource.setrlimit(resource.RLIMIT_NOFILE, ({files}, {files}))
server._SLOWEST = {slowest}
sys.exit(main(sys.argv[1:]))
"""
_HALF = b"GET / HTTP/1.1\r\nHost: localhost\r\nX: "


def _half(served: Any) -> socket.socket:
    sent = socket.create_connection(("127.0.0.1", served.port), timeout=PATIENCE)
    sent.sendall(_HALF)
    return sent


async def test_more_half_sent_headers_than_files_keep_nobody_out(serving: Any, tmp_path: Path) -> None:
    log = tmp_path / "log"
    with serving(log=log, program=("-c", _CODE.format(files=128, slowest=3600))) as served:
        page = await Tab.open(served.address)
        with ExitStack() as held:
            for _ in range(300):
                held.enter_context(_half(served))
            await page.pull()  # who is in goes on
            assert (await asyncio.to_thread(served.ask, "/liveness"))[0] == 200
            await (await Tab.open(served.address)).close()  # who comes gets in
            await page.pull()
        await page.close()
        assert not page.errors
    assert log.stat().st_size < 10_000


def test_a_server_without_a_file_left_waits_and_says_so_once(serving: Any, tmp_path: Path) -> None:
    """Files taken by something else: the oldest connections giving way does not help."""
    log = tmp_path / "log"
    code = _CODE.format(files=4096, slowest=3600).replace(
        "sys.exit",
        "import os, signal\n"
        "taken = []\n"
        "def take(*_):\n"
        "    resource.setrlimit(resource.RLIMIT_NOFILE, (len(os.listdir('/dev/fd')) + 3, 4096))\n"
        "    try:\n"
        "        while True: taken.append(os.open('/dev/null', os.O_RDONLY))\n"
        "    except OSError: pass\n"
        "def give(*_):\n"
        "    while taken: os.close(taken.pop())\n"
        "signal.signal(signal.SIGUSR1, take)\n"
        "signal.signal(signal.SIGUSR2, give)\n"
        "sys.exit",
    )
    with serving("--log", "json", log=log, program=("-c", code)) as served:
        assert served.ask("/liveness")[0] == 200
        served.process.send_signal(signal.SIGUSR1)
        with ExitStack() as held:
            for _ in range(20):
                held.enter_context(_half(served))
            until(lambda: "no file left" in log.read_text(), "the refusal")
        served.process.send_signal(signal.SIGUSR2)
        assert served.ask("/liveness")[0] == 200
    assert log.read_text().count("no file left") == 1
    assert log.stat().st_size < 10_000


def test_headers_that_do_not_come_end_the_connection(serving: Any) -> None:
    with serving(program=("-c", _CODE.format(files=1024, slowest=0.2))) as served, _half(served) as half:
        assert half.recv(100) == b""


def test_open_pages_have_their_turn_while_connections_come_without_end() -> None:
    """A loop that accepts while somebody waits would serve nobody else."""
    with (
        ExitStack() as held,
        SharedSocket(socket.create_server(("127.0.0.1", 0), backlog=100), BoardRow(SharedMetrics())) as listening,
    ):
        listening.setblocking(False)
        for _ in range(50):
            held.enter_context(socket.create_connection(listening.getsockname(), timeout=PATIENCE))
        turns = [0]
        while sum(turns) < 50:
            try:
                held.enter_context(listening.accept()[0])
                turns[-1] += 1
            except BlockingIOError:
                turns.append(0)
        assert max(turns) < 10

"""The end of a server: work in progress is finished, no new session starts, no process remains."""

import asyncio
import errno
import http.client
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from open_page import Tab
from waiting import PATIENCE, soon, until

from app.work import pool as workers

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "app/work")]


def children_of(pid: int) -> set[int]:
    result = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    direct = {int(word) for word in result.stdout.split()}
    return direct.union(*(children_of(child) for child in direct)) if direct else direct


def refuses(host: str, port: int) -> bool:
    """True where nobody listens."""
    with socket.socket() as visitor:
        return visitor.connect_ex((host, port)) == errno.ECONNREFUSED


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_signal_leaves_no_process(signal_number: signal.Signals) -> None:
    code = (
        "import asyncio, time, threading, app.serving.server as s, app.work.pool as w\n"
        "from app.serving.rules import Rules\n"
        "from tornado.ioloop import IOLoop\n"
        "if __name__ == '__main__':\n"
        "    loop = IOLoop.current().asyncio_loop\n"
        "    loop.call_later(0.1, lambda: asyncio.ensure_future(w.run_in_pool(time.sleep, 600), loop=loop))\n"
        "    s.serve(Rules(port=0, grace=0.5, workers=2))\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline().startswith("NavBudget on")
        until(lambda: len(children_of(process.pid)) >= 2, "a worker and the tracker of shared resources")
        family = children_of(process.pid)
        process.send_signal(signal_number)
        assert process.wait(PATIENCE) == 0  # the work in hand would take ten minutes
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in family), "the end of the workers")


async def test_while_a_server_ends_who_is_in_goes_on_and_nobody_else_gets_in(tmp_path: Path) -> None:
    code = (
        "import asyncio, sys, time, app.work.pool as w\n"
        "from app.cli import main\n"
        "from tornado.ioloop import IOLoop\n"
        "if __name__ == '__main__':\n"
        "    loop = IOLoop.current().asyncio_loop\n"
        "    loop.call_later(0.1, lambda: asyncio.ensure_future(w.run_in_pool(time.sleep, 600), loop=loop))\n"
        f"    main(['serve', '--port', '0', '--library', {str(tmp_path / 'l.db')!r}, '--grace', '60'])\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        address = process.stdout.readline().split()[-1]
        tab = await Tab.open(address)
        bars = (await tab.until(name="timelines"))["id"]
        connection = http.client.HTTPConnection(address.rpartition("/")[2], timeout=PATIENCE)
        connection.request("GET", "/liveness")
        assert connection.getresponse().read()
        process.send_signal(signal.SIGTERM)
        await soon(lambda: refuses(connection.host, int(connection.port)), "a server that lets nobody in")
        answered = tab.expect({bars})
        await tab.slide("imu.angle_random_walk", -4.0)
        await asyncio.wait_for(answered, PATIENCE)
        connection.request("GET", "/")
        answer = connection.getresponse()
        assert answer.status == 503
        assert "being stopped" in answer.read().decode()
        connection.close()
        process.send_signal(signal.SIGTERM)  # a second signal does not wait
        await tab.close()
        assert process.wait(PATIENCE) == 0


def test_heavy_work_steps_back_behind_the_pages() -> None:
    """That runs in processes of their own do too is shown in tests/app/work/test_alone."""
    try:
        assert asyncio.run(workers.run_in_pool(os.nice, 0)) == min(os.nice(0) + 10, 19)
    finally:
        workers.stop()
        workers.pool.cache_clear()

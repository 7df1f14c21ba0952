"""How a server ends: what is under way is finished, nobody new is let in, no process stays."""

from __future__ import annotations

import asyncio
import http.client
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from open_page import Tab

from app.work import alone as long_run
from app.work import pool as workers


def children_of(pid: int) -> set[int]:
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    direct = {int(word) for word in found.stdout.split()}
    return direct.union(*(children_of(child) for child in direct)) if direct else direct


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_signal_leaves_no_process(signal_number: signal.Signals) -> None:
    code = (
        "import asyncio, time, threading, app.serving.server as s, app.work.pool as w\n"
        "from app.serving.rules import Rules\n"
        "from tornado.ioloop import IOLoop\n"
        "if __name__ == '__main__':\n"
        "    loop = IOLoop.current().asyncio_loop\n"
        "    loop.call_later(0.1, lambda: asyncio.ensure_future(w.elsewhere(time.sleep, 600), loop=loop))\n"
        "    s.serve(Rules(port=0, grace=0.5, workers=2))\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("NavBudget on")
        deadline = time.monotonic() + 20
        while len(family := children_of(process.pid)) < 2:  # a worker and the tracker of shared resources
            assert time.monotonic() < deadline
            time.sleep(0.05)
        began = time.monotonic()
        process.send_signal(signal_number)
        assert process.wait(timeout=15) == 0
        assert time.monotonic() - began < 8
    deadline = time.monotonic() + 5
    while alive := {pid for pid in family if Path(f"/proc/{pid}").exists()}:
        assert time.monotonic() < deadline, f"still running: {alive}"
        time.sleep(0.05)


def test_while_a_server_ends_who_is_in_goes_on_and_nobody_else_gets_in(tmp_path: Path) -> None:
    code = (
        "import asyncio, sys, time, app.work.pool as w\n"
        "from app.cli import main\n"
        "from tornado.ioloop import IOLoop\n"
        "if __name__ == '__main__':\n"
        "    loop = IOLoop.current().asyncio_loop\n"
        "    loop.call_later(0.1, lambda: asyncio.ensure_future(w.elsewhere(time.sleep, 600), loop=loop))\n"
        f"    main(['serve', '--port', '0', '--library', {str(tmp_path / 'l.db')!r}, '--grace', '60'])\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]

        async def stay() -> None:
            tab = await Tab.open(address)
            bars = (await tab.until(name="phase bars"))["id"]
            kept = http.client.HTTPConnection(address.rpartition("/")[2], timeout=20)
            kept.request("GET", "/liveness")
            assert kept.getresponse().read()
            process.send_signal(signal.SIGTERM)
            slider = tab.find(label="Angle random walk", show_value=False)
            await asyncio.sleep(0.5)
            answered = tab.expect({bars})
            await tab.set(slider["id"], value=slider["attributes"]["value"] - 0.02)
            await asyncio.wait_for(answered, 20)
            with pytest.raises(ConnectionRefusedError):
                socket.create_connection((kept.host, int(kept.port)), timeout=5)
            kept.request("GET", "/")
            answer = kept.getresponse()
            assert answer.status == 503
            assert "being stopped" in answer.read().decode()
            kept.close()
            process.send_signal(signal.SIGTERM)  # a second signal does not wait
            await tab.close()

        asyncio.run(stay())
        assert process.wait(timeout=20) == 0


def test_heavy_work_steps_back_behind_the_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    try:
        assert asyncio.run(workers.elsewhere(os.nice, 0)) == min(os.nice(0) + 10, 19)
    finally:
        workers.stop()
        workers.pool.cache_clear()
    stepped: list[bool] = []
    monkeypatch.setattr(workers, "step_back", lambda: stepped.append(True))
    receiver, sender = multiprocessing.Pipe(duplex=False)
    long_run._work(sender, lambda progress: len(stepped), ())
    assert receiver.recv() == ("done", 1)

"""How a server ends: what is under way is finished, nobody new is let in, no process stays."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest


def children_of(pid: int) -> set[int]:
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    direct = {int(word) for word in found.stdout.split()}
    return direct.union(*(children_of(child) for child in direct)) if direct else direct


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_leaves_no_process(signal_number: signal.Signals) -> None:
    code = (
        "import asyncio, time, threading, app.server as s, app.workers as w\n"
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

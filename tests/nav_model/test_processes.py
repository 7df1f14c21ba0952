"""Worker processes end with their parent."""

from __future__ import annotations

import gc
import os
import struct
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.queues import SimpleQueue
from pathlib import Path

import psutil
import pytest
from waiting import PATIENCE, until

from nav_model.processes import kill_workers, worker_pool

_POOL = """
import os, sys, time
from {module} import {name}

if __name__ == "__main__":
    pool = {name}({arguments})
    print(pool.submit(os.getpid).result(), pool.submit(os.getpid).result(), flush=True)
    time.sleep(600)
"""


@pytest.mark.parametrize(
    ("module", "name", "arguments"),
    [("nav_model.processes", "worker_pool", "2"), ("nav_model.simulation.monte_carlo", "local_pool", "2"),
     ("app.work.pool", "pool", "")],
)  # fmt: skip
def test_workers_end_when_their_parent_is_killed(tmp_path, module: str, name: str, arguments: str) -> None:
    script = tmp_path / "script.py"  # a file: what is spawned imports it again
    script.write_text(_POOL.format(module=module, name=name, arguments=arguments), encoding="utf-8")
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        told = {int(word) for word in process.stdout.readline().split()}
        workers = psutil.Process(process.pid).children(recursive=True)
        assert told <= {worker.pid for worker in workers}
        process.kill()
    _, alive = psutil.wait_procs(workers, timeout=PATIENCE)
    assert not alive


def test_killed_workers_are_told_of_whatever_else_was_cancelled() -> None:
    with worker_pool(1) as pool:
        worker = psutil.Process(pool.submit(os.getpid).result(PATIENCE))
        asked = [pool.submit(time.sleep, 600) for _ in range(5)]
        assert asked[2].cancel()  # it waits behind the one that runs and the one handed on
        worker.kill()
        for future in (*asked[:2], *asked[3:]):
            with pytest.raises(BrokenProcessPool):
                future.result(PATIENCE)


def _send_half_a_result(told: str) -> None:
    """As a worker does that is killed while it sends: what says that more is to come, and no more."""
    [queue] = [thing for thing in gc.get_objects() if isinstance(thing, SimpleQueue)]
    os.write(queue._writer.fileno(), struct.pack("!i", 10**6) + b"half")
    Path(told).touch()
    time.sleep(600)


def test_workers_killed_while_they_send_a_result_end_their_pool(tmp_path: Path) -> None:
    with worker_pool(1) as pool:
        asked = [pool.submit(_send_half_a_result, str(tmp_path / "told")), pool.submit(os.getpid)]
        until((tmp_path / "told").exists, "half a result")
        kill_workers()
        for future in asked:
            with pytest.raises(BrokenProcessPool):
                future.result(PATIENCE)

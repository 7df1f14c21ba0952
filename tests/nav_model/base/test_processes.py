"""Worker processes end with their parent."""

import os
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import psutil
import pytest
from waiting import PATIENCE

from nav_model.base.processes import worker_pool

pytestmark = pytest.mark.long

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
    [("nav_model.base.processes", "worker_pool", "2"), ("nav_model.simulation.monte_carlo", "local_pool", "2"),
     ("app.work.pool", "pool", "")],
)  # fmt: skip
def test_workers_end_when_their_parent_is_killed(tmp_path, module: str, name: str, arguments: str) -> None:
    script = tmp_path / "script.py"  # a file: what is spawned imports it again
    script.write_text(_POOL.format(module=module, name=name, arguments=arguments), encoding="utf-8")
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as process:
        pids = {int(word) for word in process.stdout.readline().split()}
        workers = psutil.Process(process.pid).children(recursive=True)
        assert pids <= {worker.pid for worker in workers}
        process.kill()
    _, alive = psutil.wait_procs(workers, timeout=PATIENCE)
    assert not alive


def test_killed_workers_are_told_of_whatever_else_was_cancelled() -> None:
    with worker_pool(1) as pool:
        worker = psutil.Process(pool.submit(os.getpid).result(PATIENCE))
        asked = [pool.submit(time.sleep, 600) for _ in range(5)]
        assert asked[3].cancel()  # it waits behind the one that runs and those handed on, two at most
        worker.kill()
        for future in (*asked[:3], asked[4]):
            with pytest.raises(BrokenProcessPool):
                future.result(PATIENCE)


_HALF_A_RESULT = """
import os, signal, struct, sys, time
from multiprocessing.connection import Connection
from pathlib import Path
from nav_model.base.processes import kill_workers, worker_pool

def send_half_a_result(told):
    # As a worker does that is killed while it sends: what says that more is to come, and no more.
    frame = sys._getframe()
    while "result_queue" not in frame.f_locals:
        frame = frame.f_back
    os.write(frame.f_locals["result_queue"]._writer.fileno(), struct.pack("!i", 10**6) + b"half")
    Path('draft').write_text(str(os.getpid()))
    os.replace('draft', told)
    time.sleep(600)

def close_slowly():
    # So slowly that the end of the pool finds what the thread that mourns has closed, but not yet forgotten.
    close = Connection._close
    Connection._close = lambda connection: (close(connection), time.sleep(connection is pool._results._writer))

if __name__ == "__main__":
    with worker_pool({workers}) as pool:
        asked = [pool.submit(send_half_a_result, "told"), pool.submit(time.sleep, 600)]
        while not Path("told").exists() and not asked[0].done():
            time.sleep(0.01)
        {kill}
        print([type(future.exception()).__name__ for future in asked])
"""


@pytest.mark.parametrize(
    ("workers", "kill"),
    [
        (1, "kill_workers()"),
        (1, "close_slowly(), kill_workers()"),
        (1, "os.kill(int(Path('told').read_text()), signal.SIGKILL)"),
        (2, "os.kill(int(Path('told').read_text()), signal.SIGKILL)"),  # the other holds the pipe open
    ],
)
def test_workers_killed_while_they_send_a_result_end_their_pool(tmp_path: Path, workers: int, kill: str) -> None:
    script = tmp_path / "script.py"
    script.write_text(_HALF_A_RESULT.replace("{workers}", str(workers)).replace("{kill}", kill), encoding="utf-8")
    output = subprocess.check_output([sys.executable, str(script)], cwd=tmp_path, text=True, timeout=PATIENCE)
    assert output == "['BrokenProcessPool', 'BrokenProcessPool']\n"

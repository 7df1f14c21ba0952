"""Runs in processes of their own."""

import asyncio
import json
import multiprocessing
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from waiting import PATIENCE, soon

from app.work import cancellable
from app.work import pool as workers
from app.work.cancellable import RunLost, run_alone, until_asked


@pytest.fixture(autouse=True)
def nobody_waits() -> Iterator[None]:
    """No process of another test's is taken, none is left."""
    cancellable._waiting.clear()
    yield
    while cancellable._waiting:
        asyncio.run(cancellable._waiting.pop().end())


def _who(_: object = None, *, progress: Any) -> tuple[int, int, int]:
    """The process, how far it steps back behind others, and how soon it ends where memory does."""
    progress(0.5, "looking")
    return os.getpid(), os.nice(0), int(Path("/proc/self/oom_score_adj").read_text())


def _refuse(*, progress: Any) -> None:
    raise ValueError("not this one")


async def test_a_process_that_stayed_small_does_the_next_run_and_steps_back(monkeypatch: pytest.MonkeyPatch) -> None:
    messages: list[str] = []
    first = await run_alone(_who, progress=lambda _, what: messages.append(what))
    with pytest.raises(ValueError, match="not this one"):
        await run_alone(_refuse, progress=lambda *_: None)
    monkeypatch.setattr(cancellable, "_SMALL", 0)
    assert await run_alone(_who, progress=lambda *_: None) == first
    assert messages == ["looking"]
    assert not cancellable._waiting
    process, niceness, ends_first = first
    assert process not in [child.pid for child in multiprocessing.active_children()]
    assert niceness == min(os.nice(0) + 10, 19)
    assert ends_first == 500


def _for_an_hour(*, progress: Any) -> None:
    progress(0.0, "begun")
    time.sleep(3600)


async def test_cancelling_a_run_ends_it_at_once() -> None:
    messages: list[str] = []
    others = set(multiprocessing.active_children())
    task = asyncio.create_task(run_alone(_for_an_hour, progress=lambda _, what: messages.append(what)))
    await soon(lambda: messages, "the run in its process")
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await asyncio.wait_for(task, PATIENCE)
    assert set(multiprocessing.active_children()) <= others


async def test_what_nobody_asked_for_gives_way_to_whoever_asks() -> None:
    """A study flown ahead held the only place of two cores for minutes."""
    ahead: list[str] = []
    task = asyncio.create_task(until_asked(run_alone(_for_an_hour, progress=lambda _, what: ahead.append(what))))
    await soon(lambda: ahead, "the run ahead")
    answers = [run_alone(_who, progress=lambda *_: None) for _ in range(workers.size())]
    assert len(await asyncio.wait_for(asyncio.gather(*answers), PATIENCE)) == workers.size()
    await asyncio.wait_for(task, PATIENCE)
    with pytest.raises(ValueError, match="not this one"):
        await until_asked(run_alone(_refuse, progress=lambda *_: None))


def test_a_process_that_died_while_it_waited_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    class Gone:
        lives = False

    class New:
        lives = True

    monkeypatch.setattr(cancellable, "_Process", New)
    cancellable._waiting.append(Gone())
    assert isinstance(cancellable._take(), New)
    assert not cancellable._waiting


def _fail(*, progress: Any) -> None:
    raise KeyError('\n{"event": "login"}')


def test_a_fault_goes_to_the_log_and_none_of_its_text_anywhere(
    caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(RunLost):
        asyncio.run(run_alone(_fail, progress=lambda *_: None))
    (record,) = caplog.records
    assert record.__dict__["fields"]["exception"] == "KeyError"
    assert "_fail" in record.__dict__["fields"]["raised"][-1]
    assert "login" not in capfd.readouterr().err + str(record.__dict__)


_WARNING = """
import asyncio, warnings
from functools import partial
from app.serving.logs import set_up
from app.work import cancellable, pool, simulator

def warn(progress=None):
    warnings.warn("what a file says")

def fail():
    raise TypeError("what a file says")

simulator.warm_up = fail

async def all_three():
    await cancellable.run_alone(warn, progress=print)
    await pool.run_in_pool(warn)
    await simulator.prepare()

if __name__ == "__main__":
    pool.use(1, begin=partial(set_up, "json"))
    asyncio.run(all_three())
    pool.stop()
"""


def test_what_workers_have_to_say_goes_through_the_log(tmp_path: Path) -> None:
    script = tmp_path / "script.py"  # a file: what is spawned imports it again
    script.write_text(_WARNING, encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True, timeout=PATIENCE)
    records = [json.loads(line) for line in done.stderr.splitlines()]
    assert [(record["level"], record["event"]) for record in records] == [
        ("warning", "warning"), ("warning", "warning"), ("error", "fault in a worker")
    ]  # fmt: skip
    assert records[0]["category"] == "UserWarning"
    assert records[0]["raised"].startswith(str(script))
    assert records[2]["exception"] == "TypeError"
    assert "what a file says" not in done.stderr

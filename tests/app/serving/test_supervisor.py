"""Pages served from several processes: one server to whoever visits or stops it."""

import asyncio
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest
from open_page import Tab
from waiting import PATIENCE, soon, until

from app.cli import main
from app.serving import address, supervisor
from app.serving.address import SharedSocket
from app.serving.board import BoardRow, SharedMetrics
from app.serving.rules import Rules

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "nav_model/base/processes.py")]


def _page_processes(parent: int) -> set[int]:
    result = set()
    for child in psutil.Process(parent).children():
        with suppress(psutil.Error):  # it has just ended
            if "spawn_main" in " ".join(child.cmdline()):
                result.add(child.pid)
    return result


# The fuller of two processes leaves a visitor to the other for as long as that takes, on a busy machine as well.
_PATIENT = """
import app.serving.address
from app.cli import main
app.serving.address._STEP_BACK = app.serving.address._ANOTHER = 600.0
if __name__ == "__main__":
    raise SystemExit(main())
"""


def _ends_at_once(*_: Any) -> None:
    os._exit(7)


def _family() -> Any:
    """Of one process, which is not started yet."""
    return supervisor._Children(socket.create_server(("127.0.0.1", 0)), 0, Rules(processes=1), "")


def _rooms(served: Any) -> tuple[float, ...]:
    """Sessions of each process."""
    metrics = served.metrics()
    return tuple(metrics[f'navbudget_process_sessions{{process="{index}"}}'] for index in range(2))


@pytest.fixture(scope="module")
def pair(serving: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    folder = tmp_path_factory.mktemp("pair")
    (folder / "patient.py").write_text(_PATIENT)
    options = ("--processes", "2", "--max-sessions", "5", "--session-lifetime", "1",
               "--library", str(folder / "library.db"))  # fmt: skip
    with serving(*options, program=[str(folder / "patient.py")], log=folder / "log") as served:
        yield served
        family = _page_processes(served.process.pid)
        assert len(family) == 2
        port = served.port
    _nothing_stays(family, port)  # told by SIGTERM, and ended with 0
    assert "Traceback" not in (folder / "log").read_text()


def _nothing_stays(family: set[int], port: int) -> None:
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in family), "the end of the page processes")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port), PATIENCE)


async def test_pages_are_shared_out_and_the_limit_is_of_all_together(pair: Any) -> None:
    before = pair.metrics()
    connections = []
    for count in range(1, 6):
        connections.append(await pair.enter())
        rooms = await asyncio.to_thread(_rooms, pair)
        assert sum(rooms) == count
        assert abs(rooms[0] - rooms[1]) <= 1
    early = pair.ask("/")
    assert early[0] == 503
    assert "All places are taken" in early[1]
    await pair.hang_up(*connections)
    after = pair.metrics()
    assert after["navbudget_sessions_opened_total"] == before["navbudget_sessions_opened_total"] + 5
    assert after["navbudget_sessions_refused_total"] == before["navbudget_sessions_refused_total"] + 1
    until(lambda: sum(_rooms(pair)) == 0, "the end of closed pages")


async def test_a_killed_process_takes_its_own_pages_only_and_another_takes_its_place(pair: Any) -> None:
    tabs = [await Tab.open(pair.address) for _ in range(2)]
    assert await asyncio.to_thread(_rooms, pair) == (1, 1)
    family = _page_processes(pair.process.pid)
    assert len(family) == 2
    os.kill(min(family), signal.SIGKILL)
    await soon(lambda: any(tab.errors for tab in tabs), "word of the killed process's page")
    (survivor,) = [tab for tab in tabs if not tab.errors]
    answered = survivor.expect({(await survivor.until(name="timelines"))["id"]})
    await survivor.slide("imu.angle_random_walk", -4.0)
    await asyncio.wait_for(answered, PATIENCE)
    await soon(lambda: len(_page_processes(pair.process.pid) - {min(family)}) == 2, "another in its place")
    assert pair.ask("/liveness")[0] == 200
    for tab in tabs:
        with suppress(OSError):
            await tab.close()
    until(lambda: sum(_rooms(pair)) == 0, "the end of closed pages")
    for tab in [await Tab.open(pair.address) for _ in range(2)]:
        assert not tab.errors
        await tab.close()
    until(lambda: sum(_rooms(pair)) == 0, "the end of the pages of those who came after")


@pytest.mark.parametrize("number", [signal.SIGKILL, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_when_it_ends_nothing_of_it_stays(number: signal.Signals) -> None:
    command = [sys.executable, "-m", "app", "serve", "--port", "0", "--processes", "2", "--grace", "0"]
    with ExitStack() as cleanup:
        process = cleanup.enter_context(
            subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        )
        cleanup.callback(process.kill)
        port = int(process.stdout.readline().rpartition(":")[2])
        family = _page_processes(process.pid)
        assert len(family) == 2
        process.send_signal(number)
        assert process.wait(PATIENCE) == (-signal.SIGKILL if number == signal.SIGKILL else 0)
        _nothing_stays(family, port)
        assert "Traceback" not in process.stderr.read()


def test_a_signal_while_a_process_is_started_stops_that_one_too(monkeypatch: pytest.MonkeyPatch) -> None:
    family = _family()
    started: list[subprocess.Popen[bytes]] = []

    class Starting:
        """Told to stop in the midst of its start."""

        exitcode = None

        def __init__(self, **_: Any) -> None:
            self.pid: int | None = None

        def start(self) -> None:
            family.on_signal()
            assert family.listening.fileno() >= 0
            started.append(subprocess.Popen(["sleep", "600"]))
            self.pid = started[0].pid

    monkeypatch.setattr(multiprocessing.get_context("spawn"), "Process", Starting)
    family.start(0)
    assert started[0].wait(PATIENCE) == -signal.SIGTERM
    assert family.listening.fileno() < 0


def test_a_taken_port_is_told_before_anything_starts(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert main(["serve", "--processes", "2", "--port", str(taken.getsockname()[1])]) == 2
    assert "--port: cannot listen on 127.0.0.1:" in capsys.readouterr().err


def test_a_person_alone_has_one_process_and_a_team_one_per_core(monkeypatch: pytest.MonkeyPatch) -> None:
    for cores, team in ((1, 1), (2, 2), (4, 4), (32, 4)):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        assert Rules().page_processes == 1
        assert Rules(open=True).page_processes == team
        assert Rules(password_file=Path("people")).page_processes == team
    assert Rules(open=True, processes=1).page_processes == 1
    assert Rules(processes=7).page_processes == 7


@pytest.mark.parametrize("other_is_busy", [False, True])
def test_the_fuller_process_lets_the_other_go_first_but_nobody_waits_long(
    other_is_busy: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [0.0]
    monkeypatch.setattr(address, "time", SimpleNamespace(monotonic=lambda: now[0]))
    board = SharedMetrics(2)
    for process, sessions in ((0, 3), (1, 2)):
        board.put(process, "ready", 1)
        board.put(process, "sessions", sessions)
    listening = socket.create_server(("127.0.0.1", 0))
    with (
        SharedSocket(listening.dup(), BoardRow(board, 1)) as emptier,
        SharedSocket(listening, BoardRow(board, 0)) as fuller,
        socket.create_connection(fuller.getsockname()),
    ):
        with pytest.raises(BlockingIOError):
            fuller.accept()
        if not other_is_busy:
            emptier.accept()[0].close()
            return
        now[0] = 0.014
        with pytest.raises(BlockingIOError):
            fuller.accept()
        now[0] = 0.016
        fuller.accept()[0].close()


def test_a_process_that_ends_is_started_later_each_time_and_in_the_end_not_at_all() -> None:
    limit, now, pauses = supervisor.RestartLimit(), 0.0, []
    limit.started(now)
    while limit.fell(now := now + 5.0):
        pauses.append(limit.due - now)
        limit.started(now := limit.due)
    assert pauses == [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0]
    limit = supervisor.RestartLimit()
    for _ in range(100):  # each has run for an hour
        limit.started(now)
        now += 3600.0
        assert limit.fell(now)
        assert limit.due == now + 1.0


def test_processes_that_end_at_once_again_and_again_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(supervisor, "_PAUSE", 0.001)
    monkeypatch.setattr(supervisor, "_serve_pages", _ends_at_once)
    family = _family()
    family.start(0)
    family.keep()
    assert family.end() == 1
    assert family.board.total("restarts") == supervisor._MOST_ENDS - 1


def test_one_that_ends_just_after_it_was_looked_at_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(supervisor, "_PAUSE", 0.001)
    monkeypatch.setattr(supervisor, "_MOST_ENDS", 2)
    monkeypatch.setattr(supervisor, "_serve_pages", _ends_at_once)
    family = _family()
    family.start(0)
    member, looks = family.members[0], iter([None])
    member.join()
    # The first look still finds it alive, every later one finds it ended.
    late = type(
        "Late", (), {"exitcode": property(lambda _: next(looks, member.exitcode)), "sentinel": member.sentinel}
    )
    family.members[0] = late()
    wait = supervisor.wait

    def bounded(watched: list[Any], timeout: float | None = None) -> list[Any]:
        assert watched or timeout is not None, "waits for ever"
        return wait(watched, PATIENCE if timeout is None else timeout)

    monkeypatch.setattr(supervisor, "wait", bounded)
    family.keep()
    assert family.end() == 1
    assert family.board.total("restarts") == 1


def test_what_a_process_counted_outlives_it() -> None:
    board = SharedMetrics(2)
    row = BoardRow(board, 1)
    row.add("opened")
    row.add("opened")
    row.put("sessions", 2)
    BoardRow(board, 0).add("opened")
    board.clear(1)
    assert board.total("opened") == 3
    assert board.total("sessions") == 0

"""Runs: how far they are, how they end, and that the newest wins."""

import asyncio
from typing import Any

import pytest
from pages import when_done

from app.session import Session
from app.ui.run_bar import RunBar, progress_html
from app.work.run import Clock, Progress, Run
from nav_model.base.errors import InputError
from nav_model.design import Design


def to_the_end(run: Run, work: Any) -> None:
    when_done(lambda: run.start(work))


def test_the_time_left_is_the_time_spent_over_the_share_done():
    now = [100.0]
    clock = Clock(lambda: now[0])
    assert clock.progress("compiling") == Progress("compiling", None, None)
    now[0] += 30.0  # preparing says nothing of the pace
    assert clock.progress("flying", 0.0).remaining_s is None
    now[0] += 4.0
    assert clock.progress("flying", 0.25) == Progress("flying", 0.25, pytest.approx(12.0))
    now[0] += 12.0
    assert clock.progress("flying", 1.0).remaining_s is None
    assert clock.progress("flying", 0.001).remaining_s is None


def test_progress_in_words_and_as_a_bar():
    assert Progress("reading a.csv").words == "reading a.csv"
    assert Progress("gyro_z", 0.5, 3.6).words == "gyro_z, about 4 s left"
    assert "value=" not in progress_html(Progress("reading"))
    assert 'value="0.500"' in progress_html(Progress("gyro_z", 0.5, 4.0))
    assert "&lt;b&gt;" in progress_html(Progress("<b>", 0.5))


def test_a_run_tells_shows_and_ends_with_its_result():
    seen: list[tuple[bool, object, object]] = []
    run = Run()
    run.param.watch(lambda *_: seen.append((run.running, run.progress and run.progress.what, run.result)),
                    ["running", "progress", "result"])  # fmt: skip

    async def work(run: Run) -> str:
        run.tell("half", 0.5)
        run.show("partial")
        return "whole"

    to_the_end(run, work)
    assert seen == [(True, None, None), (True, "half", None), (True, "half", "partial"), (False, None, "whole")]
    assert run.message == ""


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (InputError("gyro", "is not there"), "gyro: is not there"),
        (InputError("trajectory.waypoints", "are too near"), "Waypoints: are too near"),  # as the page names them
        (InputError("trajectory.waypoints[2].latitude", "is wrong"), "Waypoints, row 2, latitude: is wrong"),
        (ValueError("wrong"), "wrong"),
        (ZeroDivisionError("none"), "none"),
    ],
)
def test_what_is_refused_becomes_the_message_and_keeps_the_last_result(error: Exception, message: str):
    run = Run(result="last")

    async def work(_: Run) -> None:
        raise error

    to_the_end(run, work)
    assert (run.running, run.progress, run.result, run.message) == (False, None, "last", message)


def test_a_fault_of_ours_ends_the_run_and_is_not_swallowed():
    run = Run()

    async def work(_: Run) -> None:
        raise KeyError("ours")

    with pytest.raises(KeyError):
        to_the_end(run, work)
    assert not run.running


async def test_the_newest_run_wins_and_a_cancelled_one_says_how_far_it_was():
    run = Run()
    calls = []

    async def endless(run: Run) -> None:
        calls.append(1)
        run.tell("3 of 9 runs", 1 / 3)
        await asyncio.Event().wait()

    async def short(_: Run) -> str:
        return "second"

    first = run.start(endless)
    while not calls:
        await asyncio.sleep(0)
    second = run.start(short)
    await asyncio.wait({first, second})
    assert (run.result, run.running, run.message) == ("second", False, "")
    third = run.start(endless)
    while len(calls) < 2:
        await asyncio.sleep(0)
    run.cancel()
    await third
    assert (run.result, run.running, run.message) == ("second", False, "Cancelled: 3 of 9 runs.")


async def test_a_session_is_busy_while_any_of_its_runs_is_and_ends_them_when_it_closes():
    session = Session(Design())
    runs = [session.new_run(), session.new_run()]

    async def endless(_: Run) -> None:
        await asyncio.Event().wait()

    tasks = [run.start(endless) for run in runs]
    await asyncio.sleep(0)
    runs[0].cancel()
    await tasks[0]
    assert session.running
    heard: list[str] = []
    runs[1].param.watch(lambda event: heard.append(event.name), ["running", "progress", "result", "message"])
    session.close()
    await tasks[1]
    assert not heard, "what the page showed is gone"


def test_the_bar_follows_its_run():
    run = Run()
    bar = RunBar(run, lambda: None, "Start")
    assert bar.cancel.disabled
    run.param.update(running=True, progress=Progress("4 of 8 runs", 0.5, 2.0))
    assert not bar.cancel.disabled
    assert "4 of 8 runs, about 2 s left" in bar.state.object
    run.param.update(running=False, progress=None, message="gyro: <is> not there")
    assert 'role="alert"' in bar.state.object
    assert "&lt;is&gt;" in bar.state.object

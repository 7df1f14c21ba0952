"""Many people at once on one server: how long a slider step takes for each, and what a session costs.

    python benchmarks/load.py                       # 50 sessions, 60 s, then 60 s more with a Monte Carlo in one more
    python benchmarks/load.py --sessions 10 --seconds 15
    python benchmarks/load.py --processes 1         # pages served by one; without it by as many as a team gets

It starts `navbudget serve` and speaks to it as a browser does: the page, its websocket with Bokeh's protocol, the
whole document, "document ready"; then every session moves the slider of the angle random walk once a second, evenly
spread over the second, sending what a key press in chromium sends. A step is answered when the new data of the
charts have arrived. A step that could not be sent on time because the one before was still unanswered counts from
the time it was due. What a browser does besides, fetching scripts and echoing sizes and theme colours when a page
opens, is left out.

This process is all the visitors; it only looks for names in what arrives. On two cores it takes a share that real
visitors' machines would not: its CPU time is printed. Wall-clock figures mean something on a quiet machine only.

Exit status: 0 if every goal holds, 1 if one is missed.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import psutil
from open_page import Tab

from app.serving.rules import Rules

GOAL_P95_MS = 250.0
GOAL_SHIFT_MS = 50.0
GOAL_SESSION_MB = 25.0
_PERIOD = 1.0  # seconds between two steps of a session
_PATIENCE = 20.0  # seconds after which a step without an answer is an error
_SLIDER = "Angle random walk"
_STEP = 0.02  # of that slider
_DATA = ("timelines", "response lines 0")  # names of the data a step must change
_RUNS = "500"  # of each Monte Carlo


@dataclass
class Phase:
    """What was measured while everybody moved: times of steps in ms, CPU times in s, resident memory in MB."""

    name: str
    steps: list[float] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    server_cpu: float = 0.0
    workers_cpu: float = 0.0
    client_cpu: float = 0.0
    resident: float = 0.0

    def p95(self) -> float:
        """The 95th percentile of the steps."""
        return percentile(self.steps, 0.95)


@dataclass
class Report:
    """A whole measurement; memory in MB, CPU time in s."""

    sessions: int
    base: float = 0.0
    opened: float = 0.0
    open_cpu: float = 0.0
    phases: list[Phase] = field(default_factory=list)


def percentile(values: list[float], share: float) -> float:
    """The smallest value that at least this share of them does not exceed; NaN of nothing."""
    ordered = sorted(values)
    return ordered[max(0, -(-round(share * 1000) * len(ordered) // 1000) - 1)] if ordered else float("nan")


async def measure(address: str, server: Server, sessions: int, seconds: float, monte_carlo: bool) -> Report:
    """Open the pages, move everybody's slider, and once more while a Monte Carlo runs in one session more."""
    for _ in range(1 if server.processes == 1 else 3 * server.processes):
        first = await _visit(address)  # what is loaded with the first page is not a session's
        await first.close()
    report = Report(sessions, base=server.resident())
    before = server.cpu()
    tabs = [await _visit(address) for _ in range(sessions)]
    report.open_cpu, report.opened = (server.cpu() - before) / sessions, server.resident()
    report.phases.append(await _phase("quiet", tabs, server, seconds))
    if monte_carlo:
        flier, over = await Tab.open(address), asyncio.Event()
        flying = asyncio.create_task(_fly(flier, over))
        given_up = time.monotonic() + 120
        while server.workers_cpu() < 4 and time.monotonic() < given_up:  # the worker is up, its kernels loaded
            await asyncio.sleep(1)
        report.phases.append(await _phase("during a Monte Carlo", tabs, server, seconds))
        over.set()
        await flying
        report.phases[-1].errors += flier.errors
        await flier.close()
    for tab in tabs:
        await tab.close()
    return report


async def _visit(address: str) -> Tab:
    """An open page with everything that a step changes on it."""
    tab = await Tab.open(address)
    for name in _DATA:
        await tab.until(name=name)
    return tab


async def _phase(name: str, tabs: list[Tab], server: Server, seconds: float) -> Phase:
    phase = Phase(name)
    own, cpu, others, begin = time.process_time(), server.cpu(), server.workers_cpu(), time.monotonic() + 0.5
    shift = _PERIOD / len(tabs)
    await asyncio.gather(*(_move(tab, begin + i * shift, begin + seconds, phase) for i, tab in enumerate(tabs)))
    phase.client_cpu, phase.server_cpu = time.process_time() - own, server.cpu() - cpu
    phase.workers_cpu, phase.resident = server.workers_cpu() - others, server.resident()
    for tab in tabs:
        phase.errors += tab.errors
        tab.errors.clear()
    return phase


async def _move(tab: Tab, begin: float, end: float, phase: Phase) -> None:
    """A slider step a second, there and back, on a fixed schedule."""
    slider = tab.find(name=_SLIDER, label=_SLIDER, show_value=False)
    data = {tab.find(name=name)["id"] for name in _DATA}
    start, steps = slider["attributes"]["value"], 0
    while (due := begin + steps * _PERIOD) < end:
        await asyncio.sleep(max(0.0, due - time.monotonic()))
        steps += 1
        value = start - _STEP * (1 + steps % 10)
        answered = tab.expect(data)
        await tab.set(slider["id"], value=value, value_throttled=value)
        try:
            await asyncio.wait_for(answered, _PATIENCE)
        except TimeoutError:
            phase.errors.append(f"no answer within {_PATIENCE:g} s")
            return
        phase.steps.append(1000 * (time.monotonic() - due))


async def _fly(tab: Tab, over: asyncio.Event) -> None:
    """Keep a Monte Carlo under way: press Start again and again, which does nothing while one is flown.

    The document is taken once only: to answer that costs the server as much as a page.
    """
    await tab.turn("Simulate")
    await tab.set((await tab.until(label="Runs"))["id"], value=_RUNS)
    start = tab.find(label="Start", icon="play_arrow")["id"]
    while not over.is_set():
        await tab.click(start)
        await asyncio.sleep(2)
    await tab.click(tab.find(label="Cancel", icon="stop")["id"])


@dataclass(frozen=True)
class Server:
    """`navbudget serve`: the process that was started, and how many it was to serve pages from."""

    process: psutil.Process
    processes: int

    def pages(self) -> list[psutil.Process]:
        """The processes that serve pages: itself, or those it started."""
        return [self.process] if self.processes == 1 else self.process.children()

    def cpu(self) -> float:
        """CPU time of the processes that serve pages."""
        return sum(_cpu(process) for process in self.pages())

    def workers_cpu(self) -> float:
        """CPU time of the processes for heavy work, which those started."""
        return sum(_cpu(child) for process in self.pages() for child in process.children())

    def resident(self) -> float:
        """Memory of the processes that serve pages."""
        return sum(process.memory_info().rss / 1e6 for process in self.pages())


@contextmanager
def served(folder: Path, processes: int = 1) -> Iterator[tuple[str, Server]]:
    """`navbudget serve` with its library and its log in a folder: the address and the server."""
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--library", str(folder / "library.db"),
               "--max-sessions", "1000", "--processes", str(processes)]  # fmt: skip
    with (
        (folder / "log").open("w") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as process,
    ):
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("NavBudget on http://"), line
        try:
            yield line.split()[-1], Server(psutil.Process(process.pid), processes)
        finally:
            process.terminate()
            process.wait(timeout=30)


def _cpu(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def judge(report: Report, log: list[str]) -> list[str]:
    """Print what was measured; comes back with the goals that do not hold."""
    missed = []
    for phase in report.phases:
        count = len(phase.steps)
        print(
            f"{phase.name}: {count} steps, {len(phase.errors)} errors; step to new data of three charts median "
            f"{percentile(phase.steps, 0.5):.0f}, p95 {phase.p95():.0f}, longest {max(phase.steps, default=0):.0f} "
            f"ms\n  CPU a step: server {1000 * phase.server_cpu / count:.1f}, visitors "
            f"{1000 * phase.client_cpu / count:.1f} ms; workers {phase.workers_cpu:.1f} s; "
            f"server resident {phase.resident:.0f} MB"
        )
        for error in sorted(set(phase.errors)):
            print(f"  error: {error[:300]}")
        if phase.errors:
            missed.append(f"{phase.name}: {len(phase.errors)} errors")
        if not phase.p95() < GOAL_P95_MS:
            missed.append(f"{phase.name}: p95 {phase.p95():.0f} ms, goal {GOAL_P95_MS:g}")
    peak = max(phase.resident for phase in report.phases)
    opened, used = ((mb - report.base) / report.sessions for mb in (report.opened, peak))
    print(
        f"a session: {report.open_cpu:.2f} s of server CPU to open, {opened:.1f} MB once open, {used:.1f} MB after "
        f"use (server without one: {report.base:.0f} MB)"
    )
    if used >= GOAL_SESSION_MB:
        missed.append(f"{used:.1f} MB a session, goal {GOAL_SESSION_MB:g}")
    if len(report.phases) > 1:
        shift = report.phases[1].p95() - report.phases[0].p95()
        print(f"Monte Carlos of {_RUNS} runs, one after the other in one more session, move p95 by {shift:+.0f} ms")
        if report.phases[1].workers_cpu == 0:
            missed.append("the Monte Carlo did not run")
        if shift > GOAL_SHIFT_MS:
            missed.append(f"p95 moved by {shift:.0f} ms, goal {GOAL_SHIFT_MS:g}")
    if log:
        print(f"the server wrote {len(log)} lines to standard error, the first: {log[0][:300]}")
        missed.append("the server's log is not empty")
    print("MISSED: " + "; ".join(missed) if missed else "every goal holds")
    return missed


def main() -> int:
    """Measure, print, judge."""
    options = argparse.ArgumentParser(description="Load test of navbudget serve")
    options.add_argument("--sessions", type=int, default=50)
    options.add_argument("--seconds", type=float, default=60.0)
    of_a_team = Rules(open=True).page_processes
    options.add_argument("--processes", type=int, default=of_a_team, help=f"that serve pages ({of_a_team})")
    options.add_argument("--no-monte-carlo", action="store_true")
    given = options.parse_args()
    busy = ", ".join(f"{x:.2f}" for x in os.getloadavg())
    print(
        f"{os.cpu_count()} cores, load before: {busy}; pages served by {given.processes}; {given.sessions} sessions, "
        f"{given.seconds:g} s",
        flush=True,
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with served(folder, given.processes) as (address, server):
            work = measure(address, server, given.sessions, given.seconds, not given.no_monte_carlo)
            report = asyncio.run(work)
        log = [line for line in (folder / "log").read_text().splitlines() if line.strip()]
    return 1 if judge(report, log) else 0


if __name__ == "__main__":
    sys.exit(main())

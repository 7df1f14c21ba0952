"""Many people at once on one server: what the machine can do, and how long a slider's step takes at shares of that.

    python benchmarks/load.py                       # 20 pages, 20 s a phase
    python benchmarks/load.py --sessions 10 --seconds 8
    python benchmarks/load.py --processes 1         # pages served by one; without it by as many as a team gets

It starts `navbudget serve` and speaks to it as a browser does: the page, its websocket with Bokeh's protocol, the
whole document, "document ready". First it says what a step costs and how many steps a second the server answers when
each page sends the next as soon as the last is answered: the capacity. Then all pages together send at half, at nine
tenths of and at twice the capacity on a fixed schedule, answered or not, and a step a second each, alone and while a
Monte Carlo is flown beside them. (A share of the capacity would not do there: that is what both cores can answer, of
which the Monte Carlo has one.) The wait of a step ends when its figures or newer ones have arrived. The same driver
moves one bare page of the same framework (`bare_page.py`), for ratios that hold on other machines too.

This process is all the visitors. On two cores it takes a share that real visitors' machines would not: its CPU time
is printed. Wall-clock figures mean something on a quiet machine only.

Exit status: 0 if every goal holds, 1 if one is missed.
"""

from __future__ import annotations

import argparse
import asyncio
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import bare_page
import psutil
from open_page import Tab

from app.serving.rules import Rules

GOALS_MS = {0.5: 100.0, 0.9: 250.0, 2.0: 500.0}
"""Share of the capacity -> the 95th percentile that is to be kept."""
GOAL_SHIFT_MS = 50.0
GOAL_SESSION_MB = 8.0
_PATIENCE = 30.0  # seconds after which a step without an answer is an error
_STEP = 0.02  # of the slider
_PLACES = 40  # of the slider, one after the other
_RUNS = "500"  # of each Monte Carlo
_ALONE = 60  # steps of one page by itself


@dataclass(frozen=True)
class Kind:
    """A page that can be driven: its slider, the data that a step changes, and where a change says its place."""

    command: tuple[str, ...]
    slider: str
    data: tuple[str, ...]
    place: re.Pattern[str]
    options: tuple[str, ...] = ()


PRODUCT = Kind(
    ("-m", "app", "serve", "--port", "0", "--max-sessions", "1000"),
    "imu.angle_random_walk", ("timelines", "response lines 0"),
    re.compile(r'"imu.angle_random_walk",{"type":"map","entries":\[\["text","([\d.e-]+) '),
)  # fmt: skip
BARE = Kind(
    (str(Path(bare_page.__file__)),), bare_page.SLIDER, bare_page.DATA, re.compile(r"moved ([\d.e-]+)")
)  # fmt: skip


class Visitor(Tab):
    """A page with a slider, and the steps that it waits for."""

    async def _stand(self) -> None:
        pass

    async def settle(self, kind: Kind) -> None:
        """Wait until the page has all that a step changes."""
        await self._arrived(set(kind.data) - {model["attributes"].get("name") for model in self.objects})
        self.kind = kind
        if kind is PRODUCT:
            self.start = float(self.row(kind.slider)[1]["place"])
        else:
            self.slider = await self.until(name=kind.slider, label=kind.slider, show_value=False)
            self.start = float(self.slider["attributes"]["value"])
        self.waits: list[float] = []
        self.due: deque[tuple[float, float]] = deque()  # place of the slider, when it was due
        self.rested = asyncio.Event()
        self.number = math.nan  # that was shown last
        self.sending = False  # a place that has not been answered
        self.newest: float | None = None  # the place that is sent when it has
        self.steps = 0
        self.heard = self._hear

    async def _arrived(self, late: set[str]) -> None:
        """Wait for the models of these names, which come after the document: a browser asks for that only once."""
        there = asyncio.Event()

        def hear(content: str) -> None:
            late.difference_update([name for name in late if f'"name":"{name}"' in content])
            if not late:
                there.set()

        self.heard = hear
        hear("")
        await asyncio.wait_for(there.wait(), 120)

    async def press(self, due: float) -> None:
        """Move the slider to the next place: the browser sends the newest when the last has been answered."""
        self.steps += 1
        place = self.start - _STEP * (1 + self.steps % _PLACES)
        self.due.append((place, due))
        self.rested.clear()
        if self.kind is BARE:
            await self.set(self.slider["id"], value=place, value_throttled=place)
        elif self.sending:
            self.newest = place
        else:
            await self._send(place)

    async def _send(self, place: float) -> None:
        self.sending, self.newest = True, None
        await self.slide(self.kind.slider, place)

    def _hear(self, content: str) -> None:
        """A change of the figures: it ends the wait of its step and of those before."""
        match = self.kind.place.search(content)
        if match is not None:
            self.number = float(match[1])
        elif '"attr":"heard"' not in content:  # the answer to a place that shows what was shown
            return
        now = time.monotonic()
        due_here = [index for index, (place, _) in enumerate(self.due) if self._is(self.number, place)]
        for _ in range(due_here[-1] + 1 if due_here else 0):
            self.waits.append(1000 * (now - self.due.popleft()[1]))
        if not self.due:
            self.rested.set()
        self.sending = False
        if self.newest is not None:
            self.next = asyncio.ensure_future(self._send(self.newest))

    def _is(self, number: float, place: float) -> bool:
        if self.kind is BARE:
            return abs(number - place) < _STEP / 2
        # The slider's decades, rad/√s, against °/√h with three digits: steps are 4.7 % apart.
        return abs(number / (10**place * 57.29578 * 60) - 1) < 0.02

    async def rest(self, errors: list[str]) -> None:
        """Wait for the last answer."""
        with suppress(TimeoutError):
            await asyncio.wait_for(self.rested.wait(), _PATIENCE)
            return
        errors.append(f"stale at rest: {len(self.due)} steps without an answer within {_PATIENCE:g} s")
        self.due.clear()


@dataclass
class Phase:
    """Measurements while everybody moved: waits in ms, CPU times in s, resident memory in MB."""

    name: str
    rate: float = 0.0
    waits: list[float] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    seconds: float = 0.0
    server_cpu: float = 0.0
    workers_cpu: float = 0.0
    client_cpu: float = 0.0

    def p95(self) -> float:
        """The 95th percentile of the waits."""
        return percentile(self.waits, 0.95)

    def row(self) -> str:
        """A line of the table."""
        return (
            f"{self.name:<32}{self.rate:>9.1f}{len(self.waits):>8}{percentile(self.waits, 0.5):>9.0f}"
            f"{self.p95():>8.0f}{max(self.waits, default=0):>9.0f}{len(self.errors):>8}"
            f"{self.server_cpu / self.seconds:>9.2f}{self.client_cpu / self.seconds:>9.2f}"
        )


@dataclass
class Report:
    """A whole measurement; memory in MB, CPU time in s."""

    open_cpu: float = 0.0
    step_cpu: float = 0.0
    capacity: float = 0.0
    session: float = 0.0
    phases: list[Phase] = field(default_factory=list)


def percentile(values: list[float], share: float) -> float:
    """The smallest value that at least this share of them does not exceed; NaN of nothing."""
    ordered = sorted(values)
    return ordered[max(0, -(-round(share * 1000) * len(ordered) // 1000) - 1)] if ordered else float("nan")


async def measure(address: str, server: Server, kind: Kind, sessions: int, seconds: float, whole: bool) -> Report:
    """Cost of a page to open and to move, and the capacity; if `whole`, also the phases at shares of it."""
    for _ in range(3 * server.processes):  # what is loaded with the first page and its first steps is not a session's
        first = await _visit(address, kind)
        await _one_after_another(first, 10, Phase("first"))
        await first.close()
    report, base, before = Report(), server.resident(), server.cpu()
    tabs = [await _visit(address, kind) for _ in range(sessions)]
    await asyncio.sleep(1)  # what follows the first screen
    report.open_cpu = (server.cpu() - before) / sessions
    alone = Phase("alone")
    await _one_after_another(tabs[0], 10, alone)
    before = server.cpu()
    await _one_after_another(tabs[0], _ALONE, alone)
    report.step_cpu = (server.cpu() - before) / _ALONE
    full = await _phase("as fast as answered", tabs, server, None, seconds)
    report.phases.append(full)
    report.capacity = full.rate
    if whole:
        for share in GOALS_MS:
            phase = await _phase(f"{share:g} of the capacity", tabs, server, share * report.capacity, seconds)
            report.phases.append(phase)
        report.session = (server.resident() - base) / sessions
        report.phases.append(await _phase("a step a second each", tabs, server, sessions, seconds))
        report.phases.append(await _beside_monte_carlo(address, tabs, server, sessions, seconds))
    for tab in tabs:
        await tab.close()
    return report


async def _visit(address: str, kind: Kind) -> Visitor:
    tab = await Visitor.open(address)
    assert isinstance(tab, Visitor)
    await tab.settle(kind)
    return tab


async def _one_after_another(tab: Visitor, count: int, phase: Phase) -> None:
    for _ in range(count):
        await tab.press(time.monotonic())
        await tab.rest(phase.errors)
        if phase.errors:
            raise SystemExit(f"a step of one page alone: {phase.errors[0]}")


async def _phase(name: str, tabs: Sequence[Visitor], server: Server, rate: float | None, seconds: float) -> Phase:
    """Everybody moves: so many steps a second in all, or each as soon as the last is answered."""
    phase = Phase(name)
    for tab in tabs:
        tab.waits.clear()
    own_cpu, cpu, others = time.process_time(), server.cpu(), server.workers_cpu()
    begin = time.monotonic()
    end = begin + seconds

    async def answered(tab: Visitor) -> None:
        while time.monotonic() < end:
            await tab.press(time.monotonic())
            await tab.rest(phase.errors)

    async def scheduled(tab: Visitor, first: float, period: float) -> None:
        due = first
        while due < end:
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            await tab.press(due)
            due += period

    if rate is None:
        await asyncio.gather(*map(answered, tabs))
    else:
        each = len(tabs) / rate
        await asyncio.gather(*(scheduled(tab, begin + i / rate, each) for i, tab in enumerate(tabs)))
    phase.seconds = time.monotonic() - begin
    phase.client_cpu, phase.server_cpu = time.process_time() - own_cpu, server.cpu() - cpu
    phase.workers_cpu = server.workers_cpu() - others
    for tab in tabs:
        await tab.rest(phase.errors)
        phase.waits += tab.waits
        phase.errors += tab.errors
        tab.errors.clear()
    phase.rate = len(phase.waits) / phase.seconds
    return phase


async def _beside_monte_carlo(
    address: str, tabs: Sequence[Visitor], server: Server, rate: float, seconds: float
) -> Phase:
    flier, over = await _visit(address, PRODUCT), asyncio.Event()
    flying = asyncio.create_task(_fly_tab(flier, over))
    given_up = time.monotonic() + 120
    while server.workers_cpu() < 4 and time.monotonic() < given_up:  # the worker is up, its kernels loaded
        await asyncio.sleep(1)
    phase = await _phase("the same beside a Monte Carlo", tabs, server, rate, seconds)
    over.set()
    await flying
    phase.errors += flier.errors
    await flier.close()
    return phase


async def _fly_tab(tab: Tab, over: asyncio.Event) -> None:
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
    """A server: the process that was started, and how many it was to serve pages from."""

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
def served(kind: Kind, log: Path, processes: int = 1, options: Sequence[str] = ()) -> Iterator[tuple[str, Server]]:
    """A server of that kind, whose standard error goes into a file: the address and the server."""
    with (
        log.open("w") as errors,
        subprocess.Popen(
            [sys.executable, *kind.command, *options], stdout=subprocess.PIPE, stderr=errors, text=True
        ) as process,
    ):
        assert process.stdout is not None
        line = process.stdout.readline()
        assert " on http://" in line, line
        try:
            yield line.split()[-1], Server(psutil.Process(process.pid), processes)
        finally:
            process.terminate()
            process.wait(timeout=30)


def _cpu(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def judge(report: Report, bare: Report, log: list[str]) -> list[str]:
    """Print what was measured; comes back with the goals that do not hold."""
    print("\nthis machine                          product     bare    ratio")
    for name, ours, theirs in (
        ("server CPU of a step [ms]", 1000 * report.step_cpu, 1000 * bare.step_cpu),
        ("server CPU of opening a page [s]", report.open_cpu, bare.open_cpu),
        ("capacity [steps/s]", report.capacity, bare.capacity),
    ):
        print(f"{name:<36}{ours:>9.2f}{theirs:>9.2f}{ours / theirs if theirs else float('nan'):>9.2f}")
    print(f"{'memory a session, after use [MB]':<36}{report.session:>9.2f}")
    print(
        "\nwaits in ms                     answered/s   steps   median     p95  longest  errors  CPU: server visitors"
    )
    for phase in report.phases:
        print(phase.row())
        for error in sorted(set(phase.errors)):
            print(f"  error: {error[:300]}")
    _, *shares, alone, flown = report.phases
    missed = [f"{phase.name}: {len(phase.errors)} errors" for phase in report.phases if phase.errors]
    for phase, (share, goal) in zip(shares, GOALS_MS.items(), strict=True):
        if not phase.p95() < goal:
            missed.append(f"p95 at {share:g} of the capacity is {phase.p95():.0f} ms, goal {goal:g}")
    shift = flown.p95() - alone.p95()
    print(f"\nMonte Carlos of {_RUNS} runs, one after the other, move p95 by {shift:+.0f} ms")
    if flown.workers_cpu == 0:
        missed.append("the Monte Carlo did not run")
    if not shift <= GOAL_SHIFT_MS:
        missed.append(f"a Monte Carlo moves p95 by {shift:.0f} ms, goal {GOAL_SHIFT_MS:g}")
    if report.session >= GOAL_SESSION_MB:
        missed.append(f"{report.session:.1f} MB a session, goal {GOAL_SESSION_MB:g}")
    if log:
        missed.append(f"the server wrote {len(log)} lines to standard error, the first: {log[0][:300]}")
    print("MISSED: " + "; ".join(missed) if missed else "every goal holds")
    return missed


def main() -> int:
    """Measure, print, judge."""
    options = argparse.ArgumentParser(description="Load test of navbudget serve")
    options.add_argument("--sessions", type=int, default=20)
    options.add_argument("--seconds", type=float, default=20.0)
    of_a_team = Rules(open=True).page_processes
    options.add_argument("--processes", type=int, default=of_a_team, help=f"that serve pages ({of_a_team})")
    given = options.parse_args()
    busy = ", ".join(f"{x:.2f}" for x in os.getloadavg())
    print(f"{os.cpu_count()} cores, load before: {busy}; pages served by {given.processes}", end="; ")
    print(f"{given.sessions} sessions, {given.seconds:g} s a phase", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with served(BARE, folder / "bare") as (address, server):
            bare = asyncio.run(measure(address, server, BARE, 1, given.seconds, whole=False))
        more = ("--library", str(folder / "library.db"), "--processes", str(given.processes))
        with served(PRODUCT, folder / "log", given.processes, more) as (address, server):
            report = asyncio.run(measure(address, server, PRODUCT, given.sessions, given.seconds, whole=True))
        log = [line for line in (folder / "log").read_text().splitlines() if line.strip()]
    return 1 if judge(report, bare, log) else 0


if __name__ == "__main__":
    sys.exit(main())

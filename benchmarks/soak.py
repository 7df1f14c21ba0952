"""Pages opened, used and closed for a long time: what stays of them in a server's memory.

    python benchmarks/soak.py                 # 300 pages
    python benchmarks/soak.py --pages 40

Each page is opened as a browser does, goes through every tab, moves a slider and is closed; every other one loses its
connection before that, each at another stage. The server frees pages by itself: nothing here has it collect garbage.
The first third is to warm up: caches fill, and memory reaches what the largest moment needs. The goal is for the
growth over the rest.

Exit status: 0 if the goal holds, 1 if it is missed.
"""

import argparse
import asyncio
import json
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from open_page import Tab

from app.subjects import SUBJECTS

GOAL_MB = 0.2
_SERVER = Path(__file__).parents[1] / "tests" / "support" / "counted_server.py"


@dataclass(frozen=True)
class Left:
    """Pages that live, and resident memory [MB]."""

    frames: int
    resident: float


@contextmanager
def counted_server(folder: Path) -> Iterator[tuple[str, Callable[[], Left]]]:
    """The address of a server, and what is left in its memory once closed pages have been freed."""
    log = folder / "told"
    command = [sys.executable, str(_SERVER), "serve", "--port", "0", "--session-lifetime", "1",
               "--library", str(folder / "library.db"), str(log)]  # fmt: skip
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]

        def look() -> Left:
            log.unlink(missing_ok=True)
            process.send_signal(signal.SIGUSR1)
            while not log.exists():
                time.sleep(0.05)
            return Left(**json.loads(log.read_text()))

        def remaining() -> Left:
            deadline = time.monotonic() + 120
            while (counts := look()).frames and time.monotonic() < deadline:
                time.sleep(0.5)
            return counts

        try:
            yield address, remaining
        finally:
            process.terminate()
            process.wait(timeout=60)


_SLIDER = "imu.angle_random_walk"


async def _life(address: str) -> AsyncIterator[Tab | None]:
    """A page from its first request on, as it is at every stage."""
    token = await Tab.fetch(address)
    yield None
    tab = await Tab.connect(address, token)
    yield tab
    await tab.greeted()
    yield tab
    await tab.ask()
    yield tab  # its document is under way
    await tab.taken()
    yield tab
    await tab.event("document_ready")
    yield tab  # its lower half is being made
    await tab.until(name="timelines")
    place = tab.row(_SLIDER)[1]["place"]
    yield tab
    bar = next(model for model in tab.objects if re.fullmatch(r"HeaderBar\d+", model["name"]))
    for index in (*range(1, len(SUBJECTS)), 0):
        await tab.set(bar["id"], active=index)
        yield tab  # the tab is being made
    for step in range(5):
        await tab.slide(_SLIDER, place - 0.02 * step)
    yield tab
    await tab.turn("Simulate")
    await tab.until(label="Start", icon="play_arrow")
    await tab.click(tab.find(label="Start", icon="play_arrow")["id"])
    yield tab  # a run is under way
    await tab.connection.write_message('{"msgid": "half", "msgtype": "PATCH-DOC", "num_buffers": 9}')
    yield tab  # the rest of the message never comes


USED = 8 + len(SUBJECTS)
"""The stage of a page that a person has used and closes."""
STAGES = USED + 2


async def _at(address: str, stage: int) -> Tab | None:
    """A page at a stage, from 1 on; None before it is connected."""
    life = _life(address)
    for _ in range(stage - 1):
        await anext(life)
    return await anext(life)


async def visit(address: str) -> None:
    """One page: every tab, a slider, and good-bye."""
    tab = await _at(address, USED)
    assert tab is not None
    await tab.pull()  # answered in its turn, so all before it is done
    await tab.close()


async def lose(address: str, stage: int) -> None:
    """One page that loses its connection at a stage."""
    tab = await _at(address, stage)
    if tab is not None:
        await tab.cut()


async def _visits(address: str, pages: int) -> None:
    for number in range(pages):
        await (lose(address, 1 + number // 2 % STAGES) if number % 2 else visit(address))


def main() -> int:
    """Measure, print, judge."""
    options = argparse.ArgumentParser(description="Memory of navbudget serve over many pages")
    options.add_argument("--pages", type=int, default=300)
    pages = options.parse_args().pages
    with tempfile.TemporaryDirectory() as name, counted_server(Path(name)) as (address, remaining):
        rows = []
        for _ in range(3):
            asyncio.run(_visits(address, pages // 3))
            rows.append(remaining())
            print(f"{pages // 3} pages more: {rows[-1].frames} alive, {rows[-1].resident:.1f} MB", flush=True)
    growth = (rows[2].resident - rows[0].resident) / (2 * (pages // 3))
    print(f"{growth:+.3f} MB a page after the first third; goal {GOAL_MB:g}")
    missed = growth > GOAL_MB or any(look.frames for look in rows)
    print("MISSED" if missed else "the goal holds")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())

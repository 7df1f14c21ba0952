"""Full garbage collections: not while somebody waits, but often enough."""

import ctypes
import gc
import subprocess
import sys

import pytest
from waiting import PATIENCE

from app.serving.collector import Collector

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving")]


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_it_waits_for_a_pause_and_then_does_it_once():
    clock = Clock()
    collector = Collector(clock)
    assert not collector.due()
    clock.now += 1.0
    collector.heard()
    clock.now += 1.9
    assert not collector.due()  # somebody may still be dragging a slider
    clock.now += 0.2
    assert collector.due()
    collector.collect()
    clock.now += 1e5
    assert not collector.due()  # nothing has happened since


def test_closed_pages_are_freed_in_a_pause_or_when_they_are_many():
    clock = Clock()
    collector = Collector(clock)
    for closed in range(25):
        clock.now += 1.0
        collector.heard()  # never a pause
        assert not collector.due(), closed
        collector.page_closed()
    assert collector.due()
    collector.collect()
    assert not collector.due()
    collector.page_closed()
    clock.now += 3.0
    assert collector.due()


def test_work_without_a_pause_is_interrupted_now_and_then():
    clock = Clock()
    collector = Collector(clock)
    for _ in range(899):
        clock.now += 1.0
        collector.heard()
        assert not collector.due()
    clock.now += 1.0
    collector.heard()
    assert collector.due()


def test_after_settling_python_leaves_everything_alone():
    """In a separate process: settings of the collector hold for all of it."""
    code = (
        "import gc; from app.serving.collector import settle; settle(); full = []\n"
        "gc.callbacks.append(lambda phase, info: full.append(1) if info['generation'] == 2 else None)\n"
        "kept = [[[]] for _ in range(400_000)]\n"
        "print(len(full), gc.get_freeze_count() > 100_000)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "True"]
    assert gc.isenabled()


_FLOOD = """
import os
from app.serving.collector import Collector
def held(): return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
parts = [bytes(2000) for _ in range(100_000)]
parts = parts[::100]
before = held()
Collector().collect()
print(before - held())
"""


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "malloc_trim"), reason="the C library is not glibc")
def test_memory_between_what_is_still_used_goes_back_to_the_system() -> None:
    returned = float(subprocess.check_output([sys.executable, "-c", _FLOOD], text=True, timeout=PATIENCE))
    assert returned > 50  # MB, of 200 in parts; what is left holds a page of memory in a hundred

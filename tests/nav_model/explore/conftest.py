"""Sweeps that are killed."""

import signal
import subprocess
import sys

import pytest

from nav_model.design.file import format_design

_KILLED = """
import os, signal, sys, threading, time
from nav_model.explore.sweep import run_sweep
from nav_model.explore.sweep_plan import read_plan

plan, parts = read_plan(sys.argv[1]), int(sys.argv[3])
told = iter(range(plan.parts + 1))

def progress(done, total):
    written = next(told)
    if written == parts:
        threading.Timer(0.005, os.kill, (os.getpid(), signal.SIGKILL)).start()
    if written == plan.parts - 1:
        time.sleep(3600)

run_sweep(plan, sys.argv[2], progress=progress)
"""


@pytest.fixture(scope="session")
def kill_during_sweep():
    """A function that begins a sweep in a process killed (kill -9) among its writing: some milliseconds after so
    many parts are there, and always before the last."""

    def kill(plan_file, out, parts):
        done = subprocess.run([sys.executable, "-c", _KILLED, plan_file, out, str(parts)], check=False)
        assert done.returncode == -signal.SIGKILL

    return kill


@pytest.fixture
def write_plan(tmp_path, open_design):
    """A function that writes the plan of a sweep beside its design and gives its path."""

    def write(text):
        (tmp_path / "design.toml").write_text(format_design(open_design), encoding="utf-8")
        path = tmp_path / "sweep.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write

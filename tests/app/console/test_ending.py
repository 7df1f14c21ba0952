"""Commands as processes: stopped by a signal, on a full disk, into a closed pipe."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from known_designs import MEMS, ROOT, TACTICAL
from waiting import PATIENCE

from app.console import ending
from nav_model.base.processes import worker_pool

pytestmark = pytest.mark.long

_DONE = re.compile(r"\b[1-9]\d* of \d+ .*\n")
_SWEEP = f"""
design = "{TACTICAL}"
rows_per_part = 1
[vary]
gnss.position_noise = {{ from = "1 cm", to = "2 m", points = 50000 }}
"""


def _run(*command: str, **options: Any) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "app", *command],
        cwd=ROOT, text=True, stderr=subprocess.PIPE, start_new_session=True, **options,
    )  # fmt: skip


def _say_until_under_way(process: subprocess.Popen[str]) -> str:
    """A command's messages until it has told of work that is done."""
    output = ""
    while not _DONE.search(output):
        more = os.read(process.stderr.fileno(), 4096).decode()
        assert more, output
        output += more
    return output


_LONG = {
    "sweep, two workers": (2, ["sweep", "{folder}/sweep.toml", "-o", "{folder}/out.csv", "--workers", "2"]),
    "sweep": (0, ["sweep", "{folder}/sweep.toml", "-o", "{folder}/out.csv", "--workers", "1"]),
    "simulate, two workers": (2, ["simulate", MEMS, "--runs", "20000", "--workers", "2", "-o", "{folder}/out.json"]),
    "sar": (0, ["sar", MEMS, "--runs", "20000", "-o", "{folder}/out.json"]),
    "report": (0, ["report", MEMS, "--with", "simulation", "--runs", "50000", "--workers", "1",
                   "-o", "{folder}/out.pdf"]),
}  # fmt: skip
"""Name of a run -> its number of workers, and the command."""
_QUICK = {("simulate, two workers", signal.SIGINT), ("sar", signal.SIGTERM), ("report", signal.SIGINT)}


@pytest.mark.parametrize(
    ("name", "number"),
    [
        pytest.param(name, number, marks=() if (name, number) in _QUICK else pytest.mark.slow)
        for name in _LONG
        for number in (signal.SIGINT, signal.SIGTERM)
    ],
)
def test_a_stopped_command_ends_its_workers_says_one_line_and_leaves_nothing_half_written(
    tmp_path: Path, name: str, number: signal.Signals
) -> None:
    workers, command = _LONG[name]
    (tmp_path / "sweep.toml").write_text(_SWEEP)
    with _run(*(part.format(folder=tmp_path) for part in command)) as process:
        try:
            before = _say_until_under_way(process)
            family = psutil.Process(process.pid).children(recursive=True)
            assert len(family) >= workers
            if number == signal.SIGINT:
                os.killpg(process.pid, number)  # as a terminal's Ctrl-C
            else:
                process.send_signal(number)
            assert process.wait(PATIENCE) == 128 + number
            lines = (before + process.stderr.read()).splitlines()
            messages = [line for line in lines if line.startswith(("navbudget", "Traceback"))]
            assert messages == [f"navbudget: {'interrupted' if number == signal.SIGINT else 'terminated'}"]
        finally:
            process.kill()
    psutil.wait_procs(family, PATIENCE)
    assert not [p for p in family if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]
    remaining = {path.name for path in tmp_path.rglob("*")} - {"sweep.toml"}
    assert not {name for name in remaining if name.startswith("out.") and name != "out.csv.parts"}
    assert not {name for name in remaining if name.endswith((".part", ".tmp"))}


@pytest.mark.parametrize(
    "name", ["simulate, two workers", pytest.param("sweep, two workers", marks=pytest.mark.slow)]
)
def test_a_worker_that_is_killed_ends_its_command_as_a_fault_of_the_surroundings(tmp_path: Path, name: str) -> None:
    (tmp_path / "sweep.toml").write_text(_SWEEP)
    with _run(*(part.format(folder=tmp_path) for part in _LONG[name][1])) as process:
        before = _say_until_under_way(process)
        workers = [p for p in psutil.Process(process.pid).children() if "spawn_main" in " ".join(p.cmdline())]
        workers[0].kill()
        assert process.wait(PATIENCE) == 3
        lines = (before + process.stderr.read()).splitlines()
    assert lines[-1] == "navbudget: something ended a worker process, perhaps a lack of memory"
    psutil.wait_procs(workers, PATIENCE)
    assert not [p for p in workers if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_the_command_is_loaded_ends_it_with_one_line(tmp_path: Path, number: signal.Signals) -> None:
    (tmp_path / "numpy.py").write_text("import os, time\nos.write(2, b'loading\\n')\ntime.sleep(600)\n")
    with _run("check", TACTICAL, env={**os.environ, "PYTHONPATH": str(tmp_path)}) as process:
        assert process.stderr.readline() == "loading\n"
        process.send_signal(number)
        assert process.wait(PATIENCE) == 128 + number
        assert process.stderr.read() == f"navbudget: {'interrupted' if number == signal.SIGINT else 'terminated'}\n"


# What is written when it is too much to keep, and what is written at the very end.
_MUCH, _LITTLE = ["evaluate", TACTICAL], ["check", TACTICAL]


@pytest.mark.parametrize("command", [_MUCH, _LITTLE])
def test_a_full_disk_is_a_fault_of_the_surroundings_and_a_closed_pipe_silent(command: list[str]) -> None:
    reading, pipe = os.pipe()
    os.close(reading)
    full = os.open("/dev/full", os.O_WRONLY)
    for output, message in ((full, "navbudget: standard output: No space left on device\n"), (pipe, "")):
        with _run(*command, stdout=output) as process:
            os.close(output)
            assert process.wait(PATIENCE) == 3
            assert process.stderr.read() == message


@pytest.mark.parametrize("command", [f"check {MEMS} {TACTICAL}", f"evaluate {MEMS}"])
def test_a_reader_that_leaves_early_is_no_fault_and_hears_nothing(command: str) -> None:
    shell = f"{sys.executable} -m app {command} | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", shell], cwd=ROOT, capture_output=True, text=True)
    # What `check` said in time is the verdict: one of the two designs does not close.
    assert done.returncode == command.startswith("check")
    assert done.stderr == ""


@pytest.mark.parametrize("closed", ["0<&-", "2>&-", "0<&- 2>&-"])
def test_closed_streams_change_no_verdict(closed: str) -> None:
    done = subprocess.run(f"{sys.executable} -m app check {MEMS} {closed}", shell=True, cwd=ROOT, capture_output=True)
    assert done.returncode == 1


@pytest.mark.parametrize(
    "command",
    [
        f"check {TACTICAL}",
        f"evaluate {TACTICAL}",
        f"sar {TACTICAL} --runs 20",
        f"explore rank {TACTICAL}",
        "presets imu",
        "--version",
        "serve --port 0",
    ],
)
def test_results_for_a_closed_standard_output_are_a_fault(command: str) -> None:
    done = subprocess.run(
        f"{sys.executable} -m app {command} >&-", shell=True, cwd=ROOT, stderr=subprocess.PIPE, text=True,
        timeout=PATIENCE,
    )  # fmt: skip
    assert done.returncode == 3
    assert done.stderr.splitlines()[-1] == "navbudget: standard output is closed"


@pytest.mark.parametrize(
    "command",
    [f"sar {TACTICAL} --runs 20 -o out.json", f"report {TACTICAL} -o out.html", "sweep sweep.toml -o out.csv"],
)
def test_a_file_is_written_also_without_a_standard_output(tmp_path: Path, command: str) -> None:
    (tmp_path / "sweep.toml").write_text(_SWEEP.replace("50000", "2"))
    shell = f"{sys.executable} -m app {command} >&-"
    assert subprocess.run(shell, shell=True, cwd=tmp_path, stderr=subprocess.DEVNULL).returncode == 0
    assert (tmp_path / command.split()[-1]).exists()


def test_a_fault_of_our_own_is_no_verdict(capsys: pytest.CaptureFixture[str]) -> None:
    assert ending.run_to_end(lambda: 1 // 0) == 4
    errors = capsys.readouterr().err
    assert "ZeroDivisionError" in errors
    assert "a fault in NavBudget" in errors


def test_what_is_around_us_has_a_code_of_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    def killed() -> int:
        with worker_pool(1) as pool:
            return int(pool.submit(os._exit, 1).result() or 0)

    def memory() -> int:
        raise MemoryError

    for command, reason in ((killed, "something ended a worker process"), (memory, "too little free memory")):
        assert ending.run_to_end(command) == 3
        message = capsys.readouterr().err
        assert message.startswith("navbudget: ")
        assert reason in message
        assert message.count("\n") == 1

"""Commands that read and write pipes, devices and links instead of ordinary files."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from known_designs import MEMS, ROOT, TACTICAL
from waiting import PATIENCE

from app.console.ending import one_line
from app.console.files import whole_file

pytestmark = pytest.mark.long


def test_a_link_stays_and_the_file_it_leads_to_is_replaced(tmp_path: Path) -> None:
    real, link = tmp_path / "real.html", tmp_path / "link.html"
    real.write_text("old")
    link.symlink_to(real)
    with whole_file(link) as file:
        file.write(b"new")
    assert link.is_symlink()
    assert real.read_text() == "new"
    assert sorted(tmp_path.iterdir()) == [link, real]


def test_a_pipe_is_written_to_and_stays(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.html"
    os.mkfifo(pipe)
    with subprocess.Popen([sys.executable, "-m", "app", "report", TACTICAL, "-o", pipe], cwd=ROOT) as process:
        assert pipe.read_bytes().lower().startswith(b"<!doctype html>")
        assert process.wait(PATIENCE) == 0
    assert pipe.is_fifo()
    assert list(tmp_path.iterdir()) == [pipe]


def test_a_name_on_several_lines_or_of_no_text_is_one_line_and_changes_no_verdict(tmp_path: Path) -> None:
    for name in (b"a\nall.toml: closes\n", b"\x1b[31ma", b"\xff\xfe"):
        path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name))
        for design, code in ((TACTICAL, 0), (MEMS, 1)):
            path.write_bytes(Path(design).read_bytes())
            done = subprocess.run([sys.executable, "-m", "app", "check", path], cwd=ROOT, capture_output=True)
            assert (done.returncode, done.stderr) == (code, b"")
            lines = done.stdout.decode().splitlines()
            *rows, verdict = lines
            assert all(row.startswith("  ") for row in rows)
            assert verdict.startswith(f"{one_line(str(path))}: ")


@pytest.mark.parametrize(
    ("command", "fed", "message"),
    [
        ("evaluate - 0<&-", b"", "standard input: is empty"),
        ("password ada 0<&-", b"", "password: must have 8 to 1024 characters"),
        ("password ada", b"\xff\xfe23456789\n", "password: is not UTF-8 text"),
        ("allan . --rate 100", b"", "cannot be read: Is a directory"),
        (f"evaluate {TACTICAL} --times nan", b"", "--times: nan is not allowed. Give seconds from 0 to 7200."),
    ],
)
def test_what_cannot_be_read_is_bad_input_told_in_one_line(command: str, fed: bytes, message: str) -> None:
    done = subprocess.run(f"{sys.executable} -m app {command}", shell=True, cwd=ROOT, input=fed, capture_output=True)
    assert done.returncode == 2
    lines = [line for line in done.stderr.decode().splitlines() if line != "reading"]
    assert len(lines) == 1
    assert message in lines[0]


def test_a_log_may_come_through_a_pipe() -> None:
    log = "for i in $(seq 600); do echo 0.$((i * 7919 % 1000)),0,0; done"
    options = "--rate 100 --gyro-unit deg/s --columns gyro_x,-,-"
    done = subprocess.run(
        ["bash", "-c", f"{sys.executable} -m app allan <({log}) {options}"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert '"gyro_x"' in done.stdout

"""The command navbudget: results on standard output, messages on standard error, exit codes."""

import io
import json
import math
import os
import signal
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from commanded import reply
from known_designs import L_BAND, MEMS, ROOT, TACTICAL

import app.__main__
import app.cli
from app.cli import main

pytestmark = pytest.mark.long


def _process(*arguments, stdin=b"", **environment):
    command, environment = [sys.executable, "-m", "app", *arguments], {**os.environ, **environment}
    return subprocess.run(command, cwd=ROOT, input=stdin, capture_output=True, env=environment, check=False)


def _evaluate(capsys, *arguments):
    assert main(["evaluate", *arguments]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return json.loads(out)


def test_results_are_utf8_whatever_the_terminal_says():
    done = _process("evaluate", MEMS, PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert (done.returncode, done.stderr) == (0, b"")
    plain = json.loads(done.stdout.decode())
    assert plain["design"]["name"] == "MEMS IMU at X band"
    assert plain["verdict"]["closes"] is False
    assert len(plain["coast"]["time_s"]) == 300
    assert _process("presets", "imu", PYTHONIOENCODING="ascii", PYTHONUTF8="0").returncode == 0
    assert _process("check", MEMS, PYTHONIOENCODING="ascii", PYTHONUTF8="0").returncode == 1


SCREENS = {"panel", "bokeh", "matplotlib", "scipy", "numba", "typst", "panel_material_ui", "IPython"}


@pytest.mark.parametrize(
    ("command", "modules"),
    [(["evaluate", MEMS], SCREENS), (["presets", "imu"], SCREENS | {"nav_model.budget", "app.document"})],
)
def test_a_command_loads_what_it_needs(command, modules):
    code = (
        "import sys\nfrom app.cli import main\n"
        f"assert main({command!r}) == 0\n"
        f"names = {modules!r}\n"
        "print(sorted(names & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


def test_version(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--version"])
    assert capsys.readouterr().out == f"navbudget {version('navbudget')}\n"


def test_standard_input(capsys, monkeypatch):
    def stdin(data):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))

    stdin(b'name = "piped"\n[gnss]\nrate = "5 Hz"\n')
    assert _evaluate(capsys, "-")["design"]["inputs"]["gnss.interval"] == 0.2
    done = _process("check", "-", stdin=Path(TACTICAL).read_bytes())
    assert done.returncode == 0
    assert b"closes" in done.stdout
    stdin(b'name = "a"\n')
    assert main(["check", "-"]) == 0
    assert "nothing was checked" in capsys.readouterr().out


def test_times_exactly(capsys):
    plain = _evaluate(capsys, MEMS, "--times", "0,10,20")
    assert plain["coast"]["time_s"] == [0.0, 10.0, 20.0]
    assert len(plain["coast"]["refined_position_sigma_m"]["vertical"]) == 3


def test_set_overrides(capsys):
    for arguments in (
        [MEMS, "--set", "imu.angle_random_walk=0.3 °/√h", "gnss.rate=10 Hz"],
        [MEMS, "--set", "imu.angle_random_walk=0.3 deg/sqrt(h)", "--set", "gnss.interval=100 ms"],
        ["--set", "imu.angle_random_walk=0.3 °/√h", "gnss.rate=10 Hz", MEMS],
    ):
        inputs = _evaluate(capsys, *arguments)["design"]["inputs"]
        assert inputs["imu.angle_random_walk"] == pytest.approx(math.radians(0.3) / 60, rel=1e-15)
        assert inputs["gnss.interval"] == 0.1
    inputs = _evaluate(capsys, MEMS, "--set", "imu.preset=LN-200", "radar.autofocus_order=2")["design"]["inputs"]
    assert inputs["imu.preset"] == "LN-200"
    assert inputs["imu.velocity_random_walk"] == pytest.approx(0.03 / 60, rel=1e-15)
    assert inputs["radar.autofocus_order"] == 2


@pytest.mark.parametrize(
    ("designs", "code"),
    [
        ([TACTICAL], 0), ([L_BAND], 0), ([TACTICAL, L_BAND], 0), ([MEMS], 1), ([TACTICAL, MEMS], 1),
        ([MEMS, TACTICAL], 1), (["nowhere.toml"], 2), ([MEMS, "nowhere.toml"], 2),
        (["nowhere.toml", TACTICAL], 2),
    ],
)  # fmt: skip
def test_check_exit_codes(capsys, designs, code):
    assert main(["check", *designs]) == code
    out, err = capsys.readouterr()
    readable = [path for path in designs if path != "nowhere.toml"]
    for path in readable:
        (verdict,) = (line for line in out.splitlines() if line.startswith(f"{path}: "))  # the file's name once
        assert ("DOES NOT CLOSE" in verdict) == (path == MEMS)
    assert err.count("\n") == designs.count("nowhere.toml")


@pytest.mark.parametrize(("kind", "names"), [("imu", ["STIM300", "LN-200"]), ("radar", ["F-SAR X", "UAVSAR"])])
def test_presets(capsys, kind, names):
    assert main(["presets", kind]) == 0
    text = capsys.readouterr().out
    plain = reply(capsys, "presets", kind, "--json")
    for name in names:
        assert f"\n{name}" in f"\n{text}"
        assert name in plain
    assert "[UNCONFIRMED]" in text
    for entry in plain.values():
        for key, value in entry.items():
            if key not in {"grade", "note"}:
                assert value["source"]
                assert value["source"] in text
                assert value["status"] in {"confirmed", "secondary", "assumed", "unconfirmed"}


@pytest.mark.parametrize(
    "arguments",
    [
        [], ["evaluate"], ["evaluate", MEMS, TACTICAL], ["check"], ["bogus"], ["presets"],
        ["presets", "stars"],
        ["evaluate", MEMS, "--bogus"], ["evaluate", MEMS, "--times"], ["report", MEMS],
    ],
)  # fmt: skip
def test_a_wrong_command_line_is_one_line_and_exit_2(capsys, arguments):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "blamed"),
    [
        ([MEMS, "--set", "gnss.position_noise"], "gnss.position_noise"),
        (["--set", "gnss.position_noise"], "gnss.position_noise"),
        ([MEMS, "--set", "gnss.position_noise", "2 cm"], "gnss.position_noise"),
        (["--set", "imu.bogus", MEMS], "imu.bogus"),
        ([MEMS, "--set", "imu.rate=1 Hz", "fast"], "fast"),
    ],
)
def test_a_change_without_its_value_is_named_and_not_taken_for_a_design(capsys, arguments, blamed):
    assert main(["evaluate", *arguments]) == 2
    assert capsys.readouterr().err == (
        f'navbudget: --set: \'{blamed}\' has no "=". Write KEY=VALUE, for example imu.angle_random_walk="0.3 °/√h".\n'
    )


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("2", "2")])
def test_openblas_has_one_thread_unless_the_environment_says_otherwise(monkeypatch, given, used):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    monkeypatch.setattr(signal, "signal", lambda number, what: None)
    monkeypatch.setattr(app.cli, "main", lambda: os.environ["OPENBLAS_NUM_THREADS"])
    assert app.__main__.main() == used


def test_the_way_in_leaves_numpy_to_the_command():
    code = "import sys, app.__main__; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0


@pytest.mark.parametrize(
    ("command", "option"),
    [
        (["suborbital", "READ"], "--save"),
        (["sar", "READ"], "-o"),
        (["trajectory", "READ", "--duration", "20"], "-o"),
        (["trajectory", MEMS, "--trajectory", "READ"], "-o"),
        (["allan", "READ", "--rate", "10"], "-o"),
        (["allan", "log.csv", "--rate", "10", "--against", "READ"], "-o"),
    ],
)
def test_what_was_read_is_not_written_over(tmp_path, command, option, capsys):
    read, link = tmp_path / "mine.toml", tmp_path / "link.toml"
    read.write_bytes(Path(MEMS).read_bytes())
    link.symlink_to(read)
    for target in (read, link):
        assert main([str(read) if word == "READ" else word for word in (*command, option, str(target))]) == 2
        assert capsys.readouterr().err == f"navbudget: {option}: '{target}' is the file that was read; name another\n"
    assert read.read_bytes() == Path(MEMS).read_bytes()


def test_what_came_through_standard_input_is_not_written_over(tmp_path):
    read = tmp_path / "mine.toml"
    read.write_bytes(Path(MEMS).read_bytes())
    command = [sys.executable, "-m", "app", "trajectory", "-", "--duration", "20", "-o", str(read)]
    with read.open() as fed:
        done = subprocess.run(command, cwd=ROOT, stdin=fed, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"navbudget: -o: '{read}' is the file that was read; name another\n"
    assert read.read_bytes() == Path(MEMS).read_bytes()

"""What each command is given wrong is refused with exit 2 and one line that says what."""

import shlex
from pathlib import Path

import bench_log
import pytest
from known_designs import MEMS

from app.cli import main

pytestmark = pytest.mark.long

_SIMULATE = "simulate DESIGN --runs 6 --seed 4 --duration 40 --outage 30,40 --every 2 --workers 1"
_TELL = {"allan", "report", "suborbital"}  # what they are doing, before they can know that it is wrong

_REFUSED = [
    ("evaluate DESIGN --times a", "times"),
    ("evaluate DESIGN --times ''", "times"),
    ("evaluate DESIGN --times 1,,2", "times"),
    ("evaluate DESIGN --times -1", "times"),
    ("evaluate DESIGN --times nan", "times"),
    ("evaluate DESIGN --times 1e9", "times"),
    ("evaluate DESIGN --set imu.bogus=1", "imu.bogus"),
    ("evaluate DESIGN --set name=\udcff", "name"),
    ("sar DESIGN --runs 5", "runs: 5"),
    ("sar DESIGN --seed -1", "--seed"),
    ("sar DESIGN --set radar.squint_angle=70°", "radar.squint_angle"),
    ("sar DESIGN --set radar.grazing_angle=90°", "radar.grazing_angle"),
    ("sar DESIGN -o /nonexistent/x.json --runs 20", "/nonexistent"),
    ("sar DESIGN --engine simulator --workers 0", "--workers"),
    (f"{_SIMULATE} --runs 0", "navbudget: --runs: "),
    (f"{_SIMULATE} --seed -1", "navbudget: --seed: "),
    (f"{_SIMULATE} --workers 0", "navbudget: --workers: "),
    (f"{_SIMULATE} --duration nan", "navbudget: --duration: "),
    (f"{_SIMULATE} --every 0", "navbudget: --every: "),
    (f"{_SIMULATE} --outage a,b", "navbudget: --outage: "),
    (f"{_SIMULATE} --outage 25,35", "navbudget: --outage: "),  # overlaps 30,40
    (f"{_SIMULATE} --trajectory loop", "navbudget: --trajectory: "),
    (f"{_SIMULATE} --trajectory DESIGN", "navbudget: --trajectory: "),
    (f"{_SIMULATE} --trajectory turns", "navbudget: --duration: "),  # too short for the turns
    (f"{_SIMULATE} --set 'gyro.bias_instability=5 mg'", "navbudget: gyro.bias_instability: "),
    (f"{_SIMULATE} --set 'gyro.drift=5 °/h'", "navbudget: gyro.drift: "),
    (f"{_SIMULATE} --set flight.latitude=89°", "navbudget: flight.latitude: "),
    (f"{_SIMULATE} --ground nan", "navbudget: --ground: "),
    (f"{_SIMULATE} --height x", "navbudget: --height: "),
    (f"{_SIMULATE} -o result.txt", "navbudget: -o: "),
    (f"{_SIMULATE} -o /nowhere/result.json", "navbudget: -o: "),
    ("suborbital --latency '5 kg'", "tracker.latency: 'kg' is not a unit of time"),
    ("suborbital --set nonsense=3", "nonsense: is not an input"),
    ("suborbital --set 'imu.gyro_bias=3 °/h'", "no DESIGN is given"),
    ("suborbital --trajectory /no/such.csv", "/no/such.csv: cannot be read"),
    ("suborbital /no/such.toml", "/no/such.toml: cannot be read"),
    ("suborbital --noise-runs -1", "--noise-runs"),
    ("suborbital --method guess", "camera.method"),
    ("suborbital --set 'flight.duration=5000 s' 'flight.initial_thrust=15 m/s²'", "reaches the ground"),
    ("allan nowhere.csv", "nowhere.csv: cannot be read: No such file or directory"),
    ("allan LOG", "rate: The file does not give the rate. Enter for example 100 Hz"),
    ("allan LOG --rate -1", "rate of -1 Hz"),
    ("allan LOG --rate 100 --gyro-unit furlong", "'furlong'"),
    ("allan LOG --rate 100 --columns gyro_x,gyro_y", "2 column names are given, but the file has 6"),
    ("allan LOG --rate 100 --arrays gyro", "arrays: 'gyro' is not an assignment"),
    (f"allan LOG --rate 100 --arrays {'g' * 5000}", "... is not an assignment"),
    ("allan LOG --rate 100 --motion --bench-arw 3", "--bench-arw: '3' has no unit"),
    ("allan LOG --rate 10 --motion", "10 Hz is too slow"),
    ("allan LOG --rate 100 --bench-arw '0.3 °/√h'", "--motion"),
    ("explore rank DESIGN --result weight", "Choose "),
    ("explore map DESIGN --x imu.rate", "cannot be an axis"),
    ("explore uncertainty DESIGN", "No input is uncertain"),
    ("explore uncertainty DESIGN --vary nonsense", "not a range"),
    ("explore search DESIGN --imus /nowhere.toml", "cannot be read"),
    ("sweep /nowhere.toml -o x.csv", "cannot be read"),
    (
        "report DESIGN -o r.pdf --with weather",
        "--with: 'weather' is not a study; simulation, trajectory, sar, ",
    ),
    ("report DESIGN -o r.pdf --with sar --runs 3", "--runs: 3 is not allowed. Enter 20"),
    ("report DESIGN -o r.pdf --with sar --seed -1", "--seed: -1"),
    ("report DESIGN -o r.pdf --with simulation --outage then", "--outage: 'then'"),
]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A static log that states no rate."""
    path = tmp_path_factory.mktemp("logs") / "bench.csv"
    path.write_bytes(bench_log.log())
    return path


@pytest.mark.parametrize(("command", "message"), _REFUSED)
def test_bad_input_is_one_line_and_exit_2_and_nothing_is_written(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    log: Path,
    command: str,
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    named = {"DESIGN": MEMS, "LOG": str(log)}
    arguments = [named.get(word, word) for word in shlex.split(command)]
    try:
        code = main(arguments)
    except SystemExit as stop:  # argparse
        code = int(stop.code or 0)
    out, err = capsys.readouterr()
    assert (code, out) == (2, "")
    *before, line = err.splitlines()
    assert line.startswith("navbudget")
    assert message in line
    assert not [other for other in before if other.startswith("navbudget")]
    assert not before or arguments[0] in _TELL
    assert not list(tmp_path.iterdir())

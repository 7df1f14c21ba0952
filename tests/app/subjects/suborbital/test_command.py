"""`navbudget suborbital` in-process."""

import contextlib
import io
import json
from pathlib import Path
from typing import Any

import pytest
from flight_files import format_flight
from known_designs import MEMS

from app.cli import main
from nav_model.suborbital.flight import reference_flight

pytestmark = pytest.mark.long

# star_tracker.md, GP-1 on the reference flight: north, east, up [m], accept 5 m.
PRINTED = {
    ("final_m", "all"): (7117.58, -26262.27, 27319.33),
    ("aided_final_m", "all"): (-3162.51, -8901.97, 15002.50),
}


def run(*arguments: str) -> tuple[int, dict[str, Any], str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(["suborbital", *arguments])
        except SystemExit as stop:  # argparse
            code = int(stop.code or 0)
    return code, json.loads(out.getvalue()) if out.getvalue() else {}, err.getvalue()


def test_without_a_design_it_gives_the_printed_table() -> None:
    code, answer, stderr = run("--noise-runs", "2")
    assert code == 0
    for (part, name), expected in PRINTED.items():
        result = answer[part][name]
        assert [result[axis] for axis in ("north", "east", "up")] == pytest.approx(expected, abs=5.0)
    assert {entry["from"] for entry in answer["inputs"].values()} == {"GP-1"}
    assert answer["white_noise_monte_carlo"]["runs"] == 2
    assert stderr.startswith("flight (")  # what is being done


def test_a_design_and_options_enter_and_are_named() -> None:
    code, answer, _ = run(
        MEMS, "--set", "imu.gyro_bias=5 °/h", "tracker.dropouts=150-160 s",
        "--from-height", "80 km", "--star-images",
    )  # fmt: skip
    assert code == 0
    came = {key: entry["from"] for key, entry in answer["inputs"].items() if entry["from"] != "GP-1"}
    assert came["gyros.bias"] == "design MEMS IMU at X band"
    assert came["tracker.from_height"] == came["camera.frames"] == came["tracker.dropouts"] == "command line"
    assert answer["inputs"]["gyros.bias"]["value"] == "5, 5, 5 °/h"
    assert 2.0 < answer["star_frames"]["mean_nees"] < 4.0
    # From 80 km some of the boost is flown on gyros: more is left than with the tracker from lift-off.
    gyro = answer["aided_final_m"]["gyro total"]
    assert abs(gyro["up"]) > 100.0


def test_every_section_of_a_design_may_be_changed() -> None:
    changes = ("name=other", "flight.speed=120 m/s", "processing.mode=post-processed", "motion.delay=1 ms",
               "oscillator.bistatic=true", "flight.latitude=30°")  # fmt: skip
    code, answer, stderr = run(MEMS, "--set", *changes)
    assert code == 0, stderr
    assert answer["design"] == "other"
    assert answer["inputs"]["flight.latitude"]["from"] == "command line"  # the study's own
    code, _, stderr = run(MEMS, "--set", "motion.wings=1")
    assert code == 2
    assert stderr.startswith("navbudget: motion.wings: unknown key; [motion] has ")


def test_a_study_file_gives_the_same_answer_as_the_options_it_was_saved_from(tmp_path: Path) -> None:
    file, flown = tmp_path / "mine.toml", tmp_path / "flown.csv"
    flown.write_bytes(format_flight(reference_flight(), every=5))
    options = ["--set", "gyros.bias=1, 2, -3 °/h", "--latency", "10 ms", "--trajectory", str(flown)]
    code, before, _ = run(*options, "--save", str(file))
    assert code == 0
    flown.unlink()  # the file holds the trajectory
    code, after, _ = run(str(file))
    assert code == 0
    assert after["trajectory"] == "flown.csv"
    for part in ("final_m", "aided_final_m", "white_noise_sigma_m"):
        assert after[part] == before[part]
    assert after["inputs"]["gyros.bias"] == {**before["inputs"]["gyros.bias"], "from": f"file {file}"}
    # and --set comes on top of it
    file.write_text('study = "suborbital"\n[gyros]\nbias = "9 deg/h"\n')
    code, top, _ = run(str(file), "--set", "gyros.bias=1 °/h")
    assert code == 0
    assert top["inputs"]["gyros.bias"]["value"] == "1, 1, 1 °/h"


def test_a_wrong_study_file_is_one_line_and_exit_2(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    for text, message in (
        ('study = "suborbital"\n[gyros]\nbias = "5 kg"\n', "gyros.bias: 'kg' is not a unit of angular rate"),
        ('study = "suborbital"\n[trajectory]\nname = "a.csv"\ncsv = "a,b\\n1,2"\n', "a.csv: columns time_s"),
    ):
        file.write_text(text)
        code, answer, error = run(str(file))
        assert (code, answer) == (2, {})
        assert message in error.splitlines()[-1]
    file.write_text('study = "suborbital"\n')
    code, _, error = run(str(file), "--set", "imu.gyro_bias=3 °/h")
    assert code == 2
    assert "no DESIGN is given but a study" in error


def test_inputs_are_listed() -> None:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert main(["suborbital", "--inputs"]) == 0
    assert "tracker.from_height" in out.getvalue()
    assert "1, 0.9, -1.1 mg" in out.getvalue()

"""The command `flown`: exit codes, JSON and messages, on made solutions and on real files."""

import json
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from nav_model.design.file import parse_design
from tests.support import made_flights as made

DESIGN = """
imu.angle_random_walk = "0.1 °/√h"
imu.velocity_random_walk = "0.03 m/s/√h"
gnss.position_noise = "1 m"
trajectory.flight = "lines"
trajectory.lines = 2
trajectory.length = "9 km"
trajectory.spacing = "2 km"
"""
REAL = Path(__file__).parents[4] / "shared/data/flight"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A design, a real-time solution as a table, and the smoothed one as an SBET."""
    folder = tmp_path_factory.mktemp("flown")
    (folder / "design.toml").write_text(DESIGN)
    flights = made.fly(parse_design(DESIGN), 1, seed=8)
    x = made.solution(flights, flights.after[:, :, 0], 1.0, "")
    rows = np.hstack([x.time_s[:, None], np.degrees(x.place[:, :2]), x.place[:, 2:]])
    np.savetxt(folder / "rt.csv", rows, "%.12f", ",", header="gps time [s],latitude [deg],longitude [deg],height [m]",
               comments="")  # fmt: skip
    y = made.solution(flights, flights.smoothed[:, :, 0], 10.0, "")
    sbet = np.zeros((len(y.time_s), 17))
    sbet[:, 0], sbet[:, 1:4], sbet[:, 7:10] = y.time_s, y.place, y.attitude
    sbet[:, 4:7] = y.velocity * [1.0, -1.0, -1.0]
    sbet.astype("<f8").tofile(folder / "pp.out")
    return folder


@pytest.mark.parametrize(("limit", "code", "verdict"), [("6 m", 0, "met"), ("20 cm", 1, "not met")])
def test_exit_codes_are_those_of_the_verdict(files, capsys, limit, code, verdict) -> None:
    asked = ["flown", str(files / "rt.csv"), "--reference", str(files / "pp.out"), "--design"]
    given = f"requirements.horizontal_position={limit}"
    assert main([*asked, str(files / "design.toml"), "--set", given, "-o", str(files / "out.json")]) == code
    answer = json.loads((files / "out.json").read_text())
    assert (answer["verdict"], answer["relation"], answer["relation_guessed"]) == (verdict, "smoothed", True)
    assert answer["solution"]["kind"] == "real-time"
    assert [line["name"] for line in answer["lines"]] == ["line 1", "line 2", "all lines"]
    assert verdict.capitalize() in capsys.readouterr().err


def test_without_a_second_solution_nothing_is_told(files, capsys) -> None:
    assert main(["flown", str(files / "pp.out"), "--design", str(files / "design.toml")]) == 5
    assert json.loads(capsys.readouterr().out)["verdict"] == "cannot be told"


def test_bad_input_is_one_message(files, capsys) -> None:
    design = ["--design", str(files / "design.toml")]
    assert main(["flown", str(files / "none.pos"), *design]) == 2
    assert main(["flown", str(files / "design.toml"), *design]) == 2
    assert main(["flown", str(files / "pp.out"), "--relation", "smoothed", *design]) == 2
    messages = [line for line in capsys.readouterr().err.splitlines() if line.startswith("navbudget:")]
    assert len(messages) == 3
    assert "needs a reference" in messages[-1]


def test_a_real_solution_of_half_a_second_is_refused(files, capsys) -> None:
    if not REAL.exists():
        pytest.skip("the shared data are not here")
    sbet = REAL / "sbet/leeward_sbet_rec0-99.out"
    assert main(["flown", str(sbet), "--design", str(files / "design.toml")]) == 2
    assert "a flight needs 20" in capsys.readouterr().err

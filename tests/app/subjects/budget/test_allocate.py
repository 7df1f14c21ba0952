"""The command `navbudget allocate`."""

import math
from pathlib import Path

import pytest
from commanded import reply

from app.cli import main
from nav_model.base.constants import SPEED_OF_LIGHT

_DESIGN = """
[requirements]
detrended_phase = "20°"
tilt = "1°"
confidence = 2
[[contributors]]
name = "lever arm"
value = "0.1 mm"
enters = "detrended_phase"
owner = "mechanics"
"""


@pytest.fixture
def design(tmp_path: Path) -> str:
    path = tmp_path / "design.toml"
    path.write_text(_DESIGN, "utf-8")
    return str(path)


def test_it_prints_the_contract_and_ends_with_0(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    result = reply(capsys, "allocate", design, "--split", "equal", "--reserve", "10%")
    assert result.keys() == {"requirement", "limit", "reserve", "closes", "blocked_by", "entries"}
    assert (result["requirement"], result["reserve"], result["closes"]) == ("detrended_phase", 0.1, True)
    square = sum(entry["allocated"] ** 2 for entry in result["entries"])
    assert math.sqrt(square) == pytest.approx(0.9 * math.radians(20), rel=1e-9)
    (arm,) = (entry for entry in result["entries"] if entry["source"] == "lever arm")
    assert arm["owner"] == "mechanics"
    assert arm["estimated"] == pytest.approx(2 * 4 * math.pi / (SPEED_OF_LIGHT / 9.6e9) * 1e-4, rel=1e-9)


def test_a_length_and_an_angle_lock_a_phase(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    locks = ["--lock", "lever arm=0.2 mm", "--lock", "gyro noise=5 deg"]
    result = reply(capsys, "allocate", design, "--requirement", "detrended_phase", *locks)
    entries = {entry["source"]: entry for entry in result["entries"]}
    assert entries["gyro noise"]["allocated"] == pytest.approx(math.radians(5), rel=1e-12)
    assert entries["lever arm"]["allocated"] == pytest.approx(4 * math.pi / (SPEED_OF_LIGHT / 9.6e9) * 2e-4, rel=1e-9)
    assert {name for name, entry in entries.items() if entry["locked"]} == {"lever arm", "gyro noise"}


def test_a_lock_that_leaves_nothing_is_named_with_1(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    locks = ["--lock", "gyro noise=30 deg", "--lock", "lever arm=0.1 mm"]
    result = reply(capsys, "allocate", design, *locks, code=1)
    assert (result["closes"], result["blocked_by"]) == (False, ["gyro noise"])


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--requirement", "yaw"], "--requirement"),
        (["--reserve", "20"], "--reserve"),
        (["--reserve", "100%"], "--reserve"),
        (["--lock", "gyro noise"], "--lock"),
        (["--lock", "gyro noise=5 m/s"], "--lock"),
        (["--lock", "weather=5 deg"], "--lock"),
        (["--lock", "gyro noise=5 deg", "--lock", "gyro noise=6 deg"], "--lock"),
    ],
)
def test_bad_input_is_named_with_2(
    design: str, capsys: pytest.CaptureFixture[str], options: list[str], named: str
) -> None:
    assert main(["allocate", design, *options]) == 2
    assert capsys.readouterr().err.startswith(f"navbudget: {named}: ")

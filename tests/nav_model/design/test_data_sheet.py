"""Rows of data sheets as they are copied: what is filled in, from which text, and what is listed instead."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.data_sheet import read_data_sheet

_DEGREE_PER_HOUR = math.radians(1) / 3600
_ARW, _VRW = "imu.angle_random_walk", "imu.velocity_random_walk"
_BG, _BA = "gyro.bias_instability", "accelerometer.bias_instability"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        (
            "Angle random walk 0.15 °/√h, bias instability 0.5 °/h, velocity random walk 0.06 m/s/√h",
            {_ARW: math.radians(0.15) / 60, _BG: 0.5 * _DEGREE_PER_HOUR, _VRW: 0.001},
        ),
        (
            "Angular Random Walk\t0.09\t°/√hr, 1σ\nIn-Run Bias Stability\t0.8\t°/hr\n"
            "Velocity Random Walk\t0.008\tm/sec/√hr\nIn-Run Bias Stability\t3.2\tµg, 1σ\nOutput data rate\t4250\tSPS",
            {_ARW: math.radians(0.09) / 60, _BG: 0.8 * _DEGREE_PER_HOUR, _VRW: 0.008 / 60, _BA: 3.2e-6 * 9.80665,
             "imu.rate": 4250.0},
        ),
        (
            "Gyro: ARW 0.15°/√h VRW 0,06 m/s/√h gyro bias instability (3σ): 1.5 deg/hr at 25 °C",
            {_ARW: math.radians(0.15) / 60, _VRW: 0.001, _BG: 0.5 * _DEGREE_PER_HOUR},
        ),
        (
            "Parameter\tConditions\tTyp\tUnit\nAngle Random Walk\t1 σ\t0.09\t°/√hr\nBias stability\t25 °C\t0.8\t°/hr",
            {_ARW: math.radians(0.09) / 60, _BG: 0.8 * _DEGREE_PER_HOUR},
        ),
        ("Output data rate 200 Hz\nBandwidth (-3 dB) 47 Hz", {"imu.rate": 200.0, "imu.bandwidth": 47.0}),
        ("| ARW | 0.15 | °/√h |\n| VRW | 0.06 | m/s/√h |", {_ARW: math.radians(0.15) / 60, _VRW: 0.001}),
        ("Rate noise density 0.004 (°/sec)/√Hz rms", {_ARW: math.radians(0.004)}),
        ("Bias repeatability 5 °/h\nAccelerometer bias repeatability 1.7 mg",
         {"gyro.turn_on_bias": 5 * _DEGREE_PER_HOUR, "accelerometer.turn_on_bias": 1.7e-3 * 9.80665}),
        ("Bias stability 10 °/h turn-on to turn-on", {"gyro.turn_on_bias": 10 * _DEGREE_PER_HOUR}),
        ("Linear acceleration effect on bias 0.009 °/s/g\nRate random walk 6 °/h/√h",
         {"gyro.g_sensitivity": math.radians(0.009) / 9.80665, "gyro.rate_random_walk": 0.1 * _DEGREE_PER_HOUR}),
        ("Angle random walk [°/√h]  0.15;  Noise: 3 mg rms @ 100 Hz BW",
         {_ARW: math.radians(0.15) / 60, _VRW: 0.3e-3 * 9.80665}),
    ],
)  # fmt: skip
def test_rows_are_filled_in_with_the_text_they_came_from(text, values):
    sheet = read_data_sheet(text)
    assert sheet.changes == pytest.approx(values, rel=1e-12)
    assert sheet.rest == ()
    design = Design().replace(sheet.changes, sheet.written, sheet.origins)
    words = " ".join(text.replace("|", " ").split())
    assert all(origin.removeprefix("data sheet: ") in words for origin in design.origins.values())


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("Angle random walk 0.3 °/h", "Write °/√h or °/h/√Hz"),
        ("Bias instability 0.5 1.0 °/h", "several numbers"),
        ("Bias stability over temperature ±10 °/h", "not known"),
        ("Bias stability ±10 °/h over temperature", "not known"),
        ("Scale factor error 100 ppm", "not known"),
        ("Range ±450 °/s", "not known"),
        ("Bias instability 0.5", "no unit"),
        ("<b>Weight</b> 55 g", "not known"),
        ("fine words", "not known"),
    ],
)
def test_what_is_not_understood_is_listed_and_fills_nothing(row, reason):
    sheet = read_data_sheet(row)
    assert sheet.changes == {}
    (rest,) = sheet.rest
    assert rest.startswith(f"{row}: ")
    assert reason in rest


def test_a_second_value_of_an_input_is_listed():
    sheet = read_data_sheet("Angle random walk 0.2 °/√h\nAngle random walk 0.3 °/√h")
    assert sheet.changes == {_ARW: pytest.approx(math.radians(0.2) / 60)}
    assert sheet.rest == ("Angle random walk 0.3 °/√h: a second value of Angle random walk",)


@pytest.mark.parametrize(
    "text", ["angle random walk 1 1 1 1 " * 190, "noise" + " 1" * 2400, "(" * 4999, "a, " * 1600]
)
def test_hostile_rows_fill_nothing(text):
    assert read_data_sheet(text).changes == {}


def test_a_longer_text_than_a_table_is_refused():
    with pytest.raises(InputError, match="Paste the table alone"):
        read_data_sheet("1 m\n" * 2000)


def test_blanks_are_joined_before_rows_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    class Spy:
        def split(self, text: str) -> list[str]:
            seen.append(text)
            return [text]

    monkeypatch.setattr("nav_model.design.data_sheet._BETWEEN", Spy())
    read_data_sheet("a" + " \t" * 2000 + "1\n" + " " * 500)
    assert seen == ["a 1\n"]

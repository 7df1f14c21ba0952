"""What a study adds to a design: read with units, refused by name, flown as it was given, said in words."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.simulation.conditions import conditions
from nav_model.simulation.design_study import specification
from nav_model.simulation.study_inputs import (
    NOTHING_ADDED,
    STUDY_KEYS,
    SimulationInputs,
    added,
    read_study_inputs,
    split_changes,
)

DPH = math.radians(1) / 3600
PAPER = Design({"flight.speed": 50.0})
# One value for every key, with what it is in SI computed by hand.
EVERYTHING = {
    "gyro.turn_on_bias": ("2 °/h", 2 * DPH),
    "gyro.bias_instability": ("25 °/h", 25 * DPH),
    "gyro.correlation_time": ("1000 s", 1000.0),
    "gyro.rate_random_walk": ("6 °/h/√h", 0.1 * DPH),
    "gyro.scale_factor": ("300 ppm", 3e-4),
    "gyro.misalignment": ("0.5 mrad", 5e-4),
    "gyro.quantization": ("1 arcsec", math.pi / 648_000),
    "accelerometer.turn_on_bias": ("2 mg", 2 * 9.80665e-3),
    "accelerometer.bias_instability": ("0.6 mg", 0.6 * 9.80665e-3),
    "accelerometer.correlation_time": ("4 h", 14_400.0),
    "accelerometer.rate_random_walk": ("60 µg/√h", 9.80665e-6),
    "accelerometer.scale_factor": ("0.1 %", 1e-3),
    "accelerometer.misalignment": ("0.2 mrad", 2e-4),
    "accelerometer.quantization": ("1 mm/s", 1e-3),
    "receiver.velocity_noise": ("2 cm/s", 0.02),
    "receiver.lever_forward": ("-1.5 m", -1.5),
    "receiver.lever_right": ("50 cm", 0.5),
    "receiver.lever_down": ("-1 m", -1.0),
    "filter.process_noise_scale": ("0.7", 0.7),
    "filter.gnss_noise_scale": ("1.3", 1.3),
    "filter.propagation_rate": ("20 Hz", 20.0),
    "filter.initial_yaw": ("0.5°", math.radians(0.5)),
}


def test_every_input_is_read_with_its_unit_and_reaches_the_flight() -> None:
    assert list(EVERYTHING) == list(STUDY_KEYS)
    more = read_study_inputs({key: text for key, (text, _) in EVERYTHING.items()})
    for key, (_, value) in EVERYTHING.items():
        assert more[key] == pytest.approx(value, rel=1e-12), key
    spec = specification(PAPER.replace({"imu.gyro_bias": DPH}), states=15, more=more)
    gyro, accelerometer = spec.imu.gyro, spec.imu.accelerometer
    assert gyro.random_walk == pytest.approx(math.radians(0.5) / 60)
    assert (gyro.residual_bias, gyro.turn_on_bias) == pytest.approx((DPH, 2 * DPH))
    assert gyro.bias_instability == pytest.approx(25 * DPH)
    assert gyro.quantization == pytest.approx(math.pi / 648_000)
    assert (accelerometer.correlation_time, accelerometer.misalignment) == pytest.approx((14_400.0, 2e-4))
    assert spec.gnss.lever_arm == pytest.approx((-1.5, 0.5, -1.0))
    assert spec.gnss.velocity_noise == pytest.approx(0.02)
    assert (spec.filter.states, spec.filter.process_noise_scale, spec.filter.propagation_rate) == (15, 0.7, 20.0)
    assert spec.initial.yaw == pytest.approx(math.radians(0.5))
    # What the specification holds is told again in full, under the same keys.
    assert added(spec) == pytest.approx({key: value for key, (_, value) in EVERYTHING.items()}, rel=1e-12)


def test_nothing_added_is_the_study_of_the_design_alone() -> None:
    assert specification(PAPER, more=NOTHING_ADDED) == specification(PAPER)
    assert added(specification(PAPER)) == {}
    assert read_study_inputs({"gyro.scale_factor": " "}) == NOTHING_ADDED


@pytest.mark.parametrize(
    ("key", "text", "reason"),
    [
        ("gyro.drift", "1 °/h", "unknown key; a study takes gyro.turn_on_bias"),
        ("gyro.bias_instability", "1 mg", "'mg' is not a unit of angular rate"),
        ("gyro.bias_instability", "-1 °/h", "The bias instability must be at least 0 °/h"),
        ("gyro.correlation_time", "0 s", "The correlation time must be at least 0.001 s"),
        ("accelerometer.scale_factor", "nan", "Enter the scale factor error, for example"),
        ("receiver.velocity_noise", "0 m/s", "must be at least 0.00001 m/s"),
        ("filter.process_noise_scale", "none", "is not a number"),
    ],
)
def test_what_cannot_be_is_refused_under_its_key(key: str, text: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        read_study_inputs({key: text})
    assert caught.value.key == key
    assert reason in caught.value.reason
    with pytest.raises(InputError):
        SimulationInputs(((key, math.nan),))


def test_changes_are_sorted_by_whose_they_are() -> None:
    of_design, of_study = split_changes(["imu.rate=200 Hz", "gyro.scale_factor = 3 ppm", "nonsense", "gyro"])
    assert of_design == ["imu.rate=200 Hz", "nonsense", "gyro"]
    assert of_study == {"gyro.scale_factor": "3 ppm"}


def test_conditions_name_what_was_added_and_what_the_filter_cannot_hold() -> None:
    def words(**texts: str) -> str:
        more = read_study_inputs({key.replace("__", "."): text for key, text in texts.items()})
        return " ".join(conditions(PAPER, specification(PAPER, states=15, more=more)))

    alone = words(gyro__bias_instability="25 °/h", gyro__correlation_time="1000 s")
    assert "gyro bias instability 25 °/h, gyro correlation time 1000 s" in alone
    assert "no state for" not in alone
    assert "one state for the sum" not in alone  # a Gauss-Markov bias alone is the filter's own model
    mixed = {"gyro__turn_on_bias": "1 °/h", "gyro__bias_instability": "25 °/h"}
    assert "The gyro bias is a Gauss-Markov process on top of" in words(**mixed)
    assert "no state for scale factor errors, quantization" in words(
        gyro__scale_factor="100 ppm", accelerometer__quantization="1 mm/s"
    )
    assert "mistuned on purpose: process noise factor 0.7" in words(filter__process_noise_scale="0.7")
    assert "yaw 2°" in words(filter__initial_yaw="2°")

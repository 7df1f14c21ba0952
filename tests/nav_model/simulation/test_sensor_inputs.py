"""Errors of the sensors, lever arm and filter of a design: read with units, refused by name, flown, told in words."""

import math

import pytest
from entered import entered

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, split_link, to_query
from nav_model.design.parts import Accelerometer, Filter, Gyro
from nav_model.simulation.conditions import conditions
from nav_model.simulation.design_study import beside_noise, specification

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
    "gyro.g_sensitivity": ("0.1 °/s/g", 360 * DPH / 9.80665),
    "accelerometer.turn_on_bias": ("2 mg", 2 * 9.80665e-3),
    "accelerometer.bias_instability": ("0.6 mg", 0.6 * 9.80665e-3),
    "accelerometer.correlation_time": ("4 h", 14_400.0),
    "accelerometer.rate_random_walk": ("60 µg/√h", 9.80665e-6),
    "accelerometer.scale_factor": ("0.1 %", 1e-3),
    "accelerometer.misalignment": ("0.2 mrad", 2e-4),
    "accelerometer.quantization": ("1 mm/s", 1e-3),
    "filter.process_noise_scale": ("0.7", 0.7),
    "filter.gnss_noise_scale": ("1.3", 1.3),
    "filter.propagation_rate": ("20 Hz", 20.0),
    "filter.initial_yaw": ("0.5°", math.radians(0.5)),
    "gnss.lever_forward": ("-1.5 m", -1.5),
    "gnss.lever_right": ("50 cm", 0.5),
    "gnss.lever_down": ("-1 m", -1.0),
}


def test_every_input_is_read_with_its_unit_and_reaches_the_flight() -> None:
    names = {f"{part.section}.{name}" for part in (Gyro, Accelerometer, Filter) for name in part.inputs()}
    assert names == {key for key in EVERYTHING if not key.startswith("gnss.")} | {"filter.states"}
    design = entered(PAPER, {key: text for key, (text, _) in EVERYTHING.items()})
    design = design.replace({"imu.gyro_bias": DPH, "filter.states": 15})
    for key, (_, value) in EVERYTHING.items():
        assert design[key] == pytest.approx(value, rel=1e-12), key
    spec = specification(design)
    gyro, accelerometer = spec.imu.gyro, spec.imu.accelerometer
    assert gyro.random_walk == pytest.approx(math.radians(0.5) / 60)
    assert (gyro.residual_bias, gyro.turn_on_bias) == pytest.approx((DPH, 2 * DPH))
    assert gyro.bias_instability == pytest.approx(25 * DPH)
    assert (gyro.quantization, gyro.g_sensitivity) == pytest.approx((math.pi / 648_000, 360 * DPH / 9.80665))
    assert (accelerometer.correlation_time, accelerometer.misalignment) == pytest.approx((14_400.0, 2e-4))
    assert spec.gnss.lever_arm == pytest.approx((-1.5, 0.5, -1.0))
    assert (spec.filter.states, spec.filter.process_noise_scale, spec.filter.propagation_rate) == (15, 0.7, 20.0)
    assert spec.initial.yaw == pytest.approx(math.radians(0.5))
    # They are written into a file and a link, and read again.
    assert parse_design(format_design(design)) == design
    assert from_query(to_query(design)) == design


def test_a_design_without_them_has_its_hash_and_its_file_of_before() -> None:
    plain = Design({"flight.speed": 50.0, "gyro.scale_factor": 0.0, "filter.states": 0})
    assert plain.content_hash == PAPER.content_hash
    assert PAPER.content_hash.startswith("4c304d2074d0")
    assert "[gyro]" not in format_design(PAPER)
    assert beside_noise(PAPER) == {}


@pytest.mark.parametrize(
    ("key", "text", "reason"),
    [
        ("gyro.drift", "1 °/h", "unknown key; [gyro] has turn_on_bias"),
        ("gyro.bias_instability", "1 mg", "'mg' is not a unit of angular rate"),
        ("gyro.bias_instability", "-1 °/h", "The gyro bias instability must be at least 0 °/h"),
        ("gyro.g_sensitivity", "1 °/h", "is not a unit of rate per acceleration. Use °/h/g or °/s/g"),
        ("gyro.correlation_time", "0 s", "The gyro correlation time must be at least 0.001 s"),
        ("accelerometer.scale_factor", "nan", "Enter the accelerometer scale factor error, for example"),
        ("filter.process_noise_scale", "none", "is not a number"),
        ("filter.states", "10", "0, 9, 12, 15, 18, 21"),
    ],
)
def test_what_cannot_be_is_refused_under_its_key(key: str, text: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_design(format_design(PAPER), changes=[f"{key}={text}"])
    assert caught.value.key == key
    assert reason in caught.value.reason


def test_names_and_links_of_before_are_read() -> None:
    """Inputs of a study once had names and settings of their own."""
    changes = ["receiver.lever_down=-1 m", "receiver.velocity_noise=2 cm/s"]
    design = parse_design(format_design(PAPER), changes=changes)
    assert (design.gnss.lever_down, design.gnss.velocity_noise) == (-1.0, 0.02)
    of_design, of_study = split_link(
        "v=50m/s&simulation.runs=20&simulation.states=15&trajectory.states=15"
        "&simulation.added=gyro.bias_instability%3D25%2B%25C2%25B0%252Fh%26receiver.lever_forward%3D2%2Bm%26x%3D1"
    )
    assert of_study == "simulation.runs=20"
    design = from_query(of_design)
    assert (design.filter.states, design.gnss.lever_forward) == (15, 2.0)
    assert design.gyro.bias_instability == pytest.approx(25 * DPH)


def test_conditions_name_what_formulas_leave_out_and_what_the_filter_cannot_hold() -> None:
    def words(**texts: str) -> str:
        design = entered(
            PAPER, {key.replace("__", "."): text for key, text in texts.items()} | {"filter.states": "15"}
        )
        return " ".join(conditions(design, specification(design)))

    alone = words(gyro__bias_instability="25 °/h", gyro__correlation_time="1000 s")
    assert "not in the formulas" not in alone
    assert "not in the formulas: gyro quantization 1 arcsec, antenna forward 2 m" in words(
        gyro__quantization="1 arcsec", gnss__lever_forward="2 m"
    )
    assert "turn with the aircraft" in words(gyro__turn_on_bias="1 °/h")
    assert "no state for" not in alone
    assert "one state for the sum" not in alone  # a Gauss-Markov bias alone is the filter's own model
    mixed = {"gyro__turn_on_bias": "1 °/h", "gyro__bias_instability": "25 °/h"}
    assert "The gyro bias is a Gauss-Markov process on top of" in words(**mixed)
    assert "no state for scale factor errors, quantization" in words(
        gyro__scale_factor="100 ppm", accelerometer__quantization="1 mm/s"
    )
    assert "mistuned on purpose: process noise factor 0.7" in words(filter__process_noise_scale="0.7")
    assert "yaw 2°" in words(filter__initial_yaw="2°")

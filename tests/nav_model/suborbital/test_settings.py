import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nav_model.base.errors import InputError
from nav_model.design.file import parse_design
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, from_design, output_every, read_changes
from nav_model.suborbital.study import SuborbitalInputs


def test_defaults_are_gp1_on_the_reference_flight():
    assert DEFAULTS.study_inputs() == SuborbitalInputs()


@given(st.tuples(*[st.floats(-900, 900)] * 3))
def test_three_axes_are_read_in_their_unit(axes):
    text = ", ".join(repr(a) for a in axes) + " mg"
    read = INPUTS["accelerometers.bias"].read(text)
    assert read == pytest.approx([a * 9.80665e-3 for a in axes], rel=1e-12, abs=1e-300)


def test_one_number_is_for_all_axes_and_each_may_carry_its_unit():
    gyro = INPUTS["gyros.bias"]
    assert gyro.read("360 °/h") == pytest.approx([math.radians(0.1)] * 3)
    mixed = gyro.read("1 °/h, 0.1 °/s, 0.5 deg/h")
    assert mixed == pytest.approx([math.radians(x) for x in (1 / 3600, 0.1, 0.5 / 3600)])
    assert gyro.read("0.1, 0.2, -0.1", "°/s") == pytest.approx([math.radians(x) for x in (0.1, 0.2, -0.1)])


def test_dropouts_are_intervals():
    assert INPUTS["tracker.dropouts"].read("200-260 s, 400 – 410.5") == ((200.0, 260.0), (400.0, 410.5))
    assert INPUTS["tracker.dropouts"].read("") == ()


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("tracker.latency", "5 kg", "not a unit of time"),
        ("tracker.latency", "-1 ms", "at least 0 ms"),
        ("tracker.latency", "nan s", "is not a time"),
        ("gyros.bias", "1, 2 °/h", "one for all axes, or three"),
        ("gyros.bias", "2000 °/h", "at most 1000 °/h in size"),
        ("tracker.dropouts", "260-200 s", "stop after it starts"),
        ("tracker.dropouts", "soon", "not an interval"),
        ("camera.method", "guess", "Choose TRIAD"),
        ("camera.brightest", "4.5", "not a whole number"),
        ("sky.magnitude_limit", "inf", "not allowed"),
        ("no.such", "1", "is not an input"),
        ("flight.burn_time", "160.05 s", "whole number of steps"),
        ("tracker.frame_interval", "1 m", "not a unit of time"),
    ],
)
def test_refusals_name_the_field(key, text, message):
    with pytest.raises(InputError, match=message) as caught:
        read_changes(DEFAULTS, {key: text}, "test")
    assert caught.value.key == key


def test_a_design_replaces_noise_and_constant_bias_only():
    design = parse_design(
        b'name = "D"\n[imu]\nvelocity_random_walk = "0.03 m/s/sqrt(h)"\nangle_random_walk = "0.12 deg/sqrt(h)"\n'
        b'accelerometer_bias = "2 mg"\ngyro_bias = "5 deg/h"\nvibration_factor = 3.0\n'
    )
    study = from_design(DEFAULTS, design)
    assert study["accelerometers.white_noise"] == pytest.approx(3 * 0.03 / 60)
    assert study["gyros.white_noise"] == pytest.approx(3 * math.radians(0.12) / 60)
    assert study["accelerometers.bias"] == pytest.approx([2 * 9.80665e-3 * s for s in (1, 1, -1)])
    assert study["gyros.bias"] == pytest.approx([math.radians(5) / 3600] * 3)
    came = {key for key, origin in study.origin.items() if origin == "design D"}
    assert came == {"accelerometers.white_noise", "gyros.white_noise", "accelerometers.bias", "gyros.bias"}
    assert all(study[key] == DEFAULTS[key] for key in INPUTS if key not in came)


@given(st.integers(1, 2000))
def test_output_spacing_divides_the_flight(tens):
    steps = 50 * tens
    every = output_every(steps)
    assert steps % every == 0
    assert steps // every <= 2000


def test_a_prime_number_of_steps_is_refused():
    with pytest.raises(InputError, match="multiple of 5 s"):
        output_every(15013)


def test_examples_all_enter_the_study():
    for path in sorted((Path(__file__).parents[3] / "examples").glob("*.toml")):
        from_design(DEFAULTS, parse_design(path.read_bytes(), path.name))

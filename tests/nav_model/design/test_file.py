"""Design files: nothing is lost, presets fill and yield, changes override."""

import math
import tomllib
from pathlib import Path

import pytest
from design_tables import any_design
from hypothesis import given, settings

import nav_model
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.file import format_design, parse_design, read_design
from nav_model.design.parts import INPUTS
from nav_model.design.presets import deviations, preset_fill

EXAMPLES = sorted((Path(nav_model.__file__).parent.parent / "examples").glob("*.toml"))


@settings(max_examples=40)
@given(any_design(reciprocals=True))
def test_writing_and_reading_again_gives_the_same_design_and_the_same_text(design):
    text = format_design(design)
    back = parse_design(text)
    assert back == design
    assert back.content_hash == design.content_hash
    assert format_design(back) == text
    for key, unit in design.written.items():
        if getattr(design, key.partition(".")[0]).given():  # else its section is not written
            assert back.written[key] == unit


def test_values_are_written_the_way_they_came():
    text = '[gnss]\nrate = "7 Hz"\n[radar]\nwavelength = "3.1 cm"\n[imu]\nangle_random_walk = "23 deg/h/rtHz"\n'
    tables = tomllib.loads(format_design(parse_design(text)))
    assert tables["gnss"]["rate"] == "7 Hz"
    assert "interval" not in tables["gnss"]
    assert tables["radar"]["wavelength"] == "3.1 cm"
    assert tables["imu"]["angle_random_walk"] == "23 °/h/√Hz"
    assert parse_design(text)["gnss.interval"] == 1 / 7
    assert parse_design(text)["radar.frequency"] == pytest.approx(299792458 / 0.031, rel=1e-15)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_survive(path):
    design = read_design(path)
    assert parse_design(format_design(design)) == design
    assert design.name
    assert design.description


@pytest.mark.parametrize("name", [n for n, e in catalogue("imu").items() if "velocity_random_walk" in e.values])
def test_an_inertial_preset_fills_its_random_walks_and_nothing_else(name):
    design = parse_design(f'[imu]\npreset = "{name}"')
    entry = catalogue("imu")[name]
    assert design["imu.preset"] == name
    default = Design()
    for key in INPUTS["imu"]:
        expected = entry.values[key].value if key in entry.values else default[f"imu.{key}"]
        assert design[f"imu.{key}"] == expected
    assert design["imu.gyro_bias"] == 0
    assert deviations(design, "imu") == frozenset()
    assert parse_design(format_design(design)) == design


@pytest.mark.parametrize("name", [n for n, e in catalogue("imu").items() if "velocity_random_walk" not in e.values])
def test_a_silent_data_sheet_takes_no_default(name):
    with pytest.raises(InputError) as caught:
        parse_design(f'[imu]\npreset = "{name}"')
    assert caught.value.key == "imu.velocity_random_walk"
    design = parse_design(f'[imu]\npreset = "{name}"\nvelocity_random_walk = "0.01 m/s/√h"')
    assert design["imu.velocity_random_walk"] == pytest.approx(0.01 / 60, rel=1e-15)


@pytest.mark.parametrize("name", catalogue("radar"))
def test_a_radar_preset_fills_the_radar_and_leaves_the_flight(name):
    design = parse_design(f'[radar]\npreset = "{name}"')
    for key, value in catalogue("radar")[name].values.items():
        assert design[f"radar.{key}"] == value.value
    assert design["flight.speed"] == Design()["flight.speed"]
    assert parse_design(format_design(design)) == design


def test_keys_given_override_the_preset_whatever_their_order_or_name():
    for text in (
        '[radar]\npreset = "F-SAR X"\nwavelength = "6 cm"\n',
        '[radar]\nwavelength = "6 cm"\npreset = "F-SAR X"\n',
        '[radar]\nwavelength = "60 mm"\npreset = "f-sar x"\n',
    ):
        design = parse_design(text)
        assert design["radar.frequency"] == pytest.approx(299792458 / 0.06, rel=1e-15)
        assert design["radar.azimuth_resolution"] == 0.2
        assert design["radar.preset"] == "F-SAR X"
        assert deviations(design, "radar") == {"frequency"}
        assert deviations(parse_design(format_design(design)), "radar") == {"frequency"}


def test_preset_fill_says_units_too():
    values, written = preset_fill("imu", "mpu-9250")
    assert values["imu.preset"] == "MPU-9250"
    assert written["imu.velocity_random_walk"] == "µg/√Hz"
    assert values["imu.angle_random_walk"] == pytest.approx(math.radians(0.01), rel=1e-15)


CHANGED = b'[imu]\npreset = "STIM300"\nangle_random_walk = "1 \xc2\xb0/\xe2\x88\x9ah"\n[gnss]\nrate = "5 Hz"\n'


@pytest.mark.parametrize(
    ("changes", "key", "value"),
    [
        (["imu.angle_random_walk=0.3 °/√h"], "imu.angle_random_walk", math.radians(0.3) / 60),
        (["imu.angle_random_walk = 0.3 deg/sqrt(h)"], "imu.angle_random_walk", math.radians(0.3) / 60),
        (["imu.preset=LN-200"], "imu.angle_random_walk", math.radians(0.07) / 60),
        (["imu.preset=LN-200", "imu.angle_random_walk=0.2 °/√h"], "imu.angle_random_walk", math.radians(0.2) / 60),
        (["imu.angle_random_walk=0.2 °/√h", "imu.preset=LN-200"], "imu.angle_random_walk", None),
        (["gnss.interval=3 s"], "gnss.interval", 3.0),
        (["gnss.rate=4 Hz"], "gnss.interval", 0.25),
        (['gnss.rate = "4 Hz"'], "gnss.interval", 0.25),
        (["imu.vibration_factor=8"], "imu.vibration_factor", 8.0),
        (["radar.autofocus_order=2"], "radar.autofocus_order", 2),
        (["gnss.correlated=true"], "gnss.correlated", True),
        (["radar.window=taylor"], "radar.window", "taylor"),
        (["name=x=y"], "name", "x=y"),
        (["imu.rate=1 Hz", "imu.rate=2 Hz"], "imu.rate", 2.0),
    ],
)
def test_changes_override_the_file(changes, key, value):
    got = parse_design(CHANGED, changes=changes)[key]
    if value is None:  # both were given on the command line: the preset does not undo its neighbour
        value = pytest.approx(math.radians(0.2) / 60, rel=1e-15)
    assert got == (pytest.approx(value, rel=1e-15) if isinstance(value, float) else value)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ("imu.angle_random_walk", "imu.angle_random_walk"),
        ("imu.arw=1 °/√h", "imu.arw"),
        ("arw=1", "arw"),
        ("imu=1", "imu"),
        ("imu.preset=Nokia", "imu.preset"),
        ("gnss.rate=0 Hz", "gnss.rate"),
        ("radar.autofocus_order=4", "radar.autofocus_order"),
        ("gnss.correlated=maybe", "gnss.correlated"),
        ("imu.vibration_factor=big", "imu.vibration_factor"),
    ],
)
def test_a_wrong_change_is_refused_by_its_key(change, key):
    with pytest.raises(InputError) as caught:
        parse_design(CHANGED, changes=[change])
    assert caught.value.key == key


def test_byte_order_mark_and_line_ends_do_not_matter():
    plain = parse_design('name = "a"\n[gnss]\nrate = "5 Hz"\n')
    assert parse_design(b'\xef\xbb\xbfname = "a"\r\n[gnss]\r\nrate = "5 Hz"\r\n') == plain

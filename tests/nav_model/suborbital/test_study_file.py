"""A study saved and opened, linked and followed, is the same study; a wrong one is refused by the field."""

import math
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.errors import InputError
from nav_model.design.declaration import Choice
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import split_link
from nav_model.design.several import Axes, Intervals, Whole
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import DEFAULTS, read_changes
from nav_model.suborbital.study_file import (
    format_study,
    from_link,
    is_study,
    parse_study,
    to_link,
)

HEADER = "time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg"


def value_of(declared):
    """Any value an input may take."""
    if isinstance(declared, Choice):
        return st.sampled_from(declared.objects)
    if isinstance(declared, Intervals):
        pair = st.tuples(st.floats(0, 1e4), st.floats(1e-6, 1e4)).map(lambda p: (p[0], p[0] + p[1]))
        return st.lists(pair.filter(lambda p: p[0] < p[1]), max_size=3).map(tuple)
    low, high = declared.limits
    if isinstance(declared, Whole):
        return st.integers(int(low), int(high)).map(float)
    if isinstance(declared, Axes):
        return st.tuples(*[st.floats(-high, high)] * len(declared.default))
    number = st.floats(low, high)
    return st.none() | number if declared.allow_None else number


# Inputs that must fit to others (burn-out on a step, pitch programme inside the burn) are drawn apart.
FREE = [
    key
    for key in INPUTS
    if not key.startswith("flight.")
    and key not in ("tracker.frame_interval", "camera.focal_length", "camera.brightest", "camera.least_stars")
] + ["flight.latitude", "flight.azimuth", "flight.gravity", "flight.final_thrust"]
STUDIES = st.fixed_dictionaries({}, optional={key: value_of(INPUTS[key]) for key in FREE})


@settings(max_examples=60)
@given(STUDIES)
def test_saved_and_opened_is_the_same_to_the_last_bit(changes):
    study = DEFAULTS.change(changes, "test")
    text = format_study(study, ("flown.csv", (HEADER + "\n0,0,0,0,0,90,0\n").encode()))
    again = parse_study(text.encode(), "mine.toml")
    assert dict(again.settings.values) == dict(study.values)
    assert again.trajectory == ("flown.csv", (HEADER + "\n0,0,0,0,0,90,0\n").encode())
    assert all(
        again.settings.origin[key] == ("GP-1" if study[key] == DEFAULTS[key] else "file mine.toml") for key in INPUTS
    )


@settings(max_examples=60)
@given(STUDIES)
def test_a_link_gives_the_same_study(changes):
    study = DEFAULTS.change(changes, "test")
    design, linked = split_link("?imu=LN-200&" + to_link(study) + "&f=1.3GHz")
    assert design == "imu=LN-200&f=1.3GHz"
    assert dict(from_link(linked).values) == dict(study.values)


def test_every_input_stands_in_the_file_in_its_unit():
    tables = tomllib.loads(format_study(DEFAULTS))
    assert tables["study"] == "suborbital"
    assert tables["gyros"]["bias"] == "3, 4, 2 °/h"
    assert tables["accelerometers"]["misalignment"] == "100, -100, -100, 100, 100, -100 ppm"
    assert tables["flight"]["burnout_pitch"] == "19°"
    assert tables["tracker"]["from_height"] == "none"
    assert tables["camera"]["pixel_pitch"] == "16 µm"
    stated = {f"{s}.{k}" for s, t in tables.items() if isinstance(t, dict) for k in t} | {"seed"}
    assert stated == set(INPUTS)


def test_what_is_not_stated_is_gp1():
    study = parse_study(b'study = "suborbital"\nseed = 7\n[gyros]\nbias = "1 deg/h"\n')
    assert study.settings["seed"] == 7
    assert study.settings["gyros.bias"] == pytest.approx([math.radians(1) / 3600] * 3)
    assert study.settings["initial.position"] == DEFAULTS["initial.position"]
    assert study.trajectory is None


def test_a_study_and_a_design_are_told_apart():
    design = format_design(parse_design(b'name = "D"\n')).encode()
    assert is_study(format_study(DEFAULTS).encode())
    assert not is_study(design)
    assert not is_study(b"\xff\xfe")
    with pytest.raises(InputError, match="study: is missing"):
        parse_study(design)
    with pytest.raises(InputError, match="study"):
        parse_design(format_study(DEFAULTS).encode())


@pytest.mark.parametrize(
    ("text", "key", "message"),
    [
        ('[gyros]\nbias = "1, 2 °/h"', "gyros.bias", "one for all axes, or three"),
        ("[gyros]\nbias = 3", "gyros.bias", "is not text in quotes"),
        ("[gyros]\nbias = true", "gyros.bias", "is not text in quotes"),
        ('[gyros]\nbias = ["1 °/h"]', "gyros.bias", "is not text in quotes"),
        ('[gyros]\nmisalignment = "1, 2, 3 ppm"', "gyros.misalignment", "one for all axes, or six"),
        ('[gyros]\nbiass = "3 °/h"', "gyros.biass", "unknown key; \\[gyros\\] has bias,"),
        ('[gyro]\nbias = "3 °/h"', "gyro", "unknown key; a study has seed, \\[accelerometers\\]"),
        ('gyros = "3 °/h"', "gyros", "must be a section"),
        ("seed = true", "seed", "True is not a number"),
        ("seed = 1.5", "seed", "not a whole number"),
        ("seed = nan", "seed", "not allowed"),
        ("seed = inf", "seed", "not allowed"),
        ("seed = 1" + "0" * 400, "seed", "not allowed"),
        ('[tracker]\nfrom_height = "5 kg"', "tracker.from_height", "not a unit of length"),
        ('[tracker]\nframe_interval = "0.15 s"', "tracker.frame_interval", "whole number of steps"),
        ('[camera]\nfocal_length = "5 m"', "camera.focal_length", "field of view of"),
        ('[sky]\nmagnitude_limit = "faint"', "sky.magnitude_limit", "not a number"),
        ('[sky]\nstars = "Gaia"', "sky.stars", "'Gaia' is not a choice here. Choose Hipparcos or synthetic."),
        ('[flight]\nburn_time = "120 s"', "flight.burn_time", "must rise in this order"),
        ('seed = 3\n[gyros]\nbias = "1 °/h"\n[flight]\nburn_time = "120 s"', "flight.burn_time", "must rise"),
        ('[flight]\nstep = "0.07 s"', "flight.step", "whole number of steps"),
        ('[flight]\nduration = "10000 s"\nstep = "0.02 s"', "flight.duration", "at most 100000 are flown"),
        ("trajectory = 3", "trajectory", "must be a section"),
        ('[trajectory]\nname = "a.csv"', "trajectory.csv", "is missing"),
        ('[trajectory]\nname = 3\ncsv = "x"', "trajectory.name", "is not text"),
        ('[trajectory]\nfile = "a.csv"', "trajectory.file", "unknown key"),
        ("[gyros", "mine.toml", "not a study file"),
        ("\0", "mine.toml", "not a study file"),
    ],
)
def test_refusals_name_the_field(text, key, message):
    with pytest.raises(InputError, match=message) as caught:
        parse_study(b'study = "suborbital"\n' + text.encode(), "mine.toml")
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b'study = "lunar"', "'lunar' is not allowed"),
        (bytes(range(256)), "not a text file"),
        (b"", "study: is missing"),
        (b"a = " + b"[" * 100_000, "nested too deeply|not a study file"),
        (b"#" * 17_000_001, "larger than 17 MB"),
    ],
)
def test_other_files_are_refused(content, message):
    with pytest.raises(InputError, match=message):
        parse_study(content, "mine.toml")


@pytest.mark.parametrize(
    ("query", "key"),
    [
        ("study.nonsense=1", "nonsense"),
        ("study.gyros.bias=1kg", "gyros.bias"),
        ("study.seed=1&study.seed=2", "seed"),
        ("study.seed", "link"),
        ("study.seed=%ff", "link"),
        ("study.seed=" + "1" * 20_000, "link"),
    ],
)
def test_wrong_links_are_refused(query, key):
    with pytest.raises(InputError) as caught:
        from_link(query)
    assert caught.value.key == key


def test_scale_factor_and_misalignment_of_each_axis_reach_the_model():
    study = read_changes(
        DEFAULTS,
        {"gyros.scale_factor": "1, 2, 3 ppm", "gyros.misalignment": "4, 5, 6, 7, 8, 9 ppm"},
        "test",
    )  # fmt: skip
    matrix = study.study_inputs().errors.gyros.constant_matrix
    assert [round(x * 1e6, 9) for row in matrix for x in row] == [1, 4, 5, 6, 2, 7, 8, 9, 3]

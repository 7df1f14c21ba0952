"""Design: defaults, bounds, immutability, identity."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import nav_model
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.file import parse_design
from nav_model.design.parts import INPUTS, declaration_of

QUANTITIES = [
    f"{section}.{name}"
    for section, inputs in INPUTS.items()
    for name, declaration in inputs.items()
    if isinstance(declaration, BaseQuantity)
]


@pytest.mark.parametrize("key", QUANTITIES)
def test_every_input_has_bounds_around_its_default(key):
    declaration = declaration_of(key)
    low, high = declaration.limits
    assert low < high
    soft_low, soft_high = declaration.softbounds
    assert low <= soft_low < soft_high <= high
    default = Design()[key]
    assert default is None or low <= default <= high


@pytest.mark.parametrize("key", QUANTITIES)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e301, -1e301, "1", True, [1.0]], ids=repr)
def test_what_is_no_number_or_out_of_bounds_is_refused_by_key(key, bad):
    with pytest.raises(InputError) as caught:
        Design({key: bad})
    assert caught.value.key == key
    assert str(caught.value).startswith(key)


@pytest.mark.parametrize("key", ["imu.accelerometer_bias", "imu.gyro_bias", "coast.before_aperture"])
def test_what_may_be_zero_may_but_not_less(key):
    assert Design({key: 0.0})[key] == 0
    with pytest.raises(InputError):
        Design({key: -1e-12})


@pytest.mark.parametrize("key", ["imu.bias", "bogus", "imu", "imu.", ".imu", "gnss.rate", "", "imu.imu.rate"])
def test_unknown_keys(key):
    with pytest.raises(InputError):
        Design({key: 1.0})


def test_a_design_does_not_change():
    design = Design()
    with pytest.raises(AttributeError):
        design.imu = None
    with pytest.raises(AttributeError):
        design.name = "other"
    for key in QUANTITIES:
        section, _, name = key.partition(".")
        with pytest.raises(TypeError):
            setattr(getattr(design, section), name, sum(declaration_of(key).limits) / 2)
    with pytest.raises(TypeError):
        design.written["imu.rate"] = "kHz"
    assert design == Design()


@pytest.mark.parametrize("key", QUANTITIES)
def test_replace_changes_one_value_and_leaves_the_original(key):
    base = Design({"name": "a", "imu.rate": 250.0})
    low, high = declaration_of(key).limits
    value = 0.75 * low + 0.25 * high
    other = base.replace({key: value})
    assert other[key] == value
    assert getattr(getattr(other, key.partition(".")[0]), key.partition(".")[2]) == value
    assert {k for k in base if base[k] != other[k]} == ({key} if base[key] != value else set())
    assert other != base
    assert other.content_hash != base.content_hash
    back = other.replace({key: base[key]})
    assert back == base
    assert hash(back) == hash(base)
    assert back.content_hash == base.content_hash


WRITTEN_TWICE = """
name = "a"
[imu]
velocity_random_walk = "{vrw}"
angle_random_walk = "{arw}"
[gnss]
{fixes}
[radar]
{carrier}
[flight]
latitude = "{latitude}"
"""


def test_identity_does_not_depend_on_units_or_way_of_saying():
    first = parse_design(
        WRITTEN_TWICE.format(
            vrw="0.06 m/s/√h",
            arw="0.6 °/√h",
            fixes='interval = "0.1 s"',
            carrier='frequency = "10 GHz"',
            latitude="0°",
        )
    )
    two = parse_design(
        WRITTEN_TWICE.format(
            vrw="0.001 m/s²/√Hz",
            arw="36 deg/h/sqrt(Hz)",
            fixes='rate = "10 Hz"',
            carrier='wavelength = "2.99792458 cm"',
            latitude="-0 rad",
        )
    )
    assert first == two
    assert hash(first) == hash(two)
    assert first.content_hash == two.content_hash
    assert first.unit("imu.velocity_random_walk") == "m/s/√h"
    assert two.unit("imu.velocity_random_walk") == "m/s²/√Hz"


@pytest.mark.parametrize("key", ["flight.latitude", "flight.heading", "flight.altitude", "imu.gyro_bias"])
def test_minus_zero_is_zero(key):
    assert Design({key: -0.0}) == Design({key: 0.0})
    assert Design({key: -0.0}).content_hash == Design({key: 0.0}).content_hash == Design({key: 0}).content_hash


def test_content_hash_is_the_same_in_another_process_with_another_hash_seed():
    root = Path(nav_model.__file__).parent.parent
    text = (root / "examples" / "tactical_x_band.toml").read_text(encoding="utf-8")
    code = (
        "import sys\nfrom nav_model.design.file import parse_design\n"
        "print(parse_design(sys.stdin.buffer.read()).content_hash)"
    )
    hashes = {
        subprocess.run(
            [sys.executable, "-c", code], cwd=root, input=text.encode(), capture_output=True, check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout.decode().strip()
        for seed in ("1", "2")
    }  # fmt: skip
    assert hashes == {parse_design(text).content_hash}
    assert len(hashes.pop()) == 64


@given(
    st.lists(st.tuples(st.sampled_from(["name", "description"]), st.text(max_size=8)), max_size=2).map(dict),
    st.lists(st.tuples(st.sampled_from(["name", "description"]), st.text(max_size=8)), max_size=2).map(dict),
)
def test_different_texts_have_different_hashes(first, second):
    a, b = Design(first), Design(second)
    assert (a == b) == (a.content_hash == b.content_hash)

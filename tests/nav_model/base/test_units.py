"""Quantity strings: spellings of data sheets, exactness both ways, refusals."""

import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.units import (
    format_quantity,
    from_si,
    parse_quantity,
    unit_symbol,
)

EVERY_UNIT = [(name, unit) for name, dimension in DIMENSIONS.items() for unit in dimension.units]
LINEAR = [(name, unit) for name, unit in EVERY_UNIT if not DIMENSIONS[name].decibels]
DECIBELS = [pair for pair in EVERY_UNIT if pair not in LINEAR]
FINITE = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e250, max_value=1e250).filter(
    lambda x: x == 0 or abs(x) > 1e-250
)


@pytest.mark.parametrize(("dimension", "unit"), LINEAR, ids=lambda value: value)
@settings(max_examples=15)
@given(value=FINITE)
def test_printing_and_reading_again_gives_the_same_float(dimension, unit, value):
    text = format_quantity(value, unit, dimension)
    back = parse_quantity(text, dimension)
    assert back.value == value
    assert back.unit == unit


@pytest.mark.parametrize(("dimension", "unit"), LINEAR, ids=lambda value: value)
@settings(max_examples=15)
@given(number=st.decimals(min_value="1e-6", max_value="1e6", places=6).filter(lambda d: d > 0))
def test_reading_then_printing_keeps_what_a_person_wrote(dimension, unit, number):
    """Up to fifteen digits every decimal survives the trip through a float, in whatever unit."""
    parsed = parse_quantity(f"{number} {unit}", dimension)
    text = format_quantity(parsed.value, unit, dimension)
    assert Fraction(text.removesuffix(unit).strip()) == Fraction(number)


@pytest.mark.parametrize(("dimension", "unit"), DECIBELS, ids=lambda value: value)
@settings(max_examples=15)
@given(level=st.decimals(min_value=-250, max_value=250, places=6), value=st.floats(1e-12, 1e12))
def test_decibels_too(dimension, unit, level, value):
    back = parse_quantity(format_quantity(value, unit, dimension), dimension)
    assert back == (value, unit)
    assert value == pytest.approx(10 ** (from_si(value, unit, dimension) / DIMENSIONS[dimension].decibels), rel=1e-13)
    parsed = parse_quantity(f"{level} {unit}", dimension)
    assert Fraction(format_quantity(parsed.value, unit, dimension).removesuffix(unit).strip()) == Fraction(level)


# (text, dimension, value in SI from definitions)
SPELLINGS = [
    ("0.05 m/s/√h", "velocity random walk", 0.05 / 60),
    ("0.05 m/s/sqrt(h)", "velocity random walk", 0.05 / 60),
    ("0.05 m/s/sqrt(hr)", "velocity random walk", 0.05 / 60),
    ("80 µg/√Hz", "velocity random walk", 80e-6 * 9.80665),
    ("80 μg/√Hz", "velocity random walk", 80e-6 * 9.80665),
    ("80 ug/sqrt(Hz)", "velocity random walk", 80e-6 * 9.80665),
    ("80 ug/rtHz", "velocity random walk", 80e-6 * 9.80665),
    ("0.08 mg/√Hz", "velocity random walk", 80e-6 * 9.80665),
    ("0.08 mg/sqrt(Hz)", "velocity random walk", 80e-6 * 9.80665),
    ("0.0008 m/s²/√Hz", "velocity random walk", 8e-4),
    ("0.0008 m/s^2/sqrt(Hz)", "velocity random walk", 8e-4),
    ("0.065 ft/s/√h", "velocity random walk", 0.065 * 0.3048 / 60),
    ("0.5 °/√h", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.5 deg/sqrt(h)", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.5 deg/sqrt(hour)", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.01 °/s/√Hz", "angle random walk", math.pi / 180 * 0.01),
    ("0.01 deg/s/sqrt(Hz)", "angle random walk", math.pi / 180 * 0.01),
    ("0.01 dps/√Hz", "angle random walk", math.pi / 180 * 0.01),
    ("30 °/h/√Hz", "angle random walk", math.pi / 180 * 30 / 3600),
    ("30 deg/h/sqrt(Hz)", "angle random walk", math.pi / 180 * 30 / 3600),
    ("1e-4 rad/√s", "angle random walk", 1e-4),
    ("1e-4 rad/sqrt(s)", "angle random walk", 1e-4),
    ("1 mg", "acceleration", 9.80665e-3),
    ("50 ug", "acceleration", 50 * 9.80665e-6),
    ("9.80665 m/s²", "acceleration", 9.80665),
    ("9.80665 m/s^2", "acceleration", 9.80665),
    ("1 °/h", "angular rate", math.pi / 180 / 3600),
    ("1 deg/h", "angular rate", math.pi / 180 / 3600),
    ("1 deg/hr", "angular rate", math.pi / 180 / 3600),
    ("1 °/s", "angular rate", math.pi / 180),
    ("45°", "angle", math.pi / 4),
    ("45 deg", "angle", math.pi / 4),
    ("10 arcsec", "angle", math.pi / 180 / 360),
    ("3 km", "length", 3000.0),
    ("2 cm", "length", 0.02),
    ("200 ms", "time", 0.2),
    ("9.6 GHz", "frequency", 9.6e9),
    ("100 m/s", "speed", 100.0),
    ("360 km/h", "speed", 100.0),
    ("100 kn", "speed", 100 * 1852 / 3600),
    ("1.5e-3 m", "length", 0.0015),
    ("-20 dB", "level", 0.1),
    ("-20 dBc/Hz", "phase noise", 0.01),
    ("0.04 g^2/Hz", "acceleration density", 0.04 * 9.80665**2),
    ("50 ug/g^2", "vibration rectification", 50e-6 / 9.80665),
    ("2 mm^2/Hz", "length density", 2e-6),
    (".5 m", "length", 0.5),
    ("−3 °", "angle", -math.pi / 60),
    ("  7   km ", "length", 7000.0),
]  # fmt: skip


@pytest.mark.parametrize(("text", "dimension", "value"), SPELLINGS, ids=[row[0] for row in SPELLINGS])
def test_spellings_of_data_sheets(text, dimension, value):
    assert parse_quantity(text, dimension).value == pytest.approx(value, rel=4e-16)


REFUSED = [
    ("", "length"), ("m", "length"), ("1", "length"), ("1 furlong", "length"), ("1 s", "length"),
    ("one m", "length"), ("nan m", "length"), ("inf m", "length"), ("1,500 m", "length"), ("1 m m", "length"),
    ("-5 Hz", "interval"), ("0 Hz", "interval"),
    ("1e999 m", "length"), ("1e99999999999 m", "length"), ("0x10 m", "length"), ("1 2 m", "length"),
    ("0.5 °/h", "angle random walk"), ("0.5 m/s/√h", "angle random walk"),
    ("0.5 °/√h", "velocity random walk"),
    ("80 µg", "velocity random walk"), ("1 °/√h", "angular rate"), ("1 m/s", "acceleration"),
    ("1 " + "m" * 200, "length"), ("1" * 200 + " m", "length"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "dimension"), REFUSED, ids=[f"{t[:20]}-{d}" for t, d in REFUSED])
def test_refusals_say_what_was_given_and_what_is_allowed(text, dimension):
    with pytest.raises(InputError) as caught:
        parse_quantity(text, dimension)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 250
    given = text.strip()[:10]
    assert given in message or "'" in message


def test_a_space_among_digits_is_named():
    with pytest.raises(InputError, match=r"'1 000 m' has a space in its number\. Write it without\."):
        parse_quantity("1 000 m", "length")


@pytest.mark.parametrize(
    ("text", "dimension", "value", "unit"),
    [("1,5 m", "length", 1.5, "m"), ("0,125 °", "angle", math.radians(0.125), "°"), (",5 s", "time", 0.5, "s"),
     ("5 Hz", "interval", 0.2, "s"), ("2,5 kHz", "interval", 4e-4, "s"), ("200 ms", "interval", 0.2, "ms")],
)  # fmt: skip
def test_a_decimal_comma_and_a_rate_are_read(text, dimension, value, unit):
    assert parse_quantity(text, dimension) == (pytest.approx(value, rel=1e-15), unit)


@pytest.mark.parametrize(("dimension", "unit"), EVERY_UNIT, ids=lambda value: value)
def test_canonical_symbols_are_fixed_points_and_examples_parse(dimension, unit):
    assert unit_symbol(unit, dimension) == unit
    for example in DIMENSIONS[dimension].examples:
        parse_quantity(example, dimension)


@pytest.mark.parametrize(("dimension", "unit"), LINEAR, ids=lambda value: value)
@settings(max_examples=15)
@given(value=st.floats(min_value=-1e280, max_value=1e280))
def test_an_amount_is_rounded_once(dimension, unit, value):
    assert from_si(value, unit, dimension) == float(Fraction(value) / DIMENSIONS[dimension].units[unit])


@pytest.mark.parametrize(
    ("value", "unit", "dimension", "digits", "text"),
    [
        (math.pi / 4, "°", "angle", None, "45°"),
        (math.pi / 4, "°", "angle", 3, "45°"),
        (0.05 / 60, "m/s/√h", "velocity random walk", 4, "0.05 m/s/√h"),
        (123456.789, "km", "length", 5, "123.46 km"),
        (1e-12, "m", "length", None, "1e-12 m"),
        (0.0, "mg", "acceleration", None, "0 mg"),
    ],
)
def test_printed_forms(value, unit, dimension, digits, text):
    assert format_quantity(value, unit, dimension, digits) == text

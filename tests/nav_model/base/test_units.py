"""Quantity strings: spellings of data sheets, exactness both ways, refusals."""

import math
import random
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.units import (
    format_quantity,
    from_si,
    parse_exact,
    parse_quantity,
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
    ("1.6968×10⁻⁴ rad/s/√Hz", "angle random walk", 1.6968e-4),
    ("1.7 x 10^-4 rad s-1 Hz-1/2", "angle random walk", 1.7e-4),
    ("±2·10-3 m/s", "speed", 2e-3),
    ("-2x10^3 m", "length", -2000.0),
    ("0.5 deg/hr^.5", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.5 ° h⁻½", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.5 ° h⁻¹ᐟ²", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("0.5 degrees per square root hour", "angle random walk", math.pi / 180 * 0.5 / 60),
    ("75 µg rms/√Hz", "velocity random walk", 75e-6 * 9.80665),
    ("3 micro g", "acceleration", 3e-6 * 9.80665),
    ("2 metres per second squared", "acceleration", 2.0),
    ("5 nautical miles", "length", 9260.0),
    ("5 arc-sec", "angle", math.pi / 180 / 720),
    ("3 m (68 %)", "length", 3.0),
    ("36 kmph", "speed", 10.0),
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
    assert DIMENSIONS[dimension].scale(unit).unit == unit
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


def test_what_was_read_before_the_grammar_reads_the_same():
    """Values and symbols as the reader of revision 439f4838 gave them, bit for bit."""
    lines = Path(__file__).with_name("spellings_at_439f4838.txt").read_text(encoding="utf-8").splitlines()
    count = 0
    for line in lines[1:]:
        dimension, symbol, value, spellings = line.split(" | ")
        for spelling in spellings.split("  "):
            text = f"0.5 {spelling.replace('␣', ' ')}"
            assert parse_quantity(text, dimension) == (float(value), symbol), text
            count += 1
    assert count == 937


# Names by what they are, written down here a second time, apart from those of the product.
_ANGLES = (("°", 0), ("deg", 0), ("degree", 0), ("degrees", 0), ("Deg", 0), ("m°", 3), ("mdeg", 3),
           ("millidegrees", 3), ("µdeg", 6), ("microdegree", 6))  # fmt: skip
_SECONDS = ("s", "sec", "second", "Sec", "SEC")
_ROOTS = ("√", "√ ", "sqrt ", "rt-", "root-", "root ", "Sqrt ")
_HERTZ = ("Hz", "hz", "HZ", "hertz")


def _spelling(rng: random.Random) -> str:
    """One of the ways to write 0.15 °/s/√Hz, which is 9 °/√h."""
    (angle, shift), second = rng.choice(_ANGLES), rng.choice(_SECONDS)
    hertz = rng.choice(_HERTZ)
    roots = [f"{rng.choice(_ROOTS)}{hertz}", f"√({hertz})", f"sqrt( {hertz} )", f"rt{hertz}", f"sqrt{hertz}"]
    root = rng.choice([*roots, *(f"{hertz}{power}" for power in ("^0.5", "^1/2", "^(1/2)", "**0.5"))])
    inverse, inverse_root = (
        rng.choice(["^-1", "⁻¹", "**-1", "-1"]),
        rng.choice(["^-1/2", "^-0.5", "^(-1/2)", "**-0.5"]),
    )
    times, over = rng.choice(["*", "·", " ", " * ", "."]), rng.choice(["/", " / ", " per "])
    if rng.random() < 0.2:  # abbreviations and hours
        angle, shift = rng.choice([("dps", 0), ("mdps", 3), ("milli-dps", 3), ("µdps", 6)])
        unit = rng.choice([f"{angle}{over}{root}", f"{angle} {hertz}{inverse_root}", f"{angle}{over}({root})"])
    else:
        unit = rng.choice([
            f"{angle}{over}{second}{over}{root}", f"({angle}{over}{second}){over}{root}",
            f"{angle}{over}({second}{times}{root})", f"{angle}{times}{second}{inverse}{times}{hertz}{inverse_root}",
            f"{angle}{over}{root}{over}{second}", f"{second}{inverse} {angle}{over}{root}",
            f"[{angle}{over}{second}{over}{root}]", f"{{{angle}{over}{second}}}{over}{root}",
            f"{angle}{over}({second}²{times}{hertz})^0.5{over}√{second}{times}√{second}",
        ])  # fmt: skip
    number = Fraction(15, 100) * 10**shift
    if rng.random() < 0.1:
        hour = rng.choice(["h", "hr", "hour"])
        number, unit = Fraction(9) * 10**shift, rng.choice([f"{angle}/√{hour}", f"{angle} {hour}^-1/2"])
        if "dps" in angle:
            number = Fraction(15, 100) * 10**shift
            unit = f"{angle}/√Hz"
    digits = f"{float(number):.{rng.randint(2, 6)}f}"
    digits = rng.choice(
        [digits, digits.replace(".", ",") if digits[-4] != "." else digits, f"{float(number) * 10:.2f}e-1"]
    )
    before = rng.choice(["", "", "", "±", "± ", "<", "≤ ", "typ ", "+/-"])
    after = rng.choice(["", "", "", " typ", " typ.", ", 1σ", " (1σ)", " @ 1σ", " 1 sigma", " rms", " RMS", " (rms)",
                        " per axis", " rms, 1σ", " @ 25 Hz"])  # fmt: skip
    return f"{before}{digits} {unit}{after}"


def test_ten_thousand_spellings_of_one_quantity_read_equal():
    rng = random.Random(40)
    texts = [text for text in (_spelling(rng) for _ in range(10_000)) if len(text) <= 100]
    value = float(Fraction(15, 100) * Fraction(math.pi) / 180)
    for text in texts:
        assert parse_quantity(text, "angle random walk").value == value, text
    assert len(set(texts)) > 9000


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("0.2 m CEP", "length", 0.2 / math.sqrt(2 * math.log(2))),
        ("1.0 m (CEP50)", "length", 1 / 1.17741),
        ("CEP 1.0 m", "length", 1 / 1.17741),
        ("2 m R95", "length", 2 / 2.44775),
        ("2 m CEP (95 %)", "length", 2 / 2.44775),
        ("3 m CE90", "length", 3 / 2.14597),
        ("2 m 2DRMS", "length", 1 / math.sqrt(2)),
        ("2 m 95 %", "length", 2 / 1.959964),
        ("2 m (LE90)", "length", 2 / 1.644854),
        ("1 m SEP", "length", 1 / 1.538172),
        ("0.3 °/h 3σ", "angular rate", math.radians(0.1) / 3600),
        ("0.3 °/h (3 sigma)", "angular rate", math.radians(0.1) / 3600),
        ("3 mg rms @ 100 Hz", "velocity random walk", 0.3e-3 * 9.80665),
        ("3 mg rms @ 100 Hz BW", "velocity random walk", 0.3e-3 * 9.80665),
        ("0.3 °/s in 900 Hz bandwidth", "angle random walk", math.radians(0.01)),
        ("0.01 °/s/√Hz @ 10 Hz", "angle random walk", math.radians(0.01)),
    ],
)
def test_words_about_accuracy_bring_a_number_to_one_sigma(text, dimension, value):
    """Against tables of the normal, Rayleigh and Maxwell distributions; what is written reads back exactly."""
    parsed = parse_quantity(text, dimension)
    assert parsed.value == pytest.approx(value, rel=3e-6)
    assert parse_quantity(format_quantity(parsed.value, parsed.unit, dimension), dimension) == parsed


def test_noise_that_grows_with_the_base_line_needs_it():
    for text in ("1 cm + 1 ppm", "(1 cm + 1 ppm)", "1 cm + 1 mm/km rms", "(10 mm + 1ppm) RMS"):
        exact, unit = parse_exact(text, "length", baseline=10e3)
        assert exact == Fraction(2, 100)
        value = float(parse_exact(text, "length", baseline=12_345.6)[0])
        again = format_quantity(value, unit, "length", baseline=12_345.6)
        assert float(parse_exact(again, "length", baseline=12_345.6)[0]) == value
        with pytest.raises(InputError, match=r"baseline. Write"):
            parse_quantity(text, "length")
    assert parse_exact("(1 cm + 1 ppm) CEP", "length", baseline=10e3)[0] == pytest.approx(Fraction(2 / 100 / 1.17741))


@pytest.mark.parametrize(
    ("text", "letters", "degrees"),
    [("48°12'30\"", "", 48 + 12.5 / 60), ("-48° 12' 30\"", "", -48 - 12.5 / 60), ("11.5° W", "EW", -11.5),
     ("N 48°12'30\"", "NS", 48 + 12.5 / 60), ("48°12′30″ S", "NS", -48 - 12.5 / 60), ("E 11°30.6'", "EW", 11.51),
     ("48.2N", "NS", 48.2)],
)  # fmt: skip
def test_places_have_minutes_seconds_and_points_of_the_compass(text, letters, degrees):
    assert float(parse_exact(text, "angle", letters=letters)[0]) == pytest.approx(math.radians(degrees), rel=1e-14)


ASKED = [
    ("0.3 °/h", "angle random walk", "°/√h or °/h/√Hz"),
    ("3 mg", "velocity random walk", "mg rms @ 100 Hz or mg/√Hz"),
    ("50'", "length", "ft or arcmin"),
    ("5 m", "time", "'m' is not a unit of time"),
    ("5 mg", "length", "'mg' is not a unit"),
    ("100 nm", "length", "NM (nautical miles) or 0.001 µm"),
    ("9600 mhz", "frequency", "mHz or MHz"),
    ("2 m 2DRMS (95 %)", "length", "twice, 95 % and 2DRMS"),
    ("1 °/h CEP", "angular rate", "CEP is of a place"),
    ("48° N", "angle", "without a point of the compass"),
    ("48°61'", "angle", "60 minutes or seconds"),
    ("1 kg", "acceleration", "'kg' is not a unit"),
]


@pytest.mark.parametrize(("text", "dimension", "message"), ASKED, ids=[row[0] for row in ASKED])
def test_what_has_two_meanings_is_asked_for(text, dimension, message):
    with pytest.raises(InputError) as caught:
        parse_quantity(text, dimension)
    assert message in str(caught.value)


HOSTILE = ["1 " + "(" * 97, "1 m" + "^9" * 40, "1 ppm^12" + "^12" * 20, "1 " + "((ppm^9)^9)" * 8,
           "1 " + "√" * 90 + "m", "1" + " " * 97 + "x", "1 m" + " typ" * 24, "1 m " + "1σ " * 30,
           "1 " + "m/" * 49, "1 km^12/km^12·km^12"]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:12])
@pytest.mark.parametrize("dimension", ["length", "ratio", "angle random walk"])
def test_hostile_units_are_refused_or_read_in_little_arithmetic(text, dimension):
    try:
        exact, _ = parse_exact(text, dimension)
    except InputError:
        return
    assert exact.denominator.bit_length() < 10_000


def test_a_unit_of_a_column_is_read_without_a_number():
    assert float(DIMENSIONS["angular rate"].scale("rad s^-1").size) == 1.0
    assert DIMENSIONS["acceleration"].scale("milli-g")[:2] == ("mg", Fraction("0.00980665"))
    with pytest.raises(InputError, match="'rad' is not a unit of angular rate"):
        DIMENSIONS["angular rate"].scale("rad")
    with pytest.raises(InputError, match="is not a unit of angular rate"):
        DIMENSIONS["angular rate"].scale(" " * 1_000_000)


_KINDS = {"imu.angle_random_walk": "angle random walk", "imu.velocity_random_walk": "velocity random walk",
          "imu.accelerometer_bias": "acceleration", "imu.gyro_bias": "angular rate", "gnss.position_noise": "length",
          "flight.altitude": "length", "flight.speed": "speed", "gnss.velocity_noise": "speed",
          "radar.frequency": "frequency", "flight.latitude": "angle"}  # fmt: skip


_ONE_VALUE = {"0.15 °/√h @ 25 °C"}
"""Of the texts without a value there: with one, as the temperature of a room takes nothing from it."""


def test_further_numbers_as_sheets_and_manuals_print_them():
    printed = Path(__file__).resolve().parents[4] / "shared" / "data" / "brought" / "units5.txt"
    if not printed.is_file():
        pytest.skip(f"numbers as printed are not present at {printed}")
    for line in printed.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            continue
        dimension, text, value = (part.strip() for part in line.split(" | "))
        if value == "-" and text not in _ONE_VALUE:
            with pytest.raises(InputError):
                parse_quantity(text, dimension)
        elif value != "-":
            assert parse_quantity(text, dimension).value == pytest.approx(float(value), rel=2e-5), text


def test_numbers_as_sheets_manuals_and_threads_print_them():
    printed = Path(__file__).resolve().parents[4] / "shared" / "data" / "brought" / "units.txt"
    if not printed.is_file():
        pytest.skip(f"numbers as printed are not present at {printed}")
    for line in printed.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            continue
        key, text, value = (part.strip() for part in line.split(" | "))
        letters = "NS" if key == "flight.latitude" else ""
        if value == "ask":
            with pytest.raises(InputError, match=r"may mean|baseline"):
                parse_exact(text, _KINDS[key])
        else:
            exact, _ = parse_exact(text, _KINDS[key], letters=letters)
            assert float(exact) == pytest.approx(float(value), rel=1e-7), text

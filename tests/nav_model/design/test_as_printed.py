"""Numbers as data sheets print them, in a design: what is written stays in the file, what counts is 1σ per axis."""

import math
import re

import pytest
from scipy.stats import chi

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.parts import declaration_of


def chi_of_space(share: float) -> float:
    """SciPy's radius of the sphere with a share of a normal distribution."""
    return float(chi.ppf(share, 3))


_CEP = math.sqrt(2 * math.log(2))  # of a circular normal distribution, in sigmas


def _conversion(design: Design, key: str) -> str:
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    return declaration.conversion(design[key], design.written[key], design.baseline)


@pytest.mark.parametrize(
    ("key", "text", "value", "note"),
    [
        ("gnss.position_noise", "0.2 m CEP", 0.2 / _CEP, "0.2 m CEP = 0.170 m, 1σ per axis"),
        ("gnss.position_noise", "20 cm (CEP)", 0.2 / _CEP, "20 cm CEP = 17.0 cm, 1σ per axis"),
        ("gnss.position_noise", "2 m (R95)", 2 / 2.447747, "2 m R95 = 0.817 m, 1σ per axis"),
        ("gnss.position_noise", "2 m LE90", 2 / 1.644854, "2 m LE90 = 1.22 m, 1σ per axis"),
        ("gnss.position_noise", "1.5 m 3D SEP 90 %", 1.5 / chi_of_space(0.9), "1.5 m SEP90 = 0.600 m, 1σ per axis"),
        ("gnss.position_noise", "2 m SEP", 2 / chi_of_space(0.5), "2 m SEP = 1.30 m, 1σ per axis"),
        ("gnss.position_noise", "3 m 3D RMS", math.sqrt(3), "3 m MRSE = 1.73 m, 1σ per axis"),
        ("gnss.position_noise", "H: 8 mm RMS", 8e-3 / math.sqrt(2), "8 mm HRMS = 5.66 mm, 1σ per axis"),
        ("gnss.position_noise", "2 m horizontal 95 %", 2 / 2.447747, "2 m R95 = 0.817 m, 1σ per axis"),
        ("gnss.vertical_position_noise", "15 mm (VRMS)", 15e-3, "15 mm VRMS = 15.0 mm, 1σ per axis"),
        ("gnss.position_noise", "2 m 95 %", 2 / 1.959964, "2 m 95 % = 1.02 m, 1σ per axis, taken as of one axis"),
        ("imu.velocity_random_walk", "3 mg rms @ 100 Hz", 0.3e-3 * 9.80665,
         "3 mg @ 100 Hz = 0.177 m/s/√h over √(100 Hz)"),
        ("imu.accelerometer_bias", "250 mGal", 2.5e-3, "250 mGal = 0.255 mg"),
    ],
)  # fmt: skip
def test_a_file_keeps_what_was_written_and_says_what_was_made_of_it(key, text, value, note):
    section, _, name = key.partition(".")
    design = parse_design(f'[{section}]\n{name} = "{text}"\n')
    assert design[key] == pytest.approx(value, rel=1e-6)
    assert _conversion(design, key) == note
    printed = format_design(design)
    assert f'{name} = "{note.partition(" = ")[0]}"' in printed
    assert parse_design(printed) == design
    assert from_query(to_query(design)) == design


def test_set_takes_what_a_file_takes():
    design = parse_design('[gnss]\nposition_noise = "1 m"\n', changes=["gnss.position_noise=1.5 m R95"])
    assert design.gnss.position_noise == pytest.approx(1.5 / 2.447747, rel=1e-6)


def test_noise_written_with_ppm_follows_the_base_line():
    """1 cm + 1 ppm is 2 cm at 10 km, and 4 cm at 30 km, in whatever order a file has the keys."""
    text = '[gnss]\nposition_noise = "1 cm + 1 ppm"\nbaseline = "10 km"\n'
    design = parse_design(text)
    assert design.gnss.position_noise == 0.02
    assert _conversion(design, "gnss.position_noise") == "1 cm + 1 ppm = 2.00 cm, 1σ per axis"
    assert 'position_noise = "1 cm + 1 ppm"' in format_design(design)
    farther = design.replace({"gnss.baseline": 30e3})
    assert farther.gnss.position_noise == pytest.approx(0.04, rel=1e-15)
    assert parse_design(format_design(farther)) == farther
    assert parse_design(text, changes=["gnss.baseline=30 km"]) == farther
    slid = farther.replace({"gnss.position_noise": 0.005})  # a value is a value, below what the baseline adds too
    assert parse_design(format_design(slid)) == slid
    with pytest.raises(InputError, match=r"gnss.position_noise: '1 cm \+ 1 ppm' grows with the baseline. Give gnss"):
        parse_design('[gnss]\nposition_noise = "1 cm + 1 ppm"\n')
    with pytest.raises(InputError, match="grows with the baseline"):
        farther.replace({"gnss.baseline": None})


def test_a_limit_is_no_accuracy():
    with pytest.raises(InputError, match=r"the horizontal position is not a 1σ\. Write m alone"):
        parse_design('[requirements]\nhorizontal_position = "10 m CEP"\n')
    with pytest.raises(InputError, match=r"flight.speed: '100 m/s 3σ' states an accuracy"):
        parse_design('[flight]\nspeed = "100 m/s 3σ"\n')
    with pytest.raises(InputError, match=r"gnss.vertical_position_noise: '2 m CEP' is of a circle"):
        parse_design('[gnss]\nvertical_position_noise = "2 m CEP"\n')
    with pytest.raises(InputError, match="is of a circle"):
        parse_design('[gnss]\nvertical_position_noise = "2 m R95"\n')
    assert parse_design('[gnss]\nvertical_position_noise = "2 m LE90"\n').gnss.vertical_position_noise < 2
    limit = '[[limits]]\nname = "near"\non = "coast_horizontal_velocity"\nlimit = "1 m/s 95 %"\n'
    with pytest.raises(InputError, match="states an accuracy"):
        parse_design(limit)
    added = '[[contributors]]\nname = "arm"\nvalue = "{}"\nenters = "{}"\n'
    design = parse_design(added.format("3 mm 3σ", "horizontal_position"))
    assert design.contributors[0].value == pytest.approx(1e-3)
    assert parse_design(format_design(design)) == design
    with pytest.raises(InputError, match="states an accuracy"):
        parse_design(added.format("3 m CE90", "ce90"))


def test_places_have_points_of_the_compass():
    design = parse_design('[flight]\nlatitude = "N 48°12\'30\\""\n')
    assert math.degrees(design.flight.latitude) == pytest.approx(48 + 12.5 / 60, rel=1e-14)
    assert parse_design(format_design(design)) == design
    points = declaration_of("trajectory.waypoints").read("48°12'30\" N, 11°30' W, 3000; S 1°, 11.5 E, 10000 ft MSL")
    degrees = [[math.degrees(angle) for angle in row[:2]] for row in points]
    assert degrees[0] == pytest.approx([48 + 12.5 / 60, -11.5])
    assert degrees[1] == pytest.approx([-1, 11.5])
    assert points[1][2] == pytest.approx(3048)
    with pytest.raises(InputError, match="Write it with N or S"):
        parse_design('[flight]\nlatitude = "48° E"\n')


def test_a_drift_is_no_random_walk():
    with pytest.raises(InputError, match=r"no angle random walk\. Write °/√h or °/h/√Hz"):
        parse_design('[imu]\nangle_random_walk = "0.3 °/h"\n')


@pytest.mark.parametrize(
    ("key", "text", "reason"),
    [
        ("gnss.position_noise", "1 m 3DRMS", "Write a third of it as DRMS, or it as MRSE"),
        ("gnss.position_noise", "H: 8 mm RMS, V: 15 mm RMS", "has two numbers. Write the one of this input"),
        (
            "gnss.position_noise",
            "10 mm + 1.0 ppm (x baseline length)",
            "grows with the baseline. Give gnss.baseline",
        ),
        ("gnss.position_noise", "1 cm + 1 mm/km", "grows with the baseline. Give gnss.baseline"),
        ("gnss.vertical_position_noise", "2 m HRMS", "is of a circle"),
        ("imu.gyro_bias", "10 °/h (-40 to 85 °C)", "is over a range of temperatures"),
        ("gyro.scale_factor", "0.5 % FS", "is of a range"),
        ("trajectory.heading_noise", "0.05° RMS @ 30 m/s", "holds at one speed"),
        ("imu.accelerometer_bias", "5 mg (H)", "is not a unit of acceleration"),
    ],
)
def test_what_has_no_value_or_two_meanings_is_asked_for(key: str, text: str, reason: str) -> None:
    section, _, name = key.partition(".")
    with pytest.raises(InputError, match=re.escape(reason)):
        parse_design(f'[{section}]\n{name} = "{text}"\n')


@pytest.mark.parametrize("words", ["@ 25 °C", "(+25°C)", "at 25 °C typ.", "(1σ, each axis)", "max"])
def test_words_that_leave_a_number_as_it_is(words: str) -> None:
    assert parse_design(f'[imu]\nangle_random_walk = "0.15 °/√h {words}"\n') == parse_design(
        '[imu]\nangle_random_walk = "0.15 °/√h"\n'
    )


def test_a_ratio_may_be_a_plain_number() -> None:
    assert Design({"gyro.scale_factor": 1e-3}).gyro.scale_factor == 1e-3
    assert parse_design('[gyro]\nscale_factor = "1e-3"\n').gyro.scale_factor == 1e-3

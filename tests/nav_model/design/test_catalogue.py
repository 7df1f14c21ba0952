"""The catalogue against the table it was made from, retyped here, converted by hand."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.design.catalogue import STATUSES, catalogue, find, read_catalogue

# name: ARW °/√h, VRW m/s/√h, gyro bias °/h, accelerometer bias mg; None where the page gives none.
IMUS = {
    "MPU-9250": (0.6, 0.177, None, None),
    "Xsens MTi-1": (0.42, 0.071, 10, 0.03),
    "ADIS16448": (0.66, 0.11, None, None),
    "ADIS16488": (0.3, 0.029, 6.5, 0.1),
    "ADIS16495-1": (0.09, 0.008, 0.8, 0.0032),
    "SBG Ellipse2": (0.15, 0.033, 7, 0.014),
    "STIM300": (0.15, 0.06, 0.5, 0.05),
    "HG1125": (0.3, 0.055, 7, 1.5),
    "HG1700": (0.125, 0.0198, 1, 1),
    "KVH FOG (SPAN-CPT)": (0.0667, None, 1, None),
    "LN-200": (0.07, 0.03, 0.35, 0.05),
    "iMAR FSAS": (0.1, 0.03, 0.75, 1),
    "Sagem Primus 200": (0.004, 0.035, 0.05, 2),
    "HG9900": (0.002, None, 0.0035, 0.025),
    "LN-100": (0.001, 0.003, 0.003, 0.01),
    "HG4930": (0.04, 0.03, 0.25, 0.025),
    "VN-100": (0.21, 0.082, 10, 0.04),
}
# name: wavelength m, range m, azimuth resolution m, speed m/s, aperture s with k = 1 as printed (or None).
RADARS = {
    "F-SAR X": (0.0312, 7e3, 0.2, 90, 6.1),
    "F-SAR C": (299792458 / 5.30e9, 7e3, 0.3, 90, None),
    "F-SAR S": (299792458 / 3.25e9, 7e3, 0.35, 90, None),
    "F-SAR L": (0.226, 7e3, 0.4, 90, 22),
    "F-SAR P": (299792458 / 0.35e9, 7e3, 1.5, 90, None),
    "E-SAR X": (0.03, 4.5e3, 0.25, 85, 3.3),
    "UAVSAR": (0.238, 17e3, 1, 220, 9.2),
    "Sandia RTV": (0.018, 9e3, 0.45, 80, 2.2),
    "Lynx spotlight": (0.018, 15e3, 0.1, 36, 37),
    "Lynx strip map": (0.018, 15e3, 0.3, 36, 12),
    "MiniSAR": (0.018, 6e3, 0.1, 36, 15),
    "PAMIR": (0.032, 30e3, 0.1, 100, 48),
    "STAR-3i": (0.031, 11e3, 1.25, 200, 0.7),
    "GeoSAR X": (0.031, 14e3, 1, 200, 1.1),
    "Pi-SAR2": (0.031, 12e3, 0.3, 200, 3.1),
    "AIRSAR C": (0.0567, 11e3, 1, 215, 1.5),
    "MathWorks example": (0.0299792458, 10e3, 1, 100, 1.4990),
}
FROM_MEMORY = {  # [M] on the page: no source was reached
    ("imu", "ADIS16495-1", "velocity_random_walk"),
    *(("imu", name, key) for name in ("HG4930", "VN-100")
      for key in ("angle_random_walk", "velocity_random_walk", "gyro_bias", "accelerometer_bias")),
    ("radar", "UAVSAR", "frequency"), ("radar", "UAVSAR", "azimuth_resolution"),
    ("radar", "Lynx spotlight", "frequency"), ("radar", "Lynx strip map", "frequency"),
    ("radar", "MiniSAR", "frequency"), ("radar", "PAMIR", "frequency"),
    ("radar", "AIRSAR C", "azimuth_resolution"),
}  # fmt: skip
# Starred on the page, or one figure chosen out of a span the source gives.
ASSUMED = {
    *(("radar", name, key) for name in RADARS if name not in {"MiniSAR", "PAMIR", "MathWorks example"}
      for key in ("slant_range", "speed")),
    ("radar", "MiniSAR", "speed"), ("radar", "PAMIR", "speed"),
    *(("radar", f"F-SAR {band}", "altitude") for band in "XCSLP"),
    ("radar", "E-SAR X", "altitude"), ("radar", "Sandia RTV", "altitude"), ("radar", "STAR-3i", "altitude"),
    ("radar", "GeoSAR X", "altitude"), ("radar", "GeoSAR X", "frequency"),
    ("radar", "PAMIR", "azimuth_resolution"),
}  # fmt: skip


def test_the_catalogue_holds_the_pages_units_and_no_others():
    assert set(catalogue("imu")) == set(IMUS)
    assert set(catalogue("radar")) == set(RADARS)


@pytest.mark.parametrize("name", IMUS)
def test_inertial_units(name):
    entry = catalogue("imu")[name]
    # The page rounds converted random walks to three digits or less.
    si = (math.pi / 180 / 60, 1 / 60, math.pi / 180 / 3600, 9.80665e-3)
    have = {**entry.values, **entry.extra}
    keys = ("angle_random_walk", "velocity_random_walk", "gyro_bias", "accelerometer_bias")
    for key, printed, factor in zip(keys, IMUS[name], si, strict=True):
        if printed is None:
            assert key not in have
        else:
            assert have[key].value / factor == pytest.approx(printed, rel=9e-3), key
    assert not {"gyro_bias", "accelerometer_bias"} & set(entry.values)  # data-sheet biases fill nothing


@pytest.mark.parametrize("name", RADARS)
def test_radars(name):
    entry = catalogue("radar")[name]
    wavelength, slant_range, resolution, speed, aperture = RADARS[name]
    have = {**entry.values, **entry.extra}
    assert 299792458 / have["frequency"].value == pytest.approx(wavelength, rel=0.02)
    assert have["slant_range"].value == slant_range
    assert have["azimuth_resolution"].value == pytest.approx(resolution, rel=0.02)
    assert have["speed"].value == speed
    if aperture is not None:
        k1 = 299792458 / have["frequency"].value * slant_range / (2 * have["azimuth_resolution"].value * speed)
        assert k1 == pytest.approx(aperture, rel=0.05)


@pytest.mark.parametrize("kind", ["imu", "radar"])
def test_every_value_has_a_unit_a_source_and_an_honest_status(kind):
    for name, entry in catalogue(kind).items():
        for key, value in {**entry.values, **entry.extra}.items():
            where = (kind, name, key)
            assert value.source.strip()
            assert value.unit
            assert value.status in STATUSES
            assert value.confirmed == (value.status == "confirmed")
            if where in FROM_MEMORY:
                assert value.status == "unconfirmed", where
                assert value.source == "unverified"
            elif where in ASSUMED:
                assert value.status == "assumed", where
            else:
                assert value.status in {"confirmed", "secondary"}, where


def test_names_are_found_whatever_the_case_and_others_refused_with_the_list():
    assert find("imu", " stim300 ").name == "STIM300"
    with pytest.raises(InputError, match=r"radar\.preset: 'F-SAR Z' is not in the catalogue; it has F-SAR X"):
        find("radar", "F-SAR Z")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("[[imu]]\n", "imu catalogue"),
        ("[[imu]]\nname = 3", "imu catalogue"),
        ("imu = 3", "imu catalogue"),
        ("[[imu", "imu catalogue"),
        ('[[imu]]\nname = "a"\nrate = "1 Hz"', "imu.a.rate"),
        ('[[imu]]\nname = "a"\nwheels = {value = "1 m", status = "confirmed", source = "s"}', "imu.a.wheels"),
        ('[[imu]]\nname = "a"\nrate = {value = "1 Hz", status = "sure", source = "s"}', "imu.a.rate"),
        ('[[imu]]\nname = "a"\nrate = {value = "1 Hz", status = "confirmed"}', "imu.a.rate"),
        ('[[imu]]\nname = "a"\nrate = {value = "1 m", status = "confirmed", source = "s"}', "imu.rate"),
        ('[[imu]]\nname = "a"\ngyro_bias = {value = "1 m", status = "confirmed", source = "s"}', "imu.a.gyro_bias"),
    ],
)
def test_a_users_catalogue_is_refused_by_name_and_key(text, key):
    with pytest.raises(InputError) as caught:
        read_catalogue(text, "imu")
    assert caught.value.key == key

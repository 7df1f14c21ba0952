"""Tables of IMUs and kalibr's files as catalogues: values with their source, what is not used named."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry
from nav_model.design.offers import read_offers

ARW, VRW = math.radians(0.15) / 60.0, 0.06 / 60.0
TABLES = {
    "semicolons": "Model;Type;ARW [deg/sqrt(hr)];VRW [m/s/sqrt(hr)];Gyro in-run bias [deg/hr];Price [USD]\n"
    "Unit A;MEMS;0.15;0.06;0.5;8000\n",
    "commas, units in the cells": "IMU,Angle random walk,Velocity random walk,Gyro bias stability,Cost\n"
    "Unit A,0.15 °/√h,0.06 m/s/√h,0.5 °/h,8000 USD\n",
    "tabs, decimal commas": "Product\tGrade\tAngular Random Walk (°/√h)\tVRW (m/s/√h)\t"
    "Gyro bias instability (°/h)\tPrice (kUSD)\n"
    "Unit A\tMEMS\t0,15\t0,06\t0,5\t8\n",
    "densities": "Name,Gyro noise density [°/s/√Hz],Accel noise density [m/s²/√Hz],"
    "Gyro bias in-run [°/h],Price [USD]\n"
    "Unit A,0.0025,0.001,0.5,8000\n",
    "quoted, with a comment": '# ours\n"Model","ARW [°/√h]","VRW [m/s/√h]","Gyro in-run bias [°/h]","Price [USD]"\n'
    '"Unit A","0.15","0.06","0.5","8000"\n',
}


def only(text: str) -> Entry:
    (entry,) = read_offers(text)["imu"].values()
    return entry


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_imus_is_a_catalogue(name: str) -> None:
    entry = only(TABLES[name])
    assert entry.name == "Unit A"
    assert entry.values["angle_random_walk"].value == pytest.approx(ARW)
    assert entry.values["velocity_random_walk"].value == pytest.approx(VRW)
    assert "your table, column " in entry.values["angle_random_walk"].source
    bias = entry.extra["gyro_bias"]
    assert (bias.value, bias.kind) == (pytest.approx(math.radians(0.5) / 3600), "in-run")
    assert entry.offer["price"].value == 8000.0


def test_what_a_table_has_beside_is_named() -> None:
    entry = only(
        "Model;ARW [°/√h];VRW [m/s/√h];Gyro range [°/s];Gyro turn-on bias [°/h];"
        "Mass [g];Bought\nA;0.1;0.1;400;3;55;no\n"
    )
    assert entry.note == "Not used: Gyro range [°/s] 400, Bought no."
    assert entry.extra["gyro_bias"].kind == "repeatability"
    assert entry.offer["mass"].value == pytest.approx(0.055)


KALIBR = """#Accelerometers
accelerometer_noise_density: 1.0e-03   #Noise density (continuous-time)
accelerometer_random_walk:   1.0e-04
gyroscope_noise_density:     4.4e-05
gyroscope_random_walk:       1.0e-06
rostopic:                    /imu0
update_rate:                 200.0
"""


@pytest.mark.parametrize(
    "text", [KALIBR, "imu0:\n" + KALIBR.replace("\n", "\n  "), KALIBR.replace("1.0e-03", "'1.0e-03'")]
)
def test_kalibr_s_file_is_a_catalogue_in_si(text: str) -> None:
    entry = only(text)
    assert entry.name == "IMU /imu0 (imu.yaml)"
    assert entry.values["angle_random_walk"].value == 4.4e-5
    assert entry.values["velocity_random_walk"].value == 1e-3
    assert "gyroscope_random_walk 1.0e-06" in entry.note


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Model;ARW;VRW [m/s/√h]\nA;0.15;0.06\n", r"'0.15' under 'ARW' has no unit. Write it in the column's name"),
        ("Model;ARW [°/√h]\nA;0.15;0.06\n", "the row 'A' has 3 fields, its head 2"),
        ("Model;ARW [°/√h]\n" + "A;1\n" * 2001, "at most 2000 rows"),
        ("Model;ARW [m]\nA;0.15\n", "'m' is not a unit of angle random walk"),
        ('Model;ARW [°/√h]\n"A;' + "x" * 200_000, "is a table that cannot be read"),
        ("Model;" + "gyr" * 2000 + "\nA;1\n", "not a catalogue file"),
        ("a,b\n1,2\n", "not a catalogue file"),
    ],
)
def test_what_is_no_such_table_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_offers(text)

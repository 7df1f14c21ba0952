"""Values for other people's filters, read back by rules of those filters."""

import csv
import math
import re

import numpy as np
import pandas as pd
import pytest
import yaml
from pyins.measurements import NedVelocity, Position

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR, MILLI_G
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.other_filters import CORRELATION_TIME, FILTERS, noise_for

DESIGN = Design().replace(
    {
        "imu.angle_random_walk": 0.15 * DEGREE / 60,
        "imu.velocity_random_walk": 0.06 / 60,
        "imu.gyro_bias": 0.5 * DEGREE_PER_HOUR,
        "imu.accelerometer_bias": 0.05 * MILLI_G,
        "imu.vibration_factor": 2.0,
        "imu.rate": 250.0,
        "gnss.velocity_noise": 0.03,
    }
)
_ARW, _VRW = 2 * DESIGN.imu.angle_random_walk, 2 * DESIGN.imu.velocity_random_walk


def bias_after(walk: float, bias: float, time: float) -> tuple[float, float]:
    """What a random walk and a Gauss-Markov bias of the assumed correlation time gain, 1 sigma."""
    return walk * math.sqrt(time), bias * math.sqrt(2 * (1 - math.exp(-time / CORRELATION_TIME)))


def test_kalibr_reads_densities_in_si() -> None:
    config = yaml.safe_load(noise_for(DESIGN, "kalibr"))
    # Its reader takes these keys, and wants each above zero (kalibr_common/ConfigReader.py, ImuParameters).
    assert config["gyroscope_noise_density"] == pytest.approx(_ARW, rel=1e-12)
    assert config["accelerometer_noise_density"] == pytest.approx(_VRW, rel=1e-12)
    assert (config["update_rate"], config["rostopic"]) == (250.0, "/imu0")
    walked, gained = bias_after(config["gyroscope_random_walk"], DESIGN.imu.gyro_bias, 60.0)
    assert walked == pytest.approx(gained, rel=0.01)
    walked, gained = bias_after(config["accelerometer_random_walk"], DESIGN.imu.accelerometer_bias, 60.0)
    assert walked == pytest.approx(gained, rel=0.01)
    # 0.3 °/√h is 0.005 °/s/√Hz by the usual rule of sixty.
    assert math.degrees(config["gyroscope_noise_density"]) == pytest.approx(0.3 / 60, rel=1e-12)
    with pytest.raises(InputError, match="kalibr needs a bias above zero"):
        noise_for(DESIGN.replace({"imu.gyro_bias": 0.0}), "kalibr")


def test_px4_adds_the_variance_of_the_random_walks() -> None:
    lines = [line for line in noise_for(DESIGN, "px4").splitlines() if not line.startswith("#")]
    rows = list(csv.reader(lines, delimiter="\t"))
    assert all((row[0], row[1]) == ("1", "1") and row[4] in {"6", "9"} for row in rows)
    values = {row[2]: float(row[3]) for row in rows}
    period = values["EKF2_PREDICT_US"] * 1e-6
    # Its covariance prediction adds (period times noise)² each period (EKF/covariance.cpp).
    steps = round(60.0 / period)
    assert steps * (period * values["EKF2_GYR_NOISE"]) ** 2 == pytest.approx(_ARW**2 * 60, rel=1e-9)
    assert steps * (period * values["EKF2_ACC_NOISE"]) ** 2 == pytest.approx(_VRW**2 * 60, rel=1e-9)
    gained = bias_after(0, DESIGN.imu.gyro_bias, 60.0)[1]
    assert math.sqrt(steps) * period * values["EKF2_GYR_B_NOISE"] == pytest.approx(gained, rel=0.01)
    assert "EKF2_GYR_B_NOISE" not in noise_for(Design(), "px4")  # PX4 keeps its own
    assert (values["EKF2_GPS_P_NOISE"], values["EKF2_GPS_V_NOISE"]) == (1.0, 0.03)
    assert "outside what PX4 allows, 0.0001 to 0.1" in noise_for(
        DESIGN.replace({"imu.angle_random_walk": 1e-7}), "px4"
    )


def test_px4_has_the_noise_of_heights_beside_what_it_takes() -> None:
    text = noise_for(DESIGN.replace({"gnss.vertical_position_noise": 1.6}), "px4")
    (heights,) = (line for line in text.splitlines() if line.startswith("# Heights"))
    assert [float(number) for number in re.findall(r"(\S+) m\b", heights)] == [1.6, 1.5]
    assert "Heights" not in noise_for(DESIGN, "px4")


def test_kf_gins_reads_data_sheet_units() -> None:
    config = yaml.safe_load(noise_for(DESIGN, "kf-gins"))
    noise = config["imunoise"]
    # Its loader multiplies by D2R/60, 1/60, D2R/3600, 1e-5 and 3600 (kf_gins.cpp).
    assert np.array(noise["arw"]) * math.pi / 180 / 60 == pytest.approx([_ARW] * 3, rel=1e-12)
    assert np.array(noise["vrw"]) / 60 == pytest.approx([_VRW] * 3, rel=1e-12)
    assert np.array(noise["gbstd"]) * math.pi / 180 / 3600 == pytest.approx([DESIGN.imu.gyro_bias] * 3, rel=1e-12)
    assert np.array(noise["abstd"]) * 1e-5 == pytest.approx([DESIGN.imu.accelerometer_bias] * 3, rel=1e-12)
    assert noise["corrtime"] * 3600 == CORRELATION_TIME
    assert noise["gbstd"] == pytest.approx([0.5] * 3)
    assert set(noise) == {"arw", "vrw", "gbstd", "abstd", "gsstd", "asstd", "corrtime"}


def test_pyins_runs_the_file() -> None:
    names: dict[str, object] = {}
    exec(noise_for(DESIGN, "pyins"), names)
    gyro, accelerometer = names["gyro_model"], names["accel_model"]
    assert gyro.v == pytest.approx([_ARW] * 3, rel=1e-12)  # type: ignore[attr-defined]
    assert accelerometer.v == pytest.approx([_VRW] * 3, rel=1e-12)  # type: ignore[attr-defined]
    assert np.diag(gyro.P) == pytest.approx([DESIGN.imu.gyro_bias**2] * 3, rel=1e-12)  # type: ignore[attr-defined]
    assert gyro.q == pytest.approx([DESIGN.imu.gyro_bias * math.sqrt(2 / CORRELATION_TIME)] * 3)  # type: ignore[attr-defined]
    exec(noise_for(Design(), "pyins"), names)  # without biases
    assert names["gyro_model"].n_states == 0  # type: ignore[attr-defined]
    vertical = {"gnss.vertical_position_noise": 1.6, "gnss.vertical_velocity_noise": 0.07}
    exec(noise_for(DESIGN.replace(vertical), "pyins"), names)
    place = pd.DataFrame({"lat": [50.0], "lon": [8.0], "alt": [100.0]}, index=[0.0])
    speed = pd.DataFrame({"VN": [0.0], "VE": [0.0], "VD": [0.0]}, index=[0.0])
    position, velocity = Position(place, names["position_sd"]), NedVelocity(speed, names["velocity_sd"])
    np.testing.assert_allclose(position.R, np.diag([1.0, 1.0, 1.6**2]))
    np.testing.assert_allclose(velocity.R, np.diag([0.03**2, 0.03**2, 0.07**2]))


def test_every_filter_is_written() -> None:
    for name in FILTERS:
        assert noise_for(DESIGN, name).startswith("# Sensor noise of a NavBudget design")


def test_an_instability_moves_with_its_own_correlation_time_beside_a_rate_random_walk() -> None:
    """As kalibr and pyins take a bias: after a second, far below its correlation time of 100 s."""
    varying = {
        "gyro.bias_instability": 2 * DEGREE_PER_HOUR,
        "gyro.correlation_time": 100.0,
        "gyro.rate_random_walk": 1e-7,
        "accelerometer.scale_factor": 3e-4,
    }
    design = DESIGN.replace(varying)
    config = yaml.safe_load(noise_for(design, "kalibr"))
    markov = 2 * DEGREE_PER_HOUR * math.sqrt(2 * (1 - math.exp(-1.0 / 100.0)))
    assert config["gyroscope_random_walk"] == pytest.approx(math.hypot(markov, 1e-7), rel=0.01)
    assert "bias with correlation time of 0.0277778 h" in noise_for(design, "kalibr")
    gins = noise_for(design, "kf-gins")
    assert "asstd: [3.000000000000e+02, 3.000000000000e+02, 3.000000000000e+02]  # [ppm]" in gins
    assert re.search(r"gbstd: \[2\.0+e\+00", gins)
    assert "corrtime: 0.0277777777778  # [hr]\n" in gins

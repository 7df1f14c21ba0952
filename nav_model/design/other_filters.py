"""A design's sensor noise in the files and parameters of other people's filters.

A bias is the design's bias instability with its correlation time, else its residual bias, which has no time scale
and takes `CORRELATION_TIME`. Where a filter asks how fast it moves, it is a random walk of sigma·√(2/τ), as long as
that is short of τ, and of the rate random walk beside it.

Sources, key by key:

- kalibr: wiki pages "YAML formats" and "IMU noise model" (github.com/ethz-asl/kalibr): noise densities in
  rad/s/√Hz and m/s²/√Hz, random walks of the biases in rad/s²/√Hz and m/s³/√Hz, update_rate in Hz.
- PX4: src/modules/ekf2/module.yaml, params_gyro_bias.yaml, params_accel_bias.yaml and params_gnss.yaml: rad/s, m/s²,
  rad/s², m/s³, m, m/s, µs. EKF/covariance.cpp multiplies the four noises by its period and squares them at every
  prediction, so they are densities over the root of that period. EKF/aid_sources/gnss/gnss_height_control.cpp has
  the noise of heights.
- KF-GINS: dataset/kf-gins.yaml (github.com/i2Nav-WHU/KF-GINS): deg/√h, m/s/√h, deg/h, mGal, hours, Hz.
- pyins: docstring of pyins.inertial_sensor.EstimationModel: SI; noise and bias_walk are roots of power densities.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.parts import Accelerometer, Gyro

CORRELATION_TIME = 3600.0
"""Of residual biases, s: assumed, since a design does not give it."""

PERIOD = 0.01
"""Prediction period of PX4's EKF2, s: its default EKF2_PREDICT_US."""

_MGAL = 1e-5


class _Noise(NamedTuple):
    """Gyro or accelerometer in SI: density, bias, the random walk of the bias, its correlation time with a word where
    that is assumed, and the scale factor."""

    density: float
    bias: float
    walk: float
    time: float
    assumed: str
    scale: float


def _real(value: float) -> str:
    """A number with a point, without which YAML 1.1 takes "1e-05" for a text."""
    return f"{value:.12e}"


def _noises(design: Design) -> tuple[_Noise, _Noise]:
    """Gyro and accelerometer, vibration factor applied."""
    imu = design.imu

    def noise(density: float, residual: float, sensor: Gyro | Accelerometer) -> _Noise:
        instability = sensor.bias_instability
        bias, time = (instability, sensor.correlation_time) if instability else (residual, CORRELATION_TIME)
        walk = math.hypot(bias * math.sqrt(2 / time), sensor.rate_random_walk)
        assumed = "" if instability else "an assumed "
        return _Noise(density * imu.vibration_factor, bias, walk, time, assumed, sensor.scale_factor)

    return (
        noise(imu.angle_random_walk, imu.gyro_bias, design.gyro),
        noise(imu.velocity_random_walk, imu.accelerometer_bias, design.accelerometer),
    )


def _moving(noise: _Noise) -> str:
    """Words on how the bias moves."""
    return f"bias with {noise.assumed}correlation time of {noise.time / 3600:g} h"


def _head(*noises: _Noise) -> str:
    zero = "# A bias of zero is the design's; enter the in-run bias where the filter needs one.\n"
    return _HEAD if all(noise.bias for noise in noises) else _HEAD + zero


def _kalibr(design: Design) -> str:
    gyro, accelerometer = _noises(design)
    for key, noise in (("imu.gyro_bias", gyro), ("imu.accelerometer_bias", accelerometer)):
        if noise.walk == 0:
            raise InputError(key, "kalibr needs a bias above zero. Enter the in-run bias, or an instability.")
    return (
        f"{_HEAD}accelerometer_noise_density: {_real(accelerometer.density)}  # m/s^2/sqrt(Hz)\n"
        f"accelerometer_random_walk: {_real(accelerometer.walk)}  # m/s^3/sqrt(Hz), {_moving(accelerometer)}\n"
        f"gyroscope_noise_density: {_real(gyro.density)}  # rad/s/sqrt(Hz)\n"
        f"gyroscope_random_walk: {_real(gyro.walk)}  # rad/s^2/sqrt(Hz), {_moving(gyro)}\n"
        f"rostopic: /imu0\nupdate_rate: {_real(design.imu.rate)}  # Hz\n"
    )


def _px4(design: Design) -> str:
    """The parameter file that QGroundControl reads: MAVLink ids, name, value and type (6 int32, 9 float)."""
    gyro, accelerometer = _noises(design)
    root = math.sqrt(PERIOD)
    gnss = design.gnss
    values: dict[str, tuple[float, str]] = {
        "EKF2_ACC_NOISE": (accelerometer.density / root, "m/s^2 at the prediction period"),
        "EKF2_GPS_P_NOISE": (gnss.position_noise, "m"),
        "EKF2_GYR_NOISE": (gyro.density / root, "rad/s at the prediction period"),
    }
    # What the design does not say keeps PX4's own value.
    if accelerometer.bias:
        values["EKF2_ACC_B_NOISE"] = accelerometer.walk / root, f"m/s^3, {_moving(accelerometer)}"
    if gyro.bias:
        values["EKF2_GYR_B_NOISE"] = gyro.walk / root, f"rad/s^2, {_moving(gyro)}"
    if gnss.velocity_noise is not None:
        values["EKF2_GPS_V_NOISE"] = gnss.velocity_noise, "m/s"
    vertical = ""
    if gnss.vertical_position_noise is not None:
        vertical = (
            f"# Heights: the design has {_real(gnss.vertical_position_noise)} m. EKF2 has no parameter for them: it "
            f"takes what the receiver reports, and no less than {_PX4_VERTICAL} times EKF2_GPS_P_NOISE, "
            f"{_real(_PX4_VERTICAL * gnss.position_noise)} m.\n"
        )
    comments = "".join(
        f"# {name}: {unit}{_beyond(value, *_PX4_RANGES[name])}\n" for name, (value, unit) in values.items()
    )
    rows = "".join(f"1\t1\t{name}\t{_real(value)}\t9\n" for name, (value, _) in values.items())
    return f"{_HEAD}{comments}{vertical}1\t1\tEKF2_PREDICT_US\t{round(PERIOD * 1e6)}\t6\n{rows}"


_PX4_VERTICAL = 1.5
"""Least noise of heights in PX4's EKF2 over that of the horizontal position."""

_PX4_RANGES = {
    "EKF2_GYR_NOISE": (0.0001, 0.1), "EKF2_ACC_NOISE": (0.01, 1.0), "EKF2_GPS_P_NOISE": (0.01, 10.0),
    "EKF2_GPS_V_NOISE": (0.01, 5.0), "EKF2_GYR_B_NOISE": (0.0, 0.01), "EKF2_ACC_B_NOISE": (0.0, 0.01),
}  # fmt: skip
"""Bounds of PX4, as its files of parameters say."""


def _beyond(value: float, low: float, high: float) -> str:
    return "" if low <= value <= high else f"; outside what PX4 allows, {low:g} to {high:g}"


def _kf_gins(design: Design) -> str:
    gyro, accelerometer = _noises(design)
    slower = max(gyro, accelerometer, key=lambda noise: (not noise.assumed, noise.time))  # it has one for both

    def three(value: float) -> str:
        return f"[{', '.join([_real(value)] * 3)}]"

    return (
        f"{_head(gyro, accelerometer)}# To be put in place of these keys of kf-gins.yaml.\n"
        f"imudatarate: {round(design.imu.rate)}  # [Hz]\nimunoise:\n"
        f"  arw: {three(gyro.density / DEGREE * 60)}  # [deg/sqrt(hr)]\n"
        f"  vrw: {three(accelerometer.density * 60)}  # [m/s/sqrt(hr)]\n"
        f"  gbstd: {three(gyro.bias / DEGREE_PER_HOUR)}  # [deg/hr]\n"
        f"  abstd: {three(accelerometer.bias / _MGAL)}  # [mGal]\n"
        f"  gsstd: {three(1e6 * gyro.scale)}  # [ppm]\n  asstd: {three(1e6 * accelerometer.scale)}  # [ppm]\n"
        f"  corrtime: {slower.time / 3600:.12g}  # [hr]{', assumed' if slower.assumed else ''}\n"
    )


def _pyins(design: Design) -> str:
    gyro, accelerometer = _noises(design)

    def model(noise: _Noise) -> str:
        bias, walk = (noise.bias, noise.walk) if noise.bias else (None, None)
        return f"inertial_sensor.EstimationModel(bias_sd={bias!r}, noise={noise.density!r}, bias_walk={walk!r})"

    def axes(level: float, upright: float | None) -> str:
        return f"np.array([{level!r}, {level!r}, {level if upright is None else upright!r}])"

    gnss = design.gnss
    velocity = ""
    if gnss.velocity_noise is not None:
        sizes = axes(gnss.velocity_noise, gnss.vertical_velocity_noise)
        velocity = f"velocity_sd = {sizes}  # m/s, of measurements.NedVelocity\n"
    return (
        f"{_head(gyro, accelerometer)}# SI; bias_walk: {_moving(gyro)}, {_moving(accelerometer)}; of fixes: north, "
        "east, down.\n"
        f"import numpy as np\nfrom pyins import inertial_sensor\n\n"
        f"gyro_model = {model(gyro)}\naccel_model = {model(accelerometer)}\n"
        f"position_sd = {axes(gnss.position_noise, gnss.vertical_position_noise)}  # m, of measurements.Position\n"
        f"{velocity}"
    )


_HEAD = "# Sensor noise of a NavBudget design, 1 sigma per axis, vibration factor applied.\n"


class OtherFilter(NamedTuple):
    """A filter: what it is called, the name of its file, and what writes it."""

    label: str
    file_name: str
    write: Callable[[Design], str]


FILTERS: Mapping[str, OtherFilter] = MappingProxyType(
    {
        "kalibr": OtherFilter("kalibr", "imu.yaml", _kalibr),
        "px4": OtherFilter("PX4 EKF2", "ekf2.params", _px4),
        "kf-gins": OtherFilter("KF-GINS", "kf-gins-imunoise.yaml", _kf_gins),
        "pyins": OtherFilter("pyins", "pyins_noise.py", _pyins),
    }
)
"""Name on the command line -> the filter."""


def noise_for(design: Design, name: str) -> str:
    """The design's noise as a filter of `FILTERS` reads it.

    Raises
    ------
    InputError
        If the filter cannot take a value that the design has.
    """
    return FILTERS[name].write(design)

"""Errors of a sensor beyond its white noise, as its data sheet prints them; all are nothing unless given."""

from typing import Any

from nav_model.base.constants import DEGREE_PER_HOUR, MILLI_G, STANDARD_GRAVITY
from nav_model.design.declaration import Quantity
from nav_model.design.part import Part

_SINCE = "0.2.0"


def _error(
    dimension: str,
    unit: str,
    short: str,
    highest: float,
    label: str,
    doc: str,
    datasheet: str,
    typical: str,
    source: str = "",
) -> Any:
    """An error that is zero unless given, `source` its name in shares, where a figure takes it."""
    return Quantity(
        default=0.0,
        dimension=dimension,
        unit=unit,
        short=short,
        bounds=(0.0, highest),
        label=label,
        doc=doc,
        datasheet=datasheet,
        typical=typical,
        source=source,
        variable=bool(source),
        since=_SINCE,
    )


def _correlation_time(short: str, sensor: str) -> Any:
    return Quantity(
        default=3600.0,
        dimension="time",
        unit="s",
        short=short,
        bounds=(1e-3, 1e9),
        softbounds=(10.0, 1e4),
        label=f"{sensor} correlation time",
        doc="Time constant of the bias instability, a first-order Gauss-Markov process.",
        datasheet="Seldom on data sheets. Take it from an Allan plot, where its flat part begins.",
        typical="fibre and laser 3600, MEMS 100 to 1000 s",
        needs=("bias_instability",),
        since=_SINCE,
    )


_TURN_ON = (
    "Constant through a flight, 1σ per axis. The filter estimates it, unlike the residual bias, with its turns: on a "
    "straight line an accelerometer's settles as a tilt of b/g, and the vertical gyro's turns the heading."
)
_INSTABILITY = (
    "Bias that varies, 1σ per axis: a Gauss-Markov process, for which the printed value is taken as sigma. The "
    "filter estimates it; tilt takes an accelerometer's in full."
)
_WALK = (
    "Density of the white noise that drives a bias which never settles. In the budget's tilt and heading it counts "
    "from the start of the leg, for as long as coast.duration."
)
_SCALE = "1σ per axis, constant through a flight. On a straight leg only the vertical gyro's shows, in heading."
_MISALIGNMENT = "1σ of each of the six small angles between the sensors' axes, constant through a flight."
_IN_RUN = '"In-run bias instability" or "bias stability", the bottom of the Allan plot.'
_REPEATABILITY = '"Bias repeatability" or "turn-on to turn-on".'


class Gyro(Part):
    """Errors of the gyros beyond angle random walk and residual bias."""

    section = "gyro"
    title = "Gyros: more of the sheet"
    optional = True

    turn_on_bias = _error(
        "angular rate", "°/h", "gto", 1e5 * DEGREE_PER_HOUR, "Gyro turn-on bias", _TURN_ON, _REPEATABILITY,
        "navigation 0.003, tactical 1 to 10, MEMS 100 to 2000 °/h",
        "gyro turn-on bias",
    )  # fmt: skip
    bias_instability = _error(
        "angular rate", "°/h", "gbi", 1e5 * DEGREE_PER_HOUR, "Gyro bias instability", _INSTABILITY, _IN_RUN,
        "navigation 0.003, tactical 0.5, MEMS 1 to 10 °/h",
        "gyro bias instability",
    )  # fmt: skip
    correlation_time = _correlation_time("gbt", "Gyro")
    rate_random_walk = _error(
        "rate random walk", "°/h/√h", "grw", 1e5 * DEGREE_PER_HOUR / 60, "Rate random walk", _WALK,
        "Seldom on data sheets: the right end of the Allan plot.", "tactical 0.1, MEMS 1 to 10 °/h/√h",
        "gyro bias random walk",
    )  # fmt: skip
    scale_factor = _error(
        "ratio", "ppm", "gsf", 0.1, "Gyro scale factor error", _SCALE, '"Scale factor error" or "repeatability".',
        "laser 5, fibre 100, MEMS 300 to 10000 ppm",
        "gyro scale factor",
    )  # fmt: skip
    misalignment = _error(
        "angle", "mrad", "gmi", 0.1, "Gyro misalignment", _MISALIGNMENT, '"Axis misalignment" or "orthogonality".',
        "laser 0.02, tactical 0.3, MEMS 1 mrad",
        "gyro misalignment",
    )  # fmt: skip
    quantization = _error(
        "angle", "arcsec", "gqu", 0.1, "Gyro quantization", "Size of one count of the integrated angle.",
        "Resolution of the angle increments.", "laser 0.5 to 1 arcsec",
    )  # fmt: skip
    g_sensitivity = _error(
        "rate per acceleration", "°/h/g", "ggs", 1e5 * DEGREE_PER_HOUR / STANDARD_GRAVITY, "Gyro g-sensitivity",
        "Rate by specific force along each axis, 1σ, constant through a flight.",
        '"Linear acceleration effect" or "g-sensitivity".', "fibre and laser none, tactical 1, MEMS 10 to 100 °/h/g",
        "gyro g-sensitivity",
    )  # fmt: skip


class Accelerometer(Part):
    """Errors of the accelerometers beyond velocity random walk and residual bias."""

    section = "accelerometer"
    title = "Accelerometers: more of the sheet"
    optional = True

    turn_on_bias = _error(
        "acceleration", "mg", "ato", 1000 * MILLI_G, "Accelerometer turn-on bias", _TURN_ON, _REPEATABILITY,
        "navigation 0.025, tactical 1, MEMS 2 to 30 mg",
        "accelerometer turn-on bias",
    )  # fmt: skip
    bias_instability = _error(
        "acceleration", "mg", "abi", 1000 * MILLI_G, "Accelerometer bias instability", _INSTABILITY, _IN_RUN,
        "navigation 0.01, tactical 0.05, MEMS 0.003 to 0.1 mg",
        "accelerometer bias instability",
    )  # fmt: skip
    correlation_time = _correlation_time("abt", "Accelerometer")
    rate_random_walk = _error(
        "acceleration random walk", "µg/√h", "awk", 10 * MILLI_G, "Acceleration random walk", _WALK,
        "Seldom on data sheets: the right end of the Allan plot.", "MEMS 10 to 100 µg/√h",
        "accelerometer bias random walk",
    )  # fmt: skip
    scale_factor = _error(
        "ratio", "ppm", "asf", 0.1, "Accelerometer scale factor error", _SCALE,
        '"Scale factor error" or "repeatability".',
        "navigation 100, tactical 300, MEMS 500 to 10000 ppm",
    )  # fmt: skip
    misalignment = _error(
        "angle", "mrad", "ami", 0.1, "Accelerometer misalignment", _MISALIGNMENT,
        '"Axis misalignment" or "orthogonality".', "navigation 0.05, tactical 0.3, MEMS 1 mrad",
        "accelerometer misalignment",
    )  # fmt: skip
    quantization = _error(
        "speed", "mm/s", "aqu", 10.0, "Accelerometer quantization", "Size of one count of the integrated velocity.",
        "Resolution of the velocity increments.", "0.1 to 1 mm/s",
    )  # fmt: skip

"""The inputs of the suborbital study: one table with units, bounds and help.

Each is declared as an input of a design is; the command line, the page, the study file and the JSON are derived
from the table. Values are SI.
"""

import math
from typing import Any

import param

from nav_model.base.constants import ARCSECOND, DEGREE, DEGREE_PER_HOUR, MILLI_G
from nav_model.design.declaration import BaseQuantity, Choice, OptionalQuantity, Quantity
from nav_model.design.several import Axes, Intervals, Whole
from nav_model.earth.gravity import ZONALS
from nav_model.suborbital.aiding import Aiding
from nav_model.suborbital.attitude import METHODS
from nav_model.suborbital.errors import ErrorSet, SensorErrors, Triple, diagonal, off_diagonal
from nav_model.suborbital.flight import FlightParameters
from nav_model.suborbital.star_camera import StarCamera
from nav_model.suborbital.study import SuborbitalInputs

Input = BaseQuantity[Any] | Choice | Axes | Intervals
_Row = tuple[str, Input]
"""Dotted key and declaration."""

_ERRORS, _FLIGHT, _AIDING, _CAMERA = ErrorSet(), FlightParameters(), Aiding(), StarCamera()


def _quantity(
    key: str, label: str, doc: str, default: float | None, dimension: str, unit: str, *numbers: float, **more: Any
) -> _Row:
    """numbers: lowest, highest and, for a slider, where it starts above zero; a default of None: may be left out."""
    low, high, *smallest = numbers
    kind: Any = OptionalQuantity if default is None else Quantity
    soft = (*smallest, high) if smallest else None
    words = {"dimension": dimension, "unit": unit, "short": "", "label": label, "doc": doc}
    return key, kind(default=default, bounds=(low, high), softbounds=soft, **words, **more)


def _whole(key: str, label: str, doc: str, default: int, low: int, high: int) -> _Row:
    return key, Whole(float(default), bounds=(low, high), label=label, doc=doc)


def _axes(
    key: str, label: str, doc: str, default: tuple[float, ...], dimension: str, unit: str, *sizes: float
) -> _Row:
    """sizes: largest on an axis, and where a slider starts above zero."""
    high, low = sizes
    return key, Axes(default, dimension=dimension, unit=unit, softbounds=(low, high), label=label, doc=doc)


def _choice(key: str, label: str, doc: str, default: str, options: tuple[str, ...]) -> _Row:
    return key, Choice(default, options={option: option for option in options}, short="", label=label, doc=doc)


def _sensor(
    part: str, name: str, defaults: SensorErrors, bias: tuple[str, str, float], noise: tuple[str, str, float]
) -> tuple[_Row, ...]:
    """Inputs of one triad; bias and noise: dimension, unit, size of one unit in SI."""

    dimension, unit, size = bias

    def triple(key: str, label: str, doc: str, default: Triple) -> _Row:
        return _axes(f"{part}.{key}", f"{name} {label}", doc, default, dimension, unit, 1e3 * size, 1e-3 * size)

    def period(key: str, label: str, doc: str, default: float) -> _Row:
        return _quantity(f"{part}.{key}", f"{name} {label}", doc, default, "time", "s", 1.0, 1e5)

    def ratios(key: str, label: str, doc: str, default: tuple[float, ...]) -> _Row:
        return _axes(f"{part}.{key}", f"{name} {label}", doc, default, "ratio", "ppm", 0.05, 1e-6)

    constant, slow = defaults.constant_matrix, defaults.oscillating_matrix
    return (
        triple("bias", "bias, constant", "Turn-on bias on the x, y and z axes.", defaults.constant_bias),
        triple("bias_instability", "bias, oscillating",
               "Amplitude on each axis of the slow part, B sin(2πt/T) [B-1].", defaults.oscillating_bias),
        period("bias_period", "bias period", "Period T of the oscillating bias.", defaults.bias_period_s),
        ratios("scale_factor", "scale factor, constant", "Of the x, y and z axes.", diagonal(constant)),
        ratios("misalignment", "misalignment, constant",
               "Cross-axis coupling, in the order xy, xz, yx, yz, zx, zy.",
               off_diagonal(constant)),
        ratios("scale_factor_instability", "scale factor, oscillating", "Amplitude of the slow part on each axis.",
               diagonal(slow)),
        ratios("misalignment_instability", "misalignment, oscillating",
               "Amplitude of the slow part, in the order of the constant one.", off_diagonal(slow)),
        period("scale_factor_period", "scale factor period",
               "Period T of the oscillating scale factor and misalignment.", defaults.matrix_period_s),
        _quantity(f"{part}.white_noise", f"{name} white noise",
                  "Random walk, the same on each axis; adds a standard deviation to the deterministic errors.",
                  defaults.white_noise, noise[0], noise[1], 0.0, 1e3 * noise[2], 1e-3 * noise[2]),
    )  # fmt: skip


_TABLE: dict[str, tuple[_Row, ...]] = {
    "Accelerometers": _sensor("accelerometers", "Accelerometer", _ERRORS.accelerometers,
                              ("acceleration", "mg", MILLI_G), ("velocity random walk", "m/s/√h", 1 / 60)),
    "Gyros": _sensor("gyros", "Gyro", _ERRORS.gyros,
                     ("angular rate", "°/h", DEGREE_PER_HOUR), ("angle random walk", "°/√h", DEGREE / 60)),
    "Initial errors": (
        _axes("initial.position", "Initial position error", "North, east, down at lift-off.",
              _ERRORS.initial.position_m, "length", "m", 1e5, 0.01),
        _axes("initial.velocity", "Initial velocity error", "North, east, down at lift-off.",
              _ERRORS.initial.velocity_m_s, "speed", "m/s", 100.0, 1e-4),
        _axes("initial.attitude", "Initial attitude error", "Rotation about north, east, down at lift-off.",
              _ERRORS.initial.attitude_rad, "angle", "arcsec", math.radians(5), 0.1 * ARCSECOND),
    ),
    "Star tracker": (
        _quantity("tracker.from_height", "Tracker from height",
                  "Frames are used from this height up, such as 80 km. Empty: from lift-off.", _AIDING.from_height_m,
                  "length", "km", 0.0, 1e7, 1e3),
        _quantity("tracker.frame_interval", "Frame interval", "A whole number of steps of the integration.",
                  _AIDING.frame_interval_s, "time", "s", 0.01, 1e4, 0.1, step=0.1),
        _quantity("tracker.latency", "Latency", "Age of an attitude when the INS uses it as the current one.",
                  _AIDING.latency_s, "time", "ms", 0.0, 10.0, 1e-4),
        _axes("tracker.misalignment", "Camera to IMU misalignment", "Rotation about the body axes x, y, z.",
              _AIDING.misalignment_rad, "angle", "arcsec", math.radians(5), 0.1 * ARCSECOND),
        ("tracker.dropouts", Intervals(_AIDING.dropouts_s, label="Dropouts",
                                       doc='Times without frames, such as "200-260 s, 400-410 s"; the gyros hold.')),
    ),
    "Camera and sky": (
        _choice("camera.frames", "Attitude frames",
                "perfect: a camera without noise; star images: every frame solved from identified stars.", "perfect",
                ("perfect", "star images")),
        _choice("camera.method", "Attitude method", "How stars give an attitude [B-9].", "SVD", tuple(METHODS)),
        _quantity("camera.centroid_noise", "Centroid noise", "One sigma per axis in the tangent plane.",
                  _CAMERA.centroid_sigma_rad, "angle", "arcsec", 1e-3 * ARCSECOND, 1000 * ARCSECOND, 0.1 * ARCSECOND),
        _quantity("camera.field_of_view", "Field of view", "Full angle across the square detector [B-8].",
                  _CAMERA.field_of_view_rad, "angle", "°", math.radians(1), math.radians(90)),
        _quantity("camera.focal_length", "Focal length",
                  "Sets the field of view if given. Empty: it follows from the field of view.", None, "length", "mm",
                  1e-3, 10.0),
        _whole("camera.pixels", "Pixels", "Along each side of the detector.", _CAMERA.pixels, 64, 16384),
        _quantity("camera.pixel_pitch", "Pixel pitch", "Between pixels.", _CAMERA.pixel_pitch_m, "length", "µm",
                  1e-6, 1e-4),
        _whole("camera.brightest", "Stars used at most", "The brightest in the field.", _CAMERA.brightest, 3, 50),
        _whole("camera.least_stars", "Gate on the number of stars", "A frame with fewer is not used.",
               _CAMERA.least_stars, 3, 50),
        _quantity("camera.roll_limit", "Gate on roll about the boresight",
                  "A frame whose predicted sigma exceeds it is not used; the gyros hold.", _CAMERA.roll_limit_rad,
                  "angle", "arcsec", ARCSECOND, math.radians(90)),
        _choice("sky.stars", "Sky", "The Hipparcos catalogue, or a seeded synthetic sky of the same density.",
                "Hipparcos", ("Hipparcos", "synthetic")),
        _quantity("sky.magnitude_limit", "Magnitude limit", "Faintest star identified, Hp.", 6.5, "", "", 2.0, 9.0),
        _whole("seed", "Seed", "Seed of centroid noise, white noise and the synthetic sky.", 1, 0, 2**31),
    ),
    "Flight and gravity": (
        _quantity("flight.latitude", "Launch latitude", "North is positive.", _FLIGHT.latitude_rad, "angle", "°",
                  math.radians(-89), math.radians(89)),
        _quantity("flight.longitude", "Launch longitude", "East is positive.", _FLIGHT.longitude_rad, "angle", "°",
                  -math.pi, math.pi),
        _quantity("flight.azimuth", "Launch azimuth", "From north, clockwise.", _FLIGHT.azimuth_rad, "angle", "°",
                  -2 * math.pi, 2 * math.pi),
        _quantity("flight.initial_thrust", "Thrust acceleration at lift-off", "Along body x.",
                  _FLIGHT.initial_thrust_m_s2, "acceleration", "m/s²", 10.0, 200.0),
        _quantity("flight.final_thrust", "Thrust acceleration at burn-out", "Along body x.",
                  _FLIGHT.final_thrust_m_s2, "acceleration", "m/s²", 10.0, 500.0),
        _quantity("flight.burn_time", "Burn time", "A whole number of steps, not before the pitch programme ends.",
                  _FLIGHT.burn_time_s, "time", "s", 10.0, 1000.0),
        _quantity("flight.pitch_start", "Pitch programme starts", "The pitch at lift-off is held until then.",
                  _FLIGHT.pitch_start_s, "time", "s", 0.0, 1000.0),
        _quantity("flight.pitch_end", "Pitch programme ends", "A quintic with zero rates at both ends.",
                  _FLIGHT.pitch_end_s, "time", "s", 1.0, 1000.0),
        _quantity("flight.initial_pitch", "Pitch at lift-off", "90° is straight up.", _FLIGHT.initial_pitch_rad,
                  "angle", "°", math.radians(30), math.radians(90)),
        _quantity("flight.burnout_pitch", "Pitch at burn-out", "Reached when the pitch programme ends.",
                  _FLIGHT.burnout_pitch_rad, "angle", "°", 0.0, math.radians(90)),
        _quantity("flight.coast_pitch_rate", "Pitch-down rate in coast", "Reached over the ramp after burn-out.",
                  _FLIGHT.coast_pitch_rate_rad_s, "angular rate", "°/s", math.radians(-1), math.radians(1)),
        _quantity("flight.coast_ramp", "Ramp of the pitch-down rate", "Cubic, from burn-out.", _FLIGHT.coast_ramp_s,
                  "time", "s", 1.0, 1000.0),
        _quantity("flight.yaw_amplitude", "Yaw oscillation", "Amplitude, a sine from lift-off.",
                  _FLIGHT.yaw_amplitude_rad, "angle", "°", 0.0, math.radians(30)),
        _quantity("flight.yaw_period", "Yaw period", "Of the oscillation.", _FLIGHT.yaw_period_s, "time", "s", 5.0,
                  1e5),
        _quantity("flight.roll_amplitude", "Roll oscillation", "Amplitude, a sine from lift-off.",
                  _FLIGHT.roll_amplitude_rad, "angle", "°", 0.0, math.radians(90)),
        _quantity("flight.roll_period", "Roll period", "Of the oscillation.", _FLIGHT.roll_period_s, "time", "s", 5.0,
                  1e5),
        _quantity("flight.duration", "Duration",
                  "A multiple of 5 s; it must end before the flight reaches the ground.", _FLIGHT.duration_s, "time",
                  "s", 200.0, 10000.0),
        _quantity("flight.step", "Step of the integration", "RK4; burn-out and frames fall on steps.", _FLIGHT.step_s,
                  "time", "s", 0.02, 1.0),
        _choice("flight.gravity", "True gravity", "The gravity field of the reference flight.", _FLIGHT.gravity,
                tuple(ZONALS)),
        _choice("ins.gravity", "INS gravity", "The gravity model that the INS uses.", SuborbitalInputs().ins_gravity,
                tuple(ZONALS)),
    ),
}  # fmt: skip


def _bound(rows: list[_Row]) -> None:
    """Give every declaration its key, which Param takes from the class it is declared in: a class a section."""
    for section in dict.fromkeys(key.rpartition(".")[0] for key, _ in rows):
        inputs = {key.rpartition(".")[2]: declared for key, declared in rows if key.rpartition(".")[0] == section}
        type(section.title(), (param.Parameterized,), {"section": section, **inputs})


_bound([row for group in _TABLE.values() for row in group])

GROUPS: dict[str, tuple[Input, ...]] = {
    title: tuple(declared for _, declared in group) for title, group in _TABLE.items()
}
"""The inputs, group by group."""

INPUTS: dict[str, Input] = {key: declared for group in _TABLE.values() for key, declared in group}
"""The inputs by dotted key, in the order of the file."""

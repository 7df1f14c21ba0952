"""What a person can set in the suborbital study: one table of inputs with units, bounds and help.

The command line, the page, the study file and the JSON are derived from it. Values are SI.
"""

from __future__ import annotations

import math

from nav_model.earth.gravity import ZONALS
from nav_model.suborbital.aiding import Aiding
from nav_model.suborbital.attitude import METHODS
from nav_model.suborbital.errors import ErrorSet, SensorErrors, Triple, diagonal, off_diagonal
from nav_model.suborbital.flight import FlightParameters
from nav_model.suborbital.setting import Setting
from nav_model.suborbital.star_camera import StarCamera
from nav_model.suborbital.study import StudyInputs

_MG, _DPH, _ARCSEC = 9.80665e-3, math.pi / 180 / 3600, math.pi / 648000
_ERRORS, _FLIGHT, _AIDING, _CAMERA = ErrorSet(), FlightParameters(), Aiding(), StarCamera()


def _sensor(
    part: str, name: str, defaults: SensorErrors, bias: tuple[str, str, float], noise: tuple[str, str, float]
) -> tuple[Setting, ...]:
    """Inputs of one triad; bias and noise: dimension, unit, size of one unit in SI."""

    def triple(key: str, label: str, doc: str, default: Triple) -> Setting:
        return Setting(
            f"{part}.{key}", f"{name} {label}", doc, "axes", default, bias[0], bias[1], 0.0, 1e3 * bias[2],
            1e-3 * bias[2],
        )  # fmt: skip

    def period(key: str, label: str, doc: str, default: float) -> Setting:
        return Setting(f"{part}.{key}", f"{name} {label}", doc, "number", default, "time", "s", 1.0, 1e5)

    def ratios(key: str, label: str, doc: str, default: tuple[float, ...]) -> Setting:
        return Setting(f"{part}.{key}", f"{name} {label}", doc, "axes", default, "ratio", "ppm", 0.0, 0.05, 1e-6)

    constant, slow = defaults.constant_matrix, defaults.oscillating_matrix
    return (
        triple("bias", "bias, constant", "Turn-on bias on the x, y and z axes.", defaults.constant_bias),
        triple("bias_instability", "bias, oscillating",
               "Amplitude on each axis of the slow part, B sin(2πt/T) [B-1].", defaults.oscillating_bias),
        period("bias_period", "bias period", "Period T of the oscillating bias.", defaults.bias_period_s),
        ratios("scale_factor", "scale factor, constant", "Of the x, y and z axes.", diagonal(constant)),
        ratios("misalignment", "misalignment, constant",
               "What an axis feels of the others: x of y, x of z, y of x, y of z, z of x, z of y.",
               off_diagonal(constant)),
        ratios("scale_factor_instability", "scale factor, oscillating", "Amplitude of the slow part on each axis.",
               diagonal(slow)),
        ratios("misalignment_instability", "misalignment, oscillating",
               "Amplitude of the slow part; the order is that of the constant one.", off_diagonal(slow)),
        period("scale_factor_period", "scale factor period",
               "Period T of the oscillating scale factor and misalignment.", defaults.matrix_period_s),
        Setting(f"{part}.white_noise", f"{name} white noise",
                "Random walk, the same on each axis; a standard deviation beside the deterministic errors.", "number",
                defaults.white_noise, noise[0], noise[1], 0.0, 1e3 * noise[2], 1e-3 * noise[2]),
    )  # fmt: skip


GROUPS: dict[str, tuple[Setting, ...]] = {
    "Accelerometers": _sensor("accelerometers", "Accelerometer", _ERRORS.accelerometers,
                              ("acceleration", "mg", _MG), ("velocity random walk", "m/s/√h", 1 / 60)),
    "Gyros": _sensor("gyros", "Gyro", _ERRORS.gyros,
                     ("angular rate", "°/h", _DPH), ("angle random walk", "°/√h", math.pi / 180 / 60)),
    "Initial errors": (
        Setting("initial.position", "Initial position error", "North, east, down at lift-off.", "axes",
                _ERRORS.initial.position_m, "length", "m", 0.0, 1e5, 0.01),
        Setting("initial.velocity", "Initial velocity error", "North, east, down at lift-off.", "axes",
                _ERRORS.initial.velocity_m_s, "speed", "m/s", 0.0, 100.0, 1e-4),
        Setting("initial.attitude", "Initial attitude error", "Rotation about north, east, down at lift-off.",
                "axes", _ERRORS.initial.attitude_rad, "angle", "arcsec", 0.0, math.radians(5), 0.1 * _ARCSEC),
    ),
    "Star tracker": (
        Setting("tracker.from_height", "Tracker from height",
                "Frames only at or above it; 80 km is typical. Empty: from lift-off.", "number",
                _AIDING.from_height_m, "length", "km", 0.0, 1e7, 1e3, optional=True),
        Setting("tracker.frame_interval", "Frame interval", "A whole number of steps of the integration.", "number",
                _AIDING.frame_interval_s, "time", "s", 0.01, 1e4, 0.1, grid=0.1),
        Setting("tracker.latency", "Latency", "Age of an attitude when the INS takes it for the current one.",
                "number", _AIDING.latency_s, "time", "ms", 0.0, 10.0, 1e-4),
        Setting("tracker.misalignment", "Camera to IMU misalignment", "Rotation about the body axes x, y, z.",
                "axes", _AIDING.misalignment_rad, "angle", "arcsec", 0.0, math.radians(5), 0.1 * _ARCSEC),
        Setting("tracker.dropouts", "Dropouts",
                'Times without frames, such as "200-260 s, 400-410 s"; the gyros hold.',
                "intervals", _AIDING.dropouts_s),
    ),
    "Camera and sky": (
        Setting("camera.frames", "Attitude frames",
                "perfect: a camera without noise; star images: every frame solved from identified stars.",
                "choice", "perfect", choices=("perfect", "star images")),
        Setting("camera.method", "Attitude method", "How stars give an attitude [B-9].", "choice", "SVD",
                choices=tuple(METHODS)),
        Setting("camera.centroid_noise", "Centroid noise", "One sigma per axis in the tangent plane.", "number",
                _CAMERA.centroid_sigma_rad, "angle", "arcsec", 1e-3 * _ARCSEC, 1000 * _ARCSEC, 0.1 * _ARCSEC),
        Setting("camera.field_of_view", "Field of view", "Full angle across the square detector [B-8].", "number",
                _CAMERA.field_of_view_rad, "angle", "°", math.radians(1), math.radians(90)),
        Setting("camera.focal_length", "Focal length",
                "Where it is given it sets the field of view. Empty: from the field of view.", "number",
                None, "length", "mm", 1e-3, 10.0, optional=True),
        Setting("camera.pixels", "Pixels", "Along each side of the detector.", "whole", float(_CAMERA.pixels),
                low=64, high=16384),
        Setting("camera.pixel_pitch", "Pixel pitch", "From pixel to pixel.", "number", _CAMERA.pixel_pitch_m,
                "length", "µm", 1e-6, 1e-4),
        Setting("camera.brightest", "Stars used at most", "The brightest in the field.", "whole",
                float(_CAMERA.brightest), low=3, high=50),
        Setting("camera.least_stars", "Gate on the number of stars", "A frame with fewer is not used.", "whole",
                float(_CAMERA.least_stars), low=3, high=50),
        Setting("camera.roll_limit", "Gate on roll about the boresight",
                "A frame whose predicted sigma exceeds it is not used; the gyros hold.", "number",
                _CAMERA.roll_limit_rad, "angle", "arcsec", _ARCSEC, math.radians(90)),
        Setting("sky.stars", "Sky", "The Hipparcos catalogue, or a seeded synthetic sky of the same density.",
                "choice", "Hipparcos", choices=("Hipparcos", "synthetic")),
        Setting("sky.magnitude_limit", "Magnitude limit", "Faintest star identified, Hp.", "number", 6.5,
                low=2.0, high=9.0),
        Setting("seed", "Seed", "Of centroid noise, white noise and the synthetic sky.", "whole", 1.0,
                low=0, high=2**31),
    ),
    "Flight and gravity": (
        Setting("flight.latitude", "Launch latitude", "North is positive.", "number", _FLIGHT.latitude_rad,
                "angle", "°", math.radians(-89), math.radians(89)),
        Setting("flight.longitude", "Launch longitude", "East is positive.", "number", _FLIGHT.longitude_rad,
                "angle", "°", -math.pi, math.pi),
        Setting("flight.azimuth", "Launch azimuth", "From north, clockwise.", "number", _FLIGHT.azimuth_rad,
                "angle", "°", -2 * math.pi, 2 * math.pi),
        Setting("flight.initial_thrust", "Thrust acceleration at lift-off", "Along body x.", "number",
                _FLIGHT.initial_thrust_m_s2, "acceleration", "m/s²", 10.0, 200.0),
        Setting("flight.final_thrust", "Thrust acceleration at burn-out", "Along body x.", "number",
                _FLIGHT.final_thrust_m_s2, "acceleration", "m/s²", 10.0, 500.0),
        Setting("flight.burn_time", "Burn time", "A whole number of steps, not before the pitch programme ends.",
                "number", _FLIGHT.burn_time_s, "time", "s", 10.0, 1000.0),
        Setting("flight.pitch_start", "Pitch programme starts", "Until then the flight keeps its first pitch.",
                "number", _FLIGHT.pitch_program_start_s, "time", "s", 0.0, 1000.0),
        Setting("flight.pitch_end", "Pitch programme ends", "A quintic with zero rates at both ends.", "number",
                _FLIGHT.pitch_program_end_s, "time", "s", 1.0, 1000.0),
        Setting("flight.initial_pitch", "Pitch at lift-off", "90° is straight up.", "number",
                _FLIGHT.initial_pitch_rad, "angle", "°", math.radians(30), math.radians(90)),
        Setting("flight.burnout_pitch", "Pitch at burn-out", "Reached when the pitch programme ends.", "number",
                _FLIGHT.burnout_pitch_rad, "angle", "°", 0.0, math.radians(90)),
        Setting("flight.coast_pitch_rate", "Pitch-down rate in coast", "Reached over the ramp after burn-out.",
                "number", _FLIGHT.coast_pitch_down_rad_s, "angular rate", "°/s", math.radians(-1), math.radians(1)),
        Setting("flight.coast_ramp", "Ramp of the pitch-down rate", "Cubic, from burn-out.", "number",
                _FLIGHT.coast_ramp_s, "time", "s", 1.0, 1000.0),
        Setting("flight.yaw_amplitude", "Yaw oscillation", "Amplitude, a sine from lift-off.", "number",
                _FLIGHT.yaw_amplitude_rad, "angle", "°", 0.0, math.radians(30)),
        Setting("flight.yaw_period", "Yaw period", "Of the oscillation.", "number", _FLIGHT.yaw_period_s, "time",
                "s", 5.0, 1e5),
        Setting("flight.roll_amplitude", "Roll oscillation", "Amplitude, a sine from lift-off.", "number",
                _FLIGHT.roll_amplitude_rad, "angle", "°", 0.0, math.radians(90)),
        Setting("flight.roll_period", "Roll period", "Of the oscillation.", "number", _FLIGHT.roll_period_s, "time",
                "s", 5.0, 1e5),
        Setting("flight.duration", "Duration", "A multiple of 5 s; it must end before the flight reaches the ground.",
                "number", _FLIGHT.duration_s, "time", "s", 200.0, 10000.0),
        Setting("flight.step", "Step of the integration", "RK4; burn-out and frames fall on steps.", "number",
                _FLIGHT.step_s, "time", "s", 0.02, 1.0),
        Setting("flight.gravity", "True gravity", "The field the flight is flown in.", "choice", _FLIGHT.gravity,
                choices=tuple(ZONALS)),
        Setting("ins.gravity", "INS gravity", "The field the INS believes in.", "choice", StudyInputs().ins_gravity,
                choices=tuple(ZONALS)),
    ),
}  # fmt: skip
"""The inputs, group by group."""

SETTINGS: dict[str, Setting] = {setting.key: setting for group in GROUPS.values() for setting in group}

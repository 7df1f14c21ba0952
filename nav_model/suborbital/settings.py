"""What a person can set in the suborbital study: one table of inputs with units, bounds and help.

The command line, the page and the JSON are derived from it. Values are SI; text with units exists only in
`Setting.read` and `Setting.show`. Three-axis inputs take one number for all axes or three, separated by commas.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nav_model.inputs import DesignError
from nav_model.suborbital.aiding import Aiding
from nav_model.suborbital.attitude import METHODS
from nav_model.suborbital.errors import (
    ErrorSet,
    InitialErrors,
    SensorErrors,
    Triple,
    scale_and_misalignment,
)
from nav_model.suborbital.flight import FlightParameters
from nav_model.suborbital.gravity import ZONALS
from nav_model.suborbital.sky import Sky, hipparcos_sky, synthetic_sky
from nav_model.suborbital.star_camera import StarCamera, focal_length
from nav_model.suborbital.study import StudyInputs
from nav_model.units import DIMENSIONS, QuantityError, format_quantity, join_quantity, parse_quantity, plain_number

if TYPE_CHECKING:
    from nav_model.design import Design

Value = float | Triple | str | tuple[tuple[float, float], ...] | None

GP1 = "GP-1"
"""Name of the parameter set of star_tracker.md, the default of every input."""


@dataclass(frozen=True)
class Setting:
    """One input.

    kind: "number" (a plain one when dimension is empty), "whole", "triple" (three axes), "choice" or
    "intervals" (pairs start-stop); low and high bound a number, or the size of each axis; optional: None is
    allowed; small: where a slider starts above zero.
    """

    key: str
    label: str
    doc: str
    kind: str
    default: Value
    dimension: str = ""
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    small: float | None = None
    optional: bool = False
    choices: tuple[str, ...] = ()

    def check(self, value: Value) -> Value:
        """The value itself; DesignError with the key, the value and what is allowed."""
        if value is None and self.optional:
            return value
        if self.kind == "choice":
            if value not in self.choices:
                raise DesignError(self.key, f"{value!r} is not allowed; it must be one of {', '.join(self.choices)}")
            return value
        if self.kind == "intervals":
            assert isinstance(value, tuple)
            for pair in value:
                assert isinstance(pair, tuple)
                if not (0 <= pair[0] < pair[1] < math.inf):
                    said = f"{pair[0]:g}-{pair[1]:g} s"
                    raise DesignError(self.key, f"{said} must start at 0 or later, and before it stops")
            return value
        numbers = value if isinstance(value, tuple) else (value,)
        for number in numbers:
            assert isinstance(number, float | int)
            size = abs(number) if self.kind == "triple" else number
            if not self.low <= size <= self.high:  # NaN lands here too
                raise DesignError(self.key, f"{self._one(number, 6)} is not allowed; {self.allowed()}")
            if self.kind == "whole" and number != round(number):
                raise DesignError(self.key, f"{number:g} is not a whole number")
        return value

    def allowed(self) -> str:
        """The bounds in words."""
        low, high = (self._one(x, 6) for x in (self.low, self.high))
        if self.kind == "triple":
            return f"each axis must be at most {high} in size"
        return f"it must be at least {low} and at most {high}"

    def read(self, text: str, unit: str = "") -> Value:
        """Text as a person writes it -> SI, checked. unit: taken where the text gives none.

        Raises
        ------
        DesignError
            Naming the key, what was given and what is allowed.
        """
        stripped = text.strip()
        if self.optional and stripped.lower() in ("", "none"):
            return None
        if self.kind == "choice":
            return self.check(stripped)
        if self.kind == "intervals":
            return self.check(_read_intervals(self.key, stripped))
        parts = [part.strip() for part in re.split(r"[,;]", stripped)] if self.kind == "triple" else [stripped]
        if len(parts) not in (1, 3):
            raise DesignError(self.key, f"{stripped!r} has {len(parts)} values; give one for all axes, or three")
        last = _NUMBER_FIRST.sub("", parts[-1]).strip() or unit
        try:
            numbers = [self._number(part, last) for part in parts]
        except QuantityError as error:
            raise DesignError(self.key, str(error)) from error
        if self.kind != "triple":
            return self.check(numbers[0])
        x, y, z = numbers if len(numbers) == 3 else numbers * 3
        return self.check((x, y, z))

    def _number(self, part: str, unit: str) -> float:
        if not self.dimension:
            try:
                return float(part.replace("−", "-"))
            except ValueError as error:
                raise QuantityError(f"{part[:40]!r} is not a number") from error
        return parse_quantity(part if _NUMBER_FIRST.sub("", part).strip() else f"{part} {unit}", self.dimension).value

    def show(self, value: Value, digits: int = 6) -> str:
        """A value in SI as text that `read` takes back, to `digits` significant digits."""
        if value is None:
            return "none"
        if isinstance(value, str):
            return value
        if self.kind == "intervals":
            assert isinstance(value, tuple)
            return ", ".join(f"{start:g}-{stop:g} s" for start, stop in value)  # type: ignore[misc]
        if not isinstance(value, tuple):
            return self._one(value, digits)
        factor = float(DIMENSIONS[self.dimension].units[self.unit])
        numbers = ", ".join(plain_number(float(x) / factor, digits) for x in value)  # type: ignore[arg-type]
        return join_quantity(numbers, self.unit)

    def _one(self, value: float, digits: int) -> str:
        if not self.dimension or not math.isfinite(value):
            return f"{value:.{digits}g}"
        return format_quantity(value, self.unit, self.dimension, digits)


_NUMBER_FIRST = re.compile(r"^[+\-−]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+\-−]?\d+)?")
_INTERVAL = re.compile(r"(\d+(?:\.\d+)?)\s*[-–]\s*(\d+(?:\.\d+)?)\s*s?")


def _read_intervals(key: str, text: str) -> tuple[tuple[float, float], ...]:
    pairs = []
    for part in filter(None, (piece.strip() for piece in re.split(r"[,;]", text))):
        match = _INTERVAL.fullmatch(part)
        if match is None:
            raise DesignError(key, f'{part[:40]!r} is not an interval; write for example "200-260 s, 400-410 s"')
        pairs.append((float(match[1]), float(match[2])))
    return tuple(pairs)


_MG, _DPH, _ARCSEC = 9.80665e-3, math.pi / 180 / 3600, math.pi / 648000
_ERRORS, _FLIGHT, _AIDING, _CAMERA = ErrorSet(), FlightParameters(), Aiding(), StarCamera()


def _sensor(
    part: str, name: str, defaults: SensorErrors, bias: tuple[str, str, float], noise: tuple[str, str, float]
) -> tuple[Setting, ...]:
    """Inputs of one triad; bias and noise: dimension, unit, size of one unit in SI."""

    def triple(key: str, label: str, doc: str, default: Triple) -> Setting:
        return Setting(
            f"{part}.{key}", f"{name} {label}", doc, "triple", default, bias[0], bias[1], 0.0, 1e3 * bias[2],
            1e-3 * bias[2],
        )  # fmt: skip

    def period(key: str, label: str, doc: str, default: float) -> Setting:
        return Setting(f"{part}.{key}", f"{name} {label}", doc, "number", default, "time", "s", 1.0, 1e5)

    def ratio(key: str, label: str, doc: str, default: float) -> Setting:
        return Setting(f"{part}.{key}", f"{name} {label}", doc, "number", default, "ratio", "ppm", 0.0, 0.05, 1e-6)

    return (
        triple("bias", "bias, constant", "Turn-on bias on the x, y and z axes.", defaults.constant_bias),
        triple("bias_instability", "bias, oscillating",
               "Amplitude on each axis of the slow part, B sin(2πt/T) [B-1].", defaults.oscillating_bias),
        period("bias_period", "bias period", "Period T of the oscillating bias.", defaults.bias_period_s),
        ratio("scale_factor", "scale factor, misalignment",
              "Constant; every axis's scale factor and, with GP-1's pattern of signs, every misalignment.",
              defaults.constant_matrix[0][0]),
        ratio("scale_factor_instability", "scale factor, oscillating",
              "Amplitude of the slow part of scale factor and misalignment.", defaults.oscillating_matrix[0][0]),
        period("scale_factor_period", "scale factor period", "Period T of the oscillating scale factor.",
               defaults.matrix_period_s),
        Setting(f"{part}.white_noise", f"{name} white noise",
                "Random walk per axis; a standard deviation beside the deterministic errors.", "number",
                defaults.white_noise, noise[0], noise[1], 0.0, 1e3 * noise[2], 1e-3 * noise[2]),
    )  # fmt: skip


GROUPS: dict[str, tuple[Setting, ...]] = {
    "Accelerometers": _sensor("accelerometers", "Accelerometer", _ERRORS.accelerometers,
                              ("acceleration", "mg", _MG), ("velocity random walk", "m/s/√h", 1 / 60)),
    "Gyros": _sensor("gyros", "Gyro", _ERRORS.gyros,
                     ("angular rate", "°/h", _DPH), ("angle random walk", "°/√h", math.pi / 180 / 60)),
    "Initial errors": (
        Setting("initial.position", "Initial position error", "North, east, down at lift-off.", "triple",
                _ERRORS.initial.position_m, "length", "m", 0.0, 1e5, 0.01),
        Setting("initial.velocity", "Initial velocity error", "North, east, down at lift-off.", "triple",
                _ERRORS.initial.velocity_m_s, "speed", "m/s", 0.0, 100.0, 1e-4),
        Setting("initial.attitude", "Initial attitude error", "Rotation about north, east, down at lift-off.",
                "triple", _ERRORS.initial.attitude_rad, "angle", "arcsec", 0.0, math.radians(5), 0.1 * _ARCSEC),
    ),
    "Star tracker": (
        Setting("tracker.from_height", "Tracker from height",
                "Frames only at or above it; 80 km is typical. Empty: from lift-off.", "number",
                _AIDING.from_height_m, "length", "km", 0.0, 1e7, 1e3, optional=True),
        Setting("tracker.frame_interval", "Frame interval", "A whole number of steps of 0.1 s.", "number",
                _AIDING.frame_interval_s, "time", "s", 0.1, 1e4, 0.1),
        Setting("tracker.latency", "Latency", "Age of an attitude when the INS takes it for the current one.",
                "number", _AIDING.latency_s, "time", "ms", 0.0, 10.0, 1e-4),
        Setting("tracker.misalignment", "Camera to IMU misalignment", "Rotation about the body axes x, y, z.",
                "triple", _AIDING.misalignment_rad, "angle", "arcsec", 0.0, math.radians(5), 0.1 * _ARCSEC),
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
        Setting("camera.field_of_view", "Field of view", "Full angle across the square detector.", "number",
                _CAMERA.field_of_view_rad, "angle", "°", math.radians(1), math.radians(90)),
        Setting("camera.brightest", "Stars used at most", "The brightest in the field.", "whole",
                float(_CAMERA.brightest), low=3, high=50),
        Setting("camera.roll_limit", "Gate on roll about the boresight",
                "A frame whose predicted sigma exceeds it is not used; the gyros hold.", "number",
                _CAMERA.roll_limit_rad, "angle", "arcsec", _ARCSEC, math.radians(90)),
        Setting("sky.stars", "Sky", "The Hipparcos catalogue, or a seeded synthetic sky of the same density.",
                "choice", "Hipparcos", choices=("Hipparcos", "synthetic")),
        Setting("sky.magnitude_limit", "Magnitude limit", "Faintest star identified, Hp.", "number", 6.5,
                low=2.0, high=9.0),
        Setting("seed", "Seed", "Of the centroid noise and of the synthetic sky.", "whole", 1.0, low=0, high=2**31),
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
        Setting("flight.burn_time", "Burn time", "A whole number of steps of 0.1 s, 150 s or more.", "number",
                _FLIGHT.burn_time_s, "time", "s", 150.0, 1000.0),
        Setting("flight.burnout_pitch", "Pitch at burn-out", "Reached at 150 s.", "number",
                _FLIGHT.burnout_pitch_rad, "angle", "°", 0.0, math.radians(90)),
        Setting("flight.duration", "Duration", "A multiple of 5 s; it must end before the flight reaches the ground.",
                "number", _FLIGHT.duration_s, "time", "s", 200.0, 10000.0),
        Setting("flight.gravity", "True gravity", "The field the flight is flown in.", "choice", _FLIGHT.gravity,
                choices=tuple(ZONALS)),
        Setting("ins.gravity", "INS gravity", "The field the INS believes in.", "choice", StudyInputs().ins_gravity,
                choices=tuple(ZONALS)),
    ),
}  # fmt: skip
"""The inputs, group by group."""

SETTINGS: dict[str, Setting] = {setting.key: setting for group in GROUPS.values() for setting in group}


@dataclass(frozen=True)
class Settings:
    """All inputs in force, SI; `values` holds every key of `SETTINGS`, `origin` where each came from."""

    values: Mapping[str, Value]
    origin: Mapping[str, str]

    def __getitem__(self, key: str) -> Any:
        return self.values[key]

    def change(self, changes: Mapping[str, Value], origin: str) -> Settings:
        """Other settings with some values replaced. DesignError for an unknown key or a value not allowed, and
        for values that do not fit together."""
        for key, value in changes.items():
            if key not in SETTINGS:
                raise DesignError(key, f"is not an input of the study; the inputs are {', '.join(SETTINGS)}")
            SETTINGS[key].check(value)
        changed = Settings({**self.values, **changes}, {**self.origin, **dict.fromkeys(changes, origin)})
        try:
            changed.study_inputs()
            changed.camera()
        except ValueError as error:
            raise DesignError(next(iter(changes), "study"), str(error)) from error
        return changed

    def study_inputs(self, step_s: float = _FLIGHT.step_s) -> StudyInputs:
        """The inputs of `run_study`. ValueError for values that do not fit together."""
        return StudyInputs(
            flight=FlightParameters(
                latitude_rad=self["flight.latitude"],
                longitude_rad=self["flight.longitude"],
                azimuth_rad=self["flight.azimuth"],
                initial_thrust_m_s2=self["flight.initial_thrust"],
                final_thrust_m_s2=self["flight.final_thrust"],
                burn_time_s=self["flight.burn_time"],
                burnout_pitch_rad=self["flight.burnout_pitch"],
                duration_s=self["flight.duration"],
                step_s=step_s,
                gravity=self["flight.gravity"],
            ),
            errors=ErrorSet(
                self._sensor("accelerometers"),
                self._sensor("gyros"),
                InitialErrors(self["initial.position"], self["initial.velocity"], self["initial.attitude"]),
            ),
            aiding=Aiding(
                from_height_m=self["tracker.from_height"],
                frame_interval_s=self["tracker.frame_interval"],
                latency_s=self["tracker.latency"],
                misalignment_rad=self["tracker.misalignment"],
                dropouts_s=self["tracker.dropouts"],
            ),
            ins_gravity=self["ins.gravity"],
        )

    def _sensor(self, part: str) -> SensorErrors:
        return SensorErrors(
            constant_bias=self[f"{part}.bias"],
            oscillating_bias=self[f"{part}.bias_instability"],
            bias_period_s=self[f"{part}.bias_period"],
            constant_matrix=scale_and_misalignment(self[f"{part}.scale_factor"]),
            oscillating_matrix=scale_and_misalignment(self[f"{part}.scale_factor_instability"]),
            matrix_period_s=self[f"{part}.scale_factor_period"],
            white_noise=self[f"{part}.white_noise"],
        )

    def camera(self) -> StarCamera:
        """The star camera [B-8]."""
        return StarCamera(
            focal_length_m=focal_length(self["camera.field_of_view"]),
            centroid_sigma_rad=self["camera.centroid_noise"],
            brightest=int(self["camera.brightest"]),
            roll_limit_rad=self["camera.roll_limit"],
        )

    def sky(self) -> Sky:
        """The sky the camera looks at. The synthetic one has the Hipparcos catalogue's number of stars."""
        limit, seed = self["sky.magnitude_limit"], int(self["seed"])
        real = hipparcos_sky(limit)
        return real if self["sky.stars"] == "Hipparcos" else synthetic_sky(len(real), seed, limit)


DEFAULTS = Settings({key: s.default for key, s in SETTINGS.items()}, dict.fromkeys(SETTINGS, GP1))
"""GP-1 on the golden flight with a perfect camera from lift-off."""


def from_design(settings: Settings, design: Design) -> Settings:
    """The study's sensors with a design's inertial unit.

    Both random walks (times the vibration factor) become the white noise. A residual bias of the design is one
    number, 1 sigma per axis: every axis takes it, with the sign GP-1 has there. What a design does not say
    (instability, scale factor, misalignment, initial errors) stays as it was.
    """
    imu = design.imu

    def signed(key: str, size: float) -> Triple:
        x, y, z = (float(s) * size + 0.0 for s in np.sign(np.array(SETTINGS[key].default, dtype=np.float64)))
        return x, y, z

    return settings.change(
        {
            "accelerometers.white_noise": imu.velocity_random_walk * imu.vibration_factor,
            "gyros.white_noise": imu.angle_random_walk * imu.vibration_factor,
            "accelerometers.bias": signed("accelerometers.bias", imu.accelerometer_bias),
            "gyros.bias": signed("gyros.bias", imu.gyro_bias),
        },
        f"design {design.name}".strip(),
    )


def read_changes(settings: Settings, changes: Mapping[str, str], origin: str) -> Settings:
    """Settings with text values put in, as the command line gives them. DesignError as `Settings.change`."""
    values: dict[str, Value] = {}
    for key, text in changes.items():
        if key not in SETTINGS:
            raise DesignError(key, f"is not an input of the study; the inputs are {', '.join(SETTINGS)}")
        values[key] = SETTINGS[key].read(text)
    return settings.change(values, origin)


def output_every(steps: int) -> int:
    """Steps between two points of the error histories: a divisor that leaves at most 320 points, or up to
    2000 where that would mean fewer than 100. ValueError when the number of steps has no such divisor."""
    for most in (320, 1000, 2000):
        every = next(d for d in range(1, steps + 1) if steps % d == 0 and steps // d <= most)
        if steps // every >= 100 or steps <= most:
            return every
    raise ValueError(
        f"the flight has {steps} steps, which no round interval divides; give it a duration that is a multiple of 5 s"
    )

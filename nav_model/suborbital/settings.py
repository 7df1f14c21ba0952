"""Inputs of the suborbital study: values in SI, their origins, and the model objects made from them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from nav_model.base.errors import InputError
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.several import Axes, with_unit
from nav_model.suborbital.aiding import Aiding
from nav_model.suborbital.errors import ErrorSet, InitialErrors, SensorErrors, Triple, scale_matrix
from nav_model.suborbital.flight import FlightParameters
from nav_model.suborbital.input_table import INPUTS, Input
from nav_model.suborbital.sky import Sky, hipparcos_sky, synthetic_sky
from nav_model.suborbital.star_camera import StarCamera, focal_length
from nav_model.suborbital.study import SuborbitalInputs

if TYPE_CHECKING:
    from nav_model.design import Design

Value = float | str | tuple[float, ...] | tuple[tuple[float, float], ...] | None
"""Value of an input, SI."""
GP1 = "GP-1"
"""Name of the parameter set of star_tracker.md, the default of every input."""
OF_DESIGN = "design"
"""Start of the origin of an input that a design gave."""


@dataclass(frozen=True)
class Settings:
    """All inputs in force, SI; `values` holds every key of `INPUTS`, `origin` where each came from."""

    values: Mapping[str, Value]
    origin: Mapping[str, str]

    def __getitem__(self, key: str) -> Any:
        return self.values[key]

    def show(self, key: str, digits: int | None = 6) -> str:
        """An input as text with its unit, which `read_value` takes back; without `digits` the shortest text that
        gives the same value."""
        declared, value = INPUTS[key], self[key]
        if value is None:
            return "none"
        return str(value) if isinstance(declared, Choice) else declared.show(value, digits)

    def change(self, changes: Mapping[str, Value], origin: str) -> Settings:
        """Other settings with some values replaced. InputError for an unknown key or a value not allowed, and
        for values that do not fit together."""
        for key, value in changes.items():
            declared(key)._validate(value)
        changed = Settings({**self.values, **changes}, {**self.origin, **dict.fromkeys(changes, origin)})
        with inputs_named(changes):
            changed.study_inputs()
            changed.camera()
        return changed

    def study_inputs(self) -> SuborbitalInputs:
        """The inputs of `run_study`. InputError for values that do not fit together."""
        return SuborbitalInputs(
            flight=FlightParameters(**{name: self[key] for name, key in _FLIGHT.items()}),
            errors=ErrorSet(
                self._sensor("accelerometers"),
                self._sensor("gyros"),
                InitialErrors(self["initial.position"], self["initial.velocity"], self["initial.attitude"]),
            ),
            aiding=Aiding(**{name: self[key] for name, key in _AIDING.items()}),
            ins_gravity=self["ins.gravity"],
        )

    def _sensor(self, part: str) -> SensorErrors:
        return SensorErrors(
            constant_bias=self[f"{part}.bias"],
            oscillating_bias=self[f"{part}.bias_instability"],
            bias_period_s=self[f"{part}.bias_period"],
            constant_matrix=scale_matrix(self[f"{part}.scale_factor"], self[f"{part}.misalignment"]),
            oscillating_matrix=scale_matrix(
                self[f"{part}.scale_factor_instability"], self[f"{part}.misalignment_instability"]
            ),
            matrix_period_s=self[f"{part}.scale_factor_period"],
            white_noise=self[f"{part}.white_noise"],
        )

    def camera(self) -> StarCamera:
        """The star camera [B-8]. InputError for a focal length whose field of view is too wide or too narrow."""
        pixels, pitch = int(self["camera.pixels"]), self["camera.pixel_pitch"]
        focal = self["camera.focal_length"]
        camera = StarCamera(
            pixels=pixels,
            pixel_pitch_m=pitch,
            focal_length_m=focal_length(self["camera.field_of_view"], pixels, pitch) if focal is None else focal,
            centroid_sigma_rad=self["camera.centroid_noise"],
            brightest=int(self["camera.brightest"]),
            least_stars=int(self["camera.least_stars"]),
            roll_limit_rad=self["camera.roll_limit"],
        )
        field = INPUTS["camera.field_of_view"]
        assert isinstance(field, BaseQuantity)
        low, high = field.limits
        if not low <= camera.field_of_view_rad <= high:
            width = field.show(camera.field_of_view_rad, 4)
            reason = f"A focal length of {1000 * camera.focal_length_m:g} mm gives a field of view of {width}."
            raise InputError("focal_length_m", f"{reason} {field.allowed()}", camera.focal_length_m)
        return camera

    def sky(self) -> Sky:
        """The sky the camera looks at. The synthetic one has the Hipparcos catalogue's number of stars."""
        limit, seed = self["sky.magnitude_limit"], int(self["seed"])
        real = hipparcos_sky(limit)
        return real if self["sky.stars"] == "Hipparcos" else synthetic_sky(len(real), seed, limit)


_UNIT = re.compile(r"_(rad_s|m_s2|rad|m|s)$")


def _keys(model: type, section: str) -> dict[str, str]:
    """Names of the inputs in the model, which have the unit, -> their keys, where they are inputs."""
    named = {field.name: f"{section}.{_UNIT.sub('', field.name)}" for field in fields(model)}
    return {name: key for name, key in named.items() if key in INPUTS}


_FLIGHT, _AIDING = _keys(FlightParameters, "flight"), _keys(Aiding, "tracker")
_MODELS = _FLIGHT | _AIDING | _keys(StarCamera, "camera")


@contextmanager
def inputs_named(changes: Collection[str] = ()) -> Iterator[None]:
    """A value that a model refuses is refused under its key in `INPUTS`; where one input alone was changed, under
    that."""
    try:
        yield
    except InputError as error:
        raise error.under(*changes if len(changes) == 1 else [_MODELS.get(error.key, error.key)]) from error


DEFAULTS = Settings({key: declared.default for key, declared in INPUTS.items()}, dict.fromkeys(INPUTS, GP1))
"""GP-1 on the reference flight with a perfect camera from lift-off."""


def from_design(settings: Settings, design: Design) -> Settings:
    """The study's sensors with a design's inertial unit.

    Both random walks (times the vibration factor) become the white noise. A residual bias of the design is one
    number, 1 sigma per axis: every axis takes it, with the sign GP-1 has there. What a design does not say
    (instability, scale factor, misalignment, initial errors) stays as it was.
    """
    imu = design.imu

    def signed(key: str, size: float) -> Triple:
        x, y, z = (float(s) * size + 0.0 for s in np.sign(np.array(DEFAULTS[key], dtype=np.float64)))
        return x, y, z

    return settings.change(
        {
            "accelerometers.white_noise": imu.velocity_random_walk * imu.vibration_factor,
            "gyros.white_noise": imu.angle_random_walk * imu.vibration_factor,
            "accelerometers.bias": signed("accelerometers.bias", imu.accelerometer_bias),
            "gyros.bias": signed("gyros.bias", imu.gyro_bias),
        },
        f"{OF_DESIGN} {design.name}".strip(),
    )


def follow_design(settings: Settings, design: Design) -> Settings:
    """Take the inputs that follow a design from this one; inputs set by the user stay."""
    now = from_design(DEFAULTS, design)
    keys = [key for key, origin in settings.origin.items() if origin.startswith(OF_DESIGN)]
    return settings.change({key: now[key] for key in keys}, now.origin[keys[0]]) if keys else settings


def follows_design(settings: Settings) -> bool:
    """True if some input comes from a design."""
    return any(origin.startswith(OF_DESIGN) for origin in settings.origin.values())


def read_changes(settings: Settings, changes: Mapping[str, str], origin: str) -> Settings:
    """Settings with text values put in, as the command line gives them. InputError as `Settings.change`."""
    return settings.change({key: read_value(key, text) for key, text in changes.items()}, origin)


def declared(key: str) -> Input:
    """The declaration of an input; InputError for a key that has none."""
    if key not in INPUTS:
        raise InputError(key, f"is not an input of the study; the inputs are {', '.join(INPUTS)}")
    return INPUTS[key]


def read_value(key: str, content: Any, unit: str = "") -> Value:
    """The value, in SI, that a file, a link or a box gives for an input.

    Parameters
    ----------
    content : Any
        Text with a unit; a number where the input has none; "none" or nothing where it may be left out.
    unit : str
        Taken where the text gives none.

    Raises
    ------
    InputError
        Naming the key, what was given and what is allowed.
    """
    declaration = declared(key)
    if isinstance(declaration, BaseQuantity):
        text = content.strip() if isinstance(content, str) else content
        if declaration.allow_None and isinstance(text, str) and text.lower() in ("", "none"):
            return None
        return declaration.read(with_unit(text, unit) if unit and isinstance(text, str) else text).value
    if isinstance(declaration, Axes):
        return declaration.read(content, unit)
    value: Value = declaration.read(content.strip() if isinstance(content, str) else content)
    return value


def output_every(steps: int) -> int:
    """Steps between two points of the error histories: a divisor that leaves at most 320 points, or up to
    2000 where that would mean fewer than 100. InputError when the number of steps has no such divisor."""
    for most in (320, 1000, 2000):
        every = next(d for d in range(1, steps + 1) if steps % d == 0 and steps // d <= most)
        if steps // every >= 100 or steps <= most:
            return every
    reason = f"the flight has {steps} steps, which no round interval divides. Give it a multiple of 5 s."
    raise InputError("flight.duration", reason)

"""The inputs of the closed forms of a budget: SI numbers, or arrays that broadcast together."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import SlowError
from nav_model.aperture import autofocus, geometry
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.constants import EARTH_RATE, MEAN_RADIUS, SPEED_OF_LIGHT
from nav_model.base.errors import InputError
from nav_model.budget.contributors import Contributors, contributors_of
from nav_model.budget.fast import fast_sources, rectified
from nav_model.design import Design
from nav_model.design.autofocus import PHASE_GRADIENT
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS, Radar
from nav_model.design.user_entries import Limit
from nav_model.processing.fast_motion import Fast

RECTIFICATION = "vibration rectification"
"""Name of the source in every budget."""

VARIABLES: tuple[str, ...] = tuple(
    declaration.key
    for names in INPUTS.values()
    for declaration in names.values()
    if isinstance(declaration, BaseQuantity) and declaration.variable
)
"""Dotted keys of every input that a figure can depend on."""

_VARYING = {
    "instability_a": "accelerometer.bias_instability",
    "time_a": "accelerometer.correlation_time",
    "walk_a": "accelerometer.rate_random_walk",
    "instability_w": "gyro.bias_instability",
    "time_w": "gyro.correlation_time",
    "walk_w": "gyro.rate_random_walk",
}
"""Fields of the biases that vary -> their keys."""

VARYING_KEYS = tuple(_VARYING.values())
"""Dotted keys of the biases that vary."""

_CONSTANT = {
    "turn_on_a": "accelerometer.turn_on_bias",
    "misalignment_a": "accelerometer.misalignment",
    "turn_on_w": "gyro.turn_on_bias",
    "scale_w": "gyro.scale_factor",
    "misalignment_w": "gyro.misalignment",
    "g_sensitivity": "gyro.g_sensitivity",
}
"""Fields of a sensor's constant errors that a filter estimates or lives with -> their keys."""

CONSTANT_KEYS = tuple(_CONSTANT.values())
"""Dotted keys of a sensor's constant errors."""

LONGEST_APERTURE = float(Radar.param["aperture_time"].bounds[1])  # s

Replacement = ArrayLike | None


@dataclass(frozen=True)
class Inputs:
    """The inputs of the figures in SI; numbers or arrays that broadcast together.

    sigma_a, sigma_w: random walk of accelerometers [m/s/√s] and gyros [rad/√s], vibration factor applied; bias_a,
    bias_w: what the filter does not absorb [m/s², rad/s]; turn_on_a, turn_on_w: constant biases that it estimates;
    instability_a, time_a, walk_a and those with w: its in-run instability [m/s², rad/s] and correlation time [s], and
    rate random walk [m/s²/√s, rad/s/√s], all None where none varies; scale_w, misalignment_a, misalignment_w
    [rad], g_sensitivity [rad/s per m/s²]. fix, fix_vertical: position noise [m] of a fix every
    `interval`; velocity, velocity_vertical: velocity noise [m/s] every `velocity_interval`; slow: GNSS error with a
    correlation time. duration: of the outage; before_aperture: from the last fix to the aperture; leg_after: with
    fixes after it [s]. fast: source -> vibration, unsensed motion, oscillator along the line of sight; rectified:
    accelerometer bias that vibration makes [m/s²]. aperture: its time [s]. residual: after an autofocus, None
    without one; estimation: 1σ of one of its estimates [rad]; estimated: multiplies its variance for each measure of
    the phase; half_cell: half the range resolution [m].
    """

    sigma_a: Array
    sigma_w: Array
    interval: Array
    fix: Array
    fix_vertical: Array
    slow: SlowError | None
    g: Array
    bias_a: Array
    bias_w: Array
    speed: Array
    altitude: Array
    latitude: Array
    heading: Array
    duration: Array
    before_aperture: Array
    wavelength: Array
    slant_range: Array
    grazing_angle: Array
    squint: Array
    aperture: Array
    autofocus_order: int
    steady_state: str
    velocity: Array | None
    velocity_vertical: Array | None
    velocity_interval: Array | None
    processing: str
    leg_after: Array
    scene_height_error: Array
    window: str
    fast: Mapping[str, Fast]
    rectified: Array | None
    contributors: Contributors
    limits: tuple[Limit, ...]
    turn_on_a: Array
    turn_on_w: Array
    scale_w: Array
    misalignment_a: Array
    misalignment_w: Array
    g_sensitivity: Array
    instability_a: Array | None = None
    instability_w: Array | None = None
    time_a: Array | None = None
    time_w: Array | None = None
    walk_a: Array | None = None
    walk_w: Array | None = None
    residual: autofocus.Residual | None = None
    estimation: Array | None = None
    estimated: Array | None = None
    half_cell: Array | None = None

    @property
    def scattered_by_estimation(self) -> Array | float:
        """Variance of the phase [rad²] that an autofocus adds beyond a cubic, which smears no main lobe. [S-10]"""
        if self.estimation is None or self.estimated is None:
            return 0.0
        quadratic, cubic, detrended = self.estimated
        return np.asarray(self.estimation**2 * max(detrended - 4 / 45 * quadratic - 4 / 175 * cubic, 0.0))

    @property
    def bias(self) -> Array:
        """Accelerometer bias with that of vibration, m/s². [P-12]"""
        return self.bias_a if self.rectified is None else np.sqrt(self.bias_a**2 + self.rectified**2)

    @property
    def settled_tilt(self) -> Array:
        """Variance of the tilt [rad²] by which a settled filter cancels what else acts on level accelerometers: their
        biases, gravity by a misalignment, and what rate random walk has made by the end of the flight. [T-22]"""
        walked = 0.0 if self.walk_a is None else self.walk_a**2 * self.duration
        variance: Array = (self.bias**2 + self.turn_on_a**2 + walked) / self.g**2 + self.misalignment_a**2
        return variance

    @property
    def heading_rate(self) -> Array:
        """Variance of the rate of the heading error by what is constant [rad²/s²]: biases of the vertical gyro,
        the turn of the Earth and along it by scale factor and misalignment, gravity by g-sensitivity. [T-22]"""
        # On a great circle the vertical gyro senses the Earth alone.
        around, ahead = EARTH_RATE * np.cos(self.latitude), self.speed / (MEAN_RADIUS + self.altitude)
        level = around**2 + 2 * around * ahead * np.sin(self.heading) + ahead**2
        variance: Array = (
            self.bias_w**2
            + self.turn_on_w**2
            + (self.scale_w * EARTH_RATE * np.sin(self.latitude)) ** 2
            + self.misalignment_w**2 * level
            + (self.g_sensitivity * self.g) ** 2
        )
        return variance

    @property
    def to_phase(self) -> Array:
        """Two-way phase of a metre, rad. [T-13]"""
        return 4 * math.pi / self.wavelength

    @property
    def imaged(self) -> NDArray[np.bool_]:
        """True where there is a line of sight, and the aperture is no longer than a design may have."""
        seen = ~geometry.hidden(self.squint.real, self.grazing_angle.real)
        return np.asarray(seen & (self.aperture.real <= LONGEST_APERTURE))

    @property
    def s(self) -> Array:
        """Density of the fixes, m·√s. [T-2]"""
        return steady.fix_density(self.fix, self.interval)

    @property
    def s_vertical(self) -> Array:
        """Density of the vertical fixes, m·√s. [T-2]"""
        return steady.fix_density(self.fix_vertical, self.interval)

    @property
    def velocity_densities(self) -> tuple[Array, Array] | None:
        """Densities of the velocity fixes, horizontal and vertical, m/s·√s; None without them. [P-2]"""
        if self.velocity is None or self.velocity_vertical is None or self.velocity_interval is None:
            return None
        root = np.sqrt(self.velocity_interval)
        return self.velocity * root, self.velocity_vertical * root

    @property
    def velocity_of_fix(self) -> tuple[Array, Array] | None:
        """Velocity that comes with each position fix, 1σ at the same density, horizontal and vertical, m/s."""
        if (densities := self.velocity_densities) is None:
            return None
        return densities[0] / np.sqrt(self.interval), densities[1] / np.sqrt(self.interval)


def inputs_of(design: Design, changes: Mapping[str, Replacement] | None = None) -> Inputs:
    """The inputs of a design, some of them replaced.

    Parameters
    ----------
    design : Design
    changes : mapping, optional
        Dotted key of `VARIABLES` -> value in SI, a number or an array. They are taken as they are: bounds are
        the caller's business.

    Raises
    ------
    InputError
        For a key that is not one of `VARIABLES`.
    """
    changed = changes or {}
    for key in changed:
        if key not in VARIABLES:
            raise InputError(key, f"no figure depends on it as a number; allowed are {', '.join(VARIABLES)}")

    def value(key: str) -> Array:
        number = changed.get(key, design[key])
        return as_numbers(number)  # type: ignore[arg-type]

    def given(key: str) -> bool:
        return changed.get(key, design[key]) is not None

    gnss, radar = design.gnss, design.radar
    factor = value("imu.vibration_factor")
    fix = value("gnss.position_noise")
    fix_vertical = value("gnss.vertical_position_noise") if given("gnss.vertical_position_noise") else fix
    wavelength, squint = SPEED_OF_LIGHT / value("radar.frequency"), value("radar.squint_angle")
    slant_range, speed = value("radar.slant_range"), value("flight.speed")
    velocity = value("gnss.velocity_noise") if given("gnss.velocity_noise") else None
    slow = None
    if gnss.correlated:
        horizontal = value("gnss.correlated_noise")
        vertical = (
            value("gnss.vertical_correlated_noise")
            if given("gnss.vertical_correlated_noise")
            else horizontal * fix_vertical / fix
        )
        slow = SlowError(horizontal, vertical, value("gnss.correlation_time"))
    varies = any(np.any(value(key)) for field, key in _VARYING.items() if not field.startswith("time"))
    resolution = value("radar.azimuth_resolution")
    aperture = (
        value("radar.aperture_time")
        if given("radar.aperture_time")
        else geometry.aperture_time(wavelength, slant_range, speed, resolution, radar.window, squint)
    )
    residual, noise = _of_autofocus(design, value, given)
    return Inputs(
        sigma_a=value("imu.velocity_random_walk") * factor,
        sigma_w=value("imu.angle_random_walk") * factor,
        interval=value("gnss.interval"),
        fix=fix,
        fix_vertical=fix_vertical,
        slow=slow,
        g=value("flight.gravity"),
        bias_a=value("imu.accelerometer_bias"),
        bias_w=value("imu.gyro_bias"),
        speed=speed,
        altitude=value("flight.altitude"),
        latitude=value("flight.latitude"),
        heading=value("flight.heading"),
        duration=value("coast.duration"),
        before_aperture=value("coast.before_aperture"),
        wavelength=wavelength,
        slant_range=slant_range,
        grazing_angle=value("radar.grazing_angle"),
        squint=squint,
        aperture=aperture,
        autofocus_order=1 if design.autofocus.works else radar.autofocus_order,
        steady_state=design.requirements.steady_state,
        velocity=velocity,
        velocity_vertical=value("gnss.vertical_velocity_noise")
        if given("gnss.vertical_velocity_noise")
        else velocity,
        velocity_interval=(
            value("gnss.velocity_interval") if given("gnss.velocity_interval") else value("gnss.interval")
        ),
        processing=design.processing.mode,
        leg_after=value("processing.leg_after"),
        scene_height_error=value("processing.scene_height_error"),
        window=radar.window,
        fast=fast_sources(design, value, wavelength, aperture),
        rectified=rectified(design, value),
        contributors=contributors_of(design, wavelength) if design.contributors else Contributors(),
        limits=design.limits,
        half_cell=(value("radar.range_resolution") if given("radar.range_resolution") else resolution) / 2,
        residual=residual,
        estimation=None if noise is None else noise.sigma,
        estimated=None if noise is None else noise.weights,
        **{field: value(key) for field, key in _CONSTANT.items()},
        **({field: value(key) for field, key in _VARYING.items()} if varies else {}),
    )


def _of_autofocus(
    design: Design, value: Callable[[str], Array], given: Callable[[str], bool]
) -> tuple[autofocus.Residual | None, autofocus.Noise | None]:
    """Residual of the design's autofocus and the error that it adds, none without one."""
    used = design.autofocus
    if not used.works:
        return None, None
    points, amplitude = (
        value(key) if given(key) else as_numbers(usual)
        for key, usual in zip(("autofocus.range_bins", "autofocus.signal_to_clutter"), used.points, strict=True)
    )
    if used.method == PHASE_GRADIENT:
        residual = autofocus.after_phase_gradient(used.blocks)
        noise = autofocus.noise_of_phase_gradient(used.blocks, points, amplitude**2)
    else:
        residual = autofocus.after_map_drift(used.order)
        noise = autofocus.noise_of_map_drift(used.order, points, amplitude**2)
    return residual, noise

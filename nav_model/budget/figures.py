"""The figures that requirements look at, for one design or for arrays of designs at once.

`nav_model.budget.analyse` and everything that explores (solving backwards, ranking, maps, search, uncertainty,
sweeps) compose the closed forms here and nowhere else. Any input may be an array; all broadcast together, and
complex numbers pass through, so that a complex step differentiates every figure exactly.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth, SlowError, cycle
from nav_model.analytic.refined_coast import refined_growth
from nav_model.analytic.steady_state import Array, Horizontal, as_numbers
from nav_model.constants import SPEED_OF_LIGHT
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS, Radar
from nav_model.errors import InputError
from nav_model.sar import geometry, phase

SETTLED = ("horizontal_position", "vertical_position", "horizontal_velocity", "vertical_velocity", "tilt")
COASTING = ("coast_horizontal_position", "coast_vertical_position")
IMAGING = ("quadratic_phase", "along_track_quadratic_phase", "detrended_phase")

FIGURES: Mapping[str, str] = MappingProxyType(
    {
        name: "quadratic_phase" if name == "along_track_quadratic_phase" else name
        for name in (*IMAGING, *SETTLED, *COASTING)
    }
)
"""Name of a figure -> name of the requirement that limits it; the order is that of a verdict."""

VARIABLES: tuple[str, ...] = tuple(
    f"{section}.{name}"
    for section, names in INPUTS.items()
    for name, declaration in names.items()
    if isinstance(declaration, BaseQuantity) and section != "requirements" and f"{section}.{name}" != "imu.rate"
)
"""Dotted keys of every input that a figure can depend on."""

LONGEST_APERTURE = float(Radar.param["aperture_time"].bounds[1])  # s

Replacement = ArrayLike | None


@dataclass(frozen=True)
class Inputs:
    """What the closed forms take, in SI, vibration applied; numbers or arrays that broadcast together."""

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

    @property
    def s(self) -> Array:
        """Density of the fixes, m·√s. [T-2]"""
        return steady.fix_density(self.fix, self.interval)

    @property
    def s_vertical(self) -> Array:
        """Density of the vertical fixes, m·√s. [T-2]"""
        return steady.fix_density(self.fix_vertical, self.interval)


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
    wavelength, squint = SPEED_OF_LIGHT / value("radar.frequency"), value("radar.squint_angle")
    slant_range, speed = value("radar.slant_range"), value("flight.speed")
    slow = None
    if gnss.correlated:
        slow = SlowError(value("gnss.correlated_noise"), value("gnss.correlation_time"))
    return Inputs(
        sigma_a=value("imu.velocity_random_walk") * factor,
        sigma_w=value("imu.angle_random_walk") * factor,
        interval=value("gnss.interval"),
        fix=fix,
        fix_vertical=value("gnss.vertical_position_noise") if given("gnss.vertical_position_noise") else fix,
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
        aperture=(
            value("radar.aperture_time")
            if given("radar.aperture_time")
            else geometry.aperture_time(
                wavelength, slant_range, speed, value("radar.azimuth_resolution"), radar.window, squint
            )
        ),
        autofocus_order=radar.autofocus_order,
        steady_state=design.requirements.steady_state,
    )


def sampled(x: Inputs, slow: bool = True) -> Cycle:
    """Prior and posterior of the filter as it is built, with the slow error of its fixes or without. [T-8]"""
    return cycle(x.sigma_a, x.sigma_w, x.g, x.interval, x.fix, x.fix_vertical, x.slow if slow else None)


def settled(x: Inputs) -> Sawtooth:
    """Cycle rms of the settled filter in closed form. [T-3], [T-4]"""
    return Sawtooth(steady.horizontal(x.sigma_a, x.sigma_w, x.s, x.g), steady.vertical(x.sigma_a, x.s_vertical))


def outage(x: Inputs, posterior: Sawtooth, time: ArrayLike) -> tuple[Array, Array]:
    """Refined position variances, horizontal and vertical, with the residual biases. [T-17]"""
    refined = refined_growth(
        posterior.horizontal,
        posterior.vertical,
        x.sigma_a,
        x.sigma_w,
        x.g,
        time,
        speed=x.speed,
        latitude=x.latitude,
        altitude=x.altitude,
        heading=x.heading,
    )
    bias_a, bias_w = growth.bias_position(x.bias_a, x.bias_w, x.g, time)
    return refined.horizontal + bias_a**2 + bias_w**2, refined.vertical + bias_a**2


def phase_sources(x: Inputs, start: Horizontal) -> Mapping[str, phase.PhaseVariances]:
    """Line-of-sight variances over the aperture, source by source, from a covariance at the last fix. [S-5]"""
    return phase.phase_budget(
        start.p33,
        x.sigma_a,
        x.sigma_w,
        x.bias_a,
        x.bias_w,
        x.g,
        x.aperture,
        x.before_aperture,
        x.grazing_angle,
        x.autofocus_order,
    )


def along_track_phase(x: Inputs, start: Horizontal) -> Array:
    """Quadratic phase [rad], 1σ, of the along-track velocity error at the aperture. [S-2]"""
    variance = growth.horizontal_growth(start, x.sigma_a, x.sigma_w, x.g, x.before_aperture).velocity
    drift_a, drift_w = growth.bias_velocity(x.bias_a, x.bias_w, x.g, x.before_aperture)
    return phase.along_track_quadratic(
        variance + drift_a**2 + drift_w**2, x.speed, x.aperture, x.wavelength, x.slant_range, x.squint
    )


def figures(x: Inputs, names: Collection[str] = tuple(FIGURES)) -> dict[str, Array]:
    """One sigma of the figures asked for, in SI: what `analyse` holds against the requirements.

    Parameters
    ----------
    x : Inputs
    names : collection of str
        Keys of `FIGURES`; what nobody asks for is not computed.

    Returns
    -------
    dict
        Name -> array of the inputs' broadcast shape, or of a smaller shape that broadcasts to it. Phase figures
        are NaN where the aperture is longer than a design may have.
    """
    found: dict[str, Array] = {}
    wanted = set(names)
    imaging, settling, coasting = (wanted.intersection(group) for group in (IMAGING, SETTLED, COASTING))
    closed = settled(x) if (imaging and x.slow is None) or (settling and x.steady_state == "closed") else None
    saw = sampled(x) if coasting or closed is None or (settling and x.steady_state != "closed") else None
    if imaging:
        # With a slow GNSS error no closed form covers the start of the aperture; the augmented filter does.
        start = (saw.posterior if saw and x.slow is not None else closed).horizontal  # type: ignore[union-attr]
        whole = phase.total(phase_sources(x, start))
        to_phase = np.where(x.aperture.real <= LONGEST_APERTURE, 4 * math.pi, np.nan) / x.wavelength
        found["quadratic_phase"] = to_phase * np.sqrt(whole.quadratic)
        found["detrended_phase"] = to_phase * np.sqrt(whole.detrended)
        if "along_track_quadratic_phase" in wanted:
            track = along_track_phase(x, start)
            found["along_track_quadratic_phase"] = np.where(np.isnan(to_phase.real), np.nan, track)
    if settling:
        moment = closed if x.steady_state == "closed" else getattr(saw, x.steady_state)
        assert moment is not None
        level, upright = moment
        variances = (level.p11, upright.v11, level.p22, upright.v22, level.p33)
        found |= {name: np.sqrt(variance) for name, variance in zip(SETTLED, variances, strict=True)}
    if coasting:
        assert saw is not None
        ends = outage(x, saw.posterior, x.duration)
        found |= {name: np.sqrt(variance) for name, variance in zip(COASTING, ends, strict=True)}
    return {name: found[name] for name in FIGURES if name in wanted}

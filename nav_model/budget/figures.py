"""The figures that requirements limit, for one design or for arrays of designs at once.

`nav_model.budget.analyse` and everything that explores (solving backwards, ranking, maps, search, uncertainty,
sweeps) compose the closed forms here and nowhere else. Any input may be an array; all broadcast together, and
complex numbers pass through, so that a complex step differentiates every figure exactly.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth, cycle
from nav_model.analytic.refined_coast import refined_growth
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.analytic.turning import TURNING, smoothed_bent_variance, turn_weights
from nav_model.aperture import geometry, phase
from nav_model.base.arrays import Array, as_numbers
from nav_model.budget.contributors import NONE, entering, with_contributors
from nav_model.budget.fast import LEVELS, levels
from nav_model.budget.inputs import RECTIFICATION, Inputs
from nav_model.budget.response import responses
from nav_model.design.contributors import BY_ORDER, COASTING, EXTRA, IN_OUTAGE, RESPONSE
from nav_model.design.own import Limit
from nav_model.processing.flight import Channel
from nav_model.processing.geolocation import (
    NINETY,
    Line,
    Shifts,
    circular_error,
    free_line,
    ground_covariance,
    shifts,
)
from nav_model.processing.smoother import smoothed_error

SETTLED = ("horizontal_position", "vertical_position", "horizontal_velocity", "vertical_velocity", "tilt")
IMAGING = ("quadratic_phase", "along_track_quadratic_phase", "cubic_phase", "detrended_phase")
PLACING = ("azimuth_shift", "range_shift", "ce90", "le90", "cep")
_WITHIN = {"ce90": 0.9, "cep": 0.5}
"""Radii -> the share of images that each contains."""

FIGURES: Mapping[str, str] = MappingProxyType(
    {
        name: "quadratic_phase" if name == "along_track_quadratic_phase" else name
        for name in (*IMAGING, *LEVELS, *PLACING, *SETTLED, *COASTING)
        if name not in EXTRA
    }
)
"""Name of a figure -> name of the requirement that limits it; the order is that of a verdict."""

_MODELLED = (*FIGURES, "cep", *BY_ORDER)

INITIAL_TILT = "initial tilt"
"""Name of the source in a phase budget: what other sources have made of the tilt at the last fix."""


def sampled(x: Inputs) -> Cycle:
    """Prior and posterior of the filter as it is built. [T-8]"""
    noises = x.sigma_a, x.sigma_w, x.g, x.interval, x.fix, x.fix_vertical
    return cycle(*noises, x.slow, x.velocity_of_fix)


def settled(x: Inputs) -> Sawtooth:
    """Cycle rms of the settled filter in closed form. [T-3], [T-4], with velocity [P-6]"""
    level, upright = x.velocity_densities or (None, None)
    return Sawtooth(
        steady.horizontal(x.sigma_a, x.sigma_w, x.s, x.g, level), steady.vertical(x.sigma_a, x.s_vertical, upright)
    )


def outage(
    x: Inputs, posterior: Sawtooth, time: ArrayLike, rule: tuple[Array, Array] | None = None
) -> tuple[Array, Array]:
    """Refined position variances, horizontal and vertical, with the residual biases; `rule` as there. [T-17]"""
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
        rule=rule,
    )
    bias_a, bias_w = growth.bias_position(x.bias, x.bias_w, x.g, time)
    return refined.horizontal + bias_a**2 + bias_w**2, refined.vertical + bias_a**2


def free_growth(x: Inputs, closed: Sawtooth, time: Array) -> dict[str, Array]:
    """Variances in an outage: positions, and the figures of `IN_OUTAGE`, with the residual biases. [T-9], [T-10]"""
    level = growth.horizontal_growth(closed.horizontal, x.sigma_a, x.sigma_w, x.g, time)
    upright = growth.vertical_growth(closed.vertical, x.sigma_a, time)
    bias_a, bias_w = growth.bias_position(x.bias, x.bias_w, x.g, time)
    drift_a, drift_w = growth.bias_velocity(x.bias, x.bias_w, x.g, time)
    return {
        "position_horizontal": level.position + bias_a**2 + bias_w**2,
        "position_vertical": upright.position + bias_a**2,
        "coast_horizontal_velocity": level.velocity + drift_a**2 + drift_w**2,
        "coast_vertical_velocity": upright.velocity + drift_a**2,
        "coast_tilt": level.tilt + (x.bias_w * time) ** 2,
        "coast_heading": steady.yaw_variance(x.sigma_w, time),
    }


def in_outage(limit: Limit) -> bool:
    """Whether a limit is on a value at a time in the outage."""
    return limit.on in IN_OUTAGE or limit.at is not None


def _limited(x: Inputs, limit: Limit, found: Mapping[str, Array]) -> Array:
    """What a limit of the user's own limits, without its contributors; zero where that is one of them."""
    if limit.on in RESPONSE:
        entered = entering(x.own, "quadratic_phase", post_processed=x.post_processed)
        return responses(x, with_contributors(found["quadratic_phase"], entered))[limit.on]
    if not in_outage(limit):
        return found[limit.on] if limit.on in found else np.asarray(0.0)
    time = x.duration if limit.at is None else np.asarray(limit.at)
    if limit.on in COASTING:
        return np.sqrt(outage(x, sampled(x).posterior, time)[COASTING.index(limit.on)])
    return np.sqrt(free_growth(x, settled(x), time)[limit.on])


def phase_sources(x: Inputs, start: Horizontal) -> Mapping[str, phase.PhaseVariances]:
    """Line-of-sight variances over the aperture, source by source, from a covariance at the last fix. [S-5]"""
    arguments = x.g, x.aperture, x.before_aperture, x.grazing_angle, x.autofocus_order
    found = phase.phase_budget(start.p33, x.sigma_a, x.sigma_w, x.bias_a, x.bias_w, *arguments)
    if x.rectified is None and not x.fast:
        return found
    more = {
        name: phase.PhaseVariances(made.quadratic, made.cubic, getattr(made, f"left_{x.autofocus_order}"))
        for name, made in x.fast.items()
    }
    if x.rectified is not None:
        more[RECTIFICATION] = phase.phase_budget(0.0, 0.0, 0.0, x.rectified, 0.0, *arguments)["accelerometer bias"]
    return {**found, **more}


def along_track_phase(x: Inputs, start: Horizontal) -> Array:
    """Quadratic phase [rad], 1σ, of the along-track velocity error at the aperture. [S-2]"""
    variance = growth.horizontal_growth(start, x.sigma_a, x.sigma_w, x.g, x.before_aperture).velocity
    drift_a, drift_w = growth.bias_velocity(x.bias, x.bias_w, x.g, x.before_aperture)
    return phase.along_track_quadratic(
        variance + drift_a**2 + drift_w**2, x.speed, x.aperture, x.wavelength, x.slant_range, x.squint
    )


def begun(x: Inputs, posterior: Sawtooth | None = None) -> Sawtooth:
    """The filter at the last fix before the aperture: its cycle rms, [T-3] and [T-4] or [P-6], but no less than the
    covariance just after a fix [T-8], which is larger where the fixes are far apart.

    No closed form has a slow GNSS error. It adds here what it adds to the covariance just after a fix. So no error
    improves a figure, and a smoother, which starts from that covariance, is no worse. `posterior` is it, where known.
    """
    closed, after = settled(x), posterior or sampled(x).posterior
    white = after if x.slow is None else sampled(replace(x, slow=None)).posterior
    level, upright = (
        [least + np.where(mean.real > less.real, mean - less, 0) for mean, less, least in zip(*channel, strict=True)]
        for channel in zip(closed, white, after, strict=True)
    )
    return Sawtooth(Horizontal(*level), Vertical(*upright))


def free_lines(x: Inputs, start: Sawtooth) -> tuple[Line, Line]:
    """Line in the error of a free INS from the last fix over the aperture, horizontal and vertical. [P-7]"""
    inside = x.before_aperture, x.aperture
    return (
        free_line(start.horizontal, x.sigma_a, x.sigma_w, x.bias, x.bias_w, x.g, *inside),
        free_line(start.vertical, x.sigma_a, 0.0, x.bias, 0.0, x.g, *inside),
    )


def smoothed_lines(x: Inputs) -> tuple[Line, Line]:
    """The same of the smoothed trajectory."""
    level, upright = _smoothed(x, _NEEDED["ce90"])
    return _line(level), _line(upright)


def _smoothed(x: Inputs, columns: Collection[str]) -> list[dict[str, Array]]:
    """Variances of the smoothed error, of a horizontal axis and of the vertical one. [P-3], [P-5]"""
    return smoothed_error(channels(x), x.aperture, x.leg_after, x.before_aperture, columns)


def _line(part: Mapping[str, Array]) -> Line:
    return Line(part["mean"], part["slope"], part["mean_slope"])


def free_shifts(x: Inputs, start: Sawtooth) -> Shifts:
    """Shift of an image that a free INS from the last fix focuses. [P-7]"""
    return with_fast(x, shifts(*free_lines(x, start), x.grazing_angle, x.slant_range, x.speed, x.squint))


def with_fast(x: Inputs, moved: Shifts) -> Shifts:
    """The image's shift with what vibration, unsensed motion and oscillator add along the line of sight. [P-7]"""
    if not x.fast:
        return moved
    return moved._replace(
        range=moved.range + sum(made.mean for made in x.fast.values()),
        azimuth=moved.azimuth + _lever(x) ** 2 * _fast_slope(x),
    )


def _lever(x: Inputs) -> Array:
    """Azimuth shift of a metre a second along the line of sight, s."""
    return np.asarray(x.slant_range / (x.speed * np.cos(x.squint)))


def _fast_slope(x: Inputs) -> Array:
    """Variance of the slope over the aperture from vibration, unsensed motion and oscillator, m²/s²."""
    return np.asarray(sum(made.slope for made in x.fast.values()) * 4 / x.aperture**2)


def placing(x: Inputs, moved: Shifts, names: Collection[str] = PLACING) -> dict[str, Array]:
    """Figures of `PLACING` from the variances of the image's shift."""
    found: dict[str, Array] = {}
    if "azimuth_shift" in names:
        found["azimuth_shift"] = np.sqrt(moved.azimuth)
    if "range_shift" in names:
        found["range_shift"] = np.sqrt(moved.range)
    if not {"ce90", "cep"}.isdisjoint(names):
        ground = ground_covariance(moved, x.grazing_angle, x.scene_height_error, x.squint)
        found |= {name: circular_error(*ground, share=share) for name, share in _WITHIN.items() if name in names}
    if "le90" in names:
        found["le90"] = NINETY * np.sqrt(moved.height + x.scene_height_error**2)
    return found


def channels(x: Inputs) -> tuple[Channel, Channel]:
    """Inputs of the smoother for a horizontal axis and the vertical one."""
    slow = (None, None) if x.slow is None else (as_numbers(x.slow.sigma), as_numbers(x.slow.correlation_time))
    level, upright, interval = x.velocity, x.velocity_vertical, x.velocity_interval
    if level is None:
        upright = interval = None
    return (
        Channel(x.sigma_a, x.g * x.sigma_w, x.fix, x.interval, level, interval, *slow),
        Channel(x.sigma_a, None, x.fix_vertical, x.interval, upright, interval, *slow),
    )


_NEEDED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "quadratic_phase": ("quadratic",),
        "along_track_quadratic_phase": ("turned",),
        "cubic_phase": ("cubic",),
        **dict.fromkeys(PLACING, ("mean", "slope", "mean_slope")),
        **dict.fromkeys(("horizontal_position", "vertical_position"), ("position",)),
        **dict.fromkeys(("horizontal_velocity", "vertical_velocity"), ("velocity",)),
        "tilt": ("tilt",),
        "detrended_phase_1": ("left_1",),
        "detrended_phase_2": ("left_2",),
        "detrended_phase_3": ("left_3",),
        "slope_shift": ("slope",),
        "turning_quadratic_phase": ("quadratic", *TURNING),
        "turning_detrended_phase_1": ("left_2", "quadratic", *TURNING),
        "turning_detrended_phase_2": ("left_3", "cubic", *(f"cubic_{name}" for name in TURNING)),
    }
)
"""What each smoothed figure takes from the smoother; "detrended_phase" is the one of the design's autofocus order."""

SMOOTHED = tuple(_NEEDED)
"""Names of every figure that `smoothed_figures` knows, beside "detrended_phase"."""


def smoothed_figures(x: Inputs, names: Collection[str]) -> dict[str, Array]:
    """One sigma of some figures with a smoother that has every fix. [P-3], [P-5]

    Parameters
    ----------
    x : Inputs
    names : collection of str
        Of `SMOOTHED`: also the residual after each autofocus order, "detrended_phase_1" to 3, "slope_shift", the
        azimuth shift without the position along the track, and "turning_quadratic_phase" and
        "turning_detrended_phase_1" and 2, the quadratic phase and the residuals along the line of sight as it turns.
        Constant residual biases cost nothing: the smoother takes them up.
    """
    return smoothed_with_shifts(x, names)[0]


def smoothed_with_shifts(x: Inputs, names: Collection[str]) -> tuple[dict[str, Array], Shifts | None]:
    """`smoothed_figures`, and the image's shift, from which `PLACING` comes; None where none of it is asked for."""
    order = f"detrended_phase_{x.autofocus_order}"
    wanted = {order if name == "detrended_phase" else name for name in names} - set(LEVELS)
    h, v = _smoothed(x, sorted({column for name in wanted for column in _NEEDED[name]}))
    wide, high = geometry.line_of_sight_weights(x.grazing_angle)
    to_phase = x.to_phase
    found: dict[str, Array] = {}
    for name in wanted & set(_PHASES):
        column = _NEEDED[name][0]
        fast = sum(getattr(made, column) for made in x.fast.values())
        found[name] = to_phase * np.sqrt(wide * h[column] + high * v[column] + fast)
    if "along_track_quadratic_phase" in wanted:
        turn = x.speed * np.cos(x.squint) ** 2 * x.aperture / (2 * x.slant_range)
        found["along_track_quadratic_phase"] = to_phase * turn * np.sqrt(h["turned"])
    if any(name.startswith("turning") for name in wanted):
        found |= _turning(x, h, v, wanted)
    if "slope_shift" in wanted:
        found["slope_shift"] = _lever(x) * np.sqrt(wide * h["slope"] + high * v["slope"] + _fast_slope(x))
    moved = None
    if wanted & set(PLACING):
        moved = with_fast(x, shifts(_line(h), _line(v), x.grazing_angle, x.slant_range, x.speed, x.squint))
        found |= placing(x, moved, wanted)
    for name, part, column in (
        ("horizontal_position", h, "position"), ("vertical_position", v, "position"),
        ("horizontal_velocity", h, "velocity"), ("vertical_velocity", v, "velocity"), ("tilt", h, "tilt"),
    ):  # fmt: skip
        if name in wanted:
            found[name] = np.sqrt(part[column] + x.bias**2) / x.g if name == "tilt" else np.sqrt(part[column])
    if "detrended_phase" in names:
        found["detrended_phase"] = found[order]
    if set(LEVELS).intersection(names):
        found |= levels(x.fast.values(), to_phase, x.aperture, x.window)
    return {name: found[name] for name in names}, moved


def _turning(x: Inputs, h: Mapping[str, Array], v: Mapping[str, Array], names: Collection[str]) -> dict[str, Array]:
    """Figures along the turning line of sight: [S-2] and the terms that it omits.

    A residual is that after the next order, which the turn hardly changes (0.08 % in the examples, 0.7 % where the
    line of sight turns by 0.225 rad to each side), and the turning quadratic or cubic.
    """
    turn = turn_weights(x.grazing_angle, x.squint, x.speed / x.slant_range, x.aperture)
    wide, high = geometry.line_of_sight_weights(x.grazing_angle)

    def along(column: str) -> Array:
        fast = sum(getattr(made, column) for made in x.fast.values())
        return np.asarray(wide * h[column] + high * v[column] + fast)

    def turning(column: str, of: str = "") -> Array:
        axes = ((turn.along, h), (turn.across, h), (turn.down, v))
        return along(column) + sum(smoothed_bent_variance(*pair, of) for pair in axes)

    variances: dict[str, Array] = {}
    if {"turning_quadratic_phase", "turning_detrended_phase_1"}.intersection(names):
        variances["turning_quadratic_phase"] = turning("quadratic")
    if "turning_detrended_phase_1" in names:
        variances["turning_detrended_phase_1"] = along("left_2") + 4 / 45 * variances["turning_quadratic_phase"]
    if "turning_detrended_phase_2" in names:
        variances["turning_detrended_phase_2"] = along("left_3") + 4 / 175 * turning("cubic", "cubic_")
    return {name: x.to_phase * np.sqrt(variance) for name, variance in variances.items()}


_PHASES = ("quadratic_phase", "cubic_phase", "detrended_phase_1", "detrended_phase_2", "detrended_phase_3")


def figures(x: Inputs, names: Collection[str] = tuple(FIGURES)) -> dict[str, Array]:
    """One sigma of some figures, in SI: those that `analyse` compares with the requirements, contributors included.

    Parameters
    ----------
    x : Inputs
    names : collection of str
        Keys of `FIGURES`, names of the user's own limits, or `INITIAL_TILT` [rad] of real time; others are not
        computed.

    Returns
    -------
    dict
        Name -> array of the inputs' broadcast shape, or of a smaller shape that broadcasts to it. Phase figures
        are NaN where the aperture is longer than a design may have.
    """
    limits = [limit for limit in x.limits if limit.name in names]
    needed = {"quadratic_phase" if limit.on in RESPONSE else limit.on for limit in limits if not in_outage(limit)}
    found = _of_model(x, {*names, *needed})
    own = {limit.name: _limited(x, limit, found) for limit in limits}
    wanted = {name: value for name, value in found.items() if name in names} | own
    return {
        name: with_contributors(value, entering(x.own, name, post_processed=x.post_processed))
        for name, value in wanted.items()
    }


def _of_model(x: Inputs, names: Collection[str]) -> dict[str, Array]:
    """The figures without contributors."""
    found: dict[str, Array] = {}
    wanted = set(names)
    if x.post_processed:
        found |= smoothed_figures(x, [name for name in _MODELLED if name in wanted and name not in COASTING])
        wanted &= set(COASTING)
    if wanted.intersection(LEVELS):
        found |= levels(x.fast.values(), x.to_phase, x.aperture, x.window)
    steady, coasting = wanted.intersection(SETTLED), wanted.intersection(COASTING)
    imaged = wanted.intersection((*IMAGING, *BY_ORDER, *PLACING, INITIAL_TILT))
    if steady or coasting or imaged:
        saw = sampled(x)
        start = begun(x, saw.posterior) if imaged or x.steady_state == "closed" else saw.posterior
        if placed := wanted.intersection(PLACING):
            found |= placing(x, free_shifts(x, start), placed)
        if wanted.intersection(IMAGING):
            found |= imaging(x, start.horizontal)
        for name in wanted.intersection(BY_ORDER):
            other = replace(x, autofocus_order=BY_ORDER[name])
            found[name] = imaging(other, start.horizontal)["detrended_phase"]
        if imaged:
            found[INITIAL_TILT] = np.sqrt(start.horizontal.p33)
        if steady:
            found |= sigmas(start if x.steady_state == "closed" else getattr(saw, x.steady_state), x)
        if coasting:
            ends = outage(x, saw.posterior, x.duration)
            found |= {name: np.sqrt(variance) for name, variance in zip(COASTING, ends, strict=True)}
    return {name: found[name] for name in (*_MODELLED, INITIAL_TILT) if name in names}


SHARED = (*SETTLED, *COASTING, *PLACING, "along_track_quadratic_phase", INITIAL_TILT)
"""What `real_time_figures` finds, beside limits in the outage: the phase and the image's place have shares
elsewhere."""


def real_time_figures(x: Inputs) -> dict[str, Array]:
    """Figures of `SHARED` in real time without contributors, one sigma, whatever the processing; ``initial tilt``
    [rad] of [S-5]."""
    own = (limit.name for limit in x.limits if in_outage(limit))
    return figures(replace(x, post_processed=False, steady_state="closed", own=NONE), (*SHARED, *own))


def sigmas(moment: Sawtooth, x: Inputs) -> dict[str, Array]:
    """Figures of `SETTLED` from the covariances of both channels.

    A filter sees only the sum of tilt and accelerometer bias on a straight level leg: settled, the tilt is b/g.
    """
    level, upright = moment
    variances = (level.p11, upright.v11, level.p22, upright.v22, level.p33 + (x.bias / x.g) ** 2)
    return {name: np.sqrt(variance) for name, variance in zip(SETTLED, variances, strict=True)}


def imaging(x: Inputs, start: Horizontal) -> dict[str, Array]:
    """Figures of `IMAGING` of a free INS from the last fix. [S-5], [S-6], [S-2]"""
    whole = phase.total(phase_sources(x, start))
    to_phase = x.to_phase
    return {
        "quadratic_phase": to_phase * np.sqrt(whole.quadratic),
        "along_track_quadratic_phase": np.where(np.isnan(to_phase.real), np.nan, along_track_phase(x, start)),
        "cubic_phase": to_phase * np.sqrt(whole.cubic),
        "detrended_phase": to_phase * np.sqrt(whole.detrended),
    }

"""From a design to its budget: one pass through the closed forms.

`analyse` composes the closed forms through `nav_model.figures`; pages, reports and JSON read its result.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth
from nav_model.analytic.sensitivity import horizontal_parts, horizontal_shares, vertical_parts
from nav_model.analytic.steady_state import Array, Horizontal
from nav_model.design import Design
from nav_model.figures import (
    LONGEST_APERTURE,
    Inputs,
    along_track_phase,
    inputs_of,
    outage,
    phase_sources,
    sampled,
    settled,
)
from nav_model.inputs import DesignError
from nav_model.sar import geometry, phase
from nav_model.sar.impulse_response import ImpulseResponse, quadratic_response
from nav_model.verdict import Verdict, judge

GNSS_NOISE, ACCELEROMETER_NOISE, GYRO_NOISE = "GNSS noise", "accelerometer noise", "gyro noise"
ACCELEROMETER_BIAS, GYRO_BIAS, SLOW_GNSS = "accelerometer bias", "gyro bias", "slow GNSS error"

COAST_POINTS = 300
_NO_IMAGE = 1000.0  # rad of quadratic phase: the response is smeared over more than 600 cells

Shares = Mapping[str, float]


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of the navigation errors at one moment: m, m/s, rad."""

    position_horizontal: float
    position_vertical: float
    velocity_horizontal: float
    velocity_vertical: float
    tilt: float


@dataclass(frozen=True)
class SteadyState:
    """The settled filter.

    ``closed`` is the cycle rms in closed form [T-3], [T-4]; ``prior`` and ``posterior`` are the discrete
    filter just before and after a fix [T-8], slow GNSS error included. ``asymptote`` is [T-7]: position,
    velocity, tilt, horizontal. ``lambda_dt`` is the larger of the two channels. ``shares`` gives, for each
    kind of error, the share of each source in its variance [T-18].
    """

    closed: Sigmas
    prior: Sigmas
    posterior: Sigmas
    gyro_dominance: float
    asymptote: tuple[float, float, float]
    lambda_dt: float
    shares: Mapping[str, Shares]


@dataclass(frozen=True)
class Coast:
    """Sigmas against time since the last fix, arrays of one length: s, m, m/s, rad.

    ``position_*``, ``velocity_*`` and ``tilt`` are the polynomials [T-9], [T-10] with the residual biases in
    quadrature; ``refined_*`` is [T-17] with the same biases. ``shares_horizontal`` and ``shares_vertical``
    split the variance of position at the end of ``duration``.
    """

    duration: float
    time: Array
    position_horizontal: Array
    position_vertical: Array
    velocity_horizontal: Array
    velocity_vertical: Array
    tilt: Array
    yaw_growth: Array
    refined_horizontal: Array
    refined_vertical: Array
    perfect_start_horizontal: Array
    perfect_start_vertical: Array
    initial_tilt: Array
    end_refined_horizontal: float
    end_refined_vertical: float
    shares_horizontal: Shares
    shares_vertical: Shares


@dataclass(frozen=True)
class PhaseLine:
    """One source of the phase budget: 1σ in rad; ``share`` is of the quadratic-phase variance."""

    source: str
    quadratic: float
    cubic: float
    detrended: float
    share: float
    detrended_share: float


@dataclass(frozen=True)
class Sar:
    """The phase budget of the aperture: s, m, rad.

    ``impulse_response`` is that of the 1σ quadratic as navigation delivers it; ``after_autofocus`` that of
    what is left of it. Both are None when the phase is beyond 1000 rad and there is no image to describe.
    ``tilt_shares`` splits the initial tilt by the source that put it there [T-18], ``velocity_shares`` the
    variance of along-track velocity at the start of the aperture.
    """

    wavelength: float
    aperture_time: float
    aperture_length: float
    cell_length: float
    window: str
    autofocus_order: int
    quadratic: float
    cubic: float
    detrended: float
    along_track_quadratic: float
    lines: tuple[PhaseLine, ...]
    tilt_shares: Shares
    velocity_shares: Shares
    impulse_response: ImpulseResponse | None
    after_autofocus: ImpulseResponse | None


@dataclass(frozen=True)
class Budget:
    """Everything known about a design, immutable, in SI.

    `nav_model.provenance` says which equation each number comes from.
    """

    design: Design
    steady_state: SteadyState
    coast: Coast
    sar: Sar
    verdict: Verdict


def analyse(design: Design, times: ArrayLike | None = None) -> Budget:
    """The budget of one design.

    Parameters
    ----------
    design : Design
    times : array_like, optional
        Seconds since the last fix for the outage curves; by default 300 points over ``coast.duration``.

    Returns
    -------
    Budget

    Raises
    ------
    DesignError
        If `times` are not finite, negative or beyond the bounds of ``coast.duration``, if the aperture that
        follows from the radar's figures is longer than ``radar.aperture_time`` may be, or if the design's
        figures are so far apart that double precision cannot hold them together.
    """
    try:
        return _analyse(design, times)
    except ArithmeticError as error:
        key = "gnss.correlated_noise" if design.gnss.correlated else "imu.angle_random_walk"
        reason = f"{design[key]:.3g} (SI) gives no figure beside the other noises: {error}"
        raise DesignError(key, reason) from error


def _analyse(design: Design, times: ArrayLike | None) -> Budget:
    inputs = inputs_of(design)
    _refuse_hidden_target(float(inputs.squint), float(inputs.grazing_angle))
    _refuse_long_aperture(float(inputs.aperture))
    time = _times(design, times)
    closed = settled(inputs)
    moments = sampled(inputs)
    white = moments if inputs.slow is None else sampled(inputs, slow=False)
    steady_state = _steady_state(inputs, closed, moments, white)
    coast = _coast(inputs, closed, moments.posterior, white.posterior, time)
    # With a slow GNSS error no closed form covers the start of the aperture; the augmented filter does.
    start = closed.horizontal if inputs.slow is None else moments.posterior.horizontal
    sar = _sar(design, inputs, closed.horizontal, start, steady_state.shares["tilt"])
    return Budget(design, steady_state, coast, sar, judge(design, steady_state, coast, sar))


def _refuse_hidden_target(squint: float, grazing: float) -> None:
    if math.cos(squint) < math.sin(grazing) - 1e-12:
        raise DesignError(
            "radar.squint_angle",
            f"{math.degrees(squint):.4g}° leaves no line of sight at a grazing angle of "
            f"{math.degrees(grazing):.4g}°; at most {90 - math.degrees(grazing):.4g}° goes, or less grazing angle",
        )


def _refuse_long_aperture(aperture: float) -> None:
    if aperture > LONGEST_APERTURE:
        raise DesignError(
            "radar.azimuth_resolution",
            f"needs an aperture of {aperture:.4g} s at this range and speed; at most {LONGEST_APERTURE:g} s go",
        )


def _times(design: Design, times: ArrayLike | None) -> Array:
    if times is None:
        return np.linspace(0.0, design.coast.duration, COAST_POINTS)
    time = np.atleast_1d(np.asarray(times, float))
    longest = design.coast.param["duration"].bounds[1]
    if time.ndim != 1 or not np.all(np.isfinite(time) & (time >= 0) & (time <= longest)):
        raise DesignError("times", f"{times!r} is not allowed; seconds from 0 to {longest:g}")
    return time


def _sigmas(moment: Sawtooth) -> Sigmas:
    p, v = moment
    return Sigmas(*(math.sqrt(float(x)) for x in (p.p11, v.v11, p.p22, v.v22, p.p33)))


def _steady_state(inputs: Inputs, closed: Sawtooth, moments: Cycle, white: Cycle) -> SteadyState:
    x = inputs
    asymptote = steady.gyro_dominated(x.sigma_w, x.s, x.g)
    lambda_dt = max(
        float(steady.lambda_dt(variance, s, x.interval))
        for variance, s in ((closed.horizontal.p11, x.s), (closed.vertical.v11, x.s_vertical))
    )
    return SteadyState(
        closed=_sigmas(closed),
        prior=_sigmas(moments.prior),
        posterior=_sigmas(moments.posterior),
        gyro_dominance=float(steady.gyro_dominance(x.sigma_a, x.sigma_w, x.s, x.g)),
        asymptote=(math.sqrt(asymptote[0]), math.sqrt(asymptote[1]), math.sqrt(asymptote[2])),
        lambda_dt=lambda_dt,
        shares=_steady_shares(x, closed, moments.prior, white.prior),
    )


def _steady_shares(x: Inputs, closed: Sawtooth, prior: Sawtooth, white: Sawtooth) -> Mapping[str, Shares]:
    by_kind: dict[str, dict[str, float]] = {}
    kinds = ("horizontal_position", "horizontal_velocity", "tilt")
    for kind, shares in zip(kinds, horizontal_shares(x.sigma_a, x.sigma_w, x.s, x.g), strict=True):
        by_kind[kind] = {
            ACCELEROMETER_NOISE: float(shares.accelerometer),
            GYRO_NOISE: float(shares.gyro),
            GNSS_NOISE: float(shares.gnss),
        }
    accelerometer, _ = vertical_parts(x.sigma_a, x.s_vertical)
    v = closed.vertical
    for kind, part, whole in (
        ("vertical_position", accelerometer.v11, v.v11),
        ("vertical_velocity", accelerometer.v22, v.v22),
    ):
        share = float(part / whole)
        by_kind[kind] = {ACCELEROMETER_NOISE: share, GNSS_NOISE: 1 - share}
    if prior is not white:
        pairs = {
            "horizontal_position": (prior.horizontal.p11, white.horizontal.p11),
            "horizontal_velocity": (prior.horizontal.p22, white.horizontal.p22),
            "tilt": (prior.horizontal.p33, white.horizontal.p33),
            "vertical_position": (prior.vertical.v11, white.vertical.v11),
            "vertical_velocity": (prior.vertical.v22, white.vertical.v22),
        }
        for kind, (with_slow, without) in pairs.items():
            kept = min(float(without / with_slow), 1.0)
            by_kind[kind] = {source: share * kept for source, share in by_kind[kind].items()}
            by_kind[kind][SLOW_GNSS] = 1 - kept
    return MappingProxyType({kind: MappingProxyType(shares) for kind, shares in by_kind.items()})


def _coast(x: Inputs, closed: Sawtooth, posterior: Sawtooth, white: Sawtooth, time: Array) -> Coast:
    a, w, g = x.sigma_a, x.sigma_w, x.g
    p, v = closed
    duration = float(x.duration)
    level = growth.horizontal_growth(p, a, w, g, time)
    upright = growth.vertical_growth(v, a, time)
    refined_horizontal, refined_vertical = map(np.sqrt, outage(x, posterior, np.append(time, duration)))
    bias_a, bias_w = growth.bias_position(x.bias_a, x.bias_w, g, time)
    drift_a, drift_w = growth.bias_velocity(x.bias_a, x.bias_w, g, time)
    perfect = growth.perfect_start(a, w, g, time)
    shares = _coast_shares(x, posterior, white, duration)
    curves = {
        "time": time,
        "position_horizontal": np.sqrt(level.position + bias_a**2 + bias_w**2),
        "position_vertical": np.sqrt(upright.position + bias_a**2),
        "velocity_horizontal": np.sqrt(level.velocity + drift_a**2 + drift_w**2),
        "velocity_vertical": np.sqrt(upright.velocity + drift_a**2),
        "tilt": np.sqrt(level.tilt + (x.bias_w * time) ** 2),
        "yaw_growth": np.sqrt(steady.yaw_variance(w, time)),
        "refined_horizontal": refined_horizontal[:-1],
        "refined_vertical": refined_vertical[:-1],
        "perfect_start_horizontal": np.sqrt(perfect[0]),
        "perfect_start_vertical": np.sqrt(perfect[1]),
        "initial_tilt": np.sqrt(growth.initial_tilt(p.p33, g, time)),
    }
    for curve in curves.values():
        curve.flags.writeable = False
    return Coast(
        duration=duration,
        end_refined_horizontal=float(refined_horizontal[-1]),
        end_refined_vertical=float(refined_vertical[-1]),
        shares_horizontal=shares[0],
        shares_vertical=shares[1],
        **curves,
    )


def _coast_shares(x: Inputs, posterior: Sawtooth, white: Sawtooth, time: float) -> tuple[Shares, Shares]:
    """Shares in the position variances `time` after the last fix, from the polynomials by linearity.

    A slow GNSS error has what the augmented start adds to the `white` one.
    """
    a, w, g = x.sigma_a, x.sigma_w, x.g
    bias_a, bias_w = (float(bias) ** 2 for bias in growth.bias_position(x.bias_a, x.bias_w, g, time))
    level: dict[str, Array | float] = {source: grown.position for source, grown in _grown_parts(x, time).items()}
    level |= {ACCELEROMETER_BIAS: bias_a, GYRO_BIAS: bias_w}
    accelerometer, gnss = vertical_parts(a, x.s_vertical)
    upright: dict[str, Array | float] = {
        ACCELEROMETER_NOISE: growth.vertical_growth(accelerometer, a, time).position,
        GNSS_NOISE: growth.vertical_growth(gnss, 0.0, time).position,
        ACCELEROMETER_BIAS: bias_a,
    }
    if posterior is not white:
        slow, fast = (growth.horizontal_growth(m.horizontal, a, w, g, time) for m in (posterior, white))
        slow_v, fast_v = (growth.vertical_growth(m.vertical, a, time) for m in (posterior, white))
        level[SLOW_GNSS] = np.maximum(slow.position - fast.position, 0.0)
        upright[SLOW_GNSS] = np.maximum(slow_v.position - fast_v.position, 0.0)
    return _normalised(level), _normalised(upright)


def _grown_parts(x: Inputs, time: ArrayLike) -> dict[str, growth.HorizontalGrowth]:
    """What each white noise has grown to `time` after the last fix, in a horizontal channel. [T-9], [T-18]"""
    a, w, g = x.sigma_a, x.sigma_w, x.g
    parts = horizontal_parts(a, w, x.s, g)
    return {
        ACCELEROMETER_NOISE: growth.horizontal_growth(parts.accelerometer, a, 0.0, g, time),
        GYRO_NOISE: growth.horizontal_growth(parts.gyro, 0.0, w, g, time),
        GNSS_NOISE: growth.horizontal_growth(parts.gnss, 0.0, 0.0, g, time),
    }


def _normalised(variances: Mapping[str, Array | float]) -> Shares:
    values = {source: float(variance) for source, variance in variances.items()}
    whole = math.fsum(values.values())
    return MappingProxyType({source: value / whole for source, value in values.items()})


def _sar(design: Design, x: Inputs, p: Horizontal, start: Horizontal, tilt_shares: Shares) -> Sar:
    radar = design.radar
    wavelength, aperture = float(x.wavelength), float(x.aperture)
    budget = phase_sources(x, start)
    whole = phase.total(budget)
    to_phase = 4 * math.pi / wavelength
    quadratic = to_phase * math.sqrt(float(whole.quadratic))
    cubic = to_phase * math.sqrt(float(whole.cubic))
    lines = tuple(
        PhaseLine(
            source,
            quadratic=to_phase * math.sqrt(float(variances.quadratic)),
            cubic=to_phase * math.sqrt(float(variances.cubic)),
            detrended=to_phase * math.sqrt(float(variances.detrended)),
            share=float(variances.quadratic / whole.quadratic),
            detrended_share=float(variances.detrended / whole.detrended),
        )
        for source, variances in budget.items()
    )
    response = _response(quadratic, radar.window)
    return Sar(
        wavelength=wavelength,
        aperture_time=aperture,
        aperture_length=aperture * design.flight.speed,
        cell_length=float(
            geometry.cell_length(wavelength, radar.slant_range, design.flight.speed, aperture, x.squint)
        ),
        window=radar.window,
        autofocus_order=radar.autofocus_order,
        quadratic=quadratic,
        cubic=cubic,
        detrended=to_phase * math.sqrt(float(whole.detrended)),
        along_track_quadratic=float(along_track_phase(x, start)),
        lines=lines,
        tilt_shares=tilt_shares,
        velocity_shares=_velocity_shares(x, p, start),
        impulse_response=response,
        after_autofocus=response if radar.autofocus_order == 1 else _response(0.0, radar.window),
    )


def _response(quadratic: float, window: str) -> ImpulseResponse | None:
    return quadratic_response(quadratic, window) if quadratic <= _NO_IMAGE else None  # type: ignore[arg-type]


def _velocity_shares(x: Inputs, p: Horizontal, start: Horizontal) -> Shares:
    """Whose the variance of along-track velocity is, after the coast before the aperture."""
    coast = x.before_aperture
    bias_a, bias_w = (float(bias) ** 2 for bias in growth.bias_velocity(x.bias_a, x.bias_w, x.g, coast))
    parts: dict[str, Array | float] = {source: part.velocity for source, part in _grown_parts(x, coast).items()}
    parts |= {ACCELEROMETER_BIAS: bias_a, GYRO_BIAS: bias_w}
    if start is not p:
        grown, white = (growth.horizontal_growth(m, x.sigma_a, x.sigma_w, x.g, coast).velocity for m in (start, p))
        parts[SLOW_GNSS] = np.maximum(grown - white, 0.0)
    return _normalised(parts)

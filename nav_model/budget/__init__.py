"""From a design to its budget: one pass through the closed forms.

`analyse` composes the closed forms through `nav_model.budget.figures` into the `Budget` of `nav_model.budget.result`,
which pages, reports and JSON read. A figure here is a standard deviation that a requirement limits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth
from nav_model.analytic.steady_state import Array, Horizontal
from nav_model.budget.fast import LEVELS, levels, stays
from nav_model.budget.figures import (
    COASTING,
    PLACING,
    SETTLED,
    SMOOTHED,
    along_track_phase,
    begun,
    by_state_space,
    ends_left_out,
    free_shifts,
    outage,
    phase_sources,
    placing,
    sampled_both,
    settled,
    smoothed_figures,
    smoothed_with_shifts,
)
from nav_model.budget.inputs import LONGEST_APERTURE, Inputs, inputs_of
from nav_model.budget.result import (
    AfterFlight,
    Budget,
    Echo,
    Outage,
    PhaseLine,
    Placement,
    PostProcessed,
    Sar,
    Sigmas,
    Spectral,
    SteadyState,
    Verdict,
)
from nav_model.budget.shares import (
    Parts,
    Shares,
    coast_shares,
    shares_by_step,
    steady_shares,
    velocity_shares,
    white_parts,
)
from nav_model.budget.verdict import confidence_of, judge
from nav_model.design import Design
from nav_model.errors import InputError, shown
from nav_model.frozen import FrozenMapping, Later, Once
from nav_model.processing.geolocation import Shifts, circular_error, ground_covariance
from nav_model.processing.paired_echo import NOTHING, echo, fast_lines
from nav_model.processing.smoother import SPECTRUM, STATE_SPACE
from nav_model.sar import geometry, phase
from nav_model.sar.impulse_response import (
    ImpulseResponse,
    half_power_extent,
    ideal_null_cells,
    quadratic_response,
    with_echoes,
)

__all__ = ["COAST_POINTS", "Budget", "analyse"]

COAST_POINTS = 300
_NO_IMAGE = 1000.0  # rad of quadratic phase: the response is smeared over more than 600 cells


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
    InputError
        If `times` are not finite, negative or beyond the bounds of ``coast.duration``, if the aperture that
        follows from the radar's inputs is longer than ``radar.aperture_time`` may be, or if the design's
        values are so far apart that double precision cannot hold them together.

    Examples
    --------
    >>> from nav_model import Design, analyse
    >>> budget = analyse(Design({"imu.angle_random_walk": 1e-5, "requirements.tilt": 1e-3}))
    >>> f"{budget.steady_state.prior.tilt:.3e} rad"
    '6.706e-05 rad'
    >>> budget.verdict.closes
    True
    """
    with _refused(design):
        budget = _analyse(design, times)
        assert budget.verdict  # after flight it is worked out here, and refused if it must be
        return budget


@contextmanager
def _refused(design: Design) -> Iterator[None]:
    """Refuse a design whose values are too far apart for double precision."""
    try:
        yield
    except ArithmeticError as error:
        key = "gnss.correlated_noise" if design.gnss.correlated else "imu.angle_random_walk"
        reason = f"{design[key]:.3g} (SI) gives no figure beside the other noises: {error}"
        raise InputError(key, reason, design[key]) from error


def _analyse(design: Design, times: ArrayLike | None) -> Budget:
    inputs = inputs_of(design)
    _refuse_hidden_target(float(inputs.squint), float(inputs.grazing_angle))
    _refuse_long_aperture(float(inputs.aperture))
    _refuse_late_data(design.motion.delay, float(inputs.aperture))
    time = _times(design, times)
    closed = settled(inputs)
    moments, white = sampled_both(inputs)
    parts = Once(partial(white_parts, inputs))
    steady_state = _steady_state(inputs, parts, closed, moments, white)
    coast = _coast(inputs, parts, closed, moments.posterior, white.posterior, time)
    # With a slow GNSS error no closed form covers the start of the aperture; the augmented filter does.
    start = closed if inputs.slow is None else moments.posterior
    sar = _sar(design, inputs, parts, closed.horizontal, start.horizontal, steady_state.shares["tilt"])
    place = Once(partial(_place, inputs, start))
    spectral = _spectral(inputs, sar.cell_length)
    verdict = judge(design, steady_state, coast, sar, place, spectral)
    later = partial(_after_flight, design, inputs, steady_state, coast, sar, spectral)
    margin = partial(_margin_after_flight, design, inputs, verdict)
    return Budget(design, steady_state, coast, sar, place, spectral, verdict, later, margin)


def _after_flight(
    design: Design, inputs: Inputs, steady_state: SteadyState, coast: Outage, sar: Sar, spectral: Spectral
) -> AfterFlight:
    # What no number comes of is refused, not shown.
    with _refused(design), np.errstate(invalid="raise", divide="raise"):
        smoothed, placement = _post_processed(inputs)
    return AfterFlight(
        smoothed, placement, judge(design, steady_state, coast, sar, lambda: placement, spectral, smoothed)
    )


def _margin_after_flight(design: Design, inputs: Inputs, in_real_time: Verdict) -> float | None:
    limits = {check.name: check.limit / confidence_of(design, check.name) for check in in_real_time.checks}
    with _refused(design), np.errstate(invalid="raise", divide="raise"):
        found = smoothed_figures(inputs, [name for name in limits if name not in COASTING])
        margins = [1 - float(value) / limits[name] for name, value in found.items()]
        if not all(map(math.isfinite, margins)):
            raise FloatingPointError("the smoothed figures are beyond double precision")
    return min([*margins, *(check.margin for check in in_real_time.checks if check.name in COASTING)], default=None)


def _each(names: Iterable[str], work_out: Callable[[], Mapping[str, Shares]]) -> Mapping[str, Shares]:
    """Shares of each figure, all worked out when one of them is first looked at."""
    found = Later(work_out)
    return FrozenMapping({name: Later(partial(found.__getitem__, name)) for name in names})


def _shares_of(sized: Mapping[str, tuple[float, Shares]]) -> dict[str, Shares]:
    return {name: shares for name, (_, shares) in sized.items()}


def _place(x: Inputs, start: Sawtooth) -> Placement:
    """That of a free INS from the last fix."""
    shares = _each(PLACING, lambda: _shares_of(shares_by_step(x, lambda y: placing(y, free_shifts(y, begun(y))))))
    return _placement(x, free_shifts(x, start), shares)


def _placement(x: Inputs, moved: Shifts, shares: Mapping[str, Shares]) -> Placement:
    ground = ground_covariance(moved, x.grazing_angle, x.scene_height_error, x.squint)
    placed = {name: float(value) for name, value in placing(x, moved).items()}
    return Placement(
        range=placed["range_shift"],
        azimuth=placed["azimuth_shift"],
        ground=(float(ground[0]), float(ground[1]), float(ground[2])),
        ce90=placed["ce90"],
        cep=float(circular_error(*ground, share=0.5)),
        le90=placed["le90"],
        shares=shares,
    )


def _post_processed(x: Inputs) -> tuple[PostProcessed, Placement]:
    moved: list[Shifts | None] = []

    def both(y: Inputs) -> dict[str, Array]:
        found, shifts = smoothed_with_shifts(y, SMOOTHED)
        moved.append(shifts)
        return found

    sized = shares_by_step(x, both)
    value = {name: value for name, (value, _) in sized.items()}
    if not all(map(math.isfinite, value.values())):
        raise FloatingPointError("the smoothed figures are beyond double precision")
    shares = _shares_of(sized)
    shares["detrended_phase"] = shares[f"detrended_phase_{x.autofocus_order}"]
    by_order = value["detrended_phase_1"], value["detrended_phase_2"], value["detrended_phase_3"]
    left_out = bool(ends_left_out(x))
    smoothed = PostProcessed(
        sigmas=Sigmas(*(value[name] for name in SETTLED)),
        quadratic=value["quadratic_phase"],
        cubic=value["cubic_phase"],
        detrended=by_order[x.autofocus_order - 1],
        by_order=by_order,
        along_track_quadratic=value["along_track_quadratic_phase"],
        turning_quadratic=value["turning_quadratic_phase"],
        turning_by_order=(value["turning_detrended_phase_1"], value["turning_detrended_phase_2"]),
        azimuth_shift=value["slope_shift"],
        method=STATE_SPACE if bool(by_state_space(x)) and not left_out else SPECTRUM,
        ends_left_out=left_out,
        shares=FrozenMapping(shares),
        respond=partial(_response, x),
    )
    assert moved[0] is not None
    shifts = Shifts(*(np.asarray(value.real.flat[0]) for value in moved[0]))  # the shares' steps are imaginary
    return smoothed, _placement(x, shifts, FrozenMapping({name: shares[name] for name in PLACING}))


def _refuse_hidden_target(squint: float, grazing: float) -> None:
    if math.cos(squint) < math.sin(grazing) - 1e-12:
        raise InputError(
            "radar.squint_angle",
            f"{math.degrees(squint):.4g}° leaves no line of sight at a grazing angle of "
            f"{math.degrees(grazing):.4g}°. Enter at most {90 - math.degrees(grazing):.4g}°, or a smaller grazing "
            "angle.",
        )


def _refuse_long_aperture(aperture: float) -> None:
    if aperture > LONGEST_APERTURE:
        raise InputError(
            "radar.azimuth_resolution",
            f"This resolution needs an aperture of {aperture:.4g} s at this range and speed. "
            f"At most {LONGEST_APERTURE:g} s are allowed.",
        )


def _refuse_late_data(delay: float, aperture: float) -> None:
    if delay > aperture:
        raise InputError(
            "motion.delay",
            f"{delay:.4g} s is longer than the aperture of {aperture:.4g} s. Enter a shorter delay.",
            delay,
        )


def _times(design: Design, times: ArrayLike | None) -> Array:
    if times is None:
        return _even_times(design.coast.duration)
    time = np.atleast_1d(np.array(times, float))  # a copy: the budget's arrays are read-only, the caller's stay his
    longest = design.coast.param["duration"].bounds[1]
    wrong = time[~((time >= 0) & (time <= longest))]
    if time.ndim != 1 or wrong.size:
        said = f"{wrong[0]:g}" if wrong.size else shown(times)
        raise InputError("times", f"{said} is not allowed. Give seconds from 0 to {longest:g}.", times)
    return time


@lru_cache(maxsize=64)
def _even_times(duration: float) -> Array:
    """One object for one duration: what is drawn over it is soon seen to be the same."""
    return np.linspace(0.0, duration, COAST_POINTS)


def _sigmas(moment: Sawtooth) -> Sigmas:
    p, v = moment
    return Sigmas(*(math.sqrt(float(x)) for x in (p.p11, v.v11, p.p22, v.v22, p.p33)))


def _steady_state(inputs: Inputs, parts: Parts, closed: Sawtooth, moments: Cycle, white: Cycle) -> SteadyState:
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
        shares=_each(SETTLED, lambda: steady_shares(parts(), moments.prior, white.prior)),
    )


def _coast(x: Inputs, parts: Parts, closed: Sawtooth, posterior: Sawtooth, white: Sawtooth, time: Array) -> Outage:
    a, w, g = x.sigma_a, x.sigma_w, x.g
    p, v = closed
    duration = float(x.duration)
    level = growth.horizontal_growth(p, a, w, g, time)
    upright = growth.vertical_growth(v, a, time)
    refined_horizontal, refined_vertical = map(np.sqrt, outage(x, posterior, np.append(time, duration)))
    bias_a, bias_w = growth.bias_position(x.bias, x.bias_w, g, time)
    drift_a, drift_w = growth.bias_velocity(x.bias, x.bias_w, g, time)
    perfect = growth.perfect_start(a, w, g, time)
    shares = _each(COASTING, lambda: coast_shares(x, parts(), posterior, white, duration))
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
    return Outage(
        duration=duration,
        end_refined_horizontal=float(refined_horizontal[-1]),
        end_refined_vertical=float(refined_vertical[-1]),
        shares_horizontal=shares[COASTING[0]],
        shares_vertical=shares[COASTING[1]],
        **curves,
    )


def _sar(design: Design, x: Inputs, parts: Parts, p: Horizontal, start: Horizontal, tilt_shares: Shares) -> Sar:
    radar = design.radar
    wavelength, aperture = float(x.wavelength), float(x.aperture)
    budget = phase_sources(x, start)
    whole = phase.total(budget)
    to_phase = 4 * math.pi / wavelength
    quadratic, cubic = (to_phase * math.sqrt(float(part)) for part in (whole.quadratic, whole.cubic))
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
        velocity_shares=Later(lambda: velocity_shares(x, parts(), p, start)),
        half_power_extent=None if quadratic > _NO_IMAGE else half_power_extent(quadratic, x.window),  # type: ignore[arg-type]
        respond=partial(_response, x),
    )


def _spectral(x: Inputs, cell: float) -> Spectral:
    """Echoes beyond the main lobe, highest first, and what is scattered."""
    if not x.fast:
        none: Shares = FrozenMapping({"no such source": 1.0})
        return Spectral(
            (), FrozenMapping(dict.fromkeys(LEVELS, NOTHING)), 1.0, FrozenMapping(dict.fromkeys(LEVELS, none))
        )
    sized = shares_by_step(x, lambda y: levels(y.fast.values(), y.to_phase, y.aperture, y.window))
    lobe = ideal_null_cells(x.window)  # type: ignore[arg-type]
    echoes = [
        Echo(name, float(at), float(phase), float(level), float(at * x.aperture * cell))
        for name, made in x.fast.items()
        for at, phase, level, beside in zip(
            made.frequency,
            x.to_phase * made.amplitude,
            echo(x.to_phase * made.amplitude),
            fast_lines(made, x.aperture, lobe),
            strict=True,
        )
        if beside and level > NOTHING
    ]
    return Spectral(
        tuple(sorted(echoes, key=lambda item: -item.level)),
        FrozenMapping({name: value for name, (value, _) in sized.items()}),
        float(stays(x.fast.values(), x.to_phase, x.aperture, x.window)[0]),
        FrozenMapping({name: _of(x.fast, shares) for name, (_, shares) in sized.items()}),
        float(x.to_phase**2 * sum(made.scattered for made in x.fast.values())),
    )


def _of(names: Collection[str], shares: Shares) -> Shares:
    """Shares of these sources alone; even ones where none of them has any."""
    whole = math.fsum(shares[name] for name in names)
    return FrozenMapping({name: shares[name] / whole if whole else 1 / len(names) for name in names})


def _response(x: Inputs, quadratic: float) -> ImpulseResponse | None:
    """Of a quadratic phase, with the echoes and the scattered energy of the design's fast sources. [P-9], [P-11]"""
    if quadratic > _NO_IMAGE:
        return None
    response = quadratic_response(quadratic, x.window)  # type: ignore[arg-type]
    if not x.fast:
        return response
    whole, near = (float(part) for part in stays(x.fast.values(), x.to_phase, x.aperture, x.window))
    return with_echoes(
        response, float(levels(x.fast.values(), x.to_phase, x.aperture, x.window)["paired_echo"]), whole, near
    )

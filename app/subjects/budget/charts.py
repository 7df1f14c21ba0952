"""The charts of a budget, as plain data. Each takes a `Budget` and draws what is in it; none computes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache

import numpy as np

from app.charts.kinds import Array, Band, Bar, BarChart, Chart, Limit, Line, Points, Span
from app.document.numbers import decibels, number, percent, show
from app.document.wording import DETRENDED
from app.subjects.budget.tables import ALONG_TRACK
from nav_model.analytic import regime
from nav_model.budget import Budget
from nav_model.budget.fast import scattered_floor
from nav_model.budget.provenance import WIDE_SAWTOOTH, provenance
from nav_model.sar.geometry import phase_to_metres
from nav_model.sar.impulse_response import aperture_positions, response_curve

_LEAD = 0.2  # of the outage shown: steady state to the left of zero
_DEG = 180 / math.pi
_RESPONSE_SAMPLES, _RESPONSE_CELLS = 1024, 6.0  # of the aperture; shown on each side of the target


def _limit(budget: Budget, name: str, scale: float = 1.0) -> float:
    """A requirement's limit brought to one sigma, NaN when it is not given."""
    limit = getattr(budget.design.requirements, name)
    return math.nan if limit is None else scale * float(limit) / budget.design.requirements.confidence


def _limits(budget: Budget, spans: Iterable[tuple[str, float, float]], scale: float = 1.0) -> tuple[Limit, ...]:
    return tuple(
        Limit(name, f"limit on {name.replace('_', ' ')}, at 1σ", start, stop, _limit(budget, name, scale))
        for name, start, stop in spans
    )


def _grid(budget: Budget) -> Array:
    """The time axis of a timeline: two points of steady state, then the outage."""
    return np.concatenate(([-_LEAD * budget.coast.duration, 0.0], budget.coast.time))


def _held(level: float, curve: Array) -> Array:
    """A curve after zero, its steady-state level before."""
    return np.concatenate(([level, level], curve))


def _after(curve: Array) -> Array:
    """A curve that has no steady state; its zero at the last fix cannot stand on a log axis."""
    return np.concatenate(([np.nan, np.nan], np.where(curve > 0, curve, np.nan)))


def _cycle_band(budget: Budget, key: str, label: str, field: str, style: str, scale: float = 1.0) -> Band:
    prior, posterior = (
        scale * getattr(moment, field) for moment in (budget.steady_state.prior, budget.steady_state.posterior)
    )
    x = np.array([-_LEAD * budget.coast.duration, 0.0])
    source = f"{_cycle_method(budget)} [T-8]"
    return Band(key, label, x, np.full(2, posterior), np.full(2, prior), style, source)


def _cycle_method(budget: Budget) -> str:
    return provenance(budget)["steady_state.discrete.prior"].method


def _aperture_span(budget: Budget) -> Span:
    start = budget.design.coast.before_aperture
    return Span("aperture", "aperture", start, start + budget.sar.aperture_time)


def _validity(budget: Budget) -> str:
    value = budget.steady_state.lambda_dt
    word = "wide sawtooth: read the band" if value > WIDE_SAWTOOTH else "narrow sawtooth"
    return f"λ·dt = {number(value)} ({word})"


def position_chart(budget: Budget) -> Chart:
    """Position sigma against time: steady state, then outage."""
    steady, coast = budget.steady_state, budget.coast
    lead, end = -_LEAD * coast.duration, coast.duration
    ratio = coast.end_refined_horizontal / coast.position_horizontal[-1]
    ratio_v = coast.end_refined_vertical / coast.position_vertical[-1]
    slow = " A slow GNSS error enters the band and the refined curves only." if budget.design.gnss.correlated else ""
    x = _grid(budget)
    curves = (
        ("ch", "horizontal", _held(steady.closed.position_horizontal, coast.position_horizontal),
         "horizontal", "closed form [T-3], [T-9]"),
        ("rh", "horizontal, refined", _after(coast.refined_horizontal),
         "horizontal refined", "linear covariance propagation [T-17]"),
        ("cv", "vertical", _held(steady.closed.position_vertical, coast.position_vertical),
         "vertical", "closed form [T-4], [T-10]"),
        ("rv", "vertical, refined", _after(coast.refined_vertical),
         "vertical refined", "linear covariance propagation [T-17]"),
        ("ph", "horizontal, perfect start", _after(coast.perfect_start_horizontal),
         "perfect start", "closed form [T-11]"),
        ("th", "horizontal, initial tilt alone", _after(coast.initial_tilt),
         "initial tilt", "closed form [T-12]"),
    )  # fmt: skip
    lines = tuple(Line(key, label, x, y, style, source) for key, label, y, style, source in curves)
    limits = _limits(
        budget,
        (
            ("horizontal_position", lead, 0.0),
            ("vertical_position", lead, 0.0),
            ("coast_horizontal_position", 0.0, end),
            ("coast_vertical_position", 0.0, end),
        ),
    )
    floor = 0.3 * min(
        steady.posterior.position_horizontal, steady.posterior.position_vertical, steady.closed.position_vertical
    )
    top = max(*(np.nanmax(line.y) for line in lines[:4]), *(0 if math.isnan(x.level) else x.level for x in limits))
    return Chart(
        key="position",
        title="Position sigma",
        x_label="time since the last fix [s]",
        y_label="position, 1σ [m]",
        lines=lines,
        bands=(
            _cycle_band(budget, "bh", "horizontal, before/after fix", "position_horizontal", "horizontal"),
            _cycle_band(budget, "bv", "vertical, before/after fix", "position_vertical", "vertical"),
        ),
        limits=limits,
        spans=(_aperture_span(budget),),
        y_log=True,
        y_range=(floor, 2 * top),
        knowledge=(
            f"Curves [T-3], [T-4], [T-9], [T-10] in closed form; band [T-8]: {_cycle_method(budget)}, "
            f"{_validity(budget)}; refined [T-17] is {number(ratio)} (horizontal) and {number(ratio_v)} (vertical) "
            f"times the polynomial at {number(end, given=True)} s.{slow}"
        ),
    )


def velocity_chart(budget: Budget) -> Chart:
    """Velocity sigma against time."""
    steady, coast = budget.steady_state, budget.coast
    lead = -_LEAD * coast.duration
    x = _grid(budget)
    return Chart(
        key="velocity",
        title="Velocity sigma",
        x_label="time since the last fix [s]",
        y_label="velocity, 1σ [m/s]",
        lines=(
            Line("ch", "horizontal", x, _held(steady.closed.velocity_horizontal, coast.velocity_horizontal),
                 "horizontal", "closed form [T-3], [T-9]"),
            Line("cv", "vertical", x, _held(steady.closed.velocity_vertical, coast.velocity_vertical),
                 "vertical", "closed form [T-4], [T-10]"),
        ),
        bands=(
            _cycle_band(budget, "bh", "horizontal, before/after fix", "velocity_horizontal", "horizontal"),
            _cycle_band(budget, "bv", "vertical, before/after fix", "velocity_vertical", "vertical"),
        ),
        limits=_limits(budget, (("horizontal_velocity", lead, 0.0), ("vertical_velocity", lead, 0.0))),
        spans=(_aperture_span(budget),),
        y_log=True,
        knowledge=f"Closed forms [T-3], [T-4], [T-9], [T-10]; band [T-8], {_validity(budget)}.",
    )  # fmt: skip


def attitude_chart(budget: Budget) -> Chart:
    """Tilt sigma and yaw growth against time."""
    steady, coast = budget.steady_state, budget.coast
    lead = -_LEAD * coast.duration
    x = _grid(budget)
    return Chart(
        key="attitude",
        title="Attitude sigma",
        x_label="time since the last fix [s]",
        y_label="attitude, 1σ [°]",
        lines=(
            Line("tilt", "roll and pitch, each", x, _held(steady.closed.tilt * _DEG, coast.tilt * _DEG),
                 "tilt", "closed form [T-3], [T-9]"),
            Line("yaw", "yaw, growth alone", x, _after(coast.yaw_growth * _DEG), "yaw", "closed form [T-5]"),
        ),
        bands=(_cycle_band(budget, "bt", "tilt, before/after fix", "tilt", "tilt", _DEG),),
        limits=_limits(budget, (("tilt", lead, 0.0),), _DEG),
        spans=(_aperture_span(budget),),
        y_log=True,
        knowledge=(
            f"Tilt [T-3], [T-9] in closed form, band [T-8], {_validity(budget)}. "
            "Yaw is unobservable on a straight path: only its growth [T-5] is shown."
        ),
    )  # fmt: skip


def timelines(budget: Budget) -> tuple[Chart, Chart, Chart]:
    """Position, velocity and attitude on one time axis, as the page shows them together.

    Before the last fix each curve has the level that its requirement is held against, the tile's; after it, in real
    time whatever the processing, position is the refined curve [T-17], velocity and attitude the formulas [T-9],
    [T-10], [T-5].
    """
    coast, x = budget.coast, _grid(budget)
    chosen = getattr(budget.steady_state, budget.design.requirements.steady_state)
    settled = budget.smoothed.sigmas if budget.smoothed else chosen
    lead, end = float(x[0]), coast.duration
    span = (_aperture_span(budget),)

    def chart(
        key: str, quantity: str, unit: str, curves: tuple[tuple[str, str, Array], ...], *limits: Limit
    ) -> Chart:
        lines = tuple(Line(label, label, x, y, style) for label, style, y in curves)
        return Chart(
            key, f"{quantity} sigma", "time since the last fix [s]", f"{quantity}, 1σ [{unit}]", lines,
            limits=limits, spans=span, y_log=True,
        )  # fmt: skip

    return (
        chart(
            "position", "position", "m",
            (
                ("horizontal", "horizontal", _held(settled.position_horizontal, coast.refined_horizontal)),
                ("vertical", "vertical", _held(settled.position_vertical, coast.refined_vertical)),
            ),
            *_limits(
                budget,
                (
                    ("horizontal_position", lead, 0.0),
                    ("vertical_position", lead, 0.0),
                    ("coast_horizontal_position", 0.0, end),
                    ("coast_vertical_position", 0.0, end),
                ),
            ),
        ),
        chart(
            "velocity", "velocity", "m/s",
            (
                ("horizontal", "horizontal", _held(settled.velocity_horizontal, coast.velocity_horizontal)),
                ("vertical", "vertical", _held(settled.velocity_vertical, coast.velocity_vertical)),
            ),
            *_limits(budget, (("horizontal_velocity", lead, 0.0), ("vertical_velocity", lead, 0.0))),
        ),
        chart(
            "attitude", "attitude", "°",
            (
                ("roll, pitch", "tilt", _held(settled.tilt * _DEG, coast.tilt * _DEG)),
                ("yaw growth", "yaw", _after(coast.yaw_growth * _DEG)),
            ),
            *_limits(budget, (("tilt", lead, 0.0),), _DEG),
        ),
    )  # fmt: skip


TOTAL = "total"
"""What the sum of the sources in quadrature is called beside them."""
_LINE_EQUATIONS = {
    "initial tilt": "(4π/λ)(T²/8) g √p33 cos ψ [S-5]",
    "accelerometer noise": "(4π/λ)(T²/8) σa √(10/7T) [S-5]",
    "gyro noise": "(4π/λ)(T²/8) g σω √(181T/462) cos ψ [S-5]",
    "accelerometer bias": "(4π/λ)(T²/8) ba [S-5]",
    "gyro bias": "(4π/λ)(T²/8) g bg (Tc + T/2) cos ψ [S-5]",
    "coast before aperture": "(4π/λ)(T²/8) g σω √Tc cos ψ [S-5]",
    "vibration": "what the IMU leaves of it [P-8], through the aperture [P-5]",
    "unsensed motion": "through the aperture [P-5]",
    "oscillator": "phase noise over the echo's way [P-10], through the aperture [P-5]",
    "vibration rectification": "(4π/λ)(T²/8) times the bias [P-12], [S-5]",
}


def phase_chart(budget: Budget) -> BarChart:
    """The phase budget of the design's processing by source, its total in quadrature, and the along-track term."""
    sar, smoothed = budget.sar, budget.smoothed
    left = DETRENDED[sar.autofocus_order]

    def bar(label: str, quadratic: float, detrended: float, source: str) -> Bar:
        first, second = map(float, 1000 * phase_to_metres(np.array([quadratic, detrended]), sar.wavelength))
        return Bar(label, quadratic * _DEG, detrended * _DEG, first, second, source)

    if smoothed is None:
        bars = [bar(x.source, x.quadratic, x.detrended, _LINE_EQUATIONS[x.source]) for x in sar.lines]
        marks, along = "[S-5], [T-15]", "πVT²δV/(λR) [S-2]"
        slow = " Tilt from the augmented filter [T-8]." if budget.design.gnss.correlated else ""
        knowledge = (
            "Formulas [S-5], [T-15], [S-6] with the line of sight of [S-1]; along-track [S-2]. "
            f"Quadratic before autofocus; residual rms after {left}.{slow}"
        )
    else:
        shares = smoothed.shares["quadratic_phase"], smoothed.shares["detrended_phase"]
        bars = [
            bar(
                source,
                smoothed.quadratic * math.sqrt(shares[0][source]),
                smoothed.detrended * math.sqrt(shares[1][source]),
                "[P-4], [P-5]",
            )
            for source in shares[0]
        ]
        marks = along = "[P-5]"
        knowledge = (
            f"Smoothed with the whole leg, by {smoothed.method} [P-3], shares [P-4], through the aperture [P-5]. "
            f"Quadratic before autofocus; residual rms after {left}."
        )
    image = smoothed or sar
    return BarChart(
        key="phase",
        title="SAR phase error by source",
        x_label="line-of-sight phase over the aperture, 1σ [°]",
        first_label="quadratic",
        second_label=f"residual rms after {left}",
        bars=(
            *bars,
            bar(TOTAL, image.quadratic, image.detrended, marks),
            bar(ALONG_TRACK, image.along_track_quadratic, math.nan, along),
        ),
        first_limit=_limit(budget, "quadratic_phase", _DEG),
        second_limit=_limit(budget, "detrended_phase", _DEG),
        knowledge=knowledge,
    )


@cache
def _regime_curves() -> tuple[Array, Array, Array]:
    return regime.curves(1e-2, 1e5, 200)


def regime_chart(budget: Budget) -> Chart:
    """Horizontal over vertical position variance against gyro dominance, with the design and the catalogue."""
    kappa, exact, asymptote = _regime_curves()
    here, height = regime.design_point(budget.design)
    names, kappas, ratios = regime.catalogue_points(budget.design)
    return Chart(
        key="regime",
        title="What limits horizontal position: gyro or accelerometer",
        x_label="gyro dominance κ [1]",
        y_label="variance, horizontal / vertical [1]",
        lines=(
            Line("exact", "exact, u⁴ = 1 + κu", kappa, exact, "exact", "closed form [T-6]"),
            Line("asymptote", "gyro-dominated, κ^(1/3)", kappa, asymptote, "asymptote", "closed form [T-7]"),
        ),
        points=(
            Points("catalogue", "catalogue with this GNSS", kappas, ratios, names, "reference", "circle",
                   "closed form [T-6]"),
            Points("design", "this design", np.array([here]), np.array([height]), ("this design",), "limit",
                   "diamond", "closed form [T-6]"),
        ),
        x_log=True,
        y_log=True,
        knowledge=(
            f"κ = {number(here)}: "
            + ("gyro noise limits the horizontal channel" if here > 10 else
               "accelerometer noise limits it, the gyro hardly matters to position" if here < 0.1 else
               "both matter")
            + f"; the asymptote is {percent(abs(float(regime.asymptote_error(here))))} off here [T-6], [T-7]."
        ),
    )  # fmt: skip


@cache
def _ideal_response(window: str) -> Array:
    """Power [dB] of an aperture without error."""
    return response_curve(np.ones(_RESPONSE_SAMPLES), window, _RESPONSE_CELLS)[1]  # type: ignore[arg-type]


def response_chart(budget: Budget) -> Chart:
    """Azimuth impulse response: without error, with the 1σ quadratic, with quadratic and cubic."""
    sar, image, random = budget.sar, budget.smoothed or budget.sar, budget.spectral.random
    x = aperture_positions(_RESPONSE_SAMPLES)
    quadratic = image.quadratic * x**2 + budget.spectral.phase(x, sar.aperture_time)
    phases = np.stack((quadratic, quadratic + image.cubic * x**3))
    keys = ("ideal", "quadratic", "cubic")
    labels = ("no error", "1σ quadratic", "with cubic")
    if image.impulse_response is None:
        cells, power = np.array([0.0]), np.full((3, 1), np.nan)
    else:
        cells, spread = response_curve(np.exp(1j * phases), sar.window, _RESPONSE_CELLS)  # type: ignore[arg-type]
        power = np.vstack((_ideal_response(sar.window), spread))
        if random > 0:
            floor = scattered_floor(budget.design, cells, sar.wavelength, sar.aperture_time, random)
            power[1:] = 10 * np.log10(10 ** (power[1:] / 10) * math.exp(-random) + floor)
    response = image.impulse_response
    said = (
        "No image: more than 1000 rad of quadratic phase."
        if response is None
        else (
            f"1σ quadratic: width {show(float(response.half_power_extent_cells) * sar.cell_length, 'length')} "
            f"({number(float(response.half_power_extent_cells))} cells), "
            f"PSLR {decibels(float(response.pslr_fixed_db))}, "
            f"ISLR {decibels(float(response.islr_fixed_db))} (outside the error-free main lobe, whole line), "
            f"peak loss {decibels(-float(response.peak_loss_db))}."
        )
    )
    metres = cells * sar.cell_length
    return Chart(
        key="response",
        title="Point target in azimuth",
        x_label="azimuth [m]",
        y_label="power [dB]",
        lines=tuple(
            Line(
                key,
                label,
                metres,
                np.where(np.isfinite(values), values, np.nan),  # an exact null has no logarithm
                style,
                "aperture integral [S-5]",
            )
            for key, label, values, style in zip(
                keys, labels, power, ("reference", "quadratic", "with cubic"), strict=True
            )
        ),
        y_range=(-45.0, 2.0),
        knowledge=f"{said} Before autofocus.{' With the paired echoes [P-9].' if budget.spectral.echoes else ''}"
        + (" The floor is the mean power of what random motion and oscillator scatter [P-11]." if random > 0 else ""),
    )


BUDGET_CHARTS = (
    position_chart,
    velocity_chart,
    attitude_chart,
    phase_chart,
    response_chart,
    regime_chart,
)
"""Every chart of the Budget page, in the order of the page and of the report."""

"""Sigmas over the time since the last fix, as plain data: three charts on one axis."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from app.charts.kinds import Array, Chart, LimitLine, Line, Span
from app.document.numbers import number, percent
from nav_model.budget import Budget
from nav_model.budget.navigation import steady_marks
from nav_model.budget.verdict import lowest_limit
from nav_model.design.figures import label_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

_LEAD = 0.2  # of the outage shown: steady state to the left of zero
_BEFORE = 12  # times there
_TIME = "time since the last fix [s]"
_YAW = " Heading cannot be observed on a straight path: only its growth [T-5] is shown."
DEGREES = 180 / math.pi
"""Of a radian."""


def limit_at_sigma(budget: Budget, name: str, scale: float = 1.0) -> float:
    """The lowest limit on a figure at one sigma, NaN when none is given."""
    lowest = lowest_limit(budget.design, name)
    return math.nan if lowest is None else scale * lowest.at_one_sigma


def _limits(budget: Budget, spans: Iterable[tuple[str, float, float]], scale: float = 1.0) -> tuple[LimitLine, ...]:
    return tuple(
        LimitLine(name, f"limit on {label_of(name).lower()}, at 1σ", start, stop, limit_at_sigma(budget, name, scale))
        for name, start, stop in spans
    )


def _grid(budget: Budget) -> Array:
    """The time axis of a timeline: some times with fixes, then the outage."""
    interval, lead = budget.design.gnss.interval, _LEAD * budget.coast.duration
    # At fixes, so that a smoothed curve shows its level and not its saw.
    before = -interval * np.rint(np.linspace(lead, 0.0, _BEFORE)[1:] / interval)
    return np.concatenate(([-lead], before, budget.coast.time))


def _held(level: float, curve: Array) -> Array:
    """A curve after zero, with its steady-state level before it."""
    return np.concatenate((np.full(_BEFORE, level), curve))


def _after(curve: Array) -> Array:
    """A curve that has no steady state; its zero at the last fix cannot be drawn on a log axis."""
    return np.concatenate((np.full(_BEFORE, np.nan), np.where(curve > 0, curve, np.nan)))


def _aperture_span(budget: Budget) -> Span:
    start = budget.design.coast.before_aperture
    return Span("aperture", "aperture", start, start + budget.sar.aperture_time)


def _smoothed_aperture(budget: Budget) -> Span:
    """A smoothed aperture has fixes in it: among the times with fixes."""
    start = -_LEAD * budget.coast.duration
    return Span("aperture", "aperture", start, min(start + budget.sar.aperture_time, 0.0))


def _beside(ratio: float) -> str:
    return f"{percent(abs(ratio - 1))} {'above' if ratio > 1 else 'below'}"


def _cited(budget: Budget) -> str:
    """The equations of the steady state, each once."""
    return ", ".join(dict.fromkeys(steady_marks(budget.design)))


def _position_knowledge(budget: Budget) -> str:
    """Source and method of the curves of position."""
    coast, steady = budget.coast, budget.steady_state
    growth = steady.prior["horizontal_position"] / steady.posterior["horizontal_position"] - 1
    ratio = coast.refined_horizontal[-1] / coast.position_horizontal[-1]
    ratio_v = coast.refined_vertical[-1] / coast.position_vertical[-1]
    smoothed = (
        " Smoothed with the fixes before and after the outage [P-3]; dashed curves are an outage in real time."
        if budget.post_processed
        else ""
    )
    return (
        f"Formulas {_cited(budget)}, [T-9], [T-10]; before and after a fix [T-8]: the error grows by "
        f"{percent(growth)} between fixes; with Schuler and Coriolis terms [T-17], horizontal is "
        f"{_beside(ratio)} and vertical {_beside(ratio_v)} the simple formula at "
        f"{number(coast.duration, given=True)} s.{smoothed}"
    )


def position_chart(budget: Budget) -> Chart:
    """Position sigma against time."""
    return _drawn(all_timelines(budget)[0])


def velocity_chart(budget: Budget) -> Chart:
    """Velocity sigma against time."""
    return _drawn(all_timelines(budget)[1])


def attitude_chart(budget: Budget) -> Chart:
    """Tilt sigma and heading growth against time."""
    return _drawn(all_timelines(budget)[2])


def _drawn(chart: Chart) -> Chart:
    """A chart alone, which need not have the same series for every design."""
    return replace(chart, lines=tuple(line for line in chart.lines if not np.isnan(line.y).all()))


def all_timelines(budget: Budget) -> tuple[Chart, Chart, Chart]:
    """Position, velocity and attitude on one time axis, as the page shows them together.

    In real time each curve has the level that its requirement limits before the last fix, the tile's; after it
    position is the refined curve [T-17], velocity and attitude the formulas [T-9], [T-17], [T-5]. Post-processed, the
    smoother bridges the outage from both sides [P-3]; requirements after an outage are those of real time, beside it.
    """
    coast, x, smoothed = budget.coast, _grid(budget), budget.post_processed
    lead, end = float(x[0]), coast.duration
    span = (_aperture_span(budget) if not smoothed else _smoothed_aperture(budget),)
    through = budget.smoothed_outage(x) if smoothed else {}

    def pair(
        label: str, style: str, free_style: str, name: str, curve: Array, scale: float = 1.0
    ) -> tuple[tuple[str, str, Array], ...]:
        """A curve of the design's processing; the outage in real time beside a smoothed one."""
        beside, curve = f"{label}, real time", budget[f"coast_{name}", REAL_TIME].around(curve).sigma
        if not smoothed:
            level = budget[name, REAL_TIME].sigma
            return (label, style, scale * _held(level, curve)), (beside, free_style, np.full(len(x), np.nan))
        bridged = budget[name, POST_PROCESSED].around(through[name]).sigma
        return (label, style, scale * bridged), (beside, free_style, scale * _after(curve))

    def both(quantity: str, after: str = "refined") -> tuple[tuple[str, str, Array], ...]:
        """Horizontal and vertical: while fixes come in, then the curve of the outage that is named so."""
        return tuple(
            curve
            for axis in ("horizontal", "vertical")
            for curve in pair(axis, axis, f"{axis} refined", f"{axis}_{quantity}",
                              getattr(coast, f"{after}_{axis}"))
        )  # fmt: skip

    def chart(
        key: str, unit: str, curves: tuple[tuple[str, str, Array], ...], limited: Iterable[str], marks: str,
        scale: float = 1.0, knowledge: str = "",
    ) -> Chart:  # fmt: skip
        source = f"formula {marks}" if not smoothed else f"smoothed [P-3], in real time by formula {marks}"
        lines = tuple(Line(label, label, x, y, style, source) for label, style, y in curves)
        spans = ((name, 0.0, end) if name.startswith("coast") else (name, lead, 0.0) for name in limited)
        return Chart(
            key, f"{key.capitalize()} sigma", _TIME, f"{key}, 1σ [{unit}]", lines,
            limits=_limits(budget, spans, scale), spans=span, y_log=True, named_at_ends=True,
            knowledge=knowledge or f"{source[0].upper()}{source[1:]}.{_YAW if key == 'attitude' else ''}",
        )  # fmt: skip

    positions = ("horizontal_position", "vertical_position", "coast_horizontal_position", "coast_vertical_position")
    attitude = (
        *pair("tilt", "tilt", "tilt, real time", "tilt", coast.tilt, DEGREES),
        ("heading growth", "yaw", _after(coast.yaw_growth * DEGREES)),
    )
    cited = _cited(budget)
    return (
        chart(
            "position",
            "m",
            both("position"),
            positions,
            f"{cited}, [T-17]",
            knowledge=_position_knowledge(budget),
        ),
        chart(
            "velocity",
            "m/s",
            both("velocity", "velocity"),
            ("horizontal_velocity", "vertical_velocity"),
            f"{cited}, [T-9], [T-17]",
        ),
        chart("attitude", "°", attitude, ("tilt",), f"{cited}, [T-9], [T-5]", DEGREES),
    )

"""Results of a covariance along a flight: figures over time, real time and post-processed, and shares by source."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import EARTH_RATE
from nav_model.base.units import time_in_words
from nav_model.budget.inputs import Inputs
from nav_model.budget.json import verdict_json
from nav_model.budget.real_time import RealTime
from nav_model.budget.verdict import Verdict
from nav_model.design.figures import FIGURES
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.simulation.truth import TruthStates
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.trust import too_much_trust

FloatArray = NDArray[np.float64]
STATE_AXES: Mapping[str, slice] = {
    "horizontal_position": slice(0, 2),
    "vertical_position": slice(2, 3),
    "horizontal_velocity": slice(3, 5),
    "vertical_velocity": slice(5, 6),
    "tilt": slice(6, 8),
    "heading": slice(8, 9),
}
"""Figures of states, and their axes among position, velocity and roll, pitch, yaw; the others are of an image."""
_SHARES = {
    f"{axis}_{state}": f"{state}_{axis}" for axis in ("horizontal", "vertical") for state in ("position", "velocity")
}  # in JSON, where these names came first
_HEADING_SHOWS = {REAL_TIME: 0.35, POST_PROCESSED: 0.02}  # from there it adds a per cent of tilt
_START_SHOWS = 0.05  # part by which the budget's start is larger
_WAITED = 4.0  # of the filter's time constants: fixes that come later change less than a per cent
_MOMENTS = {
    "prior": "just before a fix",
    "posterior": "just after a fix",
    "closed": "averaged before and after a fix",
}


@dataclass(frozen=True, eq=False)
class Processed:
    """Figures of one processing over the result's times, 1 sigma.

    position [m] and velocity [m/s] north, east, down, attitude [rad] roll, pitch, yaw: the model's after the fix, if
    there is one, (outputs, 3). figures: by name among `nav_model.design.figures.IN_FLIGHT`, (outputs), with the
    user's own contributors; those of an image are NaN where the aperture does not lie within the flight, those of
    states are of the larger axis, at the worst moment of the fix interval (`TrajectoryResult.moment`). shares: by
    figure, (sources, outputs); they add up to one at every time. Shares of `ce90` are of the sum of both variances,
    those of `tilt` and of horizontal figures of the sum of both axes.
    """

    position: FloatArray
    velocity: FloatArray
    attitude: FloatArray
    figures: Mapping[str, FloatArray]
    shares: Mapping[str, FloatArray]


@dataclass(frozen=True)
class LineResult:
    """A line against its limits: figures at its start, worst and rms over what is flown of it, 1 sigma, its limits on
    them, and the share of the line within each.

    worst_s: when each is worst [s of the flight]. failing: names of the figures beyond their limit; refused: of those
    that have a limit and no value on the line; reason: why, after its name in a sentence, else empty.

    fails_at_s: when the first figure passes its limit [s after the line's start], None where none does; fails_by:
    that figure; because: the same in words, with the largest source at that time. remark: which fixes after it a
    smoother waits for in vain. longest_s, reserve_s: the longest
    line that holds, and by how much it is longer [s], as `nav_model.trajectory.line_length` solves them; None before.
    """

    name: str
    start_s: float
    stop_s: float
    first: Mapping[str, float]
    worst: Mapping[str, float]
    worst_s: Mapping[str, float]
    mean: Mapping[str, float]
    limits: Mapping[str, float]
    within: Mapping[str, float]
    failing: tuple[str, ...]
    refused: tuple[str, ...]
    reason: str
    fails_at_s: float | None
    fails_by: str
    because: str
    remark: str = ""
    longest_s: float | None = None
    reserve_s: float | None = None

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.stop_s - self.start_s

    @property
    def excess(self) -> tuple[str, float]:
        """The figure that decides on it, and its worst over its limit; none without a limit or a value."""
        over = {name: self.worst[name] / limit for name, limit in self.limits.items() if name in self.worst}
        return max(over.items(), key=lambda item: item[1], default=("", 0.0))

    @property
    def closes(self) -> bool:
        """True if every limit is met all along it."""
        return not (self.failing or self.refused)


@dataclass(frozen=True, eq=False)
class OnLines:
    """Figures by processing at some times of a flight (outputs), those on its lines at least."""

    spec: CovarianceSpec
    time_s: FloatArray
    sources: tuple[str, ...]
    figures: Mapping[str, Processed]


@dataclass(frozen=True)
class Heading:
    """Heading along the flight: sigma at the start, the best and at the end; when it becomes observable, and by what.

    `observable_s` is None where it never does; `advice` then says what would help, in a sentence.
    """

    start_sigma_rad: float
    best_sigma_rad: float
    end_sigma_rad: float
    observable_s: float | None
    cause: str
    advice: str

    def in_words(self, confidence: float = 1.0) -> str:
        """The heading in a sentence, its values at a confidence."""
        values = self.start_sigma_rad, self.best_sigma_rad, self.end_sigma_rad
        start, best, end = (f"{math.degrees(confidence * value):.3g}°" for value in values)
        if self.observable_s is None:
            return f"Heading is not observed: {start} at the start, {end} at the end. {self.advice}".strip()
        when = f" from {time_in_words(self.observable_s)} on" if self.observable_s else ""
        return f"Heading is observed{when} by {self.cause}: {best} at best, {end} at the end."


@dataclass(frozen=True)
class Swath:
    """Slant ranges [m] between which a flight closes, `height_m` above the scene; None where it closes at none.

    near_by, far_by: what fails first beyond, in words; empty where the search ends.
    """

    height_m: float
    near_m: float | None = None
    far_m: float | None = None
    near_by: str = ""
    far_by: str = ""


@dataclass(frozen=True, eq=False)
class TrajectoryResult:
    """The covariance along a flight. truth: of the flight at `time_s` (outputs). swath: near and far range, as
    `nav_model.trajectory.swath` solves them; None before."""

    spec: CovarianceSpec
    time_s: FloatArray
    truth: TruthStates
    sources: tuple[str, ...]
    real_time: Processed
    post_processed: Processed
    lines: tuple[LineResult, ...]
    heading: Heading
    swath: Swath | None = None

    @property
    def chosen(self) -> Processed:
        """The processing that the limits judge."""
        return self.real_time if self.spec.processing == REAL_TIME else self.post_processed

    @property
    def on_lines(self) -> OnLines:
        """The figures by processing, all along the flight."""
        by_processing = {REAL_TIME: self.real_time, POST_PROCESSED: self.post_processed}
        return OnLines(self.spec, self.time_s, self.sources, by_processing)

    @property
    def moment(self) -> str:
        """When the figures of states are judged, in words."""
        if self.spec.processing == POST_PROCESSED:
            return "smoothed, in the middle of an aperture"
        return _MOMENTS[self.spec.moment]


def larger_start(x: Inputs) -> float:
    """By which factor at most the errors with which the budget's real-time aperture begins, on average between fixes,
    are larger than those just after a fix. [T-3], [T-8]"""
    model = RealTime(x)
    average, after = model.at_last_fix, model.cycle.posterior
    pairs = [
        (getattr(average, channel), getattr(after, channel), names)
        for channel, names in (("horizontal", ("p11", "p22", "p33")), ("vertical", ("v11", "v22")))
    ]
    return max(math.sqrt(getattr(a, name) / getattr(b, name)) for a, b, names in pairs for name in names)


def beside_budget(spec: CovarianceSpec) -> tuple[str, ...]:
    """Why figures of a straight line differ from those of the budget of the same design, in sentences."""
    x, study, real_time = spec.inputs, spec.study, spec.processing == REAL_TIME
    sigma_a, sigma_w, g, s, s_vertical = map(float, (x.sigma_a, x.sigma_w, x.g, x.s, x.s_vertical))
    # Rates at which the filter forgets [T-3], [T-4]; what a wrong heading makes of the Earth's rate, over what the
    # gyros add meanwhile; the slowest time constant, that of a slow error too.
    horizontal, vertical = (g * sigma_w / s) ** (1 / 3), math.sqrt(sigma_a / s_vertical)
    heading_ratio = study.initial.yaw * EARTH_RATE * math.cos(x.latitude) / (sigma_w * math.sqrt(horizontal))
    slowest = 1 / min(horizontal, vertical)
    if x.slow is not None:
        slowest = max(slowest, float(np.asarray(x.slow.correlation_time)))
    larger = larger_start(x) - 1.0
    cases = (
        (
            real_time and larger > _START_SHOWS,
            "An aperture begins just after a fix here, in the budget with the average between fixes, whose errors "
            f"are up to {larger:.0%} larger: so may be the budget's images.".replace("%", " %"),
        ),
        (
            heading_ratio > _HEADING_SHOWS[spec.processing],
            f"The heading at the start, {math.degrees(study.initial.yaw):.2g}° (1σ), turns the Earth's rate into a "
            "drift, which shows in tilt and velocity beside the gyros' noise. The budget has no heading.",
        ),
        (
            not real_time and float(x.leg_after) < _WAITED * slowest,
            f"The budget's smoother has {float(x.leg_after):g} s of fixes after the aperture, this one all of them.",
        ),
        (
            not study.filter.slow and any(study.gnss.axis_markov_noise),
            "The budget's filter knows the slow GNSS error, this one does not.",
        ),
        (
            x.before_aperture > 0,
            f"The budget's {float(x.before_aperture):g} s without fixes before the aperture are flown only where the "
            "flight has such an outage.",
        ),
    )
    return tuple(sentence for holds, sentence in cases if holds)


def to_json(result: TrajectoryResult, verdict: Verdict) -> dict[str, Any]:
    """The result and the design's verdict on this flight as plain data for JSON, in SI; null where an aperture does
    not lie within the flight."""
    return {
        "time_s": result.time_s.tolist(),
        "processing": result.spec.processing,
        "real_time": _processed(result.real_time),
        "post_processed": _processed(result.post_processed),
        "shares": {
            _SHARES.get(figure, figure): {
                source: _numbers(row) for source, row in zip(result.sources, rows, strict=True)
            }
            for figure, rows in result.chosen.shares.items()
        },
        "moment": result.moment,
        "lines": [_line(line) for line in result.lines],
        "heading": {
            "start_sigma_rad": result.heading.start_sigma_rad,
            "best_sigma_rad": result.heading.best_sigma_rad,
            "end_sigma_rad": result.heading.end_sigma_rad,
            "observable_s": result.heading.observable_s,
            "text": result.heading.in_words(),
        },
        "swath": asdict(result.swath) if result.swath else None,
        "verdict": verdict_json(verdict),
        "closes": verdict.closes,
        "beside_budget": list(beside_budget(result.spec)),
        "cautions": list(too_much_trust(result.spec)),
    }


def _line(line: LineResult) -> dict[str, Any]:
    by_figure = {"start": line.first, "worst": line.worst, "worst_s": line.worst_s, "mean": line.mean}
    figures = {name: {key: values[name] for key, values in by_figure.items()} for name in line.worst}
    plain = asdict(line)
    del plain["first"]
    return plain | {"closes": line.closes, "figures": figures}


def _processed(part: Processed) -> dict[str, Any]:
    named = {
        "position_sigma_m": (part.position, ("north", "east", "down")),
        "velocity_sigma_m_s": (part.velocity, ("north", "east", "down")),
        "attitude_sigma_rad": (part.attitude, ("roll", "pitch", "yaw")),
    }
    content: dict[str, Any] = {
        name: {axis: values[:, n].tolist() for n, axis in enumerate(axes)} for name, (values, axes) in named.items()
    }
    images = {name: values for name, values in part.figures.items() if name not in STATE_AXES}
    return content | {FIGURES[name].column: _numbers(values) for name, values in images.items()}


def _numbers(values: FloatArray) -> list[float | None]:
    return [None if math.isnan(value) else value for value in values.tolist()]

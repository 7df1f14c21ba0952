"""Results of `nav_model.budget.analyse`: immutable, in SI, and picklable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from nav_model.aperture.impulse_response import ImpulseResponse
from nav_model.base.arrays import Array
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Composed, Parts, entering, with_contributors
from nav_model.budget.shares import Shares
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED
from nav_model.processing.paired_echo import NOTHING


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of the navigation errors at one moment: m, m/s, rad."""

    position_horizontal: float
    position_vertical: float
    velocity_horizontal: float
    velocity_vertical: float
    tilt: float

    def named(self) -> dict[str, float]:
        """The same under the names of the figures that requirements limit."""
        return {
            "horizontal_position": self.position_horizontal,
            "vertical_position": self.position_vertical,
            "horizontal_velocity": self.velocity_horizontal,
            "vertical_velocity": self.velocity_vertical,
            "tilt": self.tilt,
        }


@dataclass(frozen=True)
class SteadyState:
    """The settled filter.

    ``closed`` is the cycle rms in closed form [T-3], [T-4], ``average`` the same with what a slow GNSS error adds to
    it; ``prior`` and ``posterior`` are the discrete filter just before and just after a fix [T-8], slow error
    included. ``asymptote`` is [T-7]: position, velocity, tilt, horizontal. ``lambda_dt`` is the larger of the two
    channels. ``shares`` gives, for each kind of error, each source's share in the variance of ``average`` [T-18].
    None of these has the user's own contributors, ``own``, but for `checked`.
    """

    closed: Sigmas
    average: Sigmas
    prior: Sigmas
    posterior: Sigmas
    gyro_dominance: float
    asymptote: tuple[float, float, float]
    lambda_dt: float
    shares: Mapping[str, Shares]
    own: Parts

    def moment(self, moment: str) -> Sigmas:
        """The "prior", the "posterior", or "closed", the average between fixes."""
        sigmas: Sigmas = getattr(self, "average" if moment == "closed" else moment)
        return sigmas

    def checked(self, moment: str) -> Sigmas:
        """What requirements are checked against: that moment, with the contributors of real time."""
        named = self.moment(moment).named()
        return Sigmas(
            *(
                float(with_contributors(sigma, entering(self.own, name, post_processed=False)))
                for name, sigma in named.items()
            )
        )


@dataclass(frozen=True)
class Outage:
    """Sigmas against time since the last fix, arrays of one length: s, m, m/s, rad.

    ``position_*``, ``velocity_*`` and ``tilt`` are the polynomials [T-9], [T-10] with the residual biases in
    quadrature; ``refined_*`` is [T-17] with the same biases. ``checked`` has, with contributors, the refined
    positions at the end of ``duration`` and what limits of the user's own limit in the outage.
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
    checked: Mapping[str, Composed]

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __reduce__(self) -> tuple[type[Outage], tuple[Any, ...]]:
        """Through the constructor, so that the arrays are read-only in another process too."""
        return type(self), tuple(getattr(self, name) for name in self.__dataclass_fields__)


@dataclass(frozen=True)
class PhaseLine:
    """One source of the phase budget: 1σ in rad; the shares are those in the variance of each."""

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
    what is left of it. Both are None when the phase is beyond 1000 rad and there is no image to describe, and so is
    ``half_power_extent`` [cells], the width of the first.
    ``along_track_growth`` is the velocity error of mid-aperture over that at its start, which [S-2] takes.
    ``by_order`` has the detrended phases after other orders of autofocus that the design limits.
    ``shares`` gives, for each phase that a requirement can limit, the share of each source in its variance;
    ``tilt_shares`` splits the initial tilt by the source that put it there [T-18].
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
    by_order: Mapping[str, float]
    along_track_growth: float
    lines: tuple[PhaseLine, ...]
    shares: Mapping[str, Shares]
    tilt_shares: Shares
    half_power_extent: float | None
    respond: Callable[[float], ImpulseResponse | None] = field(repr=False, compare=False)

    @cached_property
    def impulse_response(self) -> ImpulseResponse | None:
        """Computed when it is first read, as a moving slider does not need side lobes."""
        return self.respond(self.quadratic)

    @cached_property
    def after_autofocus(self) -> ImpulseResponse | None:
        """Likewise."""
        return self.impulse_response if self.autofocus_order == 1 else self.respond(0.0)


@dataclass(frozen=True)
class PostProcessed:
    """Errors that remain with a smoother that has every fix: m, m/s, rad. [P-3], [P-5]

    ``by_order`` has the detrended phase after each order of autofocus, ``detrended`` is that of the design's order.
    ``turning_quadratic`` is the quadratic phase along the line of sight as it turns over the aperture: ``quadratic``
    and ``along_track_quadratic``, which verdicts check, and the effect of the turn on the position error;
    ``turning_by_order`` are the residuals after autofocus to order 1 and 2 alike. After order 3 the turn is 0.3 % at
    most where it is less than 0.05 rad to each side, and some 2 % at 0.2 rad.
    ``azimuth_shift`` is R/V times the slope of the line of sight, without the position along the track.
    ``impulse_response`` is that of the 1σ quadratic, None beyond 1000 rad.
    ``shares`` gives, for each figure that a requirement can limit, the share of each source in its variance, and
    ``sizes`` the 1σ of each. Contributors of the user's own are in what verdicts check; the figures of the turn have
    none, nor has ``navigation``, the phases under the names of their figures.
    ``through`` gives navigation's sigmas before and in an outage, `nav_model.budget.navigation.smoothed_outage`.
    """

    sigmas: Sigmas
    quadratic: float
    cubic: float
    detrended: float
    by_order: Mapping[str, float]
    along_track_quadratic: float
    turning_quadratic: float
    turning_by_order: tuple[float, float]
    azimuth_shift: float
    shares: Mapping[str, Shares]
    sizes: Mapping[str, Mapping[str, float]]
    navigation: Mapping[str, float]
    respond: Callable[[float], ImpulseResponse | None] = field(repr=False, compare=False)
    through: Callable[[Array], Mapping[str, Array]] = field(repr=False, compare=False)

    @cached_property
    def impulse_response(self) -> ImpulseResponse | None:
        """Computed when it is first read: a page of a real-time design does not show it."""
        return self.respond(self.quadratic)

    @property
    def half_power_extent(self) -> float | None:
        """Its width, cells."""
        response = self.impulse_response
        return None if response is None else float(response.half_power_extent_cells)


@dataclass(frozen=True)
class Echo:
    """A paired echo that a line makes on both sides of a target. [P-9]

    ``frequency`` [Hz] of the line and its ``phase`` [rad, peak]; ``level`` is the echo's amplitude over the
    target's, ``offset`` its distance from it [m].
    """

    source: str
    frequency: float
    phase: float
    level: float
    offset: float


@dataclass(frozen=True)
class Spectral:
    """Effects of vibration, unsensed motion and oscillator outside the main lobe. [P-9], [P-11]

    ``levels`` holds "paired_echo", the highest echo, and "islr", the root of the scattered energy over the target's:
    amplitudes, 1e-15 where there is nothing. ``stays`` is the power that stays at the target, 1 without sources.
    ``shares`` gives, for both, the share of each source. ``random`` is the variance of the phase [rad²] that spectra
    scatter beyond the main lobe.
    """

    echoes: tuple[Echo, ...]
    levels: Mapping[str, float]
    stays: float
    shares: Mapping[str, Shares]
    random: float = 0.0

    def phase(self, x: Array, aperture: float) -> Array:
        """Phase of the lines [rad] at places x in [-1, 1] of an aperture [s], as far as its samples resolve them."""
        lines = [line for line in self.echoes if line.frequency * aperture < len(x) / 4]
        return sum((line.phase * np.cos(np.pi * line.frequency * aperture * x) for line in lines), start=0 * x)


@dataclass(frozen=True)
class Placement:
    """Where the image lies, 1σ: m. [P-7]

    ``ground`` holds the variances in azimuth and in ground range and their covariance, m². ``ce90``, ``cep`` and
    ``le90`` are the radii and the height that 90 %, one half and 90 % of images stay within. ``shares`` as in
    `PostProcessed`.
    """

    range: float
    azimuth: float
    ground: tuple[float, float, float]
    ce90: float
    cep: float
    le90: float
    shares: Mapping[str, Shares]


@dataclass(frozen=True)
class Check:
    """One requirement compared with its figure.

    ``value`` is ``sigma`` times the confidence asked for, in SI; ``margin`` is the part of the limit left
    over, 1 - value/limit, negative when the requirement is not met. ``confidence`` is None where it does not count,
    ``on`` the figure that is limited, mostly ``name``. ``basis`` says which of the model's
    results was taken (prior, refined, formula ...), ``equation`` where it comes from. ``shares`` are those of the
    budget's lines in the variance, ``tilt_shares`` those of the noises in an initial tilt.
    """

    name: str
    on: str
    label: str
    dimension: str
    confidence: float | None
    value: float
    sigma: float
    limit: float
    margin: float
    met: bool
    basis: str
    equation: str
    shares: Shares
    tilt_shares: Shares

    @property
    def dominant(self) -> str:
        """The source with the largest share of the variance."""
        return max(self.shares, key=lambda source: self.shares[source])

    @property
    def dominant_share(self) -> float:
        """Its share."""
        return self.shares[self.dominant]

    @property
    def sensor(self) -> str:
        """The sensor responsible for the largest share."""
        return max(self.by_sensor, key=lambda source: self.by_sensor[source])

    @property
    def sensor_share(self) -> float:
        """Its share."""
        return self.by_sensor[self.sensor]

    @cached_property
    def by_sensor(self) -> Shares:
        """Shares by sensor: the initial tilt counts for the noises that cause it, tilt growth in a coast for the
        gyros. [T-18]"""
        charged: dict[str, float] = {}
        for source, share in self.shares.items():
            for sensor, part in makers_of(self, source).items():
                charged[sensor] = charged.get(sensor, 0.0) + share * part
        return FrozenMapping(charged)


def makers_of(check: Check, source: str) -> Shares:
    """The noises that make a source of a check, with their shares in it; itself where it is one. [T-18]"""
    if source == "coast before aperture":
        return FrozenMapping({"gyro noise": 1.0})
    return check.tilt_shares if source == "initial tilt" else FrozenMapping({source: 1.0})


@dataclass(frozen=True)
class Verdict:
    """All checks, in the order of the requirements; ``tightest`` is the one with the least margin.

    ``processing`` is the mode that the figures belong to: "real time" or "post-processed".
    """

    processing: str
    closes: bool
    confidence: float
    checks: tuple[Check, ...]
    tightest: Check | None


@dataclass(frozen=True)
class AfterFlight:
    """Results of post-processing: figures, image location and verdict."""

    figures: PostProcessed
    placement: Placement
    verdict: Verdict


@dataclass(frozen=True)
class Budget:
    """Everything known about a design, immutable, in SI.

    ``steady_state``, ``coast``, ``sar`` and ``placement`` are those of real time, ``spectral`` holds for both
    processings. ``verdict`` is that of the design's processing and decides; ``other_verdict`` holds the same
    requirements against the other one.

    For a real-time design, the results of post-processing are computed when they are first read. This raises
    `InputError` if double precision cannot hold the design's values together.

    `nav_model.budget.provenance` says which equation each number comes from.
    """

    design: Design
    steady_state: SteadyState
    coast: Outage
    sar: Sar
    placement: Placement
    spectral: Spectral
    real_time_verdict: Verdict
    work_out: Callable[[], AfterFlight] = field(repr=False, compare=False)

    @cached_property
    def _after_flight(self) -> AfterFlight:
        return self.work_out()

    @property
    def post_processed(self) -> PostProcessed:
        """Figures of post-processing."""
        return self._after_flight.figures

    @property
    def post_processed_placement(self) -> Placement:
        """Where the image lies after post-processing."""
        return self._after_flight.placement

    @property
    def _decides_after_flight(self) -> bool:
        return bool(self.design.processing.mode == POST_PROCESSED)

    @property
    def verdict(self) -> Verdict:
        """That of the design's processing, which decides."""
        return self._after_flight.verdict if self._decides_after_flight else self.real_time_verdict

    @property
    def other_verdict(self) -> Verdict:
        """The same requirements against the other processing."""
        return self.real_time_verdict if self._decides_after_flight else self._after_flight.verdict

    @property
    def has_fast_sources(self) -> bool:
        """Whether the design has residual vibration, unsensed motion or oscillator noise."""
        return bool(self.spectral.levels["islr"] > NOTHING or self.spectral.echoes)

    @property
    def smoothed(self) -> PostProcessed | None:
        """The post-processed figures where they decide, None where those of real time do."""
        return self.post_processed if self._decides_after_flight else None

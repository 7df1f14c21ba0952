"""A budget: every figure of a design in both processings, the verdicts, and the curves beside them.

``budget[figure, processing]`` is a figure with its contributors, shares and origin. It is composed in one place,
`Budget.composed`, when it is first read, from the formulas of `nav_model.budget.real_time` and
`nav_model.budget.smoothed`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from nav_model.aperture import geometry
from nav_model.aperture.impulse_response import ImpulseResponse
from nav_model.aperture.phase import PhaseVariances
from nav_model.aperture.polynomial_response import half_power_extent
from nav_model.base.arrays import Array
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Composed, Shares
from nav_model.budget.inputs import Inputs
from nav_model.budget.navigation import (
    Outage,
    SteadyState,
    outage_of,
    smoothed_outage,
    steady_marks,
    steady_state_of,
)
from nav_model.budget.real_time import RealTime
from nav_model.budget.refusals import refused
from nav_model.budget.response import NO_IMAGE, response_of
from nav_model.budget.shares import Stepped
from nav_model.budget.smoothed import Smoothed
from nav_model.budget.spectral import Spectral, spectral_of
from nav_model.budget.verdict import Check, Verdict, judge, with_flight
from nav_model.design import Design
from nav_model.design.figures import FIGURES, OF_BUDGET, PHASES, QUADRATIC, REQUIRED
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

_MOMENTS = {"prior": "prior", "posterior": "posterior", "closed": "formula"}
_NO_SOURCE: Shares = FrozenMapping({"no such source": 1.0})


@dataclass(frozen=True)
class Aperture:
    """The aperture of a design: s, m. ``cell_length`` is one cell in azimuth."""

    wavelength: float
    aperture_time: float
    aperture_length: float
    cell_length: float
    window: str
    autofocus_order: int


@dataclass(frozen=True)
class PhaseLine:
    """One source of the phase budget: 1σ in rad; the shares are those in the variance of each."""

    source: str
    quadratic: float
    cubic: float
    detrended: float
    share: float
    detrended_share: float


@dataclass(frozen=True, eq=False)
class Budget(Mapping[tuple[str, str], Composed]):
    """Everything known about a design, immutable, in SI: a mapping (figure, processing) -> `Composed`.

    ``verdict`` is that of the design's processing and decides; ``other_verdict`` holds the same requirements against
    the other one. ``flight`` has the checks that the design's flight makes, by processing, as
    `nav_model.trajectory.verdict.with_flight` gives them; while it is None they are open. Each verdict is computed
    when it is first read, which raises `InputError` if double precision cannot hold the design's values together;
    `nav_model.budget.analyse` has read what the design's processing needs.

    `nav_model.budget.provenance` says which equation each number comes from.
    """

    design: Design
    x: Inputs = field(repr=False)
    time: Array = field(repr=False)
    flight: Mapping[str, tuple[Check, ...]] | None = field(default=None, repr=False)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Budget)
            and (self.design, self.flight) == (other.design, other.flight)
            and np.array_equal(self.time, other.time)
        )

    def __hash__(self) -> int:
        return hash(self.design)

    def __getitem__(self, key: tuple[str, str]) -> Composed:
        return self.composed(*key)

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return ((name, processing) for processing in (REAL_TIME, POST_PROCESSED) for name in OF_BUDGET)

    def __len__(self) -> int:
        return 2 * len(OF_BUDGET)

    @property
    def processing(self) -> str:
        """The design's processing, which decides."""
        return self.x.processing

    @property
    def post_processed(self) -> bool:
        """True if post-processing decides."""
        return self.processing == POST_PROCESSED

    def figure(self, name: str) -> Composed:
        """A figure in the design's processing."""
        return self.composed(name, self.processing)

    def compute(self) -> None:
        """Compute what decides: the settled filter, the outage, required figures, and the design's verdict.

        Raises
        ------
        InputError
            If double precision cannot hold the design's values together.
        """
        with refused(self.design), self._strict(REAL_TIME):
            _ = self.steady_state, self.coast
        for processing in {REAL_TIME, self.processing}:
            for name in REQUIRED:
                self.composed(name, processing)
        _ = self.verdict

    # Where figures are composed.

    @cached_property
    def _cache(self) -> dict[tuple[Any, ...], Composed]:
        return {}

    def composed(
        self, name: str, processing: str, at: float | None = None, moment: str = "", *, own_limit: bool = False
    ) -> Composed:
        """A figure with what enters it, or a contributor by itself.

        Parameters
        ----------
        name : str
            Of a figure or of a contributor.
        processing : str
            "real time" or "post-processed".
        at : float, optional
            Seconds since the last fix, of a figure of the outage; by default its end.
        moment : str
            "prior", "posterior" or "closed", of a figure of the settled filter in real time; by default that which
            the design's requirements are checked at.
        own_limit : bool
            Whether a limit of the user's own asks, which tells the time of a value in the outage.

        Raises
        ------
        InputError
            If double precision cannot hold the design's values together.
        """
        key = name, processing, at, moment, own_limit
        if key not in self._cache:
            with refused(self.design), self._strict(processing):
                self._cache[key] = self._composed(*key)
        return self._cache[key]

    def _strict(self, processing: str) -> np.errstate:
        # A variance below zero has lost its digits: refused here, not where somebody reads it. Real time divides by
        # zero where an input is none.
        return np.errstate(invalid="raise", divide="raise" if processing == POST_PROCESSED else None)

    def _composed(self, name: str, processing: str, at: float | None, moment: str, own_limit: bool) -> Composed:
        if name not in FIGURES:
            alone = self.x.contributors.composed(name, processing, basis="contributor with its allowance")
            # A contributor of the other processing is zero here; it is named all the same.
            return alone if alone.parts else alone.around(0.0, FrozenMapping({name: 1.0}))
        model = self._of_model(name, processing, at, moment)
        origin = self.origin(name, processing, at, moment, own_limit=own_limit)
        return self.x.contributors.composed(name, processing, *model, *origin)

    def _of_model(self, name: str, processing: str, at: float | None, moment: str) -> tuple[float, Shares]:
        """A figure without contributors, 1σ, and the share of each source in its variance.

        Both come from its formula, evaluated once with every source stepped (`nav_model.budget.shares`). Three kinds
        differ. A measure of the impulse response is read from a phase with its contributors, and has its shares. A
        level without fast errors or an autofocus that scatters has no source. The settled filter in real time is
        checked at a moment of its cycle, with the shares of its average over the cycle.
        """
        figure, model = FIGURES[name], self.models[processing]
        if figure.follows:
            return float(model.value(name)), self.composed(figure.follows, processing).shares
        estimated = name == "islr" and bool(self.x.scattered_by_estimation)
        if figure.kind == "level" and not self.x.fast and not estimated:
            return float(model.value(name)), _NO_SOURCE
        # Without a formula of its own after the flight, a figure is that of real time.
        stepped = self._stepped_models[processing if figure.smoothed_mark else REAL_TIME]
        value, shares = self._stepped.sized(name, stepped.value(name, at))
        if not math.isfinite(value):
            raise FloatingPointError(f"{name.replace('_', ' ')} is beyond double precision")
        if figure.kind == "steady" and processing == REAL_TIME:
            value = float((model.at(model.moment(moment)) if moment else model).value(name))
        return value, shares

    def origin(
        self, name: str, processing: str, at: float | None = None, moment: str = "", *, own_limit: bool = False
    ) -> tuple[str, str]:
        """Name of the model's result that a figure is, and the mark of its equation.

        Parameters
        ----------
        name, processing, at, moment, own_limit
            As `composed`.
        """
        figure, smoothed = FIGURES[name], processing == POST_PROCESSED
        mark = figure.smoothed_mark if smoothed and figure.smoothed_mark else figure.mark
        if figure.kind == "level":
            return "lines and spectra", mark
        if figure.kind == "outage":
            when = "at its end" if at is None else f"after {at:g} s"
            return f"in the outage, {when}" if own_limit else "refined", mark
        if figure.kind == "response":
            return "impulse response with 1σ quadratic", mark
        if smoothed:
            return "smoothed", mark
        if figure.kind == "steady":
            checked = moment or self.x.steady_state
            closed = steady_marks(self.design)["vertical" in name]
            return _MOMENTS[checked], closed if checked == "closed" else mark
        slow = ", with the tilt that the slow GNSS error adds" if self.design.gnss.correlated else ""
        return f"formula{slow}", mark

    @cached_property
    def models(self) -> Mapping[str, RealTime]:
        """Processing -> the formulas with the design's inputs."""
        models = FrozenMapping({REAL_TIME: RealTime(self.x), POST_PROCESSED: Smoothed(self.x)})
        if (stepped := self._stepped_models[REAL_TIME].varying) is not None:
            varying = stepped.unstepped(self.x)
            for model in models.values():
                model.varying = varying
        return models

    # Shares come from the same formulas with every source stepped, of the filter on average between fixes.

    @cached_property
    def _stepped(self) -> Stepped:
        return Stepped(replace(self.x, steady_state="closed"))

    @cached_property
    def _stepped_models(self) -> Mapping[str, RealTime]:
        return FrozenMapping({REAL_TIME: RealTime(self._stepped.x), POST_PROCESSED: self._smoothed})

    @cached_property
    def _smoothed(self) -> Smoothed:
        return Smoothed(self._stepped.x)

    def beside(self, formula: Callable[[Smoothed], Array]) -> float:
        """Value of a formula of the smoother that is no figure, without contributors."""
        with refused(self.design), self._strict(POST_PROCESSED):
            return _real(formula(self._smoothed))

    def __reduce__(self) -> tuple[type[Budget], tuple[Any, ...]]:
        """By the inputs: what was read is computed anew."""
        return type(self), (self.design, self.x, self.time, self.flight)

    # Verdicts.

    @cached_property
    def _straight(self) -> dict[str, Verdict]:
        return {}

    def straight_leg(self, processing: str = "") -> Verdict:
        """The verdict of a straight leg in a processing, the design's by default, without what only a flight judges:
        the one that answers of arrays of designs are of."""
        processing = processing or self.processing
        if processing not in self._straight:
            self._straight[processing] = judge(
                self.design,
                processing,
                lambda name, at, own_limit: self.composed(name, processing, at, own_limit=own_limit),
            )
        return self._straight[processing]

    @cached_property
    def _verdicts(self) -> dict[str, Verdict]:
        return {}

    def judged(self, processing: str) -> Verdict:
        """The verdict in a processing, with the checks of the flight."""
        if processing not in self._verdicts:
            flight = None if self.flight is None else self.flight[processing]
            self._verdicts[processing] = with_flight(self.design, self.straight_leg(processing), flight)
        return self._verdicts[processing]

    @property
    def verdict(self) -> Verdict:
        """Verdict in the design's processing, which decides."""
        return self.judged(self.processing)

    @property
    def other_verdict(self) -> Verdict:
        """Verdict on the same requirements in the other processing."""
        return self.judged(REAL_TIME if self.post_processed else POST_PROCESSED)

    @cached_property
    def tilt_shares(self) -> Shares:
        """Shares of the sources in the tilt at the start of the aperture, in real time. [T-18]"""
        with refused(self.design):
            return self._stepped.sized("initial tilt", self._stepped_models[REAL_TIME].initial_tilt)[1]

    # What is no figure: the cycle, the outage over time, the aperture, side lobes, the response.

    @cached_property
    def steady_state(self) -> SteadyState:
        """The settled filter in real time."""
        return steady_state_of(self.models[REAL_TIME])

    @cached_property
    def coast(self) -> Outage:
        """Errors in real time against time since the last fix."""
        return outage_of(self.models[REAL_TIME], self.time)

    def smoothed_outage(self, time: Array) -> Mapping[str, Array]:
        """Post-processed figures of the settled filter, before and in an outage: `navigation.smoothed_outage`."""
        return smoothed_outage(self.x, time)

    @cached_property
    def sar(self) -> Aperture:
        """Wavelength, length and cell of the aperture."""
        x, radar, speed = self.x, self.design.radar, self.design.flight.speed
        wavelength, time = float(x.wavelength), float(x.aperture)
        cell = geometry.cell_length(wavelength, radar.slant_range, speed, time, x.squint)
        return Aperture(wavelength, time, time * speed, float(cell), radar.window, x.autofocus_order)

    @cached_property
    def spectral(self) -> Spectral:
        """Echoes beyond the main lobe and scattered energy; the same in both processings."""
        return spectral_of(self.x, self.sar.cell_length)

    @property
    def has_fast_sources(self) -> bool:
        """True if the design has residual vibration, unsensed motion or oscillator noise that shows."""
        return self.spectral.shows

    def ground(self, processing: str) -> tuple[float, float, float]:
        """Variances of the image's place in azimuth and ground range and their covariance, m², without contributors.
        [P-7]"""
        with refused(self.design), self._strict(processing):
            azimuth, across, both = map(_real, self._stepped_models[processing].ground)
        return azimuth, across, both

    def phase_lines(self, processing: str) -> tuple[PhaseLine, ...]:
        """Each source of phase over the aperture, along the turning line of sight."""
        return self._lines({name: self[name, processing] for name in PHASES})

    def sight_lines(self) -> tuple[PhaseLine, ...]:
        """Lines in real time along the line of sight of mid-aperture, where the initial tilt and the coast before
        the aperture are sources of their own. [S-5], [S-6]"""
        by_source, to_phase = self.models[REAL_TIME].phases, self.x.to_phase
        figures = {}
        for name, column in zip(PHASES, PhaseVariances._fields, strict=True):
            variances = {source: getattr(parts, column) for source, parts in by_source.items()}
            whole = sum(variances.values())
            shares = {source: float(variance / (whole or 1.0)) for source, variance in variances.items()}
            figure = self[f"line_of_sight_{name}", REAL_TIME]
            figures[name] = figure.around(float(to_phase * np.sqrt(whole)), shares)
        return self._lines(figures)

    def _lines(self, figures: Mapping[str, Composed]) -> tuple[PhaseLine, ...]:
        quadratic, cubic, detrended = (figures[name] for name in PHASES)
        return tuple(
            PhaseLine(
                source,
                quadratic.sizes.get(source, 0.0),
                cubic.sizes.get(source, 0.0),
                detrended.sizes.get(source, 0.0),
                quadratic.shares.get(source, 0.0),
                detrended.shares.get(source, 0.0),
            )
            for source in dict.fromkeys((*quadratic.sizes, *cubic.sizes, *detrended.sizes))
        )

    @cached_property
    def _responses(self) -> dict[float, ImpulseResponse | None]:
        return {}

    def response(self, processing: str) -> ImpulseResponse | None:
        """Azimuth impulse response with the quadratic phase at one sigma; None beyond 1000 rad, where no image is."""
        return self._response(self[QUADRATIC, processing].sigma)

    def response_after_autofocus(self) -> ImpulseResponse | None:
        """Impulse response with what autofocus leaves of the quadratic phase in real time."""
        return self.response(REAL_TIME) if self.sar.autofocus_order == 1 else self._response(0.0)

    def _response(self, quadratic: float) -> ImpulseResponse | None:
        if quadratic not in self._responses:
            self._responses[quadratic] = response_of(self.x, quadratic)
        return self._responses[quadratic]

    @property
    def half_power_extent(self) -> float | None:
        """Width of the response in the design's processing, cells; None where there is no image.

        In real time without paired echoes, which takes less than the whole response.
        """
        quadratic = self.figure(QUADRATIC).sigma
        if quadratic > NO_IMAGE:
            return None
        if not self.post_processed:
            return half_power_extent(quadratic, self.x.window)  # type: ignore[arg-type]
        response = self.response(POST_PROCESSED)
        return None if response is None else float(response.half_power_extent_cells)


def _real(values: Array) -> float:
    """The number of a stepped value, whose steps are imaginary."""
    return float(np.real(values).flat[-1])

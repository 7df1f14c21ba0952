"""The verdict: each requirement against its figure, with margin and dominant source."""

from collections.abc import Mapping
from dataclasses import dataclass

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Parts, composed, entering, with_contributors
from nav_model.budget.fast import LEVELS
from nav_model.budget.figures import FIGURES, IMAGING, PLACING, SETTLED
from nav_model.budget.provenance import steady_marks
from nav_model.budget.response import NO_IMAGE, limited_of
from nav_model.budget.result import Check, Outage, Placement, PostProcessed, Sar, Spectral, SteadyState, Verdict
from nav_model.budget.shares import Shares
from nav_model.design import Design
from nav_model.design.contributors import COASTING, ENTERED, IN_OUTAGE, RESPONSE, UNSCALED, label_of
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME


@dataclass(frozen=True)
class _Figure:
    """One sigma of a limited figure, its `basis`, and the shares of the sources."""

    sigma: float
    basis: str
    equation: str
    shares: Shares


@dataclass(frozen=True)
class Required:
    """A requirement in force: the value it is `on`, its limit in SI with the unit it is shown in, and its confidence,
    None where that does not multiply."""

    on: str
    limit: float
    dimension: str
    unit: str
    confidence: float | None

    @property
    def at_one_sigma(self) -> float:
        """The limit that one sigma has to meet."""
        return self.limit / (self.confidence or 1.0)


def required(design: Design) -> dict[str, Required]:
    """Name of each check of a design -> its requirement, in the order of the verdict, without computing figures."""
    usual: float = design.requirements.confidence
    found = {}
    for name, key in FIGURES.items():
        if (limit := getattr(design.requirements, key)) is not None:
            unit, factor = design.unit(f"requirements.{key}"), _factor(name, usual)
            found[name] = Required(name, limit, limit_on(name).dimension, unit, factor)
    figures = {one.name: one.enters for one in design.contributors}
    for own in design.limits:
        factor = _factor(figures.get(own.on, own.on), own.confidence or usual)
        unit = own.unit or DIMENSIONS[own.dimension].default_unit
        found[own.name] = Required(own.on, own.value, own.dimension, unit, factor)
    return found


def _factor(figure: str, confidence: float) -> float | None:
    return None if figure in UNSCALED else confidence


def confidence_of(design: Design, figure: str) -> float:
    """The design's factor on a figure's one sigma before it is compared with a limit."""
    return _factor(figure, design.requirements.confidence) or 1.0


def limit_on(name: str) -> BaseQuantity[float | None]:
    """The declaration of the requirement that limits a figure."""
    declaration = declaration_of(f"requirements.{FIGURES[name]}")
    assert isinstance(declaration, BaseQuantity)
    return declaration


def judge(
    design: Design,
    steady_state: SteadyState,
    coast: Outage,
    sar: Sar,
    placement: Placement,
    spectral: Spectral,
    smoothed: PostProcessed | None = None,
) -> Verdict:
    """Check every requirement that is given: in real time, or post-processed with `smoothed` and its `placement`.

    In steady state the prior, the worst of the cycle, is checked unless the design chooses otherwise; after
    the last fix the refined curve, which is right on the unsafe side. The limit on quadratic phase holds for
    the along-track term [S-2] as well, which has its own check because other sensors cause it.
    """
    figures = _figures(design, steady_state, coast, sar) | _levels(spectral, steady_state.own)
    if smoothed is not None:
        figures |= _smoothed(smoothed)
    figures |= _placed(placement, figures["quadratic_phase"].basis)
    if any(limit.on in RESPONSE for limit in design.limits):
        figures |= _response(sar, smoothed, figures["quadratic_phase"], steady_state.own)
    figures |= _of_limits(design, figures, coast, steady_state.own, post_processed=smoothed is not None)
    checks = []
    for name, one in required(design).items():
        figure, limit = figures[name], one.limit
        sigma = float(figure.sigma)
        value = (one.confidence or 1.0) * sigma
        margin = 1 - value / limit
        checks.append(
            Check(
                name=name,
                on=one.on,
                label=label_of(name),
                dimension=one.dimension,
                confidence=one.confidence,
                value=value,
                sigma=sigma,
                limit=limit,
                margin=margin,
                met=value <= limit,
                basis=figure.basis,
                equation=figure.equation,
                shares=figure.shares,
                tilt_shares=sar.tilt_shares,
            )
        )
    tightest = min(checks, key=lambda check: check.margin, default=None)
    processing = REAL_TIME if smoothed is None else POST_PROCESSED
    closes = all(check.met for check in checks)
    return Verdict(processing, closes, design.requirements.confidence, tuple(checks), tightest)


def _phases(of: Sar | PostProcessed) -> dict[str, float]:
    """Figures of `IMAGING`, and those of other orders of autofocus."""
    named = zip(IMAGING, (of.quadratic, of.along_track_quadratic, of.cubic, of.detrended), strict=True)
    return dict(named) | dict(of.by_order)


def _smoothed(smoothed: PostProcessed) -> dict[str, _Figure]:
    """Every figure that post-processing changes; the end of an outage stays that of real time."""
    marked = ((_phases(smoothed), "[P-5]"), (smoothed.sigmas.named(), "[P-3]"))
    return {
        name: _Figure(sigma, "smoothed", mark, smoothed.shares[name])
        for sigmas, mark in marked
        for name, sigma in sigmas.items()
    }


def _levels(spectral: Spectral, own: Parts) -> dict[str, _Figure]:
    found = {}
    for name, mark in zip(LEVELS, ("[P-9]", "[P-11]"), strict=True):
        whole = composed(spectral.levels[name], spectral.shares[name], own.get(name, ()))
        found[name] = _Figure(whole.sigma, "lines and spectra", mark, whole.shares)
    return found


def outage_mark(figure: str) -> str:
    """Mark of the equation of a value in the outage; none for what is no such value."""
    marks = {"coast_heading": "[T-5]", "coast_vertical_velocity": "[T-10]"}
    return marks.get(figure, "[T-9]" if figure in IN_OUTAGE else "[T-17]" if figure in COASTING else "")


def _of_limits(
    design: Design, figures: Mapping[str, _Figure], coast: Outage, own: Parts, *, post_processed: bool
) -> dict[str, _Figure]:
    """What limits of the user's own limit."""
    found = {}
    for limit in design.limits:
        if whole := coast.checked.get(limit.name):
            when = "at its end" if limit.at is None else f"after {limit.at:g} s"
            found[limit.name] = _Figure(whole.sigma, f"in the outage, {when}", outage_mark(limit.on), whole.shares)
        elif limit.on in ENTERED:
            found[limit.name] = figures[limit.on]
        else:
            size = with_contributors(0.0, entering(own, limit.name, post_processed=post_processed))
            alone = FrozenMapping({limit.on: 1.0})
            found[limit.name] = _Figure(float(size), "contributor with its allowance", "", alone)
    return found


def _response(sar: Sar, smoothed: PostProcessed | None, quadratic: _Figure, own: Parts) -> dict[str, _Figure]:
    """Figures of `RESPONSE`, with the shares of the quadratic phase; beyond `NO_IMAGE` those of `NO_IMAGE`."""
    response = (smoothed or sar).respond(min(quadratic.sigma, NO_IMAGE))
    assert response is not None
    found = {}
    for name, value in limited_of(response, sar.cell_length).items():
        entered = entering(own, name, post_processed=smoothed is not None)
        whole = composed(value, quadratic.shares, entered)
        found[name] = _Figure(whole.sigma, "impulse response with 1σ quadratic", quadratic.equation, whole.shares)
    return found


def _placed(placement: Placement, basis: str) -> dict[str, _Figure]:
    values = (placement.azimuth, placement.range, placement.ce90, placement.le90, placement.cep)
    return {
        name: _Figure(value, basis, "[P-7]", placement.shares[name])
        for name, value in zip(PLACING, values, strict=True)
    }


def _figures(design: Design, steady_state: SteadyState, coast: Outage, sar: Sar) -> dict[str, _Figure]:
    chosen = design.requirements.steady_state
    level, upright = steady_marks(design)
    sigmas = steady_state.moment(chosen).named()
    label = {"prior": "prior", "posterior": "posterior", "closed": "formula"}[chosen]

    def settled(name: str) -> _Figure:
        closed_mark = upright if name.startswith("vertical") else level
        mark = "[T-8]" if chosen != "closed" else closed_mark
        entered = entering(steady_state.own, name, post_processed=False)
        whole = composed(sigmas[name], steady_state.shares[name], entered)
        return _Figure(whole.sigma, label, mark, whole.shares)

    slow = design.gnss.correlated
    budget = "formula" if not slow else "formula, with the tilt that the slow GNSS error adds"
    marks = {"quadratic_phase": "[S-5]", "along_track_quadratic_phase": "[S-2]", "cubic_phase": "[S-6]"}
    phases = {
        name: _Figure(sigma, budget, marks.get(name, "[T-15], [S-6]"), sar.shares[name])
        for name, sigma in _phases(sar).items()
    }
    ends = {name: coast.checked[name] for name in COASTING}
    return {
        **phases,
        **{name: settled(name) for name in SETTLED},
        **{name: _Figure(end.sigma, "refined", "[T-17]", end.shares) for name, end in ends.items()},
    }

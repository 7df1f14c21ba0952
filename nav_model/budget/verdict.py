"""The verdict: each requirement against its figure, with margin and dominant source."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Composed, Shares
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.figures import FIGURES, IN_FLIGHT, label_of, of_kind
from nav_model.design.parts import quantity


@dataclass(frozen=True)
class Required:
    """A requirement in force: the value it is `on` and, in the outage, the time `at` which [s], its limit in SI with
    the unit it is shown in, and its confidence, None where that does not multiply."""

    on: str
    at: float | None
    limit: float
    dimension: str
    unit: str
    confidence: float | None

    @property
    def at_one_sigma(self) -> float:
        """The limit that one sigma has to meet."""
        return self.limit / (self.confidence or 1.0)


State = Literal["met", "not met", "open", "refused"]
"""Of a check; "open": not computed for these inputs yet."""
STRAIGHT_LEG = "straight leg"
"""Where a budget judges."""
WHOLE_FLIGHT = "flight"
"""Where a flight without lines judges."""
_SIGMAS_CAPTURED = 3.0
_MOST_ESTIMATION = 0.3
"""rad: beyond, an autofocus fails. A ratio in a block below 2/√(range bins × blocks) is beyond too. [S-10]"""
_NO_SHARES: Shares = FrozenMapping({})


@dataclass(frozen=True)
class Check:
    """One requirement compared with its figure.

    Attributes
    ----------
    name : str
        Of the requirement.
    on : str
        The figure that is limited, mostly `name`.
    label : str
    dimension : str
    unit : str
        In which the limit is written.
    confidence : float or None
        None where it does not multiply the figure.
    value : float
        `sigma` times the confidence, in SI; nan where the check is open or refused.
    sigma : float
    limit : float
        In SI; along a flight, that of the line which decides.
    margin : float
        The part of the limit left over, 1 - value/limit; negative where the requirement is not met.
    state : str
        "met", "not met", "open" or "refused".
    judged : str
        Where: `STRAIGHT_LEG`, the name of a line, or `WHOLE_FLIGHT`.
    straight : float or None
        The straight leg's value beside that of a flight, at the same confidence; None where there is none.
    reason : str
        Why it is open or refused.
    basis : str
        The result of the model that was taken (prior, refined, formula ...).
    equation : str
        Its mark.
    shares : mapping
        Of the sources in the variance; empty where nothing was computed.
    """

    name: str
    on: str
    label: str
    dimension: str
    unit: str
    confidence: float | None
    value: float
    sigma: float
    limit: float
    margin: float
    state: State
    judged: str
    straight: float | None
    reason: str
    basis: str
    equation: str
    shares: Shares

    @property
    def met(self) -> bool:
        """True if the value is known and within the limit."""
        return self.state == "met"

    @property
    def known(self) -> bool:
        """True if there is a value to compare."""
        return self.state in ("met", "not met")

    @property
    def dominant(self) -> str:
        """The source with the largest share of the variance; empty without any."""
        return max(self.shares, key=lambda source: self.shares[source], default="")

    @property
    def dominant_share(self) -> float:
        """The share of the dominant source."""
        return self.shares.get(self.dominant, 0.0)


@dataclass(frozen=True)
class Verdict:
    """All checks, in the order of the requirements, in one processing: "real time" or "post-processed"."""

    processing: str
    confidence: float
    checks: tuple[Check, ...]

    @property
    def state(self) -> Literal["closes", "fails", "open"]:
        """ "fails" where a requirement is not met, "closes" where all are, else "open"."""
        if self.failing:
            return "fails"
        return "open" if self.open else "closes"

    @property
    def closes(self) -> bool:
        """True if every requirement is known and met."""
        return self.state == "closes"

    @property
    def failing(self) -> tuple[str, ...]:
        """Names of the requirements that are not met."""
        return tuple(check.name for check in self.checks if check.state == "not met")

    @property
    def open(self) -> tuple[str, ...]:
        """Names of those that are open or refused."""
        return tuple(check.name for check in self.checks if not check.known)

    @property
    def tightest(self) -> Check | None:
        """The check with the least margin of those that are known; None without any."""
        return min((check for check in self.checks if check.known), key=lambda check: check.margin, default=None)


def required(design: Design) -> dict[str, Required]:
    """The requirements that a straight leg can judge, by name, in the order of the verdict."""
    return {name: given for name, given in all_required(design).items() if given.on not in of_kind("flight")}


def all_required(design: Design) -> dict[str, Required]:
    """Requirements of a design: the `required` ones, and those that only a flight can judge."""
    usual: float = design.requirements.confidence
    requirements = {}
    of_autofocus = limits_of_autofocus(design)
    for name in [name for name, figure in FIGURES.items() if figure.requirement]:
        limits = of_autofocus.get(name, ())
        if (limit := getattr(design.requirements, name)) is not None:
            limits = (*limits, (limit, _factor(name, usual)))
        unit, dimension = design.unit(f"requirements.{name}"), limit_on(name).dimension
        given = [Required(name, None, limit, dimension, unit, factor) for limit, factor in limits]
        if given:
            requirements[name] = min(given, key=lambda each: each.at_one_sigma)
    figures = {contributor.name: contributor.enters for contributor in design.contributors}
    for limit in design.limits:
        if limit.name in requirements:
            raise InputError(limit.where, "is the name of a requirement that is given too. Rename it.", limit.name)
        factor = _factor(figures.get(limit.on, limit.on), limit.confidence or usual)
        unit = limit.unit or DIMENSIONS[limit.dimension].default_unit
        requirements[limit.name] = Required(limit.on, limit.at, limit.value, limit.dimension, unit, factor)
    return requirements


def limits_of_autofocus(design: Design) -> Mapping[str, tuple[tuple[float, float | None], ...]]:
    """Limits that an autofocus has itself: figure -> limit in SI, with its confidence. [S-9], [S-10]"""
    if not design.autofocus.works:
        return {}
    radar = design.radar
    cell = radar.azimuth_resolution if radar.range_resolution is None else radar.range_resolution
    migrates = design.autofocus.migration == "stays"
    return {
        "phase_before_autofocus": ((design.autofocus.captured, _SIGMAS_CAPTURED),),
        "path_before_autofocus": ((cell / 2, design.requirements.confidence),) if migrates else (),
        "autofocus_estimation": ((_MOST_ESTIMATION, None),),
    }


def flown_names(design: Design) -> tuple[str, ...]:
    """Names of the checks that a flight makes, in the order of the verdict.

    With a plan, all requirements on figures that are known along a flight, and what single lines limit beside them;
    without one, those that a straight leg does not tell, on a straight flight of ``trajectory.duration``.
    """
    return tuple(flight_required(design, every=design.trajectory.planned))


def flies(design: Design) -> bool:
    """True if a flight judges anything of a design; limits of lines without a plan are refused there."""
    return bool(flown_names(design) or design.trajectory.limits)


def flight_required(design: Design, *, every: bool) -> dict[str, Required]:
    """The requirements that a flight checks, by name; `every`: on all figures known along one, not only on those that
    a straight leg does not tell."""
    on = IN_FLIGHT if every else of_kind("flight")
    requirements = all_required(design)
    given = {name: required for name, required in requirements.items() if required.on in on}
    if not every:
        return given
    limited = {required.on for required in given.values()}
    for figure, limit in sorted(design.trajectory.lowest_limits.items(), key=lambda item: IN_FLIGHT.index(item[0])):
        if figure not in limited:
            declared = FIGURES[figure]
            name = figure if figure not in requirements else declared.label  # a limit of the user's own has its name
            unit = design.unit(f"requirements.{figure}")
            given[name] = Required(figure, None, limit, declared.dimension, unit, confidence_of(design, figure))
    return given


def check_names(design: Design) -> tuple[str, ...]:
    """Names of all checks of a design's verdict, in its order, without computing figures."""
    return tuple(dict.fromkeys((*all_required(design), *flown_names(design))))


def lowest_limit(design: Design, figure: str) -> Required | None:
    """The limit that decides on a figure, of its requirement and the user's own limits on it; those at a time of the
    outage aside. None without any."""
    given = [each for each in all_required(design).values() if (each.on, each.at) == (figure, None)]
    return min(given, key=lambda each: each.at_one_sigma, default=None)


def decisive(design: Design, figure: str) -> tuple[float, float | None]:
    """The confidence at which a figure is told where it is compared, and the limit on it [SI]: those of the lowest
    limit, else that of the requirements and None."""
    lowest = lowest_limit(design, figure)
    return (confidence_of(design, figure), None) if lowest is None else (lowest.confidence or 1.0, lowest.limit)


def _factor(figure: str, confidence: float) -> float | None:
    return confidence if FIGURES[figure].scaled else None


def confidence_of(design: Design, figure: str) -> float:
    """The design's factor on a figure's one sigma before it is compared with a limit."""
    return _factor(figure, design.requirements.confidence) or 1.0


def limit_on(name: str) -> BaseQuantity[float | None]:
    """The declaration of the requirement that limits a figure."""
    return quantity(f"requirements.{name}")


def judge(design: Design, processing: str, compose: Callable[[str, float | None, bool], Composed]) -> Verdict:
    """Check every requirement that a straight leg can judge.

    In steady state the prior, the worst of the cycle, is checked unless the design chooses otherwise; after
    the last fix the refined curve, which is right on the unsafe side.

    Parameters
    ----------
    design : Design
    processing : str
    compose : callable
        Name of a figure or contributor, the time in the outage, and whether a limit of the user's own asks -> it.
    """
    limits = {limit.name for limit in design.limits}
    checks = []
    for name, requirement in required(design).items():
        figure = compose(requirement.on, requirement.at, name in limits)
        checks.append(
            check_of(
                name,
                requirement,
                float(figure.sigma),
                basis=figure.basis,
                equation=figure.mark,
                shares=figure.shares,
            )
        )
    return Verdict(processing, design.requirements.confidence, tuple(checks))


def check_of(name: str, requirement: Required, sigma: float, **others: Any) -> Check:
    """A requirement compared with one sigma of its figure [SI]; nan: it is open.

    others: fields of `Check` beyond their usual values, which are those of a straight leg.
    """
    value = (requirement.confidence or 1.0) * sigma
    usual: dict[str, Any] = {
        "state": "open" if math.isnan(value) else "met" if value <= requirement.limit else "not met",
        "judged": STRAIGHT_LEG,
        "straight": None,
        "reason": "",
        "basis": "",
        "equation": "",
        "shares": _NO_SHARES,
    }
    return Check(
        name=name,
        on=requirement.on,
        label=label_of(name),
        dimension=requirement.dimension,
        unit=requirement.unit,
        confidence=requirement.confidence,
        value=value,
        sigma=sigma,
        limit=requirement.limit,
        margin=1 - value / requirement.limit,
        **usual | others,
    )


def with_flight(design: Design, straight: Verdict, flight: tuple[Check, ...] | None) -> Verdict:
    """A straight leg's verdict with the checks of the flight, which are open while there are none."""
    legs = {check.name: check for check in straight.checks}
    if flight is None:
        flight = tuple(
            check_of(
                name,
                requirement,
                math.nan,
                judged=WHOLE_FLIGHT,
                straight=legs[name].value if name in legs else None,
                reason="the flight is not computed yet",
            )
            for name, requirement in flight_required(design, every=design.trajectory.planned).items()
        )
    of_flight = {check.name: check for check in flight}
    # In the order of the requirements; what single lines limit comes last.
    names = dict.fromkeys((*all_required(design), *of_flight))
    return replace(straight, checks=tuple(of_flight.get(name) or legs[name] for name in names))

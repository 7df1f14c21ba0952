"""The verdict: each requirement against its figure, with margin and dominant source."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Composed, Shares
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.figures import FIGURES, label_of, of_kind
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
        """The share of the dominant source."""
        return self.shares[self.dominant]

    @property
    def sensor(self) -> str:
        """The sensor responsible for the largest share."""
        return max(self.by_sensor, key=lambda source: self.by_sensor[source])

    @property
    def sensor_share(self) -> float:
        """The share of that sensor."""
        return self.by_sensor[self.sensor]

    @cached_property
    def by_sensor(self) -> Shares:
        """Shares by sensor: the initial tilt counts for the noises that cause it, tilt growth in a coast for the
        gyros. [T-18]"""
        charged: dict[str, float] = {}
        for source, share in self.shares.items():
            for sensor, part in self._causes(source).items():
                charged[sensor] = charged.get(sensor, 0.0) + share * part
        return FrozenMapping(charged)

    def _causes(self, source: str) -> Shares:
        """The noises that cause a source, with their shares in it; itself where it is one. [T-18]"""
        if source == "coast before aperture":
            return FrozenMapping({"gyro noise": 1.0})
        return self.tilt_shares if source == "initial tilt" else FrozenMapping({source: 1.0})


@dataclass(frozen=True)
class Verdict:
    """All checks, in the order of the requirements; ``tightest`` is the one with the least margin.

    ``processing`` is the mode that the figures belong to: "real time" or "post-processed". ``elsewhere`` names the
    requirements that only a flight can judge; with one of them, a budget alone does not close.
    """

    processing: str
    closes: bool
    confidence: float
    checks: tuple[Check, ...]
    tightest: Check | None
    elsewhere: tuple[str, ...] = ()

    @property
    def met(self) -> bool:
        """Whether every requirement that a budget can judge is met."""
        return all(check.met for check in self.checks)


def required(design: Design) -> dict[str, Required]:
    """Name of each check of a budget -> its requirement, in the order of the verdict, without computing figures."""
    return {name: given for name, given in all_required(design).items() if given.on not in of_kind("flight")}


def all_required(design: Design) -> dict[str, Required]:
    """The same with those that only a flight can judge."""
    usual: float = design.requirements.confidence
    requirements = {}
    for name, key in {name: figure.required_as for name, figure in FIGURES.items() if figure.required_as}.items():
        if (limit := getattr(design.requirements, key)) is not None:
            unit, factor = design.unit(f"requirements.{key}"), _factor(name, usual)
            requirements[name] = Required(name, None, limit, limit_on(name).dimension, unit, factor)
    figures = {contributor.name: contributor.enters for contributor in design.contributors}
    for limit in design.limits:
        if limit.name in requirements:
            raise InputError(limit.where, "is the name of a requirement that is given too. Rename it.", limit.name)
        factor = _factor(figures.get(limit.on, limit.on), limit.confidence or usual)
        unit = limit.unit or DIMENSIONS[limit.dimension].default_unit
        requirements[limit.name] = Required(limit.on, limit.at, limit.value, limit.dimension, unit, factor)
    return requirements


def judged_elsewhere(design: Design) -> tuple[str, ...]:
    """Names of the requirements that only a flight can judge."""
    return tuple(name for name, given in all_required(design).items() if given.on in of_kind("flight"))


def lowest_limit(design: Design, figure: str) -> Required | None:
    """That which decides on a figure, of its requirement and the user's own limits on it; those at a time of the
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
    return quantity(f"requirements.{FIGURES[name].required_as}")


def judge(
    design: Design, processing: str, compose: Callable[[str, float | None, bool], Composed], tilt_shares: Shares
) -> Verdict:
    """Check every requirement that is given.

    In steady state the prior, the worst of the cycle, is checked unless the design chooses otherwise; after
    the last fix the refined curve, which is right on the unsafe side. The limit on quadratic phase holds for
    the along-track term [S-2] as well, which has its own check because other sensors cause it.

    Parameters
    ----------
    design : Design
    processing : str
    compose : callable
        Name of a figure or contributor, the time in the outage, and whether a limit of the user's own asks -> it.
    tilt_shares : mapping
        Shares of the sources in the tilt at the start of the aperture.
    """
    limits = {limit.name for limit in design.limits}
    checks = []
    for name, requirement in required(design).items():
        figure, limit = compose(requirement.on, requirement.at, name in limits), requirement.limit
        sigma = float(figure.sigma)
        value = (requirement.confidence or 1.0) * sigma
        checks.append(
            Check(
                name=name,
                on=requirement.on,
                label=label_of(name),
                dimension=requirement.dimension,
                confidence=requirement.confidence,
                value=value,
                sigma=sigma,
                limit=limit,
                margin=1 - value / limit,
                met=value <= limit,
                basis=figure.basis,
                equation=figure.mark,
                shares=figure.shares,
                tilt_shares=tilt_shares,
            )
        )
    tightest = min(checks, key=lambda check: check.margin, default=None)
    elsewhere = judged_elsewhere(design)
    closes = all(check.met for check in checks) and not elsewhere
    return Verdict(processing, closes, design.requirements.confidence, tuple(checks), tightest, elsewhere)

"""Contributors of the user's own in the figures that they enter.

A figure is the root of the sum of squares of what is random, the model's included, plus the sum of what is
systematic. A length along the line of sight enters a phase by 4π/λ. Source: JCGM 100:2008, 5.1, for the random part;
ECSS-E-ST-60-10C, for adding the systematic one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from nav_model.base.frozen import FrozenMapping
from nav_model.design import Design
from nav_model.design.contributors import BOTH, SYSTEMATIC, Contributor
from nav_model.design.figures import FIGURES

_PERSISTS_IN_OUTAGE = {f"{axis}_position": (f"coast_{axis}_position",) for axis in ("horizontal", "vertical")}
# What is off in position while fixes come in, such as a datum or a time offset, is off without them too.

Shares = Mapping[str, float]
"""Source -> its share of a figure; they add up to one."""
_NO_SHARES: Shares = FrozenMapping({})


@dataclass(frozen=True)
class Contribution:
    """A contributor that is not zero: its size in the figure that it enters, 1σ in SI, with the allowance."""

    name: str
    size: Any
    systematic: bool
    processing: str


@dataclass(frozen=True)
class Contributors:
    """Contributions to each figure (`in_figures`), and each contributor by itself (`alone`), for a limit on it."""

    in_figures: Mapping[str, tuple[Contribution, ...]] = field(default_factory=lambda: FrozenMapping({}))
    alone: Mapping[str, tuple[Contribution, ...]] = field(default_factory=lambda: FrozenMapping({}))

    def composed(
        self,
        name: str,
        processing: str,
        model: Any = 0.0,
        of_model: Mapping[str, Any] = _NO_SHARES,
        basis: str = "",
        mark: str = "",
    ) -> "Composed":
        """A figure of the model with what enters it in one processing, or the contributor of that name.

        Parameters
        ----------
        name, processing : str
        model, of_model, basis, mark
            As `Composed`.
        """
        parts = (self.in_figures if name in FIGURES else self.alone).get(name, ())
        entering = tuple(part for part in parts if part.processing in (BOTH, processing))
        return Composed(model, of_model, entering, basis, mark)

    def __bool__(self) -> bool:
        return bool(self.in_figures)


@dataclass(frozen=True)
class Composed:
    """A figure of the model with its contributors; numbers or arrays, SI.

    Attributes
    ----------
    model : float or array
        The model's one sigma.
    of_model : mapping
        Source -> its share in the model's variance.
    parts : tuple of Contribution
        Contributors that enter it.
    basis, mark : str
        Name of the model's result (prior, refined, formula ...), and its equation.
    """

    model: Any
    of_model: Mapping[str, Any] = field(default_factory=lambda: _NO_SHARES)
    parts: tuple[Contribution, ...] = ()
    basis: str = ""
    mark: str = ""

    @cached_property
    def random(self) -> Any:
        """Root of the sum of squares of what is random, the model among it."""
        squares = [part.size**2 for part in self.parts if not part.systematic]
        return np.sqrt(self.model**2 + sum(squares)) if squares else self.model

    @cached_property
    def systematic(self) -> Any:
        """Sum of what is systematic."""
        return sum(part.size for part in self.parts if part.systematic)

    @cached_property
    def sigma(self) -> Any:
        """One sigma with the contributors."""
        return self.random + self.systematic if self.parts else self.model

    @cached_property
    def shares(self) -> Mapping[str, Any]:
        """Share of each source: the figure's logarithmic derivative by the source's size.

        They add up to one, and are those in the variance where nothing is systematic.
        """
        if not self.parts:
            return self.of_model
        random, whole, model = self.random, self.sigma, self.model
        nothing = isinstance(random, float) and random == 0.0  # random; then the model has no part in it
        square = 1.0 if nothing else random * whole
        mixed = {source: share * (model * model / square) for source, share in self.of_model.items()}
        for part in self.parts:
            size = part.size
            mixed[part.name] = size / whole if part.systematic else size * size / square
        return FrozenMapping(mixed)

    @cached_property
    def sizes(self) -> Mapping[str, Any]:
        """One sigma of each source by itself."""
        sizes = {source: self.model * share**0.5 for source, share in self.of_model.items()}
        return sizes | {part.name: part.size for part in self.parts}

    def around(self, model: Any, of_model: Mapping[str, Any] = _NO_SHARES) -> "Composed":
        """Another value of the model, 1σ, with the contributors of this figure."""
        return replace(self, model=model, of_model=of_model)


def contributors_of(design: Design, wavelength: Any, counted: Mapping[str, Any] | None = None) -> Contributors:
    """Contributions to each figure of a design, with the wavelength [m] that turns lengths into phases.

    `counted` has the values with their allowance by name, SI, if they are not those of the design that are not zero.
    """
    if counted is None:
        counted = {
            contributor.name: contributor.counted for contributor in design.contributors if contributor.counted
        }
    in_figures: dict[str, tuple[Contribution, ...]] = {}
    alone: dict[str, tuple[Contribution, ...]] = {}
    for contributor in design.contributors:
        if (name := contributor.name) in counted:
            into = FIGURES[contributor.enters].dimension
            part = Contribution(name, counted[name], contributor.kind == SYSTEMATIC, contributor.processing)
            entering = replace(part, size=as_phase(part.size, contributor.dimension, into, wavelength))
            # The outage's figure is one in both processings, so that what holds in one alone is not in it.
            lasts = _PERSISTS_IN_OUTAGE.get(contributor.enters, ()) if contributor.processing == BOTH else ()
            for figure in (contributor.enters, *_also(contributor.enters), *lasts):
                in_figures[figure] = (*in_figures.get(figure, ()), entering)
            alone[name] = (part,)
    return Contributors(FrozenMapping(in_figures), FrozenMapping(alone))


def _also(figure: str) -> Iterable[str]:
    """A part of a phase is in the phase of the image, and what enters that is along the line of sight."""
    return filter(FIGURES.__contains__, (FIGURES[figure].whole, f"line_of_sight_{figure}"))


def size_of(contributor: Contributor, wavelength: Any) -> Any:
    """1σ of the figure that a contributor enters, SI, with its allowance."""
    return as_phase(contributor.counted, contributor.dimension, FIGURES[contributor.enters].dimension, wavelength)


def as_phase(value: Any, dimension: str, into: str, wavelength: Any) -> Any:
    """A value in a figure: a length along the line of sight as a phase where that is one.

    Parameters
    ----------
    value : float or array
        SI.
    dimension, into : str
        Dimensions of the value and of the figure.
    wavelength : float or array
        m.
    """
    return 4 * math.pi / wavelength * value if (dimension, into) == ("length", "angle") else value

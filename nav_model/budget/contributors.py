"""Contributors of the user's own in the figures that they enter.

A figure is the root of the sum of squares of what is random, the model's included, plus the sum of what is
systematic. A length along the line of sight enters a phase by 4π/λ. Source: JCGM 100:2008, 5.1, for the random part;
ECSS-E-ST-60-10C, for adding the systematic one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
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

    def entering(self, name: str, processing: str) -> tuple[Contribution, ...]:
        """Contributions to a figure in one processing, or the contributor of that name."""
        parts = (self.in_figures if name in FIGURES else self.alone).get(name, ())
        return tuple(part for part in parts if part.processing in (BOTH, processing))

    def __bool__(self) -> bool:
        return bool(self.in_figures)


@dataclass(frozen=True)
class Composed:
    """A figure with its contributors: 1σ in SI, the share of each source, and its size; numbers or arrays.

    A share is the figure's logarithmic derivative by the source's size, so that all add up to one: that in the
    variance where nothing is systematic. ``model`` is the figure without contributors. ``basis`` says which of the
    model's results it is (prior, refined, formula ...), ``mark`` where that comes from.
    """

    sigma: Any
    shares: Mapping[str, Any]
    sizes: Mapping[str, Any]
    model: Any
    basis: str = ""
    mark: str = ""


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


def with_contributors(sigma: Any, parts: Iterable[Contribution]) -> Any:
    """A figure, 1σ, with what enters it; numbers or arrays that broadcast."""
    root, systematic = random_and_systematic(sigma, parts)
    return root + systematic


def random_and_systematic(sigma: Any, parts: Iterable[Contribution]) -> tuple[Any, Any]:
    """Root of the sum of squares of the random, the model's `sigma` among them, and sum of the systematic."""
    parts = tuple(parts)
    squares = [part.size**2 for part in parts if not part.systematic]
    root = np.sqrt(sigma**2 + sum(squares)) if squares else sigma
    return root, sum(part.size for part in parts if part.systematic)


def composed(
    sigma: Any, shares: Mapping[str, Any], parts: tuple[Contribution, ...], basis: str = "", mark: str = ""
) -> Composed:
    """A figure of the model with what enters it; numbers or arrays.

    Parameters
    ----------
    sigma : float or array
        The model's, 1σ.
    shares : mapping
        Source -> share in its variance.
    parts : tuple of Contribution
        Contributors that enter it.
    basis, mark : str, optional
        Name of the model's result, and its equation.
    """
    sizes = {source: sigma * share**0.5 for source, share in shares.items()}
    if not parts:
        return Composed(sigma, shares, sizes, sigma, basis, mark)
    root, systematic = random_and_systematic(sigma, parts)
    whole = root + systematic
    scale = sigma * sigma / (root * whole)
    mixed = {source: share * scale for source, share in shares.items()}
    for part in parts:
        size = part.size
        mixed[part.name] = size / whole if part.systematic else size * size / (root * whole)
        sizes[part.name] = size
    return Composed(whole, FrozenMapping(mixed), sizes, sigma, basis, mark)

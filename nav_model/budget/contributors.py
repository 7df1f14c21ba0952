"""Contributors of the user's own in the figures that they enter.

A figure is the root of the sum of squares of what is random, the model's included, plus the sum of what is
systematic. A length along the line of sight enters a phase by 4π/λ. Source: JCGM 100:2008, 5.1, for the random part;
ECSS-E-ST-60-10C, for adding the systematic one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from nav_model.base.frozen import FrozenMapping
from nav_model.design import Design
from nav_model.design.contributors import BOTH, ENTERED, SYSTEMATIC, Contributor
from nav_model.design.processing import POST_PROCESSED, REAL_TIME


@dataclass(frozen=True)
class Part:
    """A contributor that is not zero: its size in the figure that it enters, 1σ in SI, with the allowance."""

    name: str
    size: Any
    systematic: bool
    processing: str


Shares = Mapping[str, float]
Parts = Mapping[str, tuple[Part, ...]]
"""Figure, or limit of the user's own -> what enters it."""

NONE: Parts = FrozenMapping({})


@dataclass(frozen=True)
class Composed:
    """A figure with its contributors: 1σ in SI, the share of each source, and its size; numbers or arrays.

    A share is the figure's logarithmic derivative by the source's size, so that all add up to one: that in the
    variance where nothing is systematic.
    """

    sigma: Any
    shares: Mapping[str, Any]
    sizes: Mapping[str, Any]


def parts_of(design: Design, wavelength: Any) -> Parts:
    """What enters each figure of a design, with the wavelength [m] that turns lengths into phases.

    A limit on a figure has what enters that figure; a limit on a contributor has the contributor alone, unturned.
    """
    found: dict[str, tuple[Part, ...]] = {}
    alone: dict[str, tuple[Part, ...]] = {}
    for one in design.contributors:
        if one.counted:
            part = Part(one.name, size_of(one, wavelength), one.kind == SYSTEMATIC, one.processing)
            found[one.enters] = (*found.get(one.enters, ()), part)
            alone[one.name] = (Part(one.name, one.counted, one.kind == SYSTEMATIC, one.processing),)
    of_limits = {limit.name: (alone | found).get(limit.on, ()) for limit in design.limits}
    return FrozenMapping(found | of_limits)


def size_of(one: Contributor, wavelength: Any) -> Any:
    """1σ of the figure that a contributor enters, SI, with its allowance."""
    return turned(one.counted, one.dimension, ENTERED[one.enters], wavelength)


def turned(value: Any, dimension: str, into: str, wavelength: Any) -> Any:
    """A value in a figure of the dimension `into`: a length along the line of sight as a phase where that is one."""
    return 4 * math.pi / wavelength * value if (dimension, into) == ("length", "angle") else value


def entering(parts: Parts, figure: str, *, post_processed: bool) -> tuple[Part, ...]:
    """What enters a figure in one processing."""
    counted = (BOTH, POST_PROCESSED if post_processed else REAL_TIME)
    return tuple(part for part in parts.get(figure, ()) if part.processing in counted)


def with_contributors(sigma: Any, parts: Iterable[Part]) -> Any:
    """A figure, 1σ, with what enters it; numbers or arrays that broadcast."""
    root, systematic = random_and_systematic(sigma, parts)
    return root + systematic


def random_and_systematic(sigma: Any, parts: Iterable[Part]) -> tuple[Any, Any]:
    """Root of the sum of squares of the random, the model's `sigma` among them, and sum of the systematic."""
    parts = tuple(parts)
    squares = [part.size**2 for part in parts if not part.systematic]
    root = np.sqrt(sigma**2 + sum(squares)) if squares else sigma
    return root, sum(part.size for part in parts if part.systematic)


def composed(sigma: Any, shares: Mapping[str, Any], parts: tuple[Part, ...]) -> Composed:
    """A figure of the model, 1σ, whose `shares` are those in its variance, with what enters it; numbers or arrays."""
    sizes = {source: sigma * share**0.5 for source, share in shares.items()}
    if not parts:
        return Composed(sigma, shares, sizes)
    root, systematic = random_and_systematic(sigma, parts)
    whole = root + systematic
    scale = sigma * sigma / (root * whole)
    mixed = {source: share * scale for source, share in shares.items()}
    for part in parts:
        size = part.size
        mixed[part.name] = size / whole if part.systematic else size * size / (root * whole)
        sizes[part.name] = size
    return Composed(whole, FrozenMapping(mixed), sizes)

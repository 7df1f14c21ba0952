"""The verdict as a probability, when inputs are ranges instead of numbers.

Data-sheet values are typical or maximum, and units vary. Each uncertain input is given a distribution; scrambled
Sobol points, a quasi-Monte Carlo rule, are pushed through the closed forms. The error bar comes from independent
scramblings, each an unbiased estimate.

Source: Owen, *Randomly permuted (t,m,s)-nets and (t,s)-sequences*, 1995; L'Ecuyer and Lemieux, 2002.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, quoted
from nav_model.budget.inputs import VARIABLES
from nav_model.budget.refusals import imaged_inputs
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.explore.margins import needed_limits, ratios, worst

SCRAMBLINGS = 10
POINTS = 1024  # of each; a power of two keeps the points balanced
_STUDENT_95 = 2.2621571628540993  # two-sided 95 % of Student's t with 9 degrees of freedom
_QUANTILES = (0.05, 0.5, 0.95)
_DRAWN = (0.005, 0.995)  # quantiles between which the histogram is
_BINS = 40

Kind = Literal["uniform", "log-uniform", "lognormal"]


@dataclass(frozen=True)
class Uncertain:
    """One input's distribution, SI.

    "uniform" and "log-uniform" are between ``low`` and ``high``; "lognormal" has the median ``low`` and one
    standard deviation of a factor ``high``.
    """

    kind: Kind
    low: float
    high: float

    def at(self, fraction: Array) -> Array:
        """Quantiles: the value below which this fraction of units lies."""
        if self.kind == "uniform":
            return self.low + fraction * (self.high - self.low)
        if self.kind == "log-uniform":
            inside: Array = self.low * (self.high / self.low) ** fraction
            return inside
        from scipy.special import ndtri  # late: the command line starts without it

        spread: Array = self.low * self.high ** ndtri(fraction)
        return spread


@dataclass(frozen=True)
class Probability:
    """A probability with the ends of its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class UncertainVerdict:
    """Probability that a design closes.

    ``margin`` holds the 5, 50 and 95 % quantiles of the tightest margin; ``each`` the probability of every
    requirement by itself; ``limiting`` how often each is the tightest. ``histogram``: edges of bins of the tightest
    margin, multiples of their width, and the share of the designs in each; half a per cent at either end is left out.
    """

    designs: int
    closes: Probability
    margin: tuple[float, float, float]
    each: Mapping[str, Probability]
    limiting: Mapping[str, float]
    histogram: tuple[tuple[float, ...], tuple[float, ...]]


def read_uncertain(key: str, text: str) -> Uncertain:
    """A distribution as written: ``"0.1 °/√h .. 0.2 °/√h"``, the same with ``log`` behind, ``"0.15 °/√h */ 1.3"``.

    The first is uniform, the second log-uniform, the third lognormal about a typical value.

    Raises
    ------
    InputError
        Naming the key, what was given and what is allowed.
    """
    declaration = quantity(key)
    if key not in VARIABLES:
        raise InputError(key, f"cannot be uncertain; allowed are {', '.join(VARIABLES)}")
    if "*/" in text:
        middle, _, factor = text.partition("*/")
        spread = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*", factor)
        if not spread or not 1 < float(spread[1]) <= 10:
            raise InputError(
                key, f"{quoted(text)}: the factor behind */ must be a number above 1 and at most 10", text
            )
        return Uncertain("lognormal", declaration.read(middle.strip()).value, float(spread[1]))
    body, log, _ = text.partition(" log")
    low, dots, high = body.partition("..")
    if not dots:
        raise InputError(
            key, f"{quoted(text)} is not a range. Write LOW .. HIGH, LOW .. HIGH log, or TYPICAL */ FACTOR.", text
        )
    ends = declaration.read(low.strip()).value, declaration.read(high.strip()).value
    if not ends[0] < ends[1]:
        raise InputError(key, f"{quoted(text)}: the lower end must be below the upper", text)
    if log and ends[0] <= 0:
        raise InputError(key, f"{quoted(text)}: a log range must start above zero", text)
    return Uncertain("log-uniform" if log else "uniform", *ends)


def uncertain_verdict(
    design: Design, inputs: Mapping[str, Uncertain], seed: int = 1, points: int = POINTS
) -> UncertainVerdict:
    """Probability that the design closes when some inputs are uncertain and independent.

    Parameters
    ----------
    design : Design
    inputs : mapping
        Dotted key -> distribution.
    seed : int
        Of the scramblings; the same seed gives the same answer.
    points : int
        Of each of the `SCRAMBLINGS`, a power of two.

    Raises
    ------
    InputError
        If no input or no requirement is given, a distribution leaves its input's bounds, the design is one that
        `analyse` refuses, or so is every design of the distributions.

    Examples
    --------
    >>> from nav_model import read_design, read_uncertain, uncertain_verdict
    >>> design = read_design("examples/mems_x_band.toml")
    >>> key = "imu.angle_random_walk"
    >>> chance = uncertain_verdict(design, {key: read_uncertain(key, "0.01 °/√h .. 0.03 °/√h")})
    >>> 0 < chance.closes.low < chance.closes.high < 1
    True
    """
    imaged_inputs(design)
    if not inputs:
        raise InputError("uncertainty", "No input is uncertain. Give at least one range.")
    names = list(needed_limits(design, "judge"))
    columns = _samples(inputs, seed, points)
    total = SCRAMBLINGS * points
    by_limit = {name: np.broadcast_to(ratio, total) for name, ratio in ratios(design, columns).items()}
    largest = worst(by_limit)
    if not np.isfinite(largest).any():
        raise InputError(
            next(iter(inputs)), "No value of its range leaves an image. Give a range around the design's."
        )
    tightest = np.argmax(np.stack([by_limit[name] for name in names]), axis=0)
    margins = 1 - largest[np.isfinite(largest)]
    low, middle, high = (float(q) for q in np.quantile(margins, _QUANTILES))
    return UncertainVerdict(
        designs=total,
        closes=_probability(np.less_equal(largest, 1)),
        margin=(low, middle, high),
        each={name: _probability(np.less_equal(ratio, 1)) for name, ratio in by_limit.items()},
        limiting={name: float(np.mean(tightest == i)) for i, name in enumerate(names)},
        histogram=_histogram(margins),
    )


def _histogram(margins: Array) -> tuple[tuple[float, ...], tuple[float, ...]]:
    low, high = np.quantile(margins, _DRAWN)
    width = max((high - low) / _BINS, 1e-6)
    edges = width * np.arange(np.floor(low / width), np.floor(high / width) + 2)
    return tuple(edges.tolist()), tuple((np.histogram(margins, edges)[0] / len(margins)).tolist())


def _samples(inputs: Mapping[str, Uncertain], seed: int, points: int) -> dict[str, Array]:
    from scipy.stats.qmc import Sobol  # late: half a second that a command without it need not spend

    streams = np.random.SeedSequence(seed).spawn(SCRAMBLINGS)
    cube = np.concatenate(
        [Sobol(len(inputs), scramble=True, rng=np.random.default_rng(s)).random(points) for s in streams]
    )
    columns = {}
    for (key, uncertain), fraction in zip(inputs.items(), cube.T, strict=True):
        values = uncertain.at(np.clip(fraction, 2.0**-40, 1 - 2.0**-40))
        low, high = quantity(key).limits
        if values.min() < low or values.max() > high:
            raise InputError(key, f"The distribution reaches beyond the allowed range. {quantity(key).allowed()}")
        columns[key] = values
    return columns


def _probability(met: NDArray[np.bool_]) -> Probability:
    """Mean over the scramblings with a 95 % interval, never narrower than three designs in all of them.

    Where every design agrees the scatter is zero, yet the true probability may still be off by the rule of three.
    """
    means = met.reshape(SCRAMBLINGS, -1).mean(axis=1)
    value = float(means.mean())
    half = max(_STUDENT_95 * float(means.std(ddof=1)) / SCRAMBLINGS**0.5, 3 / met.size)
    return Probability(value, max(value - half, 0.0), min(value + half, 1.0))

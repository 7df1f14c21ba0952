"""Shares of each source in a variance, by complex steps through the closed forms and the smoother. [T-18], [P-4]"""

import math
from collections.abc import Mapping
from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np

from nav_model.analytic.discrete import SlowError
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import Shares
from nav_model.budget.inputs import RECTIFICATION, VARIABLES, Inputs
from nav_model.design.figures import LEVELS
from nav_model.design.parts import quantity

GNSS_NOISE, ACCELEROMETER_NOISE, GYRO_NOISE = "GNSS noise", "accelerometer noise", "gyro noise"
ACCELEROMETER_BIAS, GYRO_BIAS, SLOW_GNSS = "accelerometer bias", "gyro bias", "slow GNSS error"

GNSS_VELOCITY = "GNSS velocity noise"
ESTIMATION = "autofocus estimation"

_STEP = 1e-20
_LOST = 0.01
"""Part of a variance by which the shares may miss it, beyond which its digits are lost to rounding."""
_VARYING = {
    "accelerometer bias instability": ("instability_a",),
    "gyro bias instability": ("instability_w",),
    "accelerometer bias random walk": ("walk_a",),
    "gyro bias random walk": ("walk_w",),
}
_CONSTANT = {
    "accelerometer turn-on bias": ("turn_on_a",),
    "gyro turn-on bias": ("turn_on_w",),
    "gyro scale factor": ("scale_w",),
    "accelerometer misalignment": ("misalignment_a",),
    "gyro misalignment": ("misalignment_w",),
    "gyro g-sensitivity": ("g_sensitivity",),
}
_SIZES = {
    ACCELEROMETER_NOISE: ("sigma_a",),
    GYRO_NOISE: ("sigma_w",),
    GNSS_NOISE: ("fix", "fix_vertical"),
    GNSS_VELOCITY: ("velocity", "velocity_vertical"),
    SLOW_GNSS: ("slow",),
    ACCELEROMETER_BIAS: ("bias_a",),
    GYRO_BIAS: ("bias_w",),
    RECTIFICATION: ("rectified",),
    ESTIMATION: ("estimation",),
    **_VARYING,
    **_CONSTANT,
}
"""Source of error -> the fields of `Inputs` that are its size, where they have other names than its declaration."""


def sizes_of(declared: Mapping[str, str]) -> Mapping[str, tuple[str, ...]]:
    """Source of error -> the fields of `Inputs` that are its size.

    Parameters
    ----------
    declared : mapping
        Name of an input -> the source that it is the size of.

    Raises
    ------
    LookupError
        For a source without a field.
    """
    sizes, known = dict(_SIZES), {field.name for field in fields(Inputs)}
    for name, source in declared.items():
        if source in _SIZES:
            continue
        if name not in known:
            raise LookupError(
                f"the source {source!r} has no size in nav_model.budget.inputs.Inputs: "
                f"give it the field {name!r}, or name its fields in nav_model.budget.shares"
            )
        sizes[source] = (*sizes.get(source, ()), name)
    return sizes


SIZES = sizes_of({key.partition(".")[2]: source for key in VARIABLES if (source := quantity(key).source)})
"""Source of error -> the inputs that are its size."""

SEEN = (ACCELEROMETER_NOISE, GYRO_NOISE, GNSS_NOISE, GNSS_VELOCITY, SLOW_GNSS, *_VARYING)
"""Sources that filter and smoother weigh; others reach figures beside them."""

CONSTANT = tuple(_CONSTANT)
"""Constant errors of the sensors, which a settled filter cancels or no fix shows."""


class Stepped:
    """The inputs of one design with each source's size stepped once, along axes of its own. [P-4]

    A source's share is the figure's logarithmic derivative by the source's size, taken by a complex step: the filter
    and the smoother are optimal, so it is the error of that source alone. All sources are stepped in one evaluation.

    Attributes
    ----------
    x : Inputs
    """

    def __init__(self, x: Inputs) -> None:
        self._weighed, self._beside, self.x = _stepped(x)
        self._fast = tuple(x.fast)

    def sized(self, name: str, values: Array) -> tuple[float, Shares]:
        """Value of a figure and the shares of its sources, where the variance is of degree one in theirs.

        Parameters
        ----------
        name : str
        values : array
            The figure, one sigma, of the stepped inputs.

        Raises
        ------
        FloatingPointError
            If its digits are lost to rounding.
        """
        table = np.broadcast_to(values, (len(self._beside) + 1, len(self._weighed) + bool(self._beside)))
        size = float(table.real[-1, -1])
        slopes = np.append(table.imag[-1, : len(self._weighed)], table.imag[:-1, -1])
        parts = slopes / ((size or 1.0) * _STEP)
        if size and name not in LEVELS and not abs(parts.sum() - 1) < _LOST:
            raise FloatingPointError(f"the shares of {name} add up to {parts.sum():.3g} instead of one")
        parts = np.maximum(parts, 0)
        # A figure of zero, or values so far apart that rounding hides every slope: the shares are unknown.
        known = parts if np.any(parts > 0) else np.ones_like(parts)
        shares = dict(zip((*self._weighed, *self._beside), known.tolist(), strict=True))
        if name in LEVELS:
            scattering = [*self._fast, *([ESTIMATION] if name == "islr" and shares.get(ESTIMATION) else [])]
            shares = {source: shares[source] for source in scattering}
        return size, _normalised(shares)


def _normalised(variances: Mapping[str, float]) -> Shares:
    whole = math.fsum(variances.values())
    return FrozenMapping(
        {source: variance / whole if whole else 1 / len(variances) for source, variance in variances.items()}
    )


def _stepped(x: Inputs) -> tuple[list[str], list[str], Inputs]:
    """Sources that filter and smoother see, those beside them, and the inputs with each stepped once.

    The former are stepped along the last axis and the latter along one before it, so that the filter runs for its own
    sources alone. Both axes then end with no step.
    """
    there = [name for name, fields in SIZES.items() if _present(x, fields[0])]
    seen = [name for name in there if name in SEEN]
    beside = [*(name for name in there if name not in SEEN), *x.fast]
    changes: dict[str, Any] = {}
    for name, factor in zip(seen, _factors(len(seen), len(seen) + bool(beside)), strict=True):
        for field in SIZES[name]:
            value = getattr(x, field)
            if isinstance(value, SlowError):
                horizontal, vertical = value.horizontal * factor, value.vertical * factor
                changes[field] = SlowError(horizontal, vertical, value.correlation_time)
            else:
                changes[field] = value * factor
    fast = dict(x.fast)
    for name, row in zip(beside, _factors(len(beside), len(beside) + 1), strict=True):
        factor = row[:, None]
        if name in fast:
            fast[name] = fast[name].scaled(factor)
        else:
            changes |= {field: getattr(x, field) * factor for field in SIZES[name]}
    return seen, beside, replace(x, **changes, fast=fast)


@cache
def _factors(count: int, size: int) -> Array:
    """Rows that each step one of `size` places, (count, size)."""
    return as_numbers(1 + 1j * _STEP * np.eye(count, size))


def _present(x: Inputs, field: str) -> bool:
    value = getattr(x, field)
    return value is not None and (isinstance(value, SlowError) or bool(np.any(value)))

"""Shares of each source in a variance, by complex steps through the closed forms and the smoother. [T-18], [P-4]"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from nav_model.analytic.discrete import SlowError
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.fast import LEVELS
from nav_model.budget.inputs import RECTIFICATION, Inputs

GNSS_NOISE, ACCELEROMETER_NOISE, GYRO_NOISE = "GNSS noise", "accelerometer noise", "gyro noise"
ACCELEROMETER_BIAS, GYRO_BIAS, SLOW_GNSS = "accelerometer bias", "gyro bias", "slow GNSS error"

GNSS_VELOCITY, SCENE_HEIGHT = "GNSS velocity noise", "scene height error"

_STEP = 1e-20
_LOST = 0.01
"""Part of a variance by which the shares may miss it, beyond which its digits are lost to rounding."""
_FIELDS: Mapping[str, tuple[str, ...]] = {
    ACCELEROMETER_NOISE: ("sigma_a",),
    GYRO_NOISE: ("sigma_w",),
    GNSS_NOISE: ("fix", "fix_vertical"),
    GNSS_VELOCITY: ("velocity", "velocity_vertical"),
    SLOW_GNSS: ("slow",),
    ACCELEROMETER_BIAS: ("bias_a",),
    GYRO_BIAS: ("bias_w",),
    SCENE_HEIGHT: ("scene_height_error",),
    RECTIFICATION: ("rectified",),
}
"""Source of error -> the inputs that are its size."""

_SEEN = (ACCELEROMETER_NOISE, GYRO_NOISE, GNSS_NOISE, GNSS_VELOCITY, SLOW_GNSS)
"""Sources that filter and smoother weigh; others reach figures beside them."""

Shares = Mapping[str, float]
"""Source -> its share of a variance; they add up to one."""


def shares_of(sized: Mapping[str, tuple[float, Shares]]) -> dict[str, Shares]:
    return {name: shares for name, (_, shares) in sized.items()}


def shares_by_step(x: Inputs, of: Callable[[Inputs], Mapping[str, Array]]) -> dict[str, tuple[float, Shares]]:
    """Value of each figure and the shares of its sources, where the variance is of degree one in theirs. [P-4]

    A source's share is the figure's logarithmic derivative by the source's size, taken by a complex step: the filter
    and the smoother are optimal, so it is the error of that source alone. All sources are stepped in one evaluation.

    Parameters
    ----------
    x : Inputs
        Of one design.
    of : callable
        Inputs to figures, one sigma each, which broadcasts.
    """
    seen, beside, stepped = _stepped(x)
    figures = of(stepped)
    table = np.empty((len(figures), len(beside) + 1, len(seen) + bool(beside)), complex)
    for one, value in zip(table, figures.values(), strict=True):
        one[:] = value
    sizes = table.real[:, -1, -1]
    slopes = np.hstack([table.imag[:, -1, : len(seen)], table.imag[:, :-1, -1]])
    parts = slopes / (np.where(sizes, sizes, 1.0)[:, None] * _STEP)
    for figure, size, whole in zip(figures, sizes, parts.sum(axis=1), strict=True):
        if size and figure not in LEVELS and not abs(whole - 1) < _LOST:
            raise FloatingPointError(f"the shares of {figure} add up to {whole:.3g} instead of one")
    parts = np.maximum(parts, 0)
    # A figure of zero, or values so far apart that rounding hides every slope: the shares are unknown.
    parts[~np.any(parts > 0, axis=1)] = 1.0
    return {
        figure: (size, _normalised(dict(zip((*seen, *beside), row, strict=True))))
        for figure, size, row in zip(figures, sizes.tolist(), parts.tolist(), strict=True)
    }


def _normalised(variances: Mapping[str, Array | float]) -> Shares:
    values = {source: float(variance) for source, variance in variances.items()}
    whole = math.fsum(values.values())
    return FrozenMapping({source: value / whole for source, value in values.items()})


def _stepped(x: Inputs) -> tuple[list[str], list[str], Inputs]:
    """Sources that filter and smoother see, those beside them, and the inputs with each stepped once.

    The former are stepped along the last axis and the latter along one before it, so that the filter runs for its own
    sources alone. Both axes then end with no step.
    """
    there = [name for name, fields in _FIELDS.items() if _present(x, fields[0])]
    seen = [name for name in there if name in _SEEN]
    beside = [*(name for name in there if name not in _SEEN), *x.fast]
    changes: dict[str, Any] = {}
    for name, factor in zip(seen, _factors(len(seen), len(seen) + bool(beside)), strict=True):
        for field in _FIELDS[name]:
            value = getattr(x, field)
            changes[field] = value._replace(sigma=value.sigma * factor) if field == "slow" else value * factor
    fast = dict(x.fast)
    for name, row in zip(beside, _factors(len(beside), len(beside) + 1), strict=True):
        factor = row[:, None]
        if name in fast:
            fast[name] = fast[name].scaled(factor)
        else:
            changes |= {field: getattr(x, field) * factor for field in _FIELDS[name]}
    return seen, beside, replace(x, **changes, fast=fast)


@cache
def _factors(count: int, size: int) -> Array:
    """Rows that each step one of `size` places, (count, size)."""
    return as_numbers(1 + 1j * _STEP * np.eye(count, size))


def _present(x: Inputs, field: str) -> bool:
    value = getattr(x, field)
    return value is not None and (isinstance(value, SlowError) or bool(np.any(value)))

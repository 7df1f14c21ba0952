"""Shares of each source in a variance, by linearity of the closed forms in the noises. [T-18]"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic.discrete import Sawtooth, SlowError
from nav_model.analytic.sensitivity import horizontal_parts, vertical_parts
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.frozen import FrozenMapping, Later
from nav_model.budget.figures import COASTING, settled
from nav_model.budget.inputs import RECTIFICATION, Inputs

GNSS_NOISE, ACCELEROMETER_NOISE, GYRO_NOISE = "GNSS noise", "accelerometer noise", "gyro noise"
ACCELEROMETER_BIAS, GYRO_BIAS, SLOW_GNSS = "accelerometer bias", "gyro bias", "slow GNSS error"

GNSS_VELOCITY, SCENE_HEIGHT = "GNSS velocity noise", "scene height error"

_STEP = 1e-20
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


class WhiteParts(NamedTuple):
    """What each white noise contributes to the settled covariance of a horizontal channel and of the vertical."""

    level: Mapping[str, Horizontal]
    upright: Mapping[str, Vertical]


Parts = Callable[[], WhiteParts]
"""Worked out when they are first asked for."""


def white_parts(x: Inputs) -> WhiteParts:
    """What the white noises contribute, in closed form. [T-18]"""
    if x.velocity is None:
        level, upright = horizontal_parts(x.sigma_a, x.sigma_w, x.s, x.g), vertical_parts(x.sigma_a, x.s_vertical)
        return WhiteParts(
            dict(zip((ACCELEROMETER_NOISE, GYRO_NOISE, GNSS_NOISE), level, strict=True)),
            dict(zip((ACCELEROMETER_NOISE, GNSS_NOISE), upright, strict=True)),
        )
    nothing = 0 * x.bias_a
    white = replace(x, slow=None, bias_a=nothing, bias_w=nothing, scene_height_error=nothing, rectified=None, fast={})
    names, _, stepped = _stepped(white)
    found = settled(stepped)

    def of(whole: Horizontal | Vertical) -> dict[str, Any]:
        elements = [np.broadcast_to(element, len(names)).imag / (2 * _STEP) for element in whole]
        return {name: type(whole)(*(element[n] for element in elements)) for n, name in enumerate(names)}

    return WhiteParts(of(found.horizontal), of(found.vertical))


def each(names: Iterable[str], work_out: Callable[[], Mapping[str, Shares]]) -> Mapping[str, Shares]:
    """Shares of each figure, all computed when one of them is first read."""
    found = Later(work_out)
    return FrozenMapping({name: Later(partial(found.__getitem__, name)) for name in names})


def shares_of(sized: Mapping[str, tuple[float, Shares]]) -> dict[str, Shares]:
    return {name: shares for name, (_, shares) in sized.items()}


def steady_shares(parts: WhiteParts, prior: Sawtooth, white: Sawtooth) -> Mapping[str, Shares]:
    """Shares in the settled variances, by kind: ``horizontal_position``, ``tilt`` and so on. [T-18]

    White noises share the closed form; a slow GNSS error has what the augmented filter's `prior` adds to `white`.
    """
    by_kind = {
        kind: dict(_normalised({name: getattr(part, element) for name, part in channel.items()}))
        for kind, channel, element in (
            ("horizontal_position", parts.level, "p11"), ("horizontal_velocity", parts.level, "p22"),
            ("tilt", parts.level, "p33"), ("vertical_position", parts.upright, "v11"),
            ("vertical_velocity", parts.upright, "v22"),
        )
    }  # fmt: skip
    return _with_slow(by_kind, prior, white)


def _with_slow(by_kind: dict[str, dict[str, float]], prior: Sawtooth, white: Sawtooth) -> Mapping[str, Shares]:
    """Shares in the settled variances with the slow GNSS error's, which reduces those of the white noises."""
    if prior is not white:
        pairs = {
            "horizontal_position": (prior.horizontal.p11, white.horizontal.p11),
            "horizontal_velocity": (prior.horizontal.p22, white.horizontal.p22),
            "tilt": (prior.horizontal.p33, white.horizontal.p33),
            "vertical_position": (prior.vertical.v11, white.vertical.v11),
            "vertical_velocity": (prior.vertical.v22, white.vertical.v22),
        }
        for kind, (with_slow, without) in pairs.items():
            kept = min(float(without / with_slow), 1.0)
            by_kind[kind] = {source: share * kept for source, share in by_kind[kind].items()}
            by_kind[kind][SLOW_GNSS] = 1 - kept
    return FrozenMapping({kind: FrozenMapping(shares) for kind, shares in by_kind.items()})


def coast_shares(
    x: Inputs, parts: WhiteParts, posterior: Sawtooth, white: Sawtooth, time: float
) -> Mapping[str, Shares]:
    """Shares in both figures of `COASTING`, `time` after the last fix, from the polynomials by linearity.

    A slow GNSS error has what the augmented start adds to the `white` one.
    """
    a, w, g = x.sigma_a, x.sigma_w, x.g
    bias_a, bias_w = (float(bias) ** 2 for bias in growth.bias_position(x.bias_a, x.bias_w, g, time))
    level: dict[str, Array | float] = {source: grown.position for source, grown in _grown(x, parts, time).items()}
    level |= {ACCELEROMETER_BIAS: bias_a, GYRO_BIAS: bias_w}
    upright: dict[str, Array | float] = {
        source: growth.vertical_growth(part, a if source == ACCELEROMETER_NOISE else 0.0, time).position
        for source, part in parts.upright.items()
    }
    upright[ACCELEROMETER_BIAS] = bias_a
    if x.rectified is not None:
        made = float(growth.bias_position(x.rectified, 0.0, g, time)[0]) ** 2
        level[RECTIFICATION] = upright[RECTIFICATION] = made
    if posterior is not white:
        slow, fast = (growth.horizontal_growth(m.horizontal, a, w, g, time) for m in (posterior, white))
        slow_v, fast_v = (growth.vertical_growth(m.vertical, a, time) for m in (posterior, white))
        level[SLOW_GNSS] = np.maximum(slow.position - fast.position, 0.0)
        upright[SLOW_GNSS] = np.maximum(slow_v.position - fast_v.position, 0.0)
    return dict(zip(COASTING, (_normalised(level), _normalised(upright)), strict=True))


def _grown(x: Inputs, parts: WhiteParts, time: ArrayLike) -> dict[str, growth.HorizontalGrowth]:
    """What each white noise has grown to `time` after the last fix, in a horizontal channel. [T-9], [T-18]"""
    own: dict[str, tuple[Array | float, Array | float]] = {
        ACCELEROMETER_NOISE: (x.sigma_a, 0.0),
        GYRO_NOISE: (0.0, x.sigma_w),
    }
    return {
        source: growth.horizontal_growth(part, *own.get(source, (0.0, 0.0)), x.g, time)
        for source, part in parts.level.items()
    }


def _normalised(variances: Mapping[str, Array | float]) -> Shares:
    values = {source: float(variance) for source, variance in variances.items()}
    whole = math.fsum(values.values())
    return FrozenMapping({source: value / whole for source, value in values.items()})


def velocity_shares(x: Inputs, whites: WhiteParts, p: Horizontal, start: Horizontal) -> Shares:
    """Shares in the variance of along-track velocity after the coast before the aperture, of which [S-2] is made.

    `p` is the settled filter for white noises, `start` the one in force: another where a slow GNSS error is modelled.
    """
    coast = x.before_aperture
    bias_a, bias_w = (float(bias) ** 2 for bias in growth.bias_velocity(x.bias_a, x.bias_w, x.g, coast))
    parts: dict[str, Array | float] = {source: part.velocity for source, part in _grown(x, whites, coast).items()}
    parts |= {ACCELEROMETER_BIAS: bias_a, GYRO_BIAS: bias_w}
    if x.rectified is not None:
        parts[RECTIFICATION] = float(growth.bias_velocity(x.rectified, 0.0, x.g, coast)[0]) ** 2
    if start is not p:
        grown, white = (growth.horizontal_growth(m, x.sigma_a, x.sigma_w, x.g, coast).velocity for m in (start, p))
        parts[SLOW_GNSS] = np.maximum(grown - white, 0.0)
    return _normalised(parts)


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
    parts = np.maximum(slopes / (sizes[:, None] * _STEP), 0)
    # The values are so far apart that rounding hides every slope: the shares are unknown.
    parts[~np.any(parts > 0, axis=1)] = 1.0
    return {
        figure: (size, _normalised(dict(zip((*seen, *beside), row, strict=True))))
        for figure, size, row in zip(figures, sizes.tolist(), parts.tolist(), strict=True)
    }


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

"""The smoothed error of one channel: by spectrum where that holds, in state space where it does not."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.steady_state import Array
from nav_model.processing.leg import smoothed_in_leg
from nav_model.processing.spectrum import Channel, Leg, rates, smoothed

SPECTRUM, STATE_SPACE = "spectrum", "state space"

LONG = 6.0
"""Times 1/w0 of leg on each side: what is missing beyond is 0.1 % of the quadratic phase."""

_DENSE = 0.7  # w0 times the fix interval: sampled fixes act like the noise of their density to 0.02 %


def _values(channel: Channel) -> dict[str, Array]:
    """What a channel has; the vertical one is a horizontal one without gyro noise."""
    whole = replace(channel, gyro=0 * channel.accelerometer) if channel.gyro is None else channel
    return {name: value for name, value in vars(whole).items() if value is not None}


def by_state_space(channel: Channel, leg: Leg) -> NDArray[np.bool_]:
    """Where the spectrum does not hold: a short leg, sparse fixes, or a time without them before the aperture."""
    fastest, slowest = rates(channel)
    interval = channel.interval.real
    if channel.velocity_interval is not None:
        interval = np.maximum(interval, channel.velocity_interval.real)
    side = np.minimum(leg.before.real, leg.after.real)
    where = (side * slowest < LONG) | (interval * fastest > _DENSE) | (leg.gap.real > 0)
    return np.asarray(where)


def smoothed_error(
    channels: Sequence[Channel], aperture: Array, leg: Leg, names: Collection[str]
) -> list[dict[str, Array]]:
    """The smoothed error over an aperture, each design by the method that holds for it. [P-3], [P-5]

    Parameters
    ----------
    channels : sequence of Channel
    aperture : array
        Seconds.
    leg : Leg
    names : collection of str
        Of `nav_model.processing.leg.COLUMNS`, where the units are told. ``tilt`` only of channels with a gyro.

    Returns
    -------
    list of dict
        For each channel: name -> variances, an array that broadcasts to the shape of all inputs together.
    """
    if not names:
        return [{} for _ in channels]
    found: list[dict[str, Array]] = []
    short: list[NDArray[np.bool_]] = []
    for channel in channels:
        there = [name for name in names if name != "tilt" or channel.gyro is not None]
        where = by_state_space(channel, leg)
        found.append({name: np.zeros(()) for name in there} if np.all(where) else smoothed(channel, aperture, there))
        short.append(where)
    if not any(map(np.any, short)):
        return found
    # What the spectrum does not hold for, of all channels in one go.
    taken, masks = [], []
    for channel, where in zip(channels, short, strict=True):
        values = (*_values(channel).values(), aperture, *leg)
        mask = where & np.ones(np.broadcast_shapes(*(value.shape for value in values)), bool)
        even = np.zeros(mask.shape)
        taken.append([(value + even)[mask] for value in values])
        masks.append(mask)
    rows = [np.concatenate(values) for values in zip(*taken, strict=True)]
    named = dict(zip(_values(channels[0]), rows, strict=False))
    exact = smoothed_in_leg(Channel(**named), rows[-4], Leg(*rows[-3:]))
    ends = np.cumsum([np.count_nonzero(mask) for mask in masks])
    for columns, mask, end in zip(found, masks, ends, strict=True):
        part = slice(end - np.count_nonzero(mask), end)
        whole = bool(np.all(mask))
        for name, base in columns.items():
            if whole:
                columns[name] = exact[name][part].reshape(mask.shape)
                continue
            columns[name] = np.array(np.broadcast_to(base, mask.shape), np.result_type(base, exact[name]))
            columns[name][mask] = exact[name][part]
    return found

"""The smoothed error of one channel: by spectrum where that holds, in state space where it does not."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.steady_state import Array
from nav_model.processing.spectrum import Channel, Leg, rates, smoothed

SPECTRUM, STATE_SPACE = "spectrum", "state space"

_LONG = 6.0  # times 1/w0 of leg on each side: what is missing beyond is 0.1 % of the quadratic phase
_DENSE = 0.7  # w0 times the fix interval: sampled fixes act like the noise of their density to 0.02 %


def by_state_space(channel: Channel, leg: Leg) -> NDArray[np.bool_]:
    """Where the spectrum does not hold: a short leg, sparse fixes, or a time without them before the aperture."""
    fastest, slowest = rates(channel)
    interval = channel.interval.real
    if channel.velocity_interval is not None:
        interval = np.maximum(interval, channel.velocity_interval.real)
    side = np.minimum(leg.before.real, leg.after.real)
    where = (side * slowest < _LONG) | (interval * fastest > _DENSE) | (leg.gap.real > 0)
    return np.asarray(where)


def smoothed_error(channel: Channel, aperture: Array, leg: Leg, names: Collection[str]) -> dict[str, Array]:
    """Variances of the smoothed error over an aperture, each design by the method that holds for it. [P-3], [P-5]

    Parameters
    ----------
    channel : Channel
    aperture : array
        Seconds.
    leg : Leg
    names : collection of str
        Of `nav_model.processing.leg.COLUMNS`, where the units are told.

    Returns
    -------
    dict
        Name -> array that broadcasts to the shape of all inputs together.
    """
    short = by_state_space(channel, leg)
    found = {} if np.all(short) else smoothed(channel, aperture, names)
    if not np.any(short):
        return found
    from nav_model.processing.leg import smoothed_in_leg  # brings the compiler, which most designs do without

    fields = {name: value for name, value in vars(channel).items() if value is not None}
    values = np.broadcast_arrays(*fields.values(), aperture, *leg, short)
    where = values[-1]
    rows = [value[where] for value in values[:-1]]
    exact = smoothed_in_leg(
        Channel(**{"gyro": None} | dict(zip(fields, rows, strict=False))), rows[len(fields)], Leg(*rows[-3:])
    )
    merged: dict[str, Array] = {}
    for name in names:
        base = found.get(name, np.zeros(()))
        merged[name] = np.array(np.broadcast_to(base, where.shape), np.result_type(base, exact[name]))
        merged[name][where] = exact[name]
    return merged

"""Navigation errors of a budget: while fixes come in, and in the outage after them."""

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth
from nav_model.analytic.doubling import carried, drift, measured, updated, without_slow_error
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.errors import InputError, shown
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.contributors import composed, entering
from nav_model.budget.figures import SETTLED, channels, free_growth, in_outage, outage, sigmas
from nav_model.budget.inputs import Inputs
from nav_model.budget.result import Outage, Sigmas, SteadyState
from nav_model.budget.shares import Shares
from nav_model.design import Design
from nav_model.design.contributors import COASTING
from nav_model.processing.flight import Channel, Flight, values_of

COAST_POINTS = 300


def outage_times(design: Design, times: ArrayLike | None) -> Array:
    """Seconds since the last fix at which the outage is computed: those given, or `COAST_POINTS` even ones.

    Raises
    ------
    InputError
        If `times` are not finite, negative or beyond the bounds of ``coast.duration``.
    """
    if times is None:
        return _even_times(design.coast.duration)
    time = np.atleast_1d(np.array(times, float))  # a copy: the budget's arrays are read-only, the caller's stay his
    longest = design.coast.param["duration"].bounds[1]
    wrong = time[~((time >= 0) & (time <= longest))]
    if time.ndim != 1 or wrong.size:
        said = f"{wrong[0]:g}" if wrong.size else shown(times)
        raise InputError("times", f"{said} is not allowed. Give seconds from 0 to {longest:g}.", times)
    return time


@lru_cache(maxsize=64)
def _even_times(duration: float) -> Array:
    """The same array for the same duration, so that curves over it are quickly compared."""
    return np.linspace(0.0, duration, COAST_POINTS)


def steady_state_of(
    inputs: Inputs, closed: Sawtooth, average: Sawtooth, moments: Cycle, shares: Mapping[str, Shares]
) -> SteadyState:
    """The settled filter: `closed` form, the same with a slow GNSS error, and sampled `moments`; `shares` of
    `SETTLED`."""
    x = inputs
    asymptote = steady.gyro_dominated(x.sigma_w, x.s, x.g)
    lambda_dt = max(
        float(steady.lambda_dt(variance, s, x.interval))
        for variance, s in ((closed.horizontal.p11, x.s), (closed.vertical.v11, x.s_vertical))
    )
    return SteadyState(
        closed=_sigmas(closed, x),
        average=_sigmas(average, x),
        prior=_sigmas(moments.prior, x),
        posterior=_sigmas(moments.posterior, x),
        gyro_dominance=float(steady.gyro_dominance(x.sigma_a, x.sigma_w, x.s, x.g)),
        asymptote=(math.sqrt(asymptote[0]), math.sqrt(asymptote[1]), math.sqrt(asymptote[2])),
        lambda_dt=lambda_dt,
        shares=FrozenMapping({name: shares[name] for name in SETTLED}),
        own=x.own,
    )


def _sigmas(moment: Sawtooth, x: Inputs) -> Sigmas:
    return Sigmas(*map(float, sigmas(moment, x).values()))


def outage_of(
    x: Inputs, closed: Sawtooth, posterior: Sawtooth, time: Array, sized: Mapping[str, tuple[float, Shares]]
) -> Outage:
    """Errors `time` [s] after the last fix; `posterior` is the filter there, `sized` has value and shares of
    `COASTING` and of limits in the outage."""
    free = {name: np.sqrt(variance) for name, variance in free_growth(x, closed, time).items()}
    refined_horizontal, refined_vertical = map(np.sqrt, outage(x, posterior, time))
    perfect = growth.perfect_start(x.sigma_a, x.sigma_w, x.g, time)
    curves = {
        "time": time,
        "position_horizontal": free["position_horizontal"],
        "position_vertical": free["position_vertical"],
        "velocity_horizontal": free["coast_horizontal_velocity"],
        "velocity_vertical": free["coast_vertical_velocity"],
        "tilt": free["coast_tilt"],
        "yaw_growth": free["coast_heading"],
        "refined_horizontal": refined_horizontal,
        "refined_vertical": refined_vertical,
        "perfect_start_horizontal": np.sqrt(perfect[0]),
        "perfect_start_vertical": np.sqrt(perfect[1]),
        "initial_tilt": np.sqrt(growth.initial_tilt(closed.horizontal.p33, x.g, time)),
    }
    names = (*COASTING, *(limit.name for limit in x.limits if in_outage(limit)))
    checked = {name: composed(*sized[name], entering(x.own, name, post_processed=False)) for name in names}
    return Outage(duration=float(x.duration), checked=FrozenMapping(checked), **curves)


def smoothed_outage(x: Inputs, time: Array) -> dict[str, Array]:
    """Figures of `SETTLED`, post-processed, before and in an outage of ``x.duration`` just after a fix at time 0.

    The smoother bridges it from both sides: fixes come back at its end, and it has those of ``x.leg_after``. [P-3]

    Parameters
    ----------
    x : Inputs
        Of one design.
    time : array (n,)
        Seconds, negative before the outage, at most its duration.

    Returns
    -------
    dict
        Figure -> one sigma, (n,): m, m/s, rad.
    """
    level, upright = (_bridged(channel, time, x.duration, x.leg_after) for channel in channels(x))
    found = (level[0], upright[0], level[1], upright[1], np.sqrt(level[2] ** 2 + x.bias**2) / x.g)
    return dict(zip(SETTLED, found, strict=True))


def _bridged(channel: Channel, time: Array, outage: Array, after: Array) -> Array:
    """One sigma of position, velocity, and tilt times gravity: (3, n)."""
    inside = time > 0
    rows = np.append(time[~inside], 0.0)  # the last one serves all times in the outage
    flight = Flight({name: np.broadcast_to(value, rows.shape) for name, value in values_of(channel).items()})
    axis = flight.axis
    now, none, gone = rows / axis.step, 0 * rows, float(outage / axis.step[-1])
    start, again = flight.start(none), flight.information_after(none, after / axis.step)
    # Before the outage: from the last fix that both kinds share on, and with the fixes up to time 0.
    periods = as_numbers(np.ceil(-now / axis.parts) * axis.parts)
    back = measured(drift(none + gone, *axis.noise), again).info
    smoothed = updated(
        carried(start, flight.segment_to(now + periods)), flight.information_after(now + periods, periods, back)
    )
    # In it: from the last fix on, and back from the first one after it.
    late = time[inside] / axis.step[-1]
    a, w, slow = axis.noise
    alone = a[-1], w[-1], slow and (slow[0][-1], slow[1][-1])
    forward, backward = drift(late, *alone), drift(gone - late, *alone)
    bridged = updated(carried(start[-1], forward), measured(backward, again[-1]).info)
    both = without_slow_error(np.concatenate([smoothed[:-1], bridged]))
    order = np.argsort(np.concatenate([np.flatnonzero(~inside), np.flatnonzero(inside)]))
    sigma = np.sqrt(np.einsum("nii->in", both[order])[:3])
    return np.asarray(sigma * axis.length[0] / axis.step[0] ** np.arange(3)[:, None])

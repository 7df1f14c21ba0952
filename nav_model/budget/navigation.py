"""Navigation errors of a budget: while fixes come in, and in the outage after them."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth
from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, shown
from nav_model.budget.figures import COASTING, SETTLED, outage
from nav_model.budget.inputs import Inputs
from nav_model.budget.result import Outage, Sigmas, SteadyState
from nav_model.budget.shares import Parts, coast_shares, each, steady_shares
from nav_model.design import Design

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


def steady_state_of(inputs: Inputs, parts: Parts, closed: Sawtooth, moments: Cycle, white: Cycle) -> SteadyState:
    """The settled filter: `closed` form, sampled `moments`, and `white`, the same without the slow GNSS error."""
    x = inputs
    asymptote = steady.gyro_dominated(x.sigma_w, x.s, x.g)
    lambda_dt = max(
        float(steady.lambda_dt(variance, s, x.interval))
        for variance, s in ((closed.horizontal.p11, x.s), (closed.vertical.v11, x.s_vertical))
    )
    return SteadyState(
        closed=_sigmas(closed),
        prior=_sigmas(moments.prior),
        posterior=_sigmas(moments.posterior),
        gyro_dominance=float(steady.gyro_dominance(x.sigma_a, x.sigma_w, x.s, x.g)),
        asymptote=(math.sqrt(asymptote[0]), math.sqrt(asymptote[1]), math.sqrt(asymptote[2])),
        lambda_dt=lambda_dt,
        shares=each(SETTLED, lambda: steady_shares(parts(), moments.prior, white.prior)),
    )


def _sigmas(moment: Sawtooth) -> Sigmas:
    p, v = moment
    return Sigmas(*(math.sqrt(float(x)) for x in (p.p11, v.v11, p.p22, v.v22, p.p33)))


def outage_of(x: Inputs, parts: Parts, closed: Sawtooth, posterior: Sawtooth, white: Sawtooth, time: Array) -> Outage:
    """Errors `time` [s] after the last fix; `posterior` is the filter there, `white` without the slow GNSS error."""
    a, w, g = x.sigma_a, x.sigma_w, x.g
    p, v = closed
    duration = float(x.duration)
    level = growth.horizontal_growth(p, a, w, g, time)
    upright = growth.vertical_growth(v, a, time)
    refined_horizontal, refined_vertical = map(np.sqrt, outage(x, posterior, np.append(time, duration)))
    bias_a, bias_w = growth.bias_position(x.bias, x.bias_w, g, time)
    drift_a, drift_w = growth.bias_velocity(x.bias, x.bias_w, g, time)
    perfect = growth.perfect_start(a, w, g, time)
    shares = each(COASTING, lambda: coast_shares(x, parts(), posterior, white, duration))
    curves = {
        "time": time,
        "position_horizontal": np.sqrt(level.position + bias_a**2 + bias_w**2),
        "position_vertical": np.sqrt(upright.position + bias_a**2),
        "velocity_horizontal": np.sqrt(level.velocity + drift_a**2 + drift_w**2),
        "velocity_vertical": np.sqrt(upright.velocity + drift_a**2),
        "tilt": np.sqrt(level.tilt + (x.bias_w * time) ** 2),
        "yaw_growth": np.sqrt(steady.yaw_variance(w, time)),
        "refined_horizontal": refined_horizontal[:-1],
        "refined_vertical": refined_vertical[:-1],
        "perfect_start_horizontal": np.sqrt(perfect[0]),
        "perfect_start_vertical": np.sqrt(perfect[1]),
        "initial_tilt": np.sqrt(growth.initial_tilt(p.p33, g, time)),
    }
    return Outage(
        duration=duration,
        end_refined_horizontal=float(refined_horizontal[-1]),
        end_refined_vertical=float(refined_vertical[-1]),
        shares_horizontal=shares[COASTING[0]],
        shares_vertical=shares[COASTING[1]],
        **curves,
    )

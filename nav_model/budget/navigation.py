"""Navigation errors of a budget: while fixes come in, and in the outage after them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.channel import drift, tilt_variance
from nav_model.analytic.discrete import Sawtooth
from nav_model.analytic.doubling import carried, measured, updated, without_slow_error
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.errors import InputError, quoted
from nav_model.base.frozen import FrozenMapping
from nav_model.budget.inputs import Inputs
from nav_model.budget.real_time import RealTime
from nav_model.budget.varying import channels
from nav_model.design import Design
from nav_model.design.figures import STEADY
from nav_model.processing.flight import Channel, DoubledFlight, values_of

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
        wrong_time = f"{wrong[0]:g}" if wrong.size else quoted(times)
        raise InputError("times", f"{wrong_time} is not allowed. Give seconds from 0 to {longest:g}.", times)
    return time


@lru_cache(maxsize=64)
def _even_times(duration: float) -> Array:
    """Times of curves, one array for each duration, so that curves over it are quickly compared."""
    return np.linspace(0.0, duration, COAST_POINTS)


@dataclass(frozen=True)
class SteadyState:
    """The settled filter in real time, without contributors: figure -> 1σ at moments of its cycle.

    ``closed`` is the cycle rms in closed form [T-3], [T-4], ``average`` the same with what a slow GNSS error and
    varying biases add to it; ``prior`` and ``posterior`` are the discrete filter just before and just after a fix
    [T-8], these included. ``asymptote`` is [T-7]: position, velocity, tilt, horizontal. ``lambda_dt`` is the larger
    of the two channels.
    """

    closed: Mapping[str, float]
    average: Mapping[str, float]
    prior: Mapping[str, float]
    posterior: Mapping[str, float]
    gyro_dominance: float
    asymptote: tuple[float, float, float]
    lambda_dt: float


@dataclass(frozen=True)
class Outage:
    """Sigmas in real time against time since the last fix, arrays of one length: s, m, m/s, rad.

    ``position_*``, ``velocity_*`` and ``tilt`` are the polynomials [T-9], [T-10] with the residual biases in
    quadrature; ``refined_*`` is [T-17] with the same biases. All start from the covariance just after a fix [T-8] and
    are without contributors.
    """

    duration: float
    time: Array
    position_horizontal: Array
    position_vertical: Array
    velocity_horizontal: Array
    velocity_vertical: Array
    tilt: Array
    yaw_growth: Array
    refined_horizontal: Array
    refined_vertical: Array
    perfect_start_horizontal: Array
    perfect_start_vertical: Array
    initial_tilt: Array

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False


def steady_marks(design: Design) -> tuple[str, str]:
    """Marks of the steady state's equations, horizontal and vertical; velocity fixes have another equation."""
    return ("[T-3]", "[T-4]") if design.gnss.velocity_noise is None else ("[P-6]", "[P-6]")


def steady_state_of(model: RealTime) -> SteadyState:
    """The settled filter of one design."""
    x, closed = model.x, model.closed
    asymptote = steady.gyro_dominated(x.sigma_w, x.s, x.g)
    lambda_dt = max(
        float(steady.lambda_dt(variance, s, x.interval))
        for variance, s in ((closed.horizontal.p11, x.s), (closed.vertical.v11, x.s_vertical))
    )
    return SteadyState(
        closed=_sigmas(model, closed),
        average=_sigmas(model, model.moment("closed")),
        prior=_sigmas(model, model.moment("prior")),
        posterior=_sigmas(model, model.moment("posterior")),
        gyro_dominance=float(steady.gyro_dominance(x.sigma_a, x.sigma_w, x.s, x.g)),
        asymptote=(math.sqrt(asymptote[0]), math.sqrt(asymptote[1]), math.sqrt(asymptote[2])),
        lambda_dt=lambda_dt,
    )


def _sigmas(model: RealTime, moment: Sawtooth) -> Mapping[str, float]:
    then = model.at(moment)
    sigmas = {name: float(then.value(name)) for name in STEADY}
    if not all(map(math.isfinite, sigmas.values())):
        raise FloatingPointError("the settled filter is beyond double precision")
    return FrozenMapping(sigmas)


def outage_of(model: RealTime, time: Array) -> Outage:
    """Errors of one design `time` [s] after the last fix."""
    x = model.x
    polynomial, refined = model.polynomial_position(time), model.refined(time)
    perfect = growth.perfect_start(x.sigma_a, x.sigma_w, x.g, time)
    return Outage(
        duration=float(x.duration),
        time=time,
        position_horizontal=np.sqrt(polynomial[0]),
        position_vertical=np.sqrt(polynomial[1]),
        velocity_horizontal=model.coast_horizontal_velocity(time),
        velocity_vertical=model.coast_vertical_velocity(time),
        tilt=model.coast_tilt(time),
        yaw_growth=model.coast_heading(time),
        refined_horizontal=np.sqrt(refined[0]),
        refined_vertical=np.sqrt(refined[1]),
        perfect_start_horizontal=np.sqrt(perfect[0]),
        perfect_start_vertical=np.sqrt(perfect[1]),
        initial_tilt=np.sqrt(growth.initial_tilt(model.started(model.cycle.posterior).horizontal.p33, x.g, time)),
    )


def smoothed_outage(x: Inputs, time: Array) -> dict[str, Array]:
    """Post-processed figures of the steady state, before and in an outage of ``x.duration`` just after a fix at 0.

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
    horizontal, vertical = (_bridged(channel, time, x.duration, x.leg_after) for channel in channels(x))
    tilt = np.sqrt((horizontal[2] / x.g) ** 2 + x.settled_tilt)
    sigmas = (horizontal[0], vertical[0], horizontal[1], vertical[1], tilt)
    return dict(zip(STEADY, sigmas, strict=True))


def _bridged(channel: Channel, time: Array, outage: Array, after: Array) -> Array:
    """One sigma of position, velocity, and tilt times gravity: (3, n)."""
    inside = time > 0
    rows = np.append(time[~inside], 0.0)  # the last one serves all times in the outage
    flight = DoubledFlight({name: np.broadcast_to(value, rows.shape) for name, value in values_of(channel).items()})
    axis = flight.axis
    now, none, length = rows / axis.step, 0 * rows, float(outage / axis.step[-1])  # in steps
    start, after_outage = flight.start(none), flight.information_after(none, after / axis.step)
    # Before the outage: from the last fix that both kinds share on, and with the fixes up to time 0.
    periods = as_numbers(np.ceil(-now / axis.parts) * axis.parts)
    back = measured(drift(none + length, axis.noise), after_outage).info
    smoothed = updated(
        carried(start, flight.segment_to(now + periods)), flight.information_after(now + periods, periods, back)
    )
    # In it: from the last fix on, and back from the first one after it.
    late = time[inside] / axis.step[-1]
    noise = axis.noise.of(np.full(late.shape, -1))
    forward, backward = drift(late, noise), drift(length - late, noise)
    bridged = updated(carried(start[-1], forward), measured(backward, after_outage[-1]).info)
    # Both in the order of time, from steps and the filter's lengths back to SI.
    covariance = np.concatenate([smoothed[:-1], bridged])
    variance = np.einsum("nii->in", without_slow_error(covariance))[:3].copy()
    variance[2] = tilt_variance(covariance, axis.noise.of(np.zeros(len(covariance), int)))
    order = np.argsort(np.concatenate([np.flatnonzero(~inside), np.flatnonzero(inside)]))
    sigma = np.sqrt(variance[:, order])
    return np.asarray(sigma * axis.length[0] / axis.step[0] ** np.arange(3)[:, None])

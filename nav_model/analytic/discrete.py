"""The filter with discrete fixes, whose covariance is a sawtooth. [T-8]

The covariance is largest just before a fix (prior) and smallest just after (posterior); the closed form [T-3] is its
cycle rms. Both solve the discrete algebraic Riccati equation of one channel with exact transition and process noise:
in closed form (`nav_model.analytic.sampled_filter`) for white position fixes, by doubling
(`nav_model.analytic.settled_filter`) where fixes have velocity too, or a slow GNSS error, a first-order Gauss-Markov
state that the filter estimates. Doubling would serve white fixes as well, to nine digits and at a hundred times the
cost: a map of one design would take 0.3 s in place of 8 ms.
"""

from typing import NamedTuple

from numpy.typing import ArrayLike

from nav_model.analytic.sampled_filter import horizontal_cycle, vertical_cycle
from nav_model.analytic.settled_filter import settled_cycle
from nav_model.analytic.steady_state import Horizontal, Vertical


class Sawtooth(NamedTuple):
    """Steady-state covariances of a horizontal and the vertical channel at one moment of the cycle."""

    horizontal: Horizontal
    vertical: Vertical


class Cycle(NamedTuple):
    """The two ends of the sawtooth: just before a fix and just after it.

    ``slow_with_tilt`` [m rad]: after the fix, covariance of a horizontal channel's tilt error with the slow error
    of the fixes itself; zero without one.
    """

    prior: Sawtooth
    posterior: Sawtooth
    slow_with_tilt: ArrayLike = 0.0


class SlowError(NamedTuple):
    """First-order Gauss-Markov error of the fixes: 1σ of a horizontal axis and of the vertical one [m],
    ``correlation_time`` [s]."""

    horizontal: ArrayLike
    vertical: ArrayLike
    correlation_time: ArrayLike


def cycle(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_fix_vertical: ArrayLike,
    slow: SlowError | None = None,
    velocity: tuple[ArrayLike, ArrayLike] | None = None,
) -> Cycle:
    """Prior and posterior covariances of the horizontal and vertical channels. [T-8]

    The vertical one has gravity that decreases with height by 2 g/R, which drives an error in height on.

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    interval : array_like
        Between fixes, s.
    sigma_fix, sigma_fix_vertical : array_like
        One fix, 1σ, m.
    slow : SlowError, optional
        Slow error of the fixes, modelled in the filter by state augmentation. Position variance is then that
        of the estimate about the truth, slow error included.
    velocity : pair of array_like, optional
        Velocity of one fix, 1σ [m/s], horizontal and vertical.
    """
    if velocity is None and slow is None:
        horizontal_ends = horizontal_cycle(sigma_a, sigma_w, g, interval, sigma_fix)
        vertical_ends = vertical_cycle(sigma_a, g, interval, sigma_fix_vertical)
        return Cycle(*(Sawtooth(*ends) for ends in zip(horizontal_ends, vertical_ends, strict=True)))
    fixes = (sigma_fix, sigma_fix_vertical)
    before, after, with_slow = settled_cycle(sigma_a, sigma_w, g, interval, fixes, velocity, slow)
    return Cycle(Sawtooth(*before), Sawtooth(*after), with_slow)

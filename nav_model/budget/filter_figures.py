"""Figures of the filter and of an outage, a free INS after the last fix, and what all figures share.

Each member that has the name of a figure (`nav_model.design.figures`) is its formula, as `nav_model.budget.real_time`
has those of the image.
"""

from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic import coast as growth
from nav_model.analytic import steady_state as steady
from nav_model.analytic.discrete import Cycle, Sawtooth, cycle
from nav_model.analytic.refined_coast import coupling, refined_growth
from nav_model.analytic.rise import gravity_gradient, vertical_velocity
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers
from nav_model.budget.contributors import Composed
from nav_model.budget.inputs import Inputs
from nav_model.budget.varying import VaryingBiases
from nav_model.design.figures import FIGURES
from nav_model.design.processing import REAL_TIME

_NOTHING = (np.zeros(()), np.zeros(()))


class FilterFigures:
    """Figures of one design, or of arrays of designs; each, and what figures share, is computed when first read.

    Parameters
    ----------
    x : Inputs
    rule : tuple of arrays, optional
        Nodes and weights that integrate the outage, as `nav_model.analytic.refined_coast` takes them.
    """

    processing = REAL_TIME

    def __init__(self, x: Inputs, rule: tuple[Array, Array] | None = None) -> None:
        self.x = x
        self._rule = rule

    def value(self, name: str, at: ArrayLike | None = None) -> Array:
        """One sigma [SI] of a figure without contributors; one of the outage `at` a time [s], by default its end."""
        formula = getattr(self, name)
        if FIGURES[name].kind == "outage":
            formula = formula(self.x.duration if at is None else at)
        return formula  # type: ignore[no-any-return]

    def sigma(self, name: str, at: ArrayLike | None = None) -> Array:
        """One sigma of a figure with contributors; also of a contributor by itself, for a limit on it."""
        return np.asarray(self.composed(name, at).sigma)

    def composed(self, name: str, at: ArrayLike | None = None) -> Composed:
        """A figure with contributors, without shares of the model's sources."""
        value = self.value(name, at) if name in FIGURES else np.asarray(0.0)
        return self.x.contributors.composed(name, self.processing, value)

    # The filter.

    @cached_property
    def cycle(self) -> Cycle:
        """Prior and posterior of the filter as it is built. [T-8]"""
        x = self.x
        noises = x.sigma_a, x.sigma_w, x.g, x.interval, x.fix, x.fix_vertical
        return cycle(*noises, x.slow, x.velocity_of_fix)

    @cached_property
    def closed(self) -> Sawtooth:
        """Cycle rms of the settled filter in closed form. [T-3], [T-4], with velocity [P-6]"""
        x = self.x
        s_v, s_v_vertical = x.velocity_densities or (None, None)
        return Sawtooth(
            steady.horizontal(x.sigma_a, x.sigma_w, x.s, x.g, s_v),
            steady.vertical(x.sigma_a, x.s_vertical, s_v_vertical, gravity_gradient(x.g)),
        )

    @cached_property
    def at_last_fix(self) -> Sawtooth:
        """The filter at the last fix before the aperture: its cycle rms, but no less than the covariance just after a
        fix [T-8], which is larger where the fixes are far apart.

        No closed form has a slow GNSS error. It adds here what it adds to the covariance just after a fix. So no
        error improves a figure, and a smoother, which starts from that covariance, is no worse.
        """
        x, posterior = self.x, self.cycle.posterior
        white = posterior if x.slow is None else FilterFigures(replace(x, slow=None)).cycle.posterior
        horizontal, vertical = (
            [low + np.where(mean.real > less.real, mean - less, 0) for mean, less, low in zip(*channel, strict=True)]
            for channel in zip(self.closed, white, posterior, strict=True)
        )
        return Sawtooth(Horizontal(*horizontal), Vertical(*vertical))

    @cached_property
    def checked(self) -> Sawtooth:
        """The filter at the moment of its cycle that requirements are checked at."""
        return self.moment(self.x.steady_state)

    def moment(self, moment: str) -> Sawtooth:
        """The filter at the "prior", the "posterior", or "closed": on average between fixes, with varying biases."""
        saw = self.at_last_fix if moment == "closed" else getattr(self.cycle, moment)
        return saw if self.varying is None else self.varying.on(saw, after=moment != "prior", tilt=True)

    @cached_property
    def varying(self) -> VaryingBiases | None:
        """Additions by biases that vary while the filter estimates them. [T-21]

        Closed forms have white noise alone, so the covariances and formulas here do, and each figure adds it.
        """
        return None if self.x.instability_a is None else VaryingBiases(self.x)

    def started(self, saw: Sawtooth) -> Sawtooth:
        """The filter without varying biases, with them: its tilt is what accelerates, their sum."""
        return saw if self.varying is None else self.varying.on(saw, after=True)

    def at(self, moment: Sawtooth) -> Self:
        """Copy of the formulas with the steady state at another moment of the cycle."""
        other = copy(self)
        other.checked = moment
        return other

    @property
    def horizontal_position(self) -> Array:
        return np.sqrt(self.checked.horizontal.p11)

    @property
    def vertical_position(self) -> Array:
        return np.sqrt(self.checked.vertical.v11)

    @property
    def horizontal_velocity(self) -> Array:
        return np.sqrt(self.checked.horizontal.p22)

    @property
    def vertical_velocity(self) -> Array:
        return np.sqrt(self.checked.vertical.v22)

    @property
    def tilt(self) -> Array:
        # A filter sees only the sum of tilt and accelerometer bias on a straight level leg: settled, the tilt is b/g.
        return np.sqrt(self.checked.horizontal.p33 + self.x.settled_tilt)

    @property
    def initial_tilt(self) -> Array:
        """Tilt at the last fix before the aperture, rad."""
        return np.sqrt(self.started(self.at_last_fix).horizontal.p33)

    # The outage, at times since the last fix [s].

    def refined(self, time: ArrayLike) -> tuple[Array, Array]:
        """Position variances, horizontal and vertical, with all terms and the residual biases. [T-17]"""
        x, posterior = self.x, self.cycle.posterior
        free = refined_growth(
            posterior.horizontal,
            posterior.vertical,
            x.sigma_a,
            x.sigma_w,
            x.g,
            time,
            speed=x.speed,
            latitude=x.latitude,
            altitude=x.altitude,
            heading=x.heading,
            rule=self._rule,
        )
        by_coupling = coupling(x.speed, x.latitude, x.altitude, x.heading) * self._later("coupled", time)[0]
        return self._biased((free.horizontal, free.vertical + by_coupling), time)

    def _biased(self, position: tuple[Array, Array], time: ArrayLike) -> tuple[Array, Array]:
        """Position variances, horizontal and vertical, with what residual biases and varying ones add."""
        bias_a, bias_w = growth.bias_position(self.x.bias, self.x.bias_w, self.x.g, time)
        level, upright = self._later("position", time)
        return position[0] + bias_a**2 + bias_w**2 + level, position[1] + bias_a**2 + upright

    def _later(self, column: str, time: ArrayLike) -> tuple[Array, Array]:
        """Variances that varying biases add a time after the last fix, of a horizontal axis and the vertical."""
        return _NOTHING if self.varying is None else self.varying.later(time)[column]

    @cached_property
    def _refined_end(self) -> tuple[Array, Array]:
        return self.refined(self.x.duration)

    def _refined(self, time: Array) -> tuple[Array, Array]:
        return self._refined_end if time is self.x.duration else self.refined(time)

    def coast_horizontal_position(self, time: Array) -> Array:
        return np.sqrt(self._refined(time)[0])

    def coast_vertical_position(self, time: Array) -> Array:
        return np.sqrt(self._refined(time)[1])

    def polynomial_position(self, time: Array) -> tuple[Array, Array]:
        """Position variances by the polynomials, horizontal and vertical, with the biases. [T-9], [T-10]"""
        horizontal, vertical = self._polynomials(time)
        return self._biased((horizontal.position, vertical.position), time)

    def _polynomials(self, time: Array) -> tuple[growth.HorizontalGrowth, growth.VerticalGrowth]:
        """Both channels by the polynomials, from the covariance just after a fix as `refined` is. [T-9], [T-10]

        Any other moment of the cycle would let an outage begin with an error that the last fix has removed, or
        without the slow error of the fixes, which no closed form has.
        """
        x, start = self.x, self.cycle.posterior
        return (
            growth.horizontal_growth(start.horizontal, x.sigma_a, x.sigma_w, x.g, time),
            growth.vertical_growth(start.vertical, x.sigma_a, time),
        )

    def coast_horizontal_velocity(self, time: Array) -> Array:
        x, (added, _) = self.x, self._later("velocity", time)
        drift_a, drift_w = growth.bias_velocity(x.bias, x.bias_w, x.g, time)
        return np.sqrt(self._polynomials(time)[0].velocity + drift_a**2 + drift_w**2 + added)

    def coast_vertical_velocity(self, time: Array) -> Array:
        x, (_, added) = self.x, self._later("velocity", time)
        drift_a, _ = growth.bias_velocity(x.bias, x.bias_w, x.g, time)
        return np.sqrt(vertical_velocity(self.cycle.posterior.vertical, x.sigma_a, x.g, time) + drift_a**2 + added)

    def coast_tilt(self, time: Array) -> Array:
        x, start, (added, _) = self.x, self.moment("posterior").horizontal.p33, self._later("tilt", time)
        grown = x.sigma_w**2 * time + added / x.g**2 + (x.bias_w * time) ** 2
        return np.sqrt(start + grown + x.settled_tilt)

    def coast_heading(self, time: Array) -> Array:
        x, time = self.x, as_numbers(time)
        variance = steady.yaw_variance(x.sigma_w, time) + x.heading_rate * time**2
        if x.instability_w is not None and x.time_w is not None and x.walk_w is not None:
            variance = variance + growth.varying_heading(x.instability_w, x.time_w, x.walk_w, time)
        return np.sqrt(variance)

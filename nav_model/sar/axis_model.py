"""The per-axis error model of inertial and GNSS navigation: state (p, v, a) with a = g tilt + bias.

    p' = v,   v' = a + w_a,   a' = g w_g

with w_a, w_g white of densities S_a = sigma_a^2, S_g = sigma_w^2 [T-1]. The model is linear, so the error between two
fixes is the noise path of the aperture plus the transition of a constant difference: everything below is exact at the
sample times for any step.

With a slow GNSS error the filter has a fourth state, first-order Gauss-Markov [T-8]: functions with "filter" in their
name give matrices of three rows without it and four with it.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.doubling import (
    Powers,
    Segment,
    drift,
    joined,
    measured,
    settled,
    without_slow_error,
)
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.constants import STANDARD_GRAVITY


@dataclass(frozen=True)
class AxisModel:
    """One axis, SI. A vertical axis has no tilt and no gyro: give it `horizontal=False`.

    ``accelerometer_noise`` [m/s/sqrt(s)], ``gyro_noise`` [rad/sqrt(s)], ``gnss_sigma`` [m] of one fix every
    ``fix_interval`` [s]; ``accelerometer_bias`` [m/s^2] and ``gyro_bias`` [rad/s] are 1 sigma of what the
    filter has not absorbed at the start of the aperture. ``slow_sigma`` [m] and ``slow_time`` [s] of the slow
    error of the fixes, on top of their noise; zero for none. ``velocity_sigma`` [m/s] of the velocity that comes with
    each fix; zero for none. ``leg_after`` [s] is the time with fixes after the aperture, for the whole-leg smoother.
    """

    accelerometer_noise: float
    gyro_noise: float
    gnss_sigma: float
    fix_interval: float
    gravity: float = STANDARD_GRAVITY
    accelerometer_bias: float = 0.0
    gyro_bias: float = 0.0
    horizontal: bool = True
    slow_sigma: float = 0.0
    slow_time: float = 300.0
    velocity_sigma: float = 0.0
    leg_after: float = math.inf

    @property
    def tilt_noise(self) -> float:
        """Density of the noise that drives a: g sigma_w [m/s^2/sqrt(s)], zero on the vertical axis."""
        return self.gravity * self.gyro_noise if self.horizontal else 0.0

    @property
    def fix_sigmas(self) -> Array:
        """Noise of what one fix measures: position [m], and velocity [m/s] where it has that."""
        return np.array([self.gnss_sigma, self.velocity_sigma] if self.velocity_sigma else [self.gnss_sigma])


def inertial_drift(model: AxisModel, step: ArrayLike) -> tuple[Array, Array]:
    """Transition of (p, v, a) over a step [s] of shape (...), and the covariance of its noise: both (..., 3, 3)."""
    free = drift(as_numbers(step), model.accelerometer_noise**2, model.tilt_noise**2)
    return free.transition, free.noise


def filter_drift(model: AxisModel, step: ArrayLike) -> tuple[Array, Array]:
    """Transition and noise of a step for the filter's states: (..., m, m)."""
    phi, noise = inertial_drift(model, step)
    if not model.slow_sigma:
        return phi, noise
    added = [(0, 0)] * (phi.ndim - 2) + [(0, 1)] * 2
    phi, noise = np.pad(phi, added), np.pad(noise, added)
    rate = as_numbers(step) / model.slow_time
    phi[..., 3, 3], noise[..., 3, 3] = np.exp(-rate), -(model.slow_sigma**2) * np.expm1(-2 * rate)
    return phi, noise


def fix_rows(model: AxisModel) -> Array:
    """Measurement rows of a fix, (kinds, m): position with its slow error, and velocity."""
    rows = np.zeros((len(model.fix_sigmas), 4 if model.slow_sigma else 3))
    rows[0, 0] = 1.0
    rows[0, 3:] = 1.0
    rows[1:, 1] = 1.0
    return rows


def measure(prior: Array, model: AxisModel) -> tuple[Array, Array]:
    """Gain (m, kinds) and posterior covariance (m, m) of a fix (Joseph's form)."""
    rows, noise = fix_rows(model), np.diag(model.fix_sigmas**2)
    cross = prior @ rows.T
    gain = np.asarray(np.linalg.solve(rows @ cross + noise, cross.T).T, float)
    keep = np.eye(len(prior)) - gain @ rows
    return gain, keep @ prior @ keep.T + gain @ noise @ gain.T


def steady_covariance(model: AxisModel) -> Array:
    """Covariance (m, m) of (p, v, a) and, with a slow GNSS error, of the filter's estimate of it, just after a fix.

    In the steady state of the sampled filter [T-8], by doubling (`nav_model.analytic.doubling`). Without gyro noise
    tilt is not excited and its variance is zero.
    """
    return without_slow_error(settled(Powers(measured(*_step_and_fix(model)), joined)))


def information_after(model: AxisModel, time: float) -> Array:
    """Information (m, m) about the filter's states at a fix, from it and the fixes of `time` [s] after it."""
    step, fix = _step_and_fix(model)
    later = math.floor(min(time / model.fix_interval + 1e-9, 2.0**40))  # more say nothing
    if later < 0:
        return np.zeros_like(fix)
    unit = Segment(*(part[None] for part in measured(step, fix)))
    nothing = Segment(*(part[None] for part in drift(0.0, 0.0, 0.0, _slow(model))))
    known = Powers(unit, joined).prepend(np.array([later]), nothing).info[0] + fix
    of = np.eye(len(known))
    of[0, 3:] = 1.0  # as the doubling has it, the first state is position and slow error together
    return np.asarray(of.T @ known @ of)


def _step_and_fix(model: AxisModel) -> tuple[Segment, Array]:
    """From one fix to the next, and the information of a fix."""
    step = drift(model.fix_interval, model.accelerometer_noise**2, model.tilt_noise**2, _slow(model))
    fix = np.zeros(step.noise.shape)
    fix[range(len(model.fix_sigmas)), range(len(model.fix_sigmas))] = 1 / model.fix_sigmas**2
    return step, fix


def _slow(model: AxisModel) -> tuple[float, float] | None:
    return (model.slow_sigma**2, model.slow_time) if model.slow_sigma else None


def draw_state(covariance: Array, runs: int, random: np.random.Generator) -> Array:
    """States (runs, m) of zero mean and the covariance given; a singular covariance is allowed."""
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(random.standard_normal((runs, len(covariance))) @ root.T)


def noise_path(model: AxisModel, time: Array, runs: int, random: np.random.Generator) -> Array:
    """Error (3, runs, n) that the noise alone builds up from zero at time[0], exact at the times given.

    Parameters
    ----------
    model : AxisModel
        Noise of the axis.
    time : array (n,)
        Seconds.
    runs : int
        Number of runs.
    random : numpy.random.Generator
        Of the draws.
    """
    h = np.diff(time)
    s, r = model.accelerometer_noise**2, model.tilt_noise
    draws = random.standard_normal((3, runs, len(h)))
    # Cholesky factor of the noise of `inertial_drift` in the order a, v, p.
    v_root = np.sqrt(s * h + r**2 * h**3 / 12)
    p_on_v = (s * h**2 / 2 + r**2 * h**4 / 24) / v_root
    p_root = np.sqrt(np.maximum(s * h**3 / 3 + r**2 * h**5 / 45 - p_on_v**2, 0.0))
    path = np.zeros((3, runs, len(time)))
    p, v, a = path
    np.cumsum(draws[0] * (r * np.sqrt(h)), axis=1, out=a[:, 1:])
    gained = a[:, :-1] * h + draws[0] * (r * h**1.5 / 2) + draws[1] * v_root
    np.cumsum(gained, axis=1, out=v[:, 1:])
    gained = v[:, :-1] * h + a[:, :-1] * (h**2 / 2)
    gained += draws[0] * (r * h**2.5 / 6) + draws[1] * p_on_v + draws[2] * p_root
    np.cumsum(gained, axis=1, out=p[:, 1:])
    return path

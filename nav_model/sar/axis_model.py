"""The per-axis error model of inertial and GNSS navigation: state (p, v, a) with a = g tilt + bias.

    p' = v,   v' = a + w_a,   a' = g w_g

with w_a, w_g white of densities S_a = sigma_a^2, S_g = sigma_w^2 [T-1]. The model is linear, so the error of
a navigator between two fixes is the noise path of the aperture plus the transition of a constant difference:
everything below is exact at the sample times, whatever the step.

With a slow GNSS error the filter carries it as a fourth state, first-order Gauss-Markov [T-8]: the functions
named for the filter give matrices of three rows without it and four with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.constants import STANDARD_GRAVITY

_FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class AxisModel:
    """One axis, SI. A vertical axis has no tilt and no gyro: give it `horizontal=False`.

    ``accelerometer_noise`` [m/s/sqrt(s)], ``gyro_noise`` [rad/sqrt(s)], ``gnss_sigma`` [m] of one fix every
    ``fix_interval`` [s]; ``accelerometer_bias`` [m/s^2] and ``gyro_bias`` [rad/s] are 1 sigma of what the
    filter has not absorbed at the start of the aperture. ``slow_sigma`` [m] and ``slow_time`` [s] of the slow
    error of the fixes, on top of their noise; zero for none. ``velocity_sigma`` [m/s] of the velocity that comes with
    each fix; zero for none. ``leg_before`` and ``leg_after`` [s] with fixes on both sides of the aperture: what the
    whole-leg smoother has.
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
    leg_before: float = math.inf
    leg_after: float = math.inf

    def __post_init__(self) -> None:
        for name in ("accelerometer_noise", "gnss_sigma", "fix_interval", "gravity", "slow_time"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name}: {value}; a positive, finite number is needed")
        for name in ("gyro_noise", "accelerometer_bias", "gyro_bias", "slow_sigma", "velocity_sigma"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"{name}: {value}; zero or a positive, finite number is needed")
        for name in ("leg_before", "leg_after"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name}: {getattr(self, name)}; zero or a positive number is needed")

    @property
    def tilt_noise(self) -> float:
        """Density of the noise that drives a: g sigma_w [m/s^2/sqrt(s)], zero on the vertical axis."""
        return self.gravity * self.gyro_noise if self.horizontal else 0.0

    @property
    def fix_sigmas(self) -> _FloatArray:
        """Noise of what one fix measures: position [m], and velocity [m/s] where it has that."""
        return np.array([self.gnss_sigma, self.velocity_sigma] if self.velocity_sigma else [self.gnss_sigma])


class SteadyCovariance(NamedTuple):
    """Covariance (m, m) of (p, v, a) and, with a slow GNSS error, of the filter's estimate of it: just before and
    just after a fix, in the steady state."""

    prior: _FloatArray
    posterior: _FloatArray


def transition(step: ArrayLike) -> _FloatArray:
    """Transition matrices, shape (..., 3, 3), over a step [s] of shape (...)."""
    step = np.asarray(step, float)
    phi = np.zeros((*step.shape, 3, 3))
    phi[..., range(3), range(3)] = 1.0
    phi[..., 0, 1] = phi[..., 1, 2] = step
    phi[..., 0, 2] = step**2 / 2
    return phi


def process_noise(model: AxisModel, step: ArrayLike) -> _FloatArray:
    """Exact covariance (..., 3, 3) of the noise gathered over a step [s]."""
    return noise_covariance(model.accelerometer_noise**2, model.tilt_noise**2, step)


def noise_covariance(s: ArrayLike, q: ArrayLike, step: ArrayLike) -> _FloatArray:
    """The same for squared densities of the noises that drive v and a: closed form, broadcasts."""
    s, q, h = np.broadcast_arrays(*(np.asarray(x, float) for x in (s, q, step)))
    noise = np.empty((*h.shape, 3, 3))
    noise[..., 0, 0] = s * h**3 / 3 + q * h**5 / 20
    noise[..., 0, 1] = noise[..., 1, 0] = s * h**2 / 2 + q * h**4 / 8
    noise[..., 0, 2] = noise[..., 2, 0] = q * h**3 / 6
    noise[..., 1, 1] = s * h + q * h**3 / 3
    noise[..., 1, 2] = noise[..., 2, 1] = q * h**2 / 2
    noise[..., 2, 2] = q * h
    return noise


def filter_transition(model: AxisModel, step: ArrayLike) -> _FloatArray:
    """Transition (..., m, m) of the filter's states over a step [s]."""
    return _with_slow(model, transition(step), np.exp(-np.asarray(step, float) / model.slow_time))


def filter_noise(model: AxisModel, step: ArrayLike) -> _FloatArray:
    """Covariance (..., m, m) of the noise that the filter's states gather over a step [s]."""
    grown = -(model.slow_sigma**2) * np.expm1(-2 * np.asarray(step, float) / model.slow_time)
    return _with_slow(model, process_noise(model, step), grown)


def _with_slow(model: AxisModel, matrix: _FloatArray, slow: _FloatArray) -> _FloatArray:
    if not model.slow_sigma:
        return matrix
    whole = np.zeros((*matrix.shape[:-2], 4, 4))
    whole[..., :3, :3] = matrix
    whole[..., 3, 3] = slow
    return whole


def fix_rows(model: AxisModel) -> _FloatArray:
    """What a fix measures of the filter's states, (kinds, m): position with its slow error, and velocity."""
    rows = np.zeros((len(model.fix_sigmas), 4 if model.slow_sigma else 3))
    rows[0, 0] = 1.0
    rows[0, 3:] = 1.0
    rows[1:, 1] = 1.0
    return rows


def measure(prior: _FloatArray, model: AxisModel) -> tuple[_FloatArray, _FloatArray]:
    """Gain (m, kinds) and posterior covariance (m, m) of a fix (Joseph's form)."""
    rows, noise = fix_rows(model), np.diag(model.fix_sigmas**2)
    cross = prior @ rows.T
    gain = np.asarray(np.linalg.solve(rows @ cross + noise, cross.T).T, float)
    keep = np.eye(len(prior)) - gain @ rows
    return gain, keep @ prior @ keep.T + gain @ noise @ gain.T


def steady_covariance(model: AxisModel) -> SteadyCovariance:
    """Steady covariance of the sampled filter [T-8], by the structure-preserving doubling algorithm.

    Chu, Fan, Lin and Wang (2004). Without gyro noise tilt is not excited and its variance is zero.
    """
    full = filter_transition(model, model.fix_interval)
    kept = np.array([i for i in range(len(full)) if i != 2 or model.tilt_noise > 0])
    size, excited = len(kept), np.ix_(kept, kept)
    a = full[excited].T
    h = filter_noise(model, model.fix_interval)[excited]
    rows = fix_rows(model)[:, kept]
    g = (rows.T / model.fix_sigmas**2) @ rows
    for _ in range(60):
        keep = np.linalg.inv(np.eye(size) + g @ h)
        a, g, grown = a @ keep @ a, g + a @ keep @ g @ a.T, h + a.T @ h @ keep @ a
        settled = np.allclose(grown, h, rtol=1e-13, atol=0)
        h = (grown + grown.T) / 2
        if settled:
            break
    prior = np.zeros_like(full)
    prior[excited] = h
    return SteadyCovariance(prior, measure(prior, model)[1])


def draw_state(covariance: _FloatArray, runs: int, random: np.random.Generator) -> _FloatArray:
    """States (runs, m) of zero mean and the covariance given; a singular covariance is allowed."""
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(random.standard_normal((runs, len(covariance))) @ root.T)


def noise_path(model: AxisModel, time: _FloatArray, runs: int, random: np.random.Generator) -> _FloatArray:
    """Error (3, runs, n) that the noise alone builds up from zero at time[0], exact at the times given."""
    h = np.diff(time)
    s, r = model.accelerometer_noise**2, model.tilt_noise
    draws = random.standard_normal((3, runs, len(h)))
    # Cholesky factor of `process_noise` in the order a, v, p.
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

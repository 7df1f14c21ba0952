"""The five noise terms of IEEE Std 952, each as Allan variance and as cosine spectrum.

Coefficients are those of the standard, in SI for a rate signal y (angular rate [rad/s] or specific force
[m/s²]):

| term             | coefficient | unit (gyro; accelerometer) | Allan variance   | two-sided density   |
|------------------|-------------|----------------------------|------------------|---------------------|
| quantization     | Q           | rad; m/s                   | 3 Q²/τ²          | (2πf)² τ0 Q²        |
| random walk      | N           | rad/√s; m/s/√s             | N²/τ             | N²                  |
| bias instability | B           | rad/s; m/s²                | 2 ln2 B²/π       | B²/(2π f)           |
| rate random walk | K           | rad/s/√s; m/s²/√s          | K² τ/3           | K²/(2πf)²           |
| ramp             | R           | rad/s²; m/s³               | R² τ²/2          | deterministic R t   |

Source: IEEE Std 952-1997 annex C; IEEE Std 1293 for accelerometers.
"""

import math
from typing import Final

import numpy as np

from nav_model.base.arrays import Array

TERMS: Final = ("quantization", "random_walk", "bias_instability", "rate_random_walk", "ramp")
STOCHASTIC_TERMS: Final = TERMS[:4]

# A measured 1/f spectrum is folded by sampling; past this many images the rest is below 1e-3 of the first.
_ALIASES = 16


def allan_variance(term: str, coefficient: float, tau_s: Array) -> Array:
    """Allan variance of one noise term alone at averaging times `tau_s` [s], any shape (IEEE Std 952 annex
    C).

    `coefficient` is the term's SI coefficient (see the module's table). Raises ValueError for an unknown
    term.
    """
    tau = np.asarray(tau_s, dtype=np.float64)
    shapes = {
        "quantization": 3.0 / tau**2,
        "random_walk": 1.0 / tau,
        "bias_instability": np.full_like(tau, 2.0 * math.log(2.0) / math.pi),
        "rate_random_walk": tau / 3.0,
        "ramp": tau**2 / 2.0,
    }
    if term not in shapes:
        raise ValueError(f"noise term {term!r} is unknown; allowed: {', '.join(TERMS)}")
    return np.asarray(coefficient**2 * shapes[term])


def cosine_variances(index: Array, samples: int | Array, interval_s: float) -> Array:
    """Variance of each orthonormal DCT-II coefficient of the rate samples, per unit Q², N², B², K²: shape (4,
    len(index)).

    `index` k = 1..samples-1 stands for the frequency k/(2·samples·interval_s). The transform diagonalises
    white noise and a random walk exactly (summation by parts turns the walk into a sine transform of its
    independent steps), so its coefficients are independent Gaussians and the fit's likelihood is exact for
    both; flicker noise carries the finite-log factor of its lowest coefficients in closed form; quantization
    is exact but for the two ends of the log.
    """
    from scipy.special import sici

    k = np.asarray(index, dtype=np.float64)
    half = np.pi * k / (2.0 * samples)
    sine2 = np.sin(half) ** 2
    quantization = 4.0 * sine2 / interval_s**2
    white = np.full_like(k, 1.0 / interval_s)
    # Averaging over the sample interval correlates neighbouring steps of the walk by 1/4 (exact).
    walk = interval_s * (1.0 - 2.0 * sine2 / 3.0) / (4.0 * sine2)
    frequency = k / (2.0 * samples * interval_s)
    flicker = np.zeros_like(k)
    for image in range(-_ALIASES, _ALIASES + 1):
        shifted = np.abs(frequency + image / interval_s)
        flicker += np.sinc(shifted * interval_s) ** 2 / (2.0 * np.pi * shifted)
    # Var of ∫cos(πkt/T) over 1/f noise: -2c ∬ cos cos ln|t-s| has the closed form below; it tends to 1.
    angle = np.pi * k
    finite_log = 2.0 / np.pi * (sici(angle)[0] - (1.0 - np.cos(angle)) / angle)
    return np.stack([quantization, white, flicker * finite_log / interval_s, walk])


def cosine_ramp(index: Array, samples: int | Array, interval_s: float) -> Array:
    """Orthonormal DCT-II coefficients of the signal t = n·interval_s (unit slope); zero for even `index`."""
    k = np.asarray(index, dtype=np.float64)
    half = np.pi * k / (2.0 * samples)
    odd = np.mod(k, 2.0)
    return -odd * np.sqrt(2.0 / samples) * interval_s * np.cos(half) / (2.0 * np.sin(half) ** 2)

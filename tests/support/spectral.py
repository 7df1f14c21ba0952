"""Oracle for the smoothed error: what an endless leg with dense white fixes leaves, as a spectrum. [P-1] to [P-5]

Two-sided densities over angular frequency w; a variance is (1/pi) times the integral of one from zero to infinity. An
aperture's figures are linear in the error along it: integrals of it times a kernel over u from -1 to 1. Nothing here
is the product's, and `PAIRS` says of what two kernels each of its columns is the covariance.
"""

import math

import numpy as np
from numpy.polynomial import legendre

NODES, WEIGHTS = legendre.leggauss(60)
_OSCILLATING = 60.0  # w T/2; beyond, an oscillation is taken as its mean


def _kernel(order, factor, power=0):
    """Values at -1, at `NODES` and at 1: the coefficient of u^order in the fit, of the error times u^power."""
    u = np.concatenate([[-1.0], NODES, [1.0]])
    return factor * legendre.legval(u, np.eye(order + 1)[order]) * u**power


# Coefficients of the Legendre polynomials are (2m + 1)/2 times the integral, and u² has 3/2 in P_2, u³ 5/2 in P_3.
KERNELS = {
    "mean": _kernel(0, 1 / 2),
    "slope": _kernel(1, 3 / 2),
    **{f"quadratic{n}": _kernel(2, 15 / 4, n) for n in range(3)},
    **{f"cubic{n}": _kernel(3, 35 / 4, n) for n in range(3)},
}
PAIRS = {
    "mean": ("mean", "mean"), "slope": ("slope", "slope"), "mean_slope": ("mean", "slope"),
    "quadratic": ("quadratic0", "quadratic0"), "turned": ("quadratic1", "quadratic1"),
    "curved": ("quadratic2", "quadratic2"), "with_turned": ("quadratic0", "quadratic1"),
    "with_curved": ("quadratic0", "quadratic2"), "turned_curved": ("quadratic1", "quadratic2"),
    "cubic": ("cubic0", "cubic0"), "cubic_turned": ("cubic1", "cubic1"), "cubic_curved": ("cubic2", "cubic2"),
    "cubic_with_turned": ("cubic0", "cubic1"), "cubic_with_curved": ("cubic0", "cubic2"),
    "cubic_turned_curved": ("cubic1", "cubic2"),
}  # fmt: skip


def scaled(powers, aperture):
    """With slopes a second, and what polynomials up to orders 1, 2 and 3 leave of the mean square `whole`."""
    whole = powers.pop("whole")
    powers["left_1"] = whole - powers["mean"] - powers["slope"] / 3
    powers["left_2"] = powers["left_1"] - powers["quadratic"] * 4 / 45
    powers["left_3"] = powers["left_2"] - powers["cubic"] * 4 / 175
    powers["slope"] *= 4 / aperture**2
    powers["mean_slope"] *= 2 / aperture
    return powers


def _panels(edges, points=10):
    """Gauss and Legendre between edges."""
    nodes, weights = legendre.leggauss(points)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()


def filters(x):
    """For each of `PAIRS`, and for `whole`, the power that is left of an oscillation exp(i x u); x = w T/2."""
    near = x < _OSCILLATING
    wave = np.exp(1j * x[near, None] * NODES) * WEIGHTS
    through = {name: wave @ kernel[1:-1] for name, kernel in KERNELS.items()}
    result = {"whole": np.ones_like(x)}
    for name, (row, column) in PAIRS.items():
        ends = KERNELS[row][0] * KERNELS[column][0] + KERNELS[row][-1] * KERNELS[column][-1]
        result[name] = ends / x**2  # far above the oscillation only the kernels' ends count
        result[name][near] = (through[row] * through[column].conj()).real
    return result


def densities(channel, w):
    """Of the position that the inertial sensors let drift, and of the receiver's position."""
    drift = channel.accelerometer**2 / w**4
    if channel.gyro is not None:
        drift = drift + channel.gyro**2 / w**6
    known = channel.fix**2 * channel.interval
    if channel.slow is not None:
        known = known + 2 * channel.slow**2 * channel.slow_time / (1 + (w * channel.slow_time) ** 2)
    known = 1 / known
    if channel.velocity is not None:
        known = known + w**2 / (channel.velocity**2 * channel.velocity_interval)
    return drift, 1 / known


def smoothed(channel, aperture):
    """Columns of `nav_model.processing.smoother.smoothed_error` for one channel."""
    edges = np.concatenate([np.geomspace(1e-9, 1, 31), np.linspace(1, _OSCILLATING, 31)[1:]])
    edges = np.concatenate([edges, np.geomspace(_OSCILLATING, 1e7, 31)[1:]])
    x, weights = _panels(edges)
    half = float(aperture) / 2
    w, weights = x / half, weights / (math.pi * half)
    drift, receiver = densities(channel, w)
    spectrum = weights / (1 / drift + 1 / receiver)
    result = scaled({name: float(spectrum @ power) for name, power in filters(x).items()}, float(aperture))
    result |= {"position": spectrum.sum(), "velocity": spectrum @ w**2}
    if channel.gyro is not None:
        gyro, rest = channel.gyro**2 / w**2, channel.accelerometer**2 + w**4 * receiver
        result["tilt"] = np.sum(weights / (1 / gyro + 1 / rest))
    return result

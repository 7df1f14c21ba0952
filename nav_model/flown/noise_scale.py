"""Noise of IMU and receiver on a flight over that of their design, by what the difference shows. [P-19]

A filter with given gains makes each variance of its errors a sum over sources, linear in their densities:

    E d² = a² D_imu + b² D_gnss + D_rest                                                                    [P-19]

of every axis of position, velocity and tilt. Weighted least squares over the axes give a and b; a mean square of nu
degrees of freedom has the variance 2 E²/nu.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.shares import ACCELEROMETER_NOISE, GNSS_NOISE, GNSS_VELOCITY, GYRO_NOISE

FloatArray = NDArray[np.float64]
_OF = {"imu": (ACCELEROMETER_NOISE, GYRO_NOISE), "gnss": (GNSS_NOISE, GNSS_VELOCITY)}
_AXES = 8  # the heading stands for itself too seldom
_ITERATIONS = 8
_LEAST = 0.01  # of a variance
_NORMAL = 1.96


@dataclass(frozen=True)
class Factor:
    """Sigma of a noise over that of its design, with its 95 % interval."""

    value: float
    low_95: float
    high_95: float


@dataclass(frozen=True, eq=False)
class Scale:
    """Factor on the variance of each source (sources,), and those of "imu" and "gnss" on the sigma, none where the
    flight does not part them."""

    of_sources: FloatArray
    factors: Mapping[str, Factor]


def scale_of(sources: Sequence[str], variances: FloatArray, mean_squares: FloatArray, freedom: FloatArray) -> Scale:
    """The noise of a flight over that of its design.

    Parameters
    ----------
    sources : sequence of str
        Names.
    variances : array (sources, 9)
        Of the difference by the budget, mean over the lines.
    mean_squares : array (9,)
        As they were seen, nan where there is none.
    freedom : array (9,)
        Degrees of freedom of each.
    """
    from scipy.optimize import nnls

    axes = np.flatnonzero(np.isfinite(mean_squares[:_AXES]) & (freedom[:_AXES] > 1.0))
    groups = {name: np.isin(sources, members) for name, members in _OF.items()}
    rest = variances[~np.any(list(groups.values()), axis=0)].sum(axis=0)[axes]
    A = np.column_stack([variances[mask].sum(axis=0)[axes] for mask in groups.values()])
    usual = np.ones(len(sources))
    if len(axes) < 3 or not A.any(axis=0).all():
        return Scale(usual, {})
    theta = np.ones(len(groups))
    for _ in range(_ITERATIONS):
        weight = np.sqrt(freedom[axes] / 2.0) / (A @ theta + rest)
        theta = np.maximum(nnls(A * weight[:, None], (mean_squares[axes] - rest) * weight)[0], _LEAST)
    spread = np.sqrt(np.diag(np.linalg.inv((A * weight[:, None]).T @ (A * weight[:, None]))))
    factors = {}
    for n, (name, mask) in enumerate(groups.items()):
        usual[mask] = theta[n]
        if spread[n] < theta[n]:  # its sigma by that of its logarithm
            part = _NORMAL * spread[n] / (2.0 * theta[n])
            value = math.sqrt(theta[n])
            factors[name] = Factor(value, value * math.exp(-part), value * math.exp(part))
    return Scale(usual, factors)

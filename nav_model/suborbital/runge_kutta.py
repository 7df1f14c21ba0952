"""The classical Runge-Kutta method of fourth order (RK4), for kernels that know their forces at the nodes of a step.

A step of length h has three nodes, its start, middle and end, and four slopes k1 to k4, of which k2 and k3 are both
at the middle:

    k1 at y,  k2 at y + h/2 k1,  k3 at y + h/2 k2,  k4 at y + h k3;   y(t + h) = y + h/6 (k1 + 2 k2 + 2 k3 + k4)

Source: Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 1993, section II.1.
"""

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.compiled import part


@part
def node_of(slope: int) -> int:
    """Node, 0 to 2, at which a slope, 0 to 3, is taken."""
    return (slope + 1) // 2


@part
def state_at(y: Array, k: Array, slope: int, h: float) -> Array:
    """State at which a slope is taken.

    Parameters
    ----------
    y : array (...)
        State at the start of the step.
    k : array (4, ...)
        Slopes; those before `slope` are known.
    slope : int
        0 to 3.
    h : float
        Step, seconds.
    """
    if slope == 0:
        return y.copy()
    return np.asarray(y + (h if slope == 3 else 0.5 * h) * k[slope - 1])


@part
def after_step(y: Array, k: Array, h: float) -> Array:
    """State (...) after the step, from all four slopes k (4, ...)."""
    return np.asarray(y + h / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3]))

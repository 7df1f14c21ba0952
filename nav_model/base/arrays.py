"""Arrays of numbers, as every closed form takes and gives them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.base.traced import Traced

Array = NDArray[np.float64]


def as_numbers(x: ArrayLike) -> Array:
    """As an array of floats; complex numbers pass, so that a complex step gives exact derivatives.

    A `Traced` passes too, which writes the formula.

    Source: Squire and Trapp, SIAM Review 40(1), 1998.
    """
    array = np.asarray(x)
    if array.dtype.kind in "fc":
        return array
    numbers: Array = x if isinstance(x, Traced) else array.astype(float)
    return numbers


def interpolated(time: Array, stamps: Array, values: Array) -> Array:
    """Columns of values (n, k), known at `stamps` (n,), linearly between them at other times (m,): (m, k)."""
    return np.column_stack([np.interp(time, stamps, column) for column in values.T])

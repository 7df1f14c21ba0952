"""Arrays of numbers, as every closed form takes and gives them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def as_numbers(x: ArrayLike) -> Array:
    """As an array of floats; complex numbers pass, so that a complex step gives exact derivatives.

    Source: Squire and Trapp, SIAM Review 40(1), 1998.
    """
    array = np.asarray(x)
    numbers: Array = array if array.dtype.kind in "fc" else array.astype(float)
    return numbers

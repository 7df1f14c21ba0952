"""The compiled loop of back-projection; imported only when needed, because it imports Numba."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True, fastmath=True)
def project_pulses(
    profiles: NDArray[np.complex128],
    position: NDArray[np.float64],
    reference_range: NDArray[np.float64],
    bin_size: float,
    wavenumber: float,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Sum over pulses of profile(R - r0) exp(j wavenumber (R - r0)) at each pixel (z = 0), linear between bins.

    Parameters
    ----------
    profiles : array (P, bins)
        Range profiles, with range offset zero in bin bins // 2.
    position : array (P, 3)
        Antenna at each pulse, m.
    reference_range : array (P,)
        r0 of each pulse, m.
    bin_size, wavenumber : float
        m; rad/m of range.
    x, y : array
        Pixels, m.

    Returns
    -------
    array (len(y), len(x))
        Complex image.
    """
    image = np.zeros((len(y), len(x)), np.complex128)
    bins = profiles.shape[1]
    centre = bins // 2
    for p in range(profiles.shape[0]):
        px, py, pz = position[p, 0], position[p, 1], position[p, 2]
        for i in range(len(y)):
            flat = (y[i] - py) ** 2 + pz**2
            for j in range(len(x)):
                offset = np.sqrt((x[j] - px) ** 2 + flat) - reference_range[p]
                place = offset / bin_size + centre
                index = int(np.floor(place))
                if index < 0 or index >= bins - 1:
                    continue
                part = place - index
                value = profiles[p, index] * (1 - part) + profiles[p, index + 1] * part
                turn = wavenumber * offset
                image[i, j] += value * complex(np.cos(turn), np.sin(turn))
    return image

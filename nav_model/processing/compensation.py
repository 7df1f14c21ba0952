"""Remainders of sensed motion after IMU compensation, and of oscillator noise after the echo delay. [P-8],
[P-10]"""

import numpy as np

from nav_model.base.arrays import Array, as_numbers

OSCILLATING = 16 * np.pi
"""Phase w τ beyond which the power that is left is taken without its oscillation in a continuous spectrum."""


def power_left(w: Array, delay: Array, bandwidth: Array | None = None, mean: bool = False) -> Array:
    """|1 - B(w) exp(-i w τ)|²: power left of a motion after compensation with the IMU's delay and bandwidth. [P-8]

    With the echo delay and no bandwidth it is also the factor on an oscillator's phase noise, 4 sin²(w R/c). [P-10]

    Parameters
    ----------
    w : array
        Angular frequency, rad/s.
    delay : array
        Seconds.
    bandwidth : array, optional
        -3 dB bandwidth of a first-order response, Hz; without it there is only the delay.
    mean : bool
        Without the oscillation in w τ: its mean, for integrals far beyond its first periods.

    Examples
    --------
    >>> import numpy as np
    >>> f"{np.sqrt(power_left(np.array(2 * np.pi * 20), np.array(5e-3))):.3f}"  # 20 Hz, 5 ms late
    '0.618'
    """
    w, angle = as_numbers(w), as_numbers(w * delay)
    slow = 0 * w if bandwidth is None else w / (2 * np.pi * bandwidth)
    if mean:
        return np.asarray((2 + slow**2) / (1 + slow**2))
    half = np.sin(angle / 2)
    square = half**2  # products, as a power of four is slow
    return np.asarray((4 * square**2 + (slow + 2 * half * np.cos(angle / 2)) ** 2) / (1 + slow**2))

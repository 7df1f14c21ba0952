"""Where each quantity lies in the arrays that the kernels share: the first index of each group of three.

Global integers are constants in compiled code, so names cost nothing.
"""

from typing import Final

# A navigation state (15), see `strapdown`.
LATITUDE: Final = 0
LONGITUDE: Final = 1
HEIGHT: Final = 2
VELOCITY: Final = 3
"""North, east, down [m/s]; the same in a navigation state and in the filter's."""
QUATERNION: Final = 6
"""Body to NED (w, x, y, z)."""
VELOCITY_CHANGE: Final = 10
"""The last sample's, for the terms of the Earth and of transport in the middle of the step."""
WITHHELD: Final = 13
"""Remainders that rounding has so far withheld from latitude and longitude (2)."""
STATE_LENGTH: Final = 15

# The filter's error states (9, 15 or 21, and 3 more for a slow GNSS error), see `kalman`; velocity as above.
POSITION: Final = 0
ATTITUDE: Final = 6
BIASES: Final = 9
"""Accelerometer, then gyro; with 21 states both again, then as Gauss-Markov processes."""

# What a fix can measure (8): position and velocity as above, then heading and height.
HEADING: Final = 6
BAROMETER: Final = 7
MEASURED: Final = 8

# A vector of biases (12): the filter's from BIASES on, and more where it has fewer.
ACCELEROMETER: Final = 0
GYRO: Final = 3
TRIADS: Final = 6
"""From each of these to the same sensor's Gauss-Markov part."""

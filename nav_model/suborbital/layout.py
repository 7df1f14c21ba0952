"""Where each deterministic error lies in the parameter vector (61,).

Global integers are constants in compiled code, so names cost nothing.
"""

from typing import Final

ACCELEROMETERS: Final = 0
"""First entry of the accelerometers' errors."""
GYROS: Final = 24
"""First entry of the gyros' errors, as many and in the same order."""

# From the first entry of a sensor's errors [B-1]; a matrix by rows.
BIAS: Final = 0
SLOW_BIAS: Final = 3
MATRIX: Final = 6
SLOW_MATRIX: Final = 15

SENSORS: Final = slice(0, 48)
POSITION: Final = slice(48, 51)
"""North, east, down at lift-off, as velocity and attitude."""
VELOCITY: Final = slice(51, 54)
ATTITUDE: Final = slice(54, 57)
CAMERA: Final = 57
"""First of the three angles from camera to IMU."""
LATENCY: Final = 60
COUNT: Final = 61

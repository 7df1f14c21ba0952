"""A log of an IMU on a bench with known noise, as a file that states its units and no rate (it has 100 Hz)."""

import io

import numpy as np

ANGLE_WALK, VELOCITY_WALK = np.radians(0.3) / 60, 0.05 / 60  # 0.3 °/√h and 0.05 m/s/√h
_HEADER = "gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],acc_x [m/s2],acc_y [m/s2],acc_z [m/s2]"


def table(samples: int = 8000, gyros: float = 1.0, accelerometers: float = 1.0) -> np.ndarray:
    """Rates and specific forces (samples, 6), so many times noisier."""
    noise = np.random.default_rng(7).standard_normal((samples, 6)) * 10.0
    walks = np.repeat([gyros * ANGLE_WALK, accelerometers * VELOCITY_WALK], 3)
    return noise * walks + [0, 0, 0, 0, 0, 9.8]


def log(*of_table: float) -> bytes:
    """The file of such a table."""
    text = io.StringIO()
    np.savetxt(text, table(*of_table), delimiter=",", header=_HEADER, comments="", fmt="%.9g")
    return text.getvalue().encode()

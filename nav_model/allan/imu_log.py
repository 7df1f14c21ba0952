"""An inertial log in memory: SI rates, however it was stored."""

from __future__ import annotations

from dataclasses import dataclass

from nav_model.allan.noise_terms import FloatArray

AXIS_LETTERS = ("x", "y", "z")


@dataclass(frozen=True)
class ImuLog:
    """Angular rate [rad/s] and specific force [m/s²], each (samples, 3) or None, sampled at `rate_hz`.

    `temperature_c` is (samples,) or None; `reading` says how file, columns, units and rate were understood.
    """

    gyro: FloatArray | None
    accelerometer: FloatArray | None
    rate_hz: float
    temperature_c: FloatArray | None = None
    file_name: str = "in memory"
    sha256: str = ""
    reading: tuple[str, ...] = ()

    @property
    def samples(self) -> int:
        """Number of samples per axis."""
        signal = self.gyro if self.gyro is not None else self.accelerometer
        return 0 if signal is None else len(signal)

    @property
    def duration_s(self) -> float:
        """Length of the log [s]."""
        return self.samples / self.rate_hz

    def axes(self) -> list[tuple[str, str, FloatArray]]:
        """(name, quantity, signal) of every axis: gyro_x .. accelerometer_z."""
        found: list[tuple[str, str, FloatArray]] = []
        for quantity, signal in (("gyro", self.gyro), ("accelerometer", self.accelerometer)):
            if signal is not None:
                found += [(f"{quantity}_{AXIS_LETTERS[i]}", quantity, signal[:, i]) for i in range(signal.shape[1])]
        return found

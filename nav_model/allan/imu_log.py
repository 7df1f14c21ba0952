"""An inertial log in memory: rates in SI, whatever the file's format."""

from dataclasses import dataclass

from nav_model.allan.noise_terms import FloatArray
from nav_model.base.errors import InputError

AXIS_LETTERS = ("x", "y", "z")


@dataclass(frozen=True)
class ImuLog:
    """Angular rate [rad/s] and specific force [m/s²], each (samples, 3) or None, sampled at `rate_hz`.

    A sensor with a single axis has an array of (samples, 1); `gyro_axis` or `accelerometer_axis` (0 to 2) says which
    axis.

    `temperature_c` is (samples,) or None; `reading` says how file, columns, units and rate were understood.
    """

    gyro: FloatArray | None
    accelerometer: FloatArray | None
    rate_hz: float
    temperature_c: FloatArray | None = None
    file_name: str = "in memory"
    sha256: str = ""
    reading: tuple[str, ...] = ()
    gyro_axis: int = 0
    accelerometer_axis: int = 0

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
        """(name, quantity, signal) of every axis: gyro_x .. accelerometer_z. InputError if there is none."""
        found: list[tuple[str, str, FloatArray]] = []
        for quantity, signal, first in (
            ("gyro", self.gyro, self.gyro_axis),
            ("accelerometer", self.accelerometer, self.accelerometer_axis),
        ):
            if signal is not None:
                names = AXIS_LETTERS if signal.shape[1] == 3 else AXIS_LETTERS[first:]
                found += [
                    (f"{quantity}_{letter}", quantity, values)
                    for letter, values in zip(names, signal.T, strict=False)
                ]
        if not found:
            raise InputError(
                self.file_name, "The log has neither gyro nor accelerometer data. At least one is needed."
            )
        return found

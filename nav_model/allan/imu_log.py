"""An inertial log in memory: rates in SI, whatever the file's format."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.base.sampling import Rows

AXIS_LETTERS = ("x", "y", "z")
NO_BREAKS: Rows = np.empty(0, dtype=np.int64)


class AxisSignal(NamedTuple):
    """One axis: "gyro_x", "gyro", its samples [rad/s or m/s²], their rate, the first sample after each gap."""

    name: str
    quantity: str
    signal: Array
    rate_hz: float
    breaks: Rows

    @property
    def lengths(self) -> Rows:
        """Samples of each stretch between gaps."""
        return np.diff(np.concatenate([[0], self.breaks, [len(self.signal)]]))

    @property
    def stretches(self) -> list[Array]:
        """The samples between gaps."""
        return np.split(self.signal, self.breaks)


@dataclass(frozen=True)
class ImuLog:
    """Angular rate [rad/s] and specific force [m/s²], each (samples, 3) or None, sampled at `rate_hz`.

    A sensor with a single axis has an array of (samples, 1); `gyro_axis` or `accelerometer_axis` (0 to 2) says which
    axis. `rates` has the rate of a sensor that is sampled otherwise, and `breaks` the first sample after each gap in
    it, both by "gyro" or "accelerometer".

    `temperature_c` is (samples,) or None; `reading` says how file, columns, units and rate were understood;
    `rows_of_time` rows share each time stamp.
    """

    gyro: Array | None
    accelerometer: Array | None
    rate_hz: float
    temperature_c: Array | None = None
    file_name: str = "in memory"
    sha256: str = ""
    reading: tuple[str, ...] = ()
    gyro_axis: int = 0
    accelerometer_axis: int = 0
    rates: Mapping[str, float] = field(default_factory=dict)
    breaks: Mapping[str, Rows] = field(default_factory=dict)
    rows_of_time: int = 1

    @property
    def samples(self) -> int:
        """Number of samples per axis, of the sensor that has more."""
        return max((len(signal) for signal in (self.gyro, self.accelerometer) if signal is not None), default=0)

    @property
    def duration_s(self) -> float:
        """Length of the log [s], without what is lost."""
        return self.samples / self.rate_hz

    def axes(self) -> list[AxisSignal]:
        """Every axis: gyro_x .. accelerometer_z. InputError if there is none."""
        axes: list[AxisSignal] = []
        for quantity in ("gyro", "accelerometer"):
            signal, first = getattr(self, quantity), getattr(self, f"{quantity}_axis")
            if signal is not None:
                letters = AXIS_LETTERS if signal.shape[1] == 3 else AXIS_LETTERS[first:]
                sampled = self.rates.get(quantity, self.rate_hz), self.breaks.get(quantity, NO_BREAKS)
                pairs = zip(letters, signal.T, strict=False)
                axes += [AxisSignal(f"{quantity}_{letter}", quantity, values, *sampled) for letter, values in pairs]
        if not axes:
            reason = "The log has neither gyro nor accelerometer data. At least one is needed."
            raise InputError(self.file_name, reason)
        return axes

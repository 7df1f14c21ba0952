"""Results of a log analysis: frozen, SI, with provenance; and their JSON (contract.md, `allan`)."""

import math
from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np

from nav_model.allan.deviation import AllanDeviation
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.noise_terms import TERMS, allan_variance
from nav_model.base.arrays import Array
from nav_model.base.constants import DEGREE, STANDARD_GRAVITY
from nav_model.base.sampling import Rows

CONFIDENCE_INTERVAL: Final = "95 % confidence"
READING_INTERVAL: Final = "from the white-noise floor to the reading at 1 s, not a confidence interval"

_MICRO_G = STANDARD_GRAVITY * 1e-6

# Screen units of each coefficient: symbol and its value in SI.
UNITS: Final[dict[str, dict[str, tuple[str, float]]]] = {
    "gyro": {
        "quantization": ("arcsec", DEGREE / 3600.0),
        "random_walk": ("°/√h", DEGREE / 60.0),
        "bias_instability": ("°/h", DEGREE / 3600.0),
        "rate_random_walk": ("°/h/√h", DEGREE / 3600.0 / 60.0),
        "ramp": ("°/h/h", DEGREE / 3600.0 / 3600.0),
    },
    "accelerometer": {
        "quantization": ("m/s", 1.0),
        "random_walk": ("m/s/√h", 1.0 / 60.0),
        "bias_instability": ("µg", _MICRO_G),
        "rate_random_walk": ("µg/√h", _MICRO_G / 60.0),
        "ramp": ("µg/h", _MICRO_G / 3600.0),
    },
}


@dataclass(frozen=True)
class Coefficient:
    """A noise coefficient in SI with its 95 % interval and how it was obtained (`method`, a sentence for the
    reader).

    The ramp is signed; all others are positive. `reading` marks a random walk that is the effective reading
    about 1 s instead of the fitted floor; `low` to `high` then spans floor to reading and is no confidence
    interval.
    """

    value: float
    low: float
    high: float
    method: str
    reading: bool = False

    @property
    def interval(self) -> str:
        """Meaning of `low` and `high`: a reading off the curve, or a confidence interval."""
        return READING_INTERVAL if self.reading else CONFIDENCE_INTERVAL


@dataclass(frozen=True)
class LogSource:
    """Where the numbers came from: file, SHA-256, rate [Hz], duration [s], samples, how columns were read."""

    file_name: str
    sha256: str
    rate_hz: float
    duration_s: float
    samples: int
    reading: tuple[str, ...]

    @classmethod
    def of(cls, log: ImuLog) -> Self:
        """Take from a log what a result says of its file."""
        return cls(log.file_name, log.sha256, log.rate_hz, log.duration_s, log.samples, log.reading)


@dataclass(frozen=True)
class AxisNoise:
    """Noise of one axis.

    `quantity` is "gyro" (rad/s) or "accelerometer" (m/s²), sampled at `rate_hz` in stretches of `lengths` samples
    between gaps. `coefficients` maps each of noise_terms.TERMS to a
    Coefficient or None; `not_resolved` holds the reason of each None and `would_resolve` the log that would
    show it; `at_most` the 95 % limit of those that the log is consistent with none of. `white_floor` is the fitted N
    and `effective_at_1s` the slope -1/2 line read over the decade about 1 s (None where the log is too short or
    too slow), both in rad/√s or m/s/√s. `band_hz` is the top of the fitted band, `lines_hz` the vibration
    lines left out of it, `model_error` the relative departure of the measured spectrum from the five terms.
    """

    name: str
    quantity: str
    rate_hz: float
    lengths: Rows
    mean: float
    standard_deviation: float
    deviation: AllanDeviation
    coefficients: dict[str, Coefficient | None]
    not_resolved: dict[str, str]
    at_most: dict[str, float]
    would_resolve: dict[str, str]
    white_floor: float
    effective_at_1s: float | None
    band_hz: float
    lines_hz: tuple[float, ...]
    model_error: float
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class LogAnalysis:
    """All axes of one static log."""

    axes: tuple[AxisNoise, ...]
    provenance: LogSource
    warnings: tuple[str, ...]


def axis_label(name: str) -> str:
    """An axis of a log as a person reads it: "gyro x" of "gyro_x"."""
    return name.replace("_", " ")


def fitted_lines(axis: AxisNoise, tau_s: Array) -> dict[str, Array]:
    """Allan deviation of each resolved term at `tau_s` [s], and of all under "total"; SI of the rate.

    A random walk read at 1 s is drawn as read, so "total" may then lie above the measured curve.
    """
    resolved = {term: coefficient for term, coefficient in axis.coefficients.items() if coefficient is not None}
    variances = {term: allan_variance(term, coefficient.value, tau_s) for term, coefficient in resolved.items()}
    lines = {term: np.sqrt(variance) for term, variance in variances.items()}
    total = sum(variances.values(), start=np.zeros_like(tau_s))
    return {**lines, "total": np.sqrt(total)}


def triad_coefficient(result: LogAnalysis, quantity: str, term: str = "random_walk") -> Coefficient | None:
    """One coefficient for the design from a triad: rms over its axes, which keeps their mean variance.

    `quantity` is "gyro" or "accelerometer", `term` one of noise_terms.TERMS. A random walk read about 1 s on any axis
    makes the whole a reading. None when an axis is missing or did not resolve the term.
    """
    terms = [axis.coefficients[term] for axis in result.axes if axis.quantity == quantity]
    known = [coefficient for coefficient in terms if coefficient is not None]
    if len(known) < 3:
        return None
    value, low, high = (
        math.sqrt(sum(getattr(c, field) ** 2 for c in known) / len(known)) for field in ("value", "low", "high")
    )
    read = [axis_label(axis.name) for axis in result.axes if axis.quantity == quantity and _is_reading(axis)]
    read = read if term == "random_walk" else []
    method = f"rms of {quantity} x, y, z"
    if read:
        method += f"; read at 1 s, above the white-noise floor, on {', '.join(read)}"
    return Coefficient(value, low, high, method, reading=bool(read))


def _is_reading(axis: AxisNoise) -> bool:
    walk = axis.coefficients["random_walk"]
    return walk is not None and walk.reading


def to_json(result: LogAnalysis) -> dict[str, Any]:
    """The analysis as JSON-ready data: coefficients in the units of UNITS, curves and means in SI."""
    return {
        "provenance": {
            "file": result.provenance.file_name,
            "sha256": result.provenance.sha256,
            "rate_hz": result.provenance.rate_hz,
            "duration_s": result.provenance.duration_s,
            "samples": result.provenance.samples,
            "reading": list(result.provenance.reading),
        },
        "warnings": list(result.warnings),
        "axes": [_axis_json(axis) for axis in result.axes],
    }


def _axis_json(axis: AxisNoise) -> dict[str, Any]:
    units = UNITS[axis.quantity]
    white_unit, white_si = units["random_walk"]
    effective = axis.effective_at_1s
    return {
        "name": axis.name,
        "rate_hz": axis.rate_hz,
        "stretches": len(axis.lengths),
        **{term: _coefficient_json(axis.coefficients[term], *units[term]) for term in TERMS},
        "not_resolved": dict(axis.not_resolved),
        "would_resolve": dict(axis.would_resolve),
        "white_floor": {"value": axis.white_floor / white_si, "unit": white_unit},
        "effective_at_1s": None if effective is None else {"value": effective / white_si, "unit": white_unit},
        "mean": {"value": axis.mean, "unit": "rad/s" if axis.quantity == "gyro" else "m/s²"},
        "standard_deviation": axis.standard_deviation,
        "band_hz": axis.band_hz,
        "lines_hz": list(axis.lines_hz),
        "model_error": axis.model_error,
        "warnings": list(axis.warnings),
        "allan_deviation": {
            "tau_s": axis.deviation.tau_s.tolist(),
            "deviation": axis.deviation.deviation.tolist(),
            "low": axis.deviation.low.tolist(),
            "high": axis.deviation.high.tolist(),
        },
    }


def _coefficient_json(coefficient: Coefficient | None, unit: str, si: float) -> dict[str, Any] | None:
    if coefficient is None:
        return None
    return {
        "value": coefficient.value / si,
        "low": coefficient.low / si,
        "high": coefficient.high / si,
        "unit": unit,
        "method": coefficient.method,
        "interval": coefficient.interval,
    }

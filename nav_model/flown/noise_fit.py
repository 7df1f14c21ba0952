"""Noise of a receiver from its fixes on a flight: white noise, and a slow error with its time, against a reference.

A fix less the reference is taken as white noise and a first-order Gauss-Markov process, the receiver model of a
design: an ARMA(1, 1) process, whose innovations a filter in its steady state gives. Their likelihood is maximised;
intervals are those of its curvature, at 95 %. Source: Box, Jenkins and Reinsel, *Time Series Analysis*, ch. 7.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.adoption import Adoption
from nav_model.base.units import format_quantity
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.flown.relation import Compared

FloatArray = NDArray[np.float64]
_FEWEST = 200  # fixes
_TIMES = 10.0  # correlation times that a log needs to tell them
_CLEARLY = 6.0  # of the logarithm of the likelihood: a slow error with two parameters is there
_NORMAL = 1.96
_LAGS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
_DIGITS = 3
_PARTS: tuple[str, ...] = ("white", "slow", "time")


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval, and what the design declares."""

    value: float
    low_95: float
    high_95: float
    declared: float


def receiver_of(design: Design, compared: Compared) -> Mapping[str, Any]:
    """Noise of the receiver seen in a difference to a reference, beside what the design declares.

    Parameters
    ----------
    design : Design
    compared : Compared
        Fixes less the reference.

    Returns
    -------
    mapping
        "horizontal" and "vertical": "white", "slow" [m] and "time" [s], each as `Estimate` or None; "velocity": white
        [m/s] or None; "lags_s", "seen_m", "declared_m": half the mean square change over a lag, as a sigma, of a
        horizontal axis; "reason": why something is not told.
    """
    gnss, at = design.gnss, _longest_even(compared.time_s)
    time = compared.time_s[at]
    if len(time) < _FEWEST:
        return {"reason": f"{len(time)} fixes without a gap; the receiver's noise needs {_FEWEST}"}
    step, position = float(np.median(np.diff(time))), compared.position[at]
    vertical = gnss.vertical_position_noise or gnss.position_noise
    slow, slow_vertical, slow_time = 0.0, 0.0, 0.0
    if gnss.correlated:
        slow, slow_time = gnss.correlated_noise, gnss.correlation_time
        slow_vertical = gnss.vertical_correlated_noise or slow * vertical / gnss.position_noise
    result: dict[str, Any] = {}
    reasons = []
    for name, axes, declared in (
        ("horizontal", [0, 1], (gnss.position_noise, slow, slow_time)),
        ("vertical", [2], (vertical, slow_vertical, slow_time)),
    ):
        result[name], reason = _of_axes(position[:, axes], step, declared)
        reasons += [f"{name}: {reason}"] if reason else []
    result["velocity"] = None
    if compared.velocity is not None:
        velocity = compared.velocity[at][:, :2]
        white = float(np.sqrt(np.mean(np.diff(velocity, n=2, axis=0) ** 2) / 6.0))
        result["velocity"] = _of_white(white, len(velocity), gnss.velocity_noise or math.nan) if white else None
    lags = [lag for lag in _LAGS if lag < len(time) // 4]
    seen = [float(np.sqrt(np.mean((position[lag:, :2] - position[:-lag, :2]) ** 2) / 2.0)) for lag in lags]
    fade = [math.exp(-lag * step / slow_time) if slow_time else 0.0 for lag in lags]
    result |= {
        "lags_s": [lag * step for lag in lags],
        "seen_m": seen,
        "declared_m": [math.sqrt(gnss.position_noise**2 + slow**2 * (1.0 - one)) for one in fade],
        "reason": "; ".join(reasons),
    }
    return result


def _longest_even(time: FloatArray) -> slice:
    """The longest part of some times without a gap."""
    steps = np.diff(time)
    ends = np.concatenate([[0], np.flatnonzero(steps > 1.5 * np.median(steps)) + 1, [len(time)]])
    longest = int(np.argmax(np.diff(ends)))
    return slice(int(ends[longest]), int(ends[longest + 1]))


def _of_axes(values: FloatArray, step: float, declared: Sequence[float]) -> tuple[dict[str, Any], str]:
    """White noise and slow error of some axes (n, axes) alike, and why one is not told."""
    values = values - values.mean(axis=0)
    if not values.any():
        return dict.fromkeys(_PARTS), "the two are the same"
    duration = len(values) * step
    logs, sigmas = _fitted(values, step)
    alone = 0.5 * values.size * (1.0 + math.log(float(np.mean(values**2))))
    names, reason = _PARTS, ""
    if alone - _less_likely(logs, values, step) < _CLEARLY:
        white = float(np.sqrt(np.mean(values**2)))
        return dict.fromkeys(_PARTS) | {"white": _of_white(white, values.size, declared[0])}, ""
    if duration < _TIMES * math.exp(logs[2]):
        names = ("white",)
        reason = f"{duration:.0f} s are fewer than {_TIMES:.0f} correlation times of {math.exp(logs[2]):.0f} s"
    estimates: dict[str, Any] = dict.fromkeys(_PARTS)
    for name, log, sigma, given in zip(_PARTS, logs, sigmas, declared, strict=True):
        if name in names and math.isfinite(sigma) and sigma < 1.0:
            ends = math.exp(log - _NORMAL * sigma), math.exp(log + _NORMAL * sigma)
            estimates[name] = asdict(Estimate(math.exp(log), *ends, given))
        elif name in names:
            reason = reason or f"the {name} part is not told apart"
    return estimates, reason


def _of_white(sigma: float, count: int, declared: float) -> dict[str, float]:
    """White noise of so many values, with the interval of its sigma."""
    interval = math.exp(_NORMAL / math.sqrt(2.0 * count))
    return asdict(Estimate(sigma, sigma / interval, sigma * interval, declared))


def _fitted(values: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """White noise, slow error and its time that are likeliest, as logarithms, and one sigma of each."""
    from scipy.optimize import minimize

    # Second differences have next to nothing of what is slow.
    white = max(float(np.sqrt(np.mean(np.diff(values, n=2, axis=0) ** 2) / 6.0)), 1e-9)
    rest = math.sqrt(max(float(np.mean(values**2)) - white**2, 1e-4 * white**2))
    best = min(
        (
            minimize(_less_likely, np.log([white, rest, time]), args=(values, step), method="Nelder-Mead")
            for time in (5.0 * step, 30.0 * step, 200.0 * step)
        ),
        key=lambda fit: float(fit.fun),
    )
    logs, h = np.asarray(best.x), 0.02
    curvature = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            ends = [
                _less_likely(logs + h * (si * np.eye(3)[i] + sj * np.eye(3)[j]), values, step)
                for si, sj in ((1, 1), (1, -1), (-1, 1), (-1, -1))
            ]
            curvature[i, j] = (ends[0] - ends[1] - ends[2] + ends[3]) / (4.0 * h * h)
    eigen = np.linalg.eigvalsh(curvature)
    sigmas = np.sqrt(np.diag(np.linalg.inv(curvature))) if eigen[0] > 0.0 else np.full(3, np.inf)
    return logs, sigmas


def _less_likely(logs: FloatArray, values: FloatArray, step: float) -> float:
    """Negative logarithm of the likelihood, less its constant: innovations of a filter in its steady state."""
    from scipy.signal import lfilter

    white, slow, time = np.exp(np.clip(logs, -30.0, 30.0)).tolist()
    phi, r = math.exp(-step / time), white**2
    q = slow**2 * (1.0 - phi**2)
    # P of the slow error before a fix: P = phi² P r / (P + r) + q.
    b = r * (1.0 - phi**2) - q
    P = 0.5 * (-b + math.sqrt(b * b + 4.0 * q * r))
    S = P + r
    innovation = lfilter([1.0, -phi], [1.0, -phi * r / S], values, axis=0)
    return 0.5 * float(values.size * math.log(S) + np.sum(innovation**2) / S)


def adopt_receiver(receiver: Mapping[str, Any], name: str) -> Adoption:
    """The receiver's noise as changes to a design, with its origin; what is not told changes nothing.

    Parameters
    ----------
    receiver : mapping
        As `receiver_of` gives it.
    name : str
        Of the solution, for the origin.
    """
    keys = {
        ("horizontal", "white"): "gnss.position_noise",
        ("vertical", "white"): "gnss.vertical_position_noise",
        ("horizontal", "slow"): "gnss.correlated_noise",
        ("vertical", "slow"): "gnss.vertical_correlated_noise",
        ("horizontal", "time"): "gnss.correlation_time",
    }
    changes: dict[str, Any] = {}
    written: dict[str, str] = {}
    origins: dict[str, str] = {}

    def put(key: str, estimate: Mapping[str, float]) -> None:
        declared = quantity(key)
        unit, dimension = declared.unit, declared.dimension
        parsed = declared.read(format_quantity(estimate["value"], unit, dimension, _DIGITS))
        changes[key], written[key] = parsed.value, parsed.unit
        ends = (format_quantity(estimate[end], unit, dimension, _DIGITS) for end in ("low_95", "high_95"))
        origins[key] = f"from the fixes of {' '.join(name.split())[:80]}, {' to '.join(ends)} (95 %)"

    for (axis, part), key in keys.items():
        if estimate := (receiver.get(axis) or {}).get(part):
            put(key, estimate)
    if "gnss.correlated_noise" in changes:
        changes["gnss.correlated"] = True
    if velocity := receiver.get("velocity"):
        put("gnss.velocity_noise", velocity)
    return Adoption(changes, written, origins)

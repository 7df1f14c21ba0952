"""Noise parameters of every axis of a static log."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from nav_model.allan.axis_fit import PASSED_SHARE, WORST_MODEL_ERROR, AxisFit, fit_axis
from nav_model.allan.deviation import NOISE_ALPHA, AllanDeviation, averaging_times, overlapping_allan_deviation
from nav_model.allan.imu_log import AxisSignal, ImuLog
from nav_model.allan.likelihood import Estimate
from nav_model.allan.noise_terms import STOCHASTIC_TERMS, TERMS, allan_variance
from nav_model.allan.remedy import Cause, what_would_resolve
from nav_model.allan.result import UNITS, AxisNoise, Coefficient, LogAnalysis, LogSource
from nav_model.allan.spectrum import cosine_spectrum
from nav_model.allan.warnings import axis_warnings, log_warnings, saturated_share
from nav_model.base.arrays import Array

# Both shares were set on the available logs: 0.93 and more for the ADIS16405 gyros, 0.34 to 0.56 for its
# accelerometers under a 0.6 Hz line.
# The white floor stands for the random walk when it makes up at least this share of the Allan variance about
# 1 s.
_WHITE_SHARE = 0.9
# Below this share, something four times as strong as the sensor's own noise dominates there.
_LEAST_WHITE_SHARE = 0.25
_LIKELIHOOD = "maximum likelihood on the cosine spectrum, profile interval"
_READ_AT_1S = "slope -1/2 line through the Allan deviation over the decade about 1 s; from the white floor up to it"


@dataclass(frozen=True)
class _Missing:
    """Why a coefficient is not given; ``limit``: what it is at most with 95 %, where the log says that."""

    reason: str
    cause: Cause
    limit: float | None = None


def analyse_log(
    log: ImuLog, progress: Callable[[float, str], None] | None = None, bandwidth_hz: float | None = None
) -> LogAnalysis:
    """Noise parameters of a static log, axis by axis.

    `progress` receives a fraction and what is being done; `bandwidth_hz` is that of a low pass inside the sensor,
    where there is one. Raises InputError under the log's name when it is empty, ValueError when it is shorter than
    the fit needs. Method: likelihood.py for the coefficients, axis_fit.py for real-log departures, deviation.py for
    curves.

    Examples
    --------
    >>> import numpy as np
    >>> from nav_model import analyse_log, read_log
    >>> rows = np.random.default_rng(1).normal(0.0, 1e-4, (20_000, 6))  # gyros [rad/s], accelerometers [m/s²]
    >>> table = "\\n".join(",".join(f"{x:.9f}" for x in row) for row in rows)
    >>> heads = "gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],acc_x [m/s^2],acc_y [m/s^2],acc_z [m/s^2]"
    >>> log = analyse_log(read_log(f"# rate 100 Hz\\n{heads}\\n{table}\\n".encode(), file_name="bench.csv"))
    >>> len(log.axes)
    6
    """
    axes = log.axes()
    results = []
    for index, axis in enumerate(axes):
        if progress is not None:
            progress(index / len(axes), axis.name)
        results.append(_analyse_axis(axis, log.temperature_c, bandwidth_hz))
    if progress is not None:
        progress(1.0, "done")
    return LogAnalysis(tuple(results), LogSource.of(log), log_warnings(log))


def _analyse_axis(axis: AxisSignal, temperature_c: Array | None, bandwidth_hz: float | None) -> AxisNoise:
    signal = np.ascontiguousarray(axis.signal, dtype=np.float64)
    interval_s, breaks = 1.0 / axis.rate_hz, axis.breaks
    of_axis = partial(_axis_noise, axis._replace(signal=signal))

    def without_noise(why: _Missing, warning: str) -> AxisNoise:
        """An axis that holds no noise to fit, with the reason under every coefficient."""
        deviation = overlapping_allan_deviation(signal, interval_s, breaks=breaks)
        return of_axis(
            dict.fromkeys(TERMS, why), deviation=deviation, white_floor=0.0, effective_at_1s=None,
            band_hz=0.5 / interval_s, lines_hz=(), model_error=0.0, warnings=(warning,),
        )  # fmt: skip

    if np.all(signal == signal[0]):
        reason = f"not resolved: every sample is {signal[0]:g}; not connected, or resolution too coarse"
        return without_noise(_Missing(reason, "constant"), "constant: no noise to analyse")
    if cut := saturated_share(signal):
        reason = f"not resolved: {cut:.2%} of the samples are at a limit of the sensor's range, which clips its noise"
        warning = f"saturated: {cut:.2%} of the samples are at the largest or smallest value"
        return without_noise(_Missing(reason, "saturated"), warning)
    spectrum = cosine_spectrum(signal, interval_s, breaks)
    if spectrum.repeats:
        shape = "the signal repeats itself exactly, so that its spectrum is empty between lines"
        reason = f"not resolved: {shape}; no sensor's noise does"
        warning = "repeats itself exactly: a stretch copied behind itself, or a made-up signal"
        return without_noise(_Missing(reason, "repeating"), warning)
    fit = fit_axis(spectrum, bandwidth_hz)
    squares = dict(zip(STOCHASTIC_TERMS, fit.fit.squares, strict=True))
    taus = averaging_times(int(axis.lengths.max()), interval_s)
    deviation = overlapping_allan_deviation(signal, interval_s, taus, _dominant_alpha(fit, taus), breaks=breaks)
    effective = _effective_at_1s(deviation)
    outcomes: dict[str, Coefficient | _Missing] = {}
    for term in TERMS:
        estimate = fit.fit.ramp if term == "ramp" else _root(squares[term])
        outcomes[term] = _coefficient(term, axis.quantity, estimate, fit, deviation, effective)
    return of_axis(
        outcomes, deviation=deviation, white_floor=math.sqrt(squares["random_walk"].value), effective_at_1s=effective,
        band_hz=fit.band_hz, lines_hz=fit.lines_hz, model_error=fit.model_error,
        warnings=_fit_warnings(fit, outcomes, bandwidth_hz) + axis_warnings(signal, interval_s, temperature_c),
    )  # fmt: skip


def _axis_noise(axis: AxisSignal, outcomes: Mapping[str, Coefficient | _Missing], **fitted: Any) -> AxisNoise:
    """The axis with what was outcome of each term, and with the other fields as they are `fitted`."""
    resolved = {term: outcome for term, outcome in outcomes.items() if isinstance(outcome, Coefficient)}
    missing = {term: outcome for term, outcome in outcomes.items() if isinstance(outcome, _Missing)}
    longest_s = float(axis.lengths.max()) / axis.rate_hz
    return AxisNoise(
        name=axis.name,
        quantity=axis.quantity,
        rate_hz=axis.rate_hz,
        lengths=axis.lengths,
        mean=float(axis.signal.mean()),
        standard_deviation=float(axis.signal.std(ddof=1)),
        coefficients={term: resolved.get(term) for term in outcomes},
        not_resolved={term: why.reason for term, why in missing.items()},
        at_most={term: why.limit for term, why in missing.items() if why.limit is not None},
        would_resolve={
            term: what_would_resolve(why.cause, term, resolved, longest_s, 1.0 / axis.rate_hz)
            for term, why in missing.items()
        },
        **fitted,
    )


def _root(square: Estimate) -> Estimate:
    return Estimate(math.sqrt(square.value), math.sqrt(square.low), math.sqrt(square.high))


def _coefficient(
    term: str, quantity: str, estimate: Estimate, fit: AxisFit, deviation: AllanDeviation, effective: float | None
) -> Coefficient | _Missing:
    """The coefficient, or the reason why the log does not show it."""
    if fit.model_error > WORST_MODEL_ERROR:
        if fit.falls_hz is not None:
            return _Missing(f"not resolved: {_falls(fit.falls_hz)}", "filtered")
        reason = f"the spectrum departs from the five noise terms by {100 * fit.model_error:.0f} % across the band"
        disturbed = "the log is disturbed (movement or vibration), not at rest"
        return _Missing(f"not resolved: {reason}; {disturbed}", "disturbed")
    if term == "quantization" and fit.band_cut:
        shaped = "the spectrum is shaped by the sensor's filter or by vibration, which hides quantization"
        return _Missing(f"not resolved: above {fit.band_hz:g} Hz {shaped}", "filtered")
    if term == "random_walk" and not fit.clean and effective is not None:
        share = (estimate.value / effective) ** 2
        if share < _LEAST_WHITE_SHARE:
            times = f"{1.0 / math.sqrt(max(share, 1e-12)):.1f} times what the white floor explains"
            reason = f"the Allan deviation about 1 s is {times}; a disturbance dominates there"
            return _Missing(f"not resolved: {reason}", "vibrating")
        if share < _WHITE_SHARE:
            nearest = int(np.argmin(np.abs(np.log(deviation.tau_s))))
            widen = float(deviation.high[nearest] / deviation.deviation[nearest])
            return Coefficient(
                effective, min(estimate.low, effective / widen), effective * widen, _READ_AT_1S, reading=True
            )
    if estimate.low <= 0.0 <= estimate.high:
        unit, si = UNITS[quantity][term]
        limit = max(abs(estimate.low), abs(estimate.high))
        reason = f"not resolved, at most {limit / si:.3g} {unit} (95 %)"
        return _Missing(reason, "hidden", limit)
    return Coefficient(estimate.value, estimate.low, estimate.high, _LIKELIHOOD)


def _effective_at_1s(deviation: AllanDeviation) -> float | None:
    """Slope -1/2 line, least squares in logarithms over the decade of averaging times centred on 1 s.

    None unless the log's averaging times span that decade. IEEE Std 952 reads N at 1 s off a slope -1/2 line laid
    along the stretch that has that slope; where a vibration line near 1 Hz leaves no such stretch the decade is
    ours, and averages over the line, which a reading at 1 s alone takes in full. Of 17 windows tried it is among
    the closest to the ADIS16405 figures it is tested on (3 %; 1 s alone: 13 %). Those figures are what the line
    through the Allan deviation at 3 s alone gives, past the vibration (five of six to the last digit printed, all
    within 3 %): a choice of where to read, not another sensor.
    """
    low, high = 10.0**-0.5, 10.0**0.5
    if deviation.tau_s[0] > low or deviation.tau_s[-1] < high:
        return None
    inside = (deviation.tau_s >= low) & (deviation.tau_s <= high)
    level = np.log(deviation.deviation[inside] * np.sqrt(deviation.tau_s[inside]))
    return float(np.exp(level.mean()))


def _dominant_alpha(fit: AxisFit, tau_s: Array) -> Array:
    """Dominant noise type at each averaging time, for the degrees of freedom of the Allan estimates."""
    terms = [*STOCHASTIC_TERMS, "ramp"]
    values = [math.sqrt(square.value) for square in fit.fit.squares] + [fit.fit.ramp.value]
    variances = np.stack([allan_variance(term, value, tau_s) for term, value in zip(terms, values, strict=True)])
    alphas = np.array([NOISE_ALPHA[term] for term in terms], dtype=np.float64)
    return np.asarray(alphas[np.argmax(variances, axis=0)])


def _falls(frequency_hz: float) -> str:
    return f"the spectrum falls beyond {frequency_hz:.2g} Hz as behind a low pass; give the bandwidth"


def _fit_warnings(
    fit: AxisFit, outcomes: Mapping[str, Coefficient | _Missing], bandwidth_hz: float | None
) -> tuple[str, ...]:
    warnings = []
    if fit.lines_hz:
        lines = ", ".join(f"{line:.3g}" for line in fit.lines_hz)
        warnings.append(f"vibration or interference at {lines} Hz, left out of the fit")
    if fit.falls_hz is not None:
        warnings.append(_falls(fit.falls_hz))
    elif fit.band_cut and bandwidth_hz is not None:
        share = f"{PASSED_SHARE:g} of the bandwidth of {bandwidth_hz:g} Hz, which a low pass leaves as it was"
        warnings.append(f"fitted up to {fit.band_hz:g} Hz: {share}")
    elif fit.band_cut:
        warnings.append(f"fitted up to {fit.band_hz:g} Hz: above it the five noise terms do not hold")
    if fit.falls_hz is None and 0.0 < fit.model_error <= WORST_MODEL_ERROR:
        off = 100 * fit.model_error
        warnings.append(f"the spectrum departs from the fit by {off:.0f} %; the intervals include it")
    walk = outcomes["random_walk"]
    if isinstance(walk, Coefficient) and walk.reading:
        warnings.append("random walk read at 1 s includes vibration and slow noise; the white floor is lower")
    if isinstance(outcomes["ramp"], Coefficient):
        warnings.append("drifts steadily over the log: warm-up or temperature")
    return tuple(warnings)

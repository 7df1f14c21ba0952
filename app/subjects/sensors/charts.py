"""The charts of a static log, as plain data: Allan deviations with their confidence and the fitted noise terms."""

import numpy as np

from app.charts.kinds import Array, Band, Chart, Line
from nav_model.allan.noise_terms import TERMS
from nav_model.allan.result import UNITS, AxisNoise, LogAnalysis, axis_label, fitted_lines

AXES = ("x", "y", "z")
TERM_NAMES = {
    "quantization": "quantization",
    "random_walk": "random walk",
    "bias_instability": "bias instability",
    "rate_random_walk": "rate random walk",
    "ramp": "ramp",
}
_NAMES = {"gyro": "Gyros", "accelerometer": "Accelerometers"}
_SIGNALS = {"gyro": "angular rate", "accelerometer": "specific force"}
_FITTED = "noise terms of IEEE Std 952, maximum likelihood on the cosine spectrum"
_MEASURED = "overlapping Allan deviation, NIST SP 1065"
_KNOWLEDGE = (
    "overlapping Allan deviation (NIST SP 1065), 95 % intervals by the degrees of freedom of Greenhall and Riley; "
    "the fit is to the log's spectrum, not to this curve, so that the two check each other. "
)
_NOTHING = np.array([np.nan])


def triad_chart(result: LogAnalysis, quantity: str) -> Chart:
    """Allan deviation of a triad ("gyro" or "accelerometer"), the fitted noise of each axis dotted."""
    axes = {axis.name[-1]: axis for axis in result.axes if axis.quantity == quantity}
    unit, scale = _deviation_unit(quantity)
    bands, lines = [], []
    for letter in AXES:
        tau, deviation, low, high, fitted = _curves(axes.get(letter), scale)
        bands.append(Band(f"b{letter}", f"{letter}, 95 %", tau, low, high, letter, _MEASURED))
        lines += [
            Line(f"m{letter}", letter, tau, deviation, letter, _MEASURED),
            Line(f"f{letter}", f"{letter}, fitted", tau, fitted["total"], f"fit {letter}", _FITTED),
        ]
    readings = [
        letter
        for letter, axis in axes.items()
        if (walk := axis.coefficients["random_walk"]) is not None and walk.reading
    ]
    caution = ""
    if readings:
        caution = (
            f"On {', '.join(readings)} the random walk drawn is read at 1 s, above the white-noise floor, "
            "so the fitted line may lie above the measured one."
        )
    return Chart(
        key=f"allan_{quantity}",
        title=f"{_NAMES[quantity]}: Allan deviation",
        x_label="averaging time τ [s]",
        y_label=f"Allan deviation of {_SIGNALS[quantity]} [{unit}]",
        lines=tuple(lines[::2] + lines[1::2]),
        bands=tuple(bands),
        x_log=True,
        y_log=True,
        knowledge=_KNOWLEDGE + caution,
    )


def axis_chart(result: LogAnalysis, name: str) -> Chart:
    """One axis term by term: what each resolved noise term contributes; the others are absent."""
    axis = next(axis for axis in result.axes if axis.name == name)
    unit, scale = _deviation_unit(axis.quantity)
    tau, deviation, low, high, fitted = _curves(axis, scale)
    absent = np.full_like(tau, np.nan)
    terms = [Line(term, TERM_NAMES[term], tau, fitted.get(term, absent), term, f"{_FITTED}, alone") for term in TERMS]
    missing = [TERM_NAMES[term] for term in TERMS if axis.coefficients[term] is None]
    return Chart(
        key="allan_axis",
        title="One axis, term by term",
        x_label="averaging time τ [s]",
        y_label=f"Allan deviation [{unit}]",
        lines=(
            Line("measured", "measured", tau, deviation, "measured", _MEASURED),
            *terms,
            Line("total", "sum of terms", tau, fitted["total"], "fit", _FITTED),
        ),
        bands=(Band("band", "measured, 95 %", tau, low, high, "measured", _MEASURED),),
        x_log=True,
        y_log=True,
        knowledge=f"{axis_label(name)[:1].upper()}{axis_label(name)[1:]}. "
        + (
            f"Not resolved in this log, not drawn: {', '.join(missing)}."
            if missing
            else "All five terms are resolved."
        ),
    )


def _deviation_unit(quantity: str) -> tuple[str, float]:
    """The unit of the Allan deviation is that of the bias instability."""
    return UNITS[quantity]["bias_instability"]


def _curves(axis: AxisNoise | None, scale: float) -> tuple[Array, Array, Array, Array, dict[str, Array]]:
    """Averaging times, deviation, limits and fitted lines of an axis, without values that a log axis cannot show."""
    if axis is None:
        return _NOTHING, _NOTHING, _NOTHING, _NOTHING, {"total": _NOTHING}
    measured = axis.deviation
    deviation, low, high = (_positive(curve / scale) for curve in (measured.deviation, measured.low, measured.high))
    lines = fitted_lines(axis, measured.tau_s)
    return measured.tau_s, deviation, low, high, {key: _positive(line / scale) for key, line in lines.items()}


def _positive(curve: Array) -> Array:
    return np.where(curve > 0.0, curve, np.nan)

"""Sensor errors along the flight, and the white-noise ensemble."""

import math

import numpy as np

from app.charts.kinds import Band, Chart, Line
from app.document.numbers import number
from app.subjects.suborbital.charts.content import CHANNELS, SENSOR_CLASSES, SENSORS, TIME, Content, boost
from nav_model.base.constants import STANDARD_GRAVITY

_UNITS = ((1e3 / STANDARD_GRAVITY, "mg", "specific force"), (math.degrees(3600.0), "°/h", "angular rate"))
_STYLES = tuple((f"{sensor} bias", f"{sensor} instability", "everything") for sensor in SENSORS)


def sensor_chart(page: Content, axis: int, sensor: int) -> Chart:
    """One sensor's error along the flight (axis x, y, z; sensor 0 accelerometer, 1 gyro)."""
    factor, unit, what = _UNITS[sensor]
    name, letter = SENSORS[sensor], "xyz"[axis]
    history = page.sensor_errors
    errors = (history.specific_force_m_s2, history.angular_rate_rad_s)[sensor]
    white = page.survey.settings.show(f"{name}s.white_noise")
    return Chart(
        key=f"{name}-error-{letter}",
        title=f"{name.capitalize()} error, {letter} axis",
        x_label=TIME,
        y_label=f"{what} error [{unit}]",
        lines=tuple(
            Line(kind, kind, history.time_s, factor * errors[3 * sensor + k, :, axis], style, "[B-1]")
            for k, (kind, style) in enumerate(zip(SENSOR_CLASSES, _STYLES[sensor], strict=True))
        ),
        spans=boost(page.study),
        knowledge=f"Sensor error [B-1] at the true {what}: bias is every constant term (scale factor and "
        f"misalignment times the {what} among them), instability every oscillating one; white noise, {white}, "
        "has no value at an instant and is not drawn.",
    )


def noise_chart(page: Content, channel: int) -> Chart:
    """White noise in one channel, ensemble against its prediction."""
    study, ensemble = page.study, page.ensemble
    x = study.pure.time_s
    predicted = (
        ("INS alone", study.pure_noise.position_sigma_m[:, channel]),
        ("INS with tracker", study.aided_noise.position_sigma_m[:, channel]),
    )
    flown, low, high = (np.full(len(x), np.nan),) * 2, math.nan, math.nan
    result = "Prediction only; press Run for an ensemble."
    if ensemble is not None:
        flown = (ensemble.pure_rms_m[:, channel], ensemble.aided_rms_m[:, channel])
        low, high = ensemble.low, ensemble.high
        result = (
            f"Ensemble of {ensemble.runs} INS with independent noise, seed {ensemble.seed}; bands: where the rms of "
            f"so many runs lies with 95 % probability at an instant ({number(low)} to {number(high)} of predicted)."
        )
    return Chart(
        key=f"white-noise-{CHANNELS[channel]}",
        title=f"White noise, {CHANNELS[channel]}",
        x_label=TIME,
        y_label=f"{CHANNELS[channel]} error, 1σ [m]",
        lines=(
            *(Line(name, f"{name}, predicted", x, sigma, name, "covariance of [B-4]") for name, sigma in predicted),
            *(
                Line(f"{name}-rms", f"{name}, ensemble", x, rms, f"{name}, ensemble", "INS [B-3], Monte Carlo")
                for (name, _), rms in zip(predicted, flown, strict=True)
            ),
        ),
        bands=tuple(
            Band(name, f"{name}, 95 % of ensembles", x, low * sigma, high * sigma, name, "chi-square")
            for name, sigma in predicted
        ),
        spans=boost(study),
        knowledge=f"Prediction: covariance of [B-4] under white noise [B-1]. {result}",
    )

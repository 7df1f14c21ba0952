"""Sensor errors along the flight, and what white noise makes of the position."""

import math

from app.charts.kinds import Chart, Line
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
    """Sigma of white noise in one channel."""
    study = page.study
    spreads = (("INS alone", study.pure_noise), ("INS with tracker", study.aided_noise))
    return Chart(
        key=f"white-noise-{CHANNELS[channel]}",
        title=f"White noise, {CHANNELS[channel]}",
        x_label=TIME,
        y_label=f"{CHANNELS[channel]} error, 1σ [m]",
        lines=tuple(
            Line(name, name, study.pure.time_s, spread.position_sigma_m[:, channel], name, "covariance of [B-4]")
            for name, spread in spreads
        ),
        spans=boost(study),
        knowledge="Covariance of [B-4] under white noise [B-1]. The command flies it as a Monte Carlo: `navbudget "
        "suborbital --noise-runs`.",
    )

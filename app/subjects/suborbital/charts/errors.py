"""Position errors: by source, INS against aided, and the unstable height."""

import numpy as np

from app.charts.kinds import Array, Band, Chart, Line
from app.document.numbers import percent, show, show_in
from app.subjects.suborbital.charts.content import CHANNELS, SHOWN_SOURCES, SUM, TIME, Content, boost, called, km
from nav_model.suborbital.channels import height_e_folding_time, height_growth
from nav_model.suborbital.sensitivity import along_track_sigma
from nav_model.suborbital.study import Study

HOLDS_WITHIN = 0.1  # of the INS's own error: where the decoupled channel is drawn as holding


def source_chart(page: Content, channel: int) -> Chart:
    """Errors by source in one channel."""
    study = page.study
    which = "with star tracker" if page.aided_sources else "INS alone"
    x, axis = study.pure.time_s, page.axis(channel)
    return Chart(
        key=f"sources-{CHANNELS[channel]}",
        title=f"{axis.capitalize()} error by source, {which}",
        x_label=TIME,
        y_label=f"{_LABELS[channel]} [km]",
        lines=tuple(
            Line(name, SUM if name == "all" else style, x, km(page.position_m(page.aided_sources, name, channel)),
                 style, "integrated INS [B-3]")
            for name, style in SHOWN_SOURCES.items()
        ),
        spans=boost(study),
        knowledge=f"{page.how}. Each source runs alone, a sensor with all its errors. The parts have "
        "signs and partly cancel; they add up to the sum to second order. White noise is not among them.",
    )  # fmt: skip


def aided_chart(page: Content, channel: int) -> Chart:
    """The INS against the aided INS in one channel."""
    study, axis = page.study, page.axis(channel)
    x = study.pure.time_s
    pairs = tuple(
        (name, page.position_m(aided, page.case, channel), _noise(page, aided, channel))
        for name, aided in (("INS alone", False), ("INS with tracker", True))
    )
    return Chart(
        key=f"aided-{CHANNELS[channel]}",
        title=f"INS alone vs with star tracker, {axis}",
        x_label=TIME,
        y_label=f"{_LABELS[channel]} [km]",
        lines=tuple(
            Line(name, name, x, km(error), name, "integrated INS [B-3], [B-7]") for name, error, _ in pairs
        ),
        bands=tuple(
            Band(name, f"{name}, ±1σ of white noise", x, km(error - sigma), km(error + sigma), name,
                 "covariance of [B-4] under white noise")
            for name, error, sigma in pairs
        ),
        spans=boost(study),
        knowledge=f"Case: {called(page.case)}. {page.how}. Bands: white noise alone, covariance of [B-4].",
    )  # fmt: skip


_LABELS = ("horizontal error", "horizontal error", "height error")


def _noise(page: Content, aided: bool, channel: int) -> Array:
    """Sigma of white noise in the axes looked at, m."""
    study = page.study
    spread = study.aided_noise if aided else study.pure_noise
    if page.along_track and channel < 2:
        return along_track_sigma(spread, study.flight, study.every)[:, channel]
    return spread.position_sigma_m[:, channel]


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


def growth_chart(page: Content) -> Chart:
    """Size of the error of one case in one channel on a log scale, against the decoupled channel [B-5]."""
    study, channel = page.study, page.channel
    k, x = study.case(page.case), study.pure.time_s
    truth = study.pure.position_m[k, :, channel]
    ins, aided = (np.abs(e.position_m[k, :, channel]) for e in (study.pure, study.aided))
    decoupled = study.channels_m[k, :, channel]
    closed = page.closed_form_m[:, channel]
    holds, fails, agreement = _split(x, decoupled, truth)
    closed_holds, closed_fails, closed_text = _split(x, closed, truth)
    slope = _slope(study, ins) if channel == 2 else np.full(len(x), np.nan)
    slow = ", ".join(
        f"{show(float(height_e_folding_time(h)), 'time')} at {show_in(h, 'km', 'length', given=True)}"
        for h in (0.0, study.flight.apogee[1])
    )
    why = f" Slope 1/k for explanation only: e-folding time {slow} [B-6]." if channel == 2 else ""
    return Chart(
        key="growth",
        title=f"Size of the {CHANNELS[channel]} error: {called(page.case)}",
        x_label=TIME,
        y_label="size of the error [m]",
        lines=(
            Line("ins", "INS alone", x, _log(ins), "INS alone", "integrated INS [B-3]"),
            Line("aided", "INS with tracker", x, _log(aided), "INS with tracker", "integrated INS [B-7]"),
            Line("holds", "decoupled channel (dotted: not valid here)", x, holds, "decoupled, holds", "[B-5]"),
            Line("fails", "decoupled channel (dotted: not valid here)", x, fails, "decoupled, fails", "[B-5]"),
            Line("closed", "formula (dotted: not valid here)", x, closed_holds, "formula, holds", "[B-6]"),
            Line("closed-fails", "formula (dotted: not valid here)", x, closed_fails, "formula, fails", "[B-6]"),
            Line("slope", "slope 1/k", x, slope, "reference", "[B-6]"),
        ),
        spans=boost(study),
        y_log=True,
        y_range=_log_range(ins, aided, np.abs(decoupled)),
        knowledge=f"{page.how}. The decoupled channel [B-5], whose local frame does not rotate, {agreement}. The "
        f"formula [B-6], with one height and constant forcing (means of the powered flight), {closed_text}.{why}",
    )


def _split(x: Array, model: Array, truth: Array) -> tuple[Array, Array, str]:
    """Size of a model's error where it holds and where it fails, and in words until when it holds."""
    bad = np.abs(model - truth) > np.maximum(HOLDS_WITHIN * np.abs(truth), 1.0)
    last = int(np.argmax(bad)) if bad.any() else len(x)
    index, size = np.arange(len(x)), _log(np.abs(model))
    holds, fails = np.where(index <= last, size, np.nan), np.where(index >= last, size, np.nan)
    within = f"within {percent(HOLDS_WITHIN)} of the INS (or 1 m)"
    if not bad.any():
        return holds, fails, f"stays {within} throughout"
    final = f"{show(abs(model[-1]), 'length')} where the INS has {show(abs(truth[-1]), 'length')}"
    return holds, fails, f"holds {within} until {x[max(last - 1, 0)]:.0f} s; at the end it gives {final}"


def _log(values: Array) -> Array:
    return np.where(values > 0, values, np.nan)


def _log_range(*curves: Array) -> tuple[float, float]:
    top = max(float(np.max(curve)) for curve in curves)
    if top <= 0:
        return 1e-2, 1.0
    small = [float(np.min(curve[curve > 0])) for curve in curves if np.any(curve > 0)]
    return max(min(small) / 2, top * 1e-6), top * 3


def _slope(study: Study, ins: Array) -> Array:
    """exp of the integral of k, through the INS's error at two thirds of the flight."""
    growth = height_growth(study.flight)[:: study.every]
    at = 2 * len(growth) // 3
    scaled = growth / growth[at] * ins[at] if ins[at] > 0 else np.full(len(growth), np.nan)
    return np.where(np.arange(len(growth)) >= len(growth) // 4, scaled, np.nan)

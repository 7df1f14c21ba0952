"""Position errors: by source, INS against aided, and the unstable height."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.charts.description import Array, Band, Chart, Line
from app.charts.suborbital.shown import CHANNELS, SHOWN_SOURCES, TIME, Shown, boost, called, every_of, km
from nav_model.suborbital.channels import height_e_folding_time, height_growth
from nav_model.suborbital.study import Study

HOLDS_WITHIN = 0.1  # of the INS's own error: where the decoupled channel is drawn as holding


def source_chart(channel: int) -> Callable[[Shown], Chart]:
    """The chart of errors by source in one channel, as a function of `Shown`."""

    def describe(shown: Shown) -> Chart:
        study = shown.study
        errors = study.aided if shown.aided_sources else study.pure
        which = "with star tracker" if shown.aided_sources else "INS alone"
        x = study.pure.time_s
        return Chart(
            key=f"sources-{CHANNELS[channel]}",
            title=f"{CHANNELS[channel].capitalize()} error by source, {which}",
            x_label=TIME,
            y_label=f"{CHANNELS[channel]} error [km]",
            lines=tuple(
                Line(name, "everything" if name == "all" else name, x,
                     km(errors.position_m[study.case(name), :, channel]),
                     "everything" if name == "all" else name, "integrated INS [B-3]")
                for name in SHOWN_SOURCES
            ),
            spans=boost(study),
            knowledge=f"{shown.how}. Each source runs alone; the parts add up to everything to second order.",
        )  # fmt: skip

    return describe


def aided_chart(channel: int) -> Callable[[Shown], Chart]:
    """The chart of the INS against the aided INS in one channel, as a function of `Shown`."""

    def describe(shown: Shown) -> Chart:
        study = shown.study
        x, k = study.pure.time_s, study.case(shown.case)
        pairs = (
            ("INS alone", study.pure, study.pure_noise.position_sigma_m),
            ("INS with tracker", study.aided, study.aided_noise.position_sigma_m),
        )
        return Chart(
            key=f"aided-{CHANNELS[channel]}",
            title=f"INS against star tracker, {CHANNELS[channel]}",
            x_label=TIME,
            y_label=f"{CHANNELS[channel]} error [km]",
            lines=tuple(
                Line(name, name, x, km(errors.position_m[k, :, channel]), name, "integrated INS [B-3], [B-7]")
                for name, errors, _ in pairs
            ),
            bands=tuple(
                Band(name, f"{name}, ±1σ of white noise", x,
                     km(errors.position_m[k, :, channel] - sigma[:, channel]),
                     km(errors.position_m[k, :, channel] + sigma[:, channel]), name,
                     "covariance of [B-4] under white noise")
                for name, errors, sigma in pairs
            ),
            spans=boost(study),
            knowledge=f"Case: {called(shown.case)}. {shown.how}. Bands: white noise alone, covariance of [B-4].",
        )  # fmt: skip

    return describe


def growth_chart(shown: Shown) -> Chart:
    """Size of the error of one case in one channel on a log scale, against the decoupled channel [B-5]."""
    study, channel = shown.study, shown.channel
    k, x = study.case(shown.case), study.pure.time_s
    ins, aided = (np.abs(e.position_m[k, :, channel]) for e in (study.pure, study.aided))
    decoupled = np.abs(study.channels.position_m[k, :, channel])
    gap = np.abs(study.channels.position_m[k, :, channel] - study.pure.position_m[k, :, channel])
    bad = gap > np.maximum(HOLDS_WITHIN * ins, 1.0)
    last_good = len(x) if not bad.any() else int(np.argmax(bad))
    holds = np.where(np.arange(len(x)) <= last_good, decoupled, np.nan)
    fails = np.where(np.arange(len(x)) >= last_good, decoupled, np.nan)
    slope = _slope(study, ins) if channel == 2 else np.full(len(x), np.nan)
    final = f"at the end it says {decoupled[-1] / 1000:.1f} km where the INS has {ins[-1] / 1000:.1f} km"
    said = (
        f"stays within {100 * HOLDS_WITHIN:.0f} % of the INS (or 1 m) throughout"
        if not bad.any()
        else f"holds within {100 * HOLDS_WITHIN:.0f} % of the INS (or 1 m) until "
        f"{x[max(last_good - 1, 0)]:.0f} s; {final}"
    )
    slow = ", ".join(
        f"{float(height_e_folding_time(h)):.1f} s at {h / 1000:.0f} km" for h in (0.0, study.flight.apogee[1])
    )
    why = f" Slope 1/k for explanation only: e-folding time {slow} [B-6]." if channel == 2 else ""
    return Chart(
        key="growth",
        title=f"Size of the {CHANNELS[channel]} error: {called(shown.case)}",
        x_label=TIME,
        y_label="size of the error [m]",
        lines=(
            Line("ins", "INS alone", x, _log(ins), "INS alone", "integrated INS [B-3]"),
            Line("aided", "INS with tracker", x, _log(aided), "INS with tracker", "integrated INS [B-7]"),
            Line("holds", "decoupled channel, where it holds", x, _log(holds), "decoupled, holds", "[B-5]"),
            Line("fails", "decoupled channel, where it fails", x, _log(fails), "decoupled, fails", "[B-5]"),
            Line("slope", "slope 1/k of the unstable height", x, slope, "reference", "[B-6]"),
        ),
        spans=boost(study),
        y_log=True,
        y_range=_log_range(ins, aided, decoupled),
        knowledge=f"{shown.how}. The decoupled channel, whose local frame does not rotate, {said}.{why}",
    )


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
    growth = height_growth(study.flight)[:: every_of(study)]
    at = 2 * len(growth) // 3
    scaled = growth / growth[at] * ins[at] if ins[at] > 0 else np.full(len(growth), np.nan)
    return np.where(np.arange(len(growth)) >= len(growth) // 4, scaled, np.nan)

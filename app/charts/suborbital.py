"""The charts of the suborbital study, as plain data. Each takes a `Shown` and draws what is in it; none computes
an error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.charts.description import Array, Band, Chart, Line, Points, Span
from nav_model.suborbital.channels import height_e_folding_time, height_growth
from nav_model.suborbital.frames import STANDARD_GRAVITY
from nav_model.suborbital.gravity import compare_gravity
from nav_model.suborbital.mechanisation import NavigationErrors
from nav_model.suborbital.star_camera import StarFrame
from nav_model.suborbital.study import Study
from nav_model.suborbital.survey import Survey

CHANNELS = ("north", "east", "height")
SHOWN_SOURCES = (
    "accelerometer bias",
    "accelerometer instability",
    "gyro bias",
    "gyro instability",
    "initial position and velocity",
    "initial attitude",
    "all",
)
HOLDS_WITHIN = 0.1  # of the INS's own error: where the decoupled channel is drawn as holding
_TIME = "time since lift-off [s]"
_ARCSEC = math.pi / 648000


@dataclass(frozen=True)
class Shown:
    """What is on the page: the last run, the study at the sliders' positions, and what the person looks at."""

    survey: Survey
    study: Study
    case: str = "gyro total"
    channel: int = 2
    aided_sources: bool = False
    star_index: int = 50

    @property
    def exact(self) -> bool:
        """Whether the curves are those of the last run, not moved."""
        return self.study is self.survey.study

    @property
    def how(self) -> str:
        """Which answer the curves are."""
        step = self.study.flight.step_s
        run = f"Integrated INS [B-3] with sensor errors [B-1], RK4 at {step:g} s; with tracker [B-7]"
        return run if self.exact else f"{run}; then moved by the linear sensitivity matrix [B-4]"

    @property
    def star_frame(self) -> StarFrame:
        """The star image looked at."""
        return self.survey.star_frames[self.star_index]


def _every(study: Study) -> int:
    return round(study.inputs.output_interval_s / study.flight.step_s)


def _boost(study: Study) -> tuple[Span, ...]:
    burnout = study.flight.burnout_s
    return (Span("boost", "boost", 0.0, burnout if burnout is not None else 0.0),)


def _km(values: Array) -> Array:
    return values / 1000.0


# --- errors by source, INS against aided -----------------------------------------------------------------


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
            x_label=_TIME,
            y_label=f"{CHANNELS[channel]} error [km]",
            lines=tuple(
                Line(name, "everything" if name == "all" else name, x,
                     _km(errors.position_m[study.case(name), :, channel]),
                     "everything" if name == "all" else name, "integrated INS [B-3]")
                for name in SHOWN_SOURCES
            ),
            spans=_boost(study),
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
            x_label=_TIME,
            y_label=f"{CHANNELS[channel]} error [km]",
            lines=tuple(
                Line(name, name, x, _km(errors.position_m[k, :, channel]), name, "integrated INS [B-3], [B-7]")
                for name, errors, _ in pairs
            ),
            bands=tuple(
                Band(name, f"{name}, ±1σ of white noise", x,
                     _km(errors.position_m[k, :, channel] - sigma[:, channel]),
                     _km(errors.position_m[k, :, channel] + sigma[:, channel]), name,
                     "covariance of [B-4] under white noise")
                for name, errors, sigma in pairs
            ),
            spans=_boost(study),
            knowledge=f"Case: {_called(shown.case)}. {shown.how}. Bands: white noise alone, covariance of [B-4].",
        )  # fmt: skip

    return describe


def _called(case: str) -> str:
    return "everything" if case == "all" else case


# --- the unstable height and the decoupled channels ------------------------------------------------------


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
        title=f"Size of the {CHANNELS[channel]} error: {_called(shown.case)}",
        x_label=_TIME,
        y_label="size of the error [m]",
        lines=(
            Line("ins", "INS alone", x, _log(ins), "INS alone", "integrated INS [B-3]"),
            Line("aided", "INS with tracker", x, _log(aided), "INS with tracker", "integrated INS [B-7]"),
            Line("holds", "decoupled channel, where it holds", x, _log(holds), "decoupled, holds", "[B-5]"),
            Line("fails", "decoupled channel, where it fails", x, _log(fails), "decoupled, fails", "[B-5]"),
            Line("slope", "slope 1/k of the unstable height", x, slope, "reference", "[B-6]"),
        ),
        spans=_boost(study),
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
    growth = height_growth(study.flight)[:: _every(study)]
    at = 2 * len(growth) // 3
    scaled = growth / growth[at] * ins[at] if ins[at] > 0 else np.full(len(growth), np.nan)
    return np.where(np.arange(len(growth)) >= len(growth) // 4, scaled, np.nan)


# --- attitude -------------------------------------------------------------------------------------------


def _attitude(shown: Shown, key: str, title: str, field: str, axes: tuple[str, str, str], note: str) -> Chart:
    study = shown.study
    x, k = study.pure.time_s, study.case(shown.case)

    def curve(errors: NavigationErrors, axis: int) -> Array:
        return np.asarray(getattr(errors, field)[k, :, axis] / _ARCSEC)

    return Chart(
        key=key,
        title=f"{title}: {_called(shown.case)}",
        x_label=_TIME,
        y_label="attitude error [arcsec]",
        lines=(
            *(Line(f"p{i}", f"{axis}, INS alone", x, curve(study.pure, i), f"axis {'xyz'[i]}", "INS [B-3]")
              for i, axis in enumerate(axes)),
            *(Line(f"a{i}", f"{axis}, with tracker", x, curve(study.aided, i), f"axis {'xyz'[i]}, tracker",
                   "INS [B-7]") for i, axis in enumerate(axes)),
        ),
        spans=_boost(study),
        knowledge=f"{note} {shown.how}.",
    )  # fmt: skip


def inertial_attitude_chart(shown: Shown) -> Chart:
    """Attitude error on inertial axes: what the gyros or the tracker did."""
    return _attitude(
        shown, "attitude-inertial", "Attitude error, inertial frame", "attitude_inertial_rad", ("x", "y", "z"),
        "Rotation from true to estimated body attitude on inertial axes; a perfect camera brings it to zero.",
    )  # fmt: skip


def navigation_attitude_chart(shown: Shown) -> Chart:
    """Attitude error in the navigation frame, which holds the position error."""
    return _attitude(
        shown, "attitude-navigation", "Attitude error, navigation frame", "attitude_navigation_rad",
        ("north", "east", "down"),
        "On north, east, down; with the tracker what is left is the position error over the radius, dr/r [B-7].",
    )  # fmt: skip


# --- stars ----------------------------------------------------------------------------------------------


def star_chart(shown: Shown) -> Chart:
    """The camera's square at one instant, with the stars identified."""
    frame, camera = shown.star_frame, shown.survey.settings.camera()
    edge = camera.pixels - 0.5
    square = np.array([-0.5, edge, edge, -0.5, -0.5])
    names = tuple(
        f"HIP {number}, Hp {magnitude:.2f}" if shown.survey.settings["sky.stars"] == "Hipparcos"
        else f"star {number}, magnitude {magnitude:.2f}"
        for number, magnitude in zip(frame.identifier, frame.magnitude, strict=True)
    )  # fmt: skip
    faintest = shown.survey.settings["sky.magnitude_limit"]
    sizes = np.clip(6.0 + 2.5 * (faintest - frame.magnitude), 6.0, 24.0)
    ra, dec = math.degrees(frame.boresight_ra_rad) / 15.0, math.degrees(frame.boresight_dec_rad)
    verdict = "used" if frame.used else f"not used: {frame.reason}"
    margin = 0.04 * camera.pixels
    return Chart(
        key="star-frame",
        title=f"Star frame at {frame.time_s:.0f} s",
        x_label="detector x [pixel]",
        y_label="detector y [pixel]",
        lines=(Line("edge", "edge of the detector", square, np.roll(square, 1), "reference", "[B-8]"),),
        points=(
            Points("true", "identified star, larger is brighter", frame.pixel_x, frame.pixel_y, names, "star",
                   source="catalogue place, pin-hole [B-8]", sizes=sizes),
            Points("measured", "measured centroid", frame.measured_x, frame.measured_y, names, "measured star",
                   "x", "with centroid noise", np.full(len(names), 15.0)),
        ),
        x_range=(-margin, camera.pixels + margin),
        y_range=(-margin, camera.pixels + margin),
        square=True,
        knowledge=f"{frame.source}. Frame {verdict}; {frame.stars_in_field} stars in the field, boresight "
        f"{ra:.2f} h, {dec:+.1f}° on the flight's inertial axes.",
    )  # fmt: skip


def star_count_chart(shown: Shown) -> Chart:
    """Stars in the field along the flight."""
    frames = shown.survey.star_frames
    x = np.array([frame.time_s for frame in frames])
    field = np.array([float(frame.stars_in_field) for frame in frames])
    used = np.array([float(len(frame.identifier)) if frame.used else math.nan for frame in frames])
    settings = shown.survey.settings
    refused = int(np.sum(np.isnan(used)))
    return Chart(
        key="star-count",
        title="Stars in the field",
        x_label=_TIME,
        y_label="stars [count]",
        lines=(
            Line("field", "in the field", x, field, "axis x", "selection by cone, then square [B-8]"),
            Line("used", "taken for the attitude", x, used, "axis y", "brightest, frames through the gate"),
        ),
        y_range=(0.0, float(np.max(field)) * 1.1 + 1.0),
        knowledge=f"Every {x[1] - x[0] if len(x) > 1 else 0:g} s; {len(shown.survey.settings.sky())} stars at Hp ≤ "
        f"{settings['sky.magnitude_limit']:g}, mean {float(np.mean(field)):.1f} in the field; {refused} of "
        f"{len(frames)} frames gated (fewer than {settings.camera().least_stars} stars, or roll too uncertain).",
    )


# --- flight and gravity ---------------------------------------------------------------------------------


def _marks(study: Study) -> tuple[tuple[str, int], ...]:
    flight = study.flight
    marks = [("lift-off", 0), ("apogee", int(np.argmax(flight.height_m))), ("end", flight.steps)]
    if flight.burnout_s is not None:
        marks.insert(1, ("burn-out", round(flight.burnout_s / flight.step_s)))
    if study.used.any():
        marks.append(("first star frame", int(np.argmax(study.used))))
    return tuple(marks)


def map_chart(shown: Shown) -> Chart:
    """Ground track on a plain map."""
    flight, every = shown.study.flight, _every(shown.study)
    latitude, longitude = np.degrees(flight.latitude_rad), np.degrees(np.unwrap(flight.longitude_rad))
    marks = _marks(shown.study)
    at = [index for _, index in marks]
    return Chart(
        key="map",
        title="Ground track",
        x_label="longitude, east [°]",
        y_label="latitude, north [°]",
        lines=(Line("track", "ground track", longitude[::every], latitude[::every], "path", flight.name),),
        points=(
            Points("marks", _mark_label(marks), longitude[at], latitude[at], tuple(name for name, _ in marks),
                   "mark", "diamond", "flight"),
        ),
        knowledge=f"{flight.source}. Latitude and longitude on the sphere, Earth turning under the flight; "
        f"{flight.ground_range_m[-1] / 1000:.0f} km over ground. No map service is asked.",
    )  # fmt: skip


def _mark_label(marks: tuple[tuple[str, int], ...]) -> str:
    return ", ".join(name for name, _ in marks)


def height_chart(shown: Shown) -> Chart:
    """Height against time, with the tracker's frames."""
    study = shown.study
    flight, every = study.flight, _every(study)
    x, height = flight.time_s[::every], flight.height_m / 1000.0
    marks = _marks(study)
    at = [index for _, index in marks]
    apogee_time, apogee = flight.apogee
    tracked = np.where(_near_frame(study, every), height[::every], np.nan)
    speed = float(np.linalg.norm(flight.velocity_ned, axis=1).max())
    return Chart(
        key="height",
        title="Height",
        x_label=_TIME,
        y_label="height [km]",
        lines=(
            Line("height", "height", x, height[::every], "path", "flight"),
            Line("tracked", "star frames taken", x, tracked, "axis y", "instants of frames [B-7]"),
        ),
        points=(
            Points("marks", _mark_label(marks), flight.time_s[at], height[at], tuple(name for name, _ in marks),
                   "mark", "diamond", "flight"),
        ),
        spans=_boost(study),
        knowledge=f"{flight.source}. Apogee {apogee / 1000:.2f} km at {apogee_time:.1f} s; fastest "
        f"{speed:.0f} m/s over ground; {int(study.used.sum())} star frames taken.",
    )  # fmt: skip


def _near_frame(study: Study, every: int) -> np.ndarray:
    """At each point shown: whether a frame fell in the interval up to it."""
    count = np.concatenate([[0], np.cumsum(study.used)])
    index = np.arange(0, study.flight.steps + 1, every)
    return np.asarray(count[index + 1] > count[np.maximum(index + 1 - every, 0)])


def force_chart(shown: Shown) -> Chart:
    """True specific force on body axes."""
    return _body(shown, "specific-force", "Specific force, body axes", "specific force [m/s²]",
                 shown.study.flight.specific_force_b, 1.0)  # fmt: skip


def rate_chart(shown: Shown) -> Chart:
    """True inertial angular rate on body axes."""
    return _body(shown, "angular-rate", "Angular rate, body axes", "angular rate [°/s]",
                 shown.study.flight.angular_rate_b, 180.0 / math.pi)  # fmt: skip


def _body(shown: Shown, key: str, title: str, label: str, nodes: Array, scale: float) -> Chart:
    flight = shown.study.flight
    every = _every(shown.study)
    x = flight.time_s[:-1:every]
    return Chart(
        key=key,
        title=title,
        x_label=_TIME,
        y_label=label,
        lines=tuple(
            Line(axis, axis, x, scale * nodes[::every, 0, i], f"axis {axis}", "true, at the start of a step")
            for i, axis in enumerate("xyz")
        ),
        spans=_boost(shown.study),
        knowledge=f"What a perfect strapdown unit measures; the errors [B-1] are added to it. {flight.source}.",
    )


def gravity_chart(shown: Shown) -> Chart:
    """How far the gravity models are apart, by height."""
    height = np.linspace(0.0, 1.0e6, 101)
    latitude = float(shown.study.flight.latitude_rad[0])
    g = compare_gravity(latitude, height)
    x = height / 1000.0
    curves = (
        ("dm", "J2 less spherical, magnitude", g.j2_m_s2 - g.spherical_m_s2, "axis x"),
        ("em", "ellipsoidal less spherical, magnitude", g.ellipsoidal_m_s2 - g.spherical_m_s2, "axis x, tracker"),
        ("dh", "J2, across the vertical, north", g.horizontal_j2_m_s2, "axis y"),
        ("eh", "ellipsoidal, across the vertical, north", g.horizontal_ellipsoidal_m_s2, "axis y, tracker"),
    )
    return Chart(
        key="gravity",
        title="Gravity models compared",
        x_label="height [km]",
        y_label="difference from spherical [mg]",
        lines=tuple(
            Line(key, label, x, y / (1e-3 * STANDARD_GRAVITY), style, g.source) for key, label, y, style in curves
        ),
        knowledge=f"At the launch latitude, {math.degrees(latitude):.2f}° geocentric: {g.source}.",
    )

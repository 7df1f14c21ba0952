"""The flight: map, height, what a perfect unit measures; and the gravity models compared."""

import math

import numpy as np

from app.charts.kinds import Array, Chart, Line, Points
from app.document.numbers import show
from app.subjects.suborbital.charts.content import TIME, Content, boost
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.earth.gravity import compare_gravity
from nav_model.suborbital.study import Study


def _marks(study: Study, x: Array, y: Array) -> Points:
    """The instants of a flight that have a name, on a curve with a point for each node."""
    flight = study.flight
    marks = [("lift-off", 0), ("apogee", int(np.argmax(flight.height_m))), ("end", flight.steps)]
    if flight.burnout_s is not None:
        marks.insert(1, ("burn-out", round(flight.burnout_s / flight.step_s)))
    if study.used.any():
        marks.append(("first star frame", int(np.argmax(study.used))))
    names, at = zip(*marks, strict=True)
    return Points("marks", ", ".join(names), x[list(at)], y[list(at)], names, "mark", "diamond", "flight")


def map_chart(page: Content) -> Chart:
    """Ground track on a plain map."""
    flight, every = page.study.flight, page.study.every
    latitude, longitude = np.degrees(flight.latitude_rad), np.degrees(np.unwrap(flight.longitude_rad))
    return Chart(
        key="map",
        title="Ground track",
        x_label="longitude, east [°]",
        y_label="latitude, north [°]",
        lines=(Line("track", "ground track", longitude[::every], latitude[::every], "path", flight.name),),
        points=(_marks(page.study, longitude, latitude),),
        knowledge=f"{flight.source}. Latitude and longitude on the sphere, Earth turning under the flight; "
        f"{show(float(flight.ground_range_m[-1]), 'length')} over ground.",
    )  # fmt: skip


def height_chart(page: Content) -> Chart:
    """Height against time, with the tracker's frames."""
    study = page.study
    flight, every = study.flight, study.every
    x, height = flight.time_s[::every], flight.height_m / 1000.0
    apogee_time, apogee = flight.apogee
    tracked = np.where(_near_frame(study, every), height[::every], np.nan)
    speed = float(np.linalg.norm(flight.velocity_ned, axis=1).max())
    return Chart(
        key="height",
        title="Height",
        x_label=TIME,
        y_label="height [km]",
        lines=(
            Line("height", "height", x, height[::every], "path", "flight"),
            Line("tracked", "star frames taken", x, tracked, "axis y", "instants of frames [B-7]"),
        ),
        points=(_marks(study, flight.time_s, height),),
        spans=boost(study),
        knowledge=f"{flight.source}. Apogee {show(apogee, 'length')} at {apogee_time:.0f} s; fastest "
        f"{show(speed, 'speed')} over ground; {int(study.used.sum())} star frames taken.",
    )  # fmt: skip


def _near_frame(study: Study, every: int) -> np.ndarray:
    """At each point shown: whether a frame fell in the interval up to it."""
    count = np.concatenate([[0], np.cumsum(study.used)])
    index = np.arange(0, study.flight.steps + 1, every)
    return np.asarray(count[index + 1] > count[np.maximum(index + 1 - every, 0)])


def force_chart(page: Content) -> Chart:
    """True specific force on body axes."""
    return _body(page, "specific-force", "Specific force, body axes", "specific force [m/s²]",
                 page.study.flight.specific_force_b, 1.0)  # fmt: skip


def rate_chart(page: Content) -> Chart:
    """True inertial angular rate on body axes."""
    return _body(page, "angular-rate", "Angular rate, body axes", "angular rate [°/s]",
                 page.study.flight.angular_rate_b, 180.0 / math.pi)  # fmt: skip


def _body(page: Content, key: str, title: str, label: str, nodes: Array, scale: float) -> Chart:
    flight = page.study.flight
    every = page.study.every
    x = flight.time_s[:-1:every]
    return Chart(
        key=key,
        title=title,
        x_label=TIME,
        y_label=label,
        lines=tuple(
            Line(axis, axis, x, scale * nodes[::every, 0, i], f"axis {axis}", "true, at the start of a step")
            for i, axis in enumerate("xyz")
        ),
        spans=boost(page.study),
        knowledge=f"What a perfect strapdown unit measures; the errors [B-1] are added to it. {flight.source}.",
    )


def gravity_chart(page: Content) -> Chart:
    """Distance between the gravity models, by height."""
    height = np.linspace(0.0, 1.0e6, 101)
    latitude = float(page.study.flight.latitude_rad[0])
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
        knowledge=f"At the launch latitude, {show(latitude, 'angle')} geocentric: {g.source}.",
    )

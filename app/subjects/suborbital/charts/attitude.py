"""Attitude errors in both frames, and the star camera's images."""

import math

import numpy as np

from app.charts.kinds import Array, Chart, Line, Points
from app.document.numbers import number, show, show_in
from app.subjects.suborbital.charts.content import TIME, Content, boost, called
from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.navigation_errors import NavigationErrors


def _attitude(page: Content, key: str, title: str, field: str, axes: tuple[str, str, str], note: str) -> Chart:
    study = page.study
    x, k = study.pure.time_s, study.case(page.case)

    def curve(errors: NavigationErrors, axis: int) -> Array:
        return np.asarray(getattr(errors, field)[k, :, axis] / ARCSECOND)

    return Chart(
        key=key,
        title=f"{title}: {called(page.case)}",
        x_label=TIME,
        y_label="attitude error [arcsec]",
        lines=(
            *(Line(f"p{i}", f"{axis}, INS alone", x, curve(study.pure, i), f"axis {'xyz'[i]}", "INS [B-3]")
              for i, axis in enumerate(axes)),
            *(Line(f"a{i}", f"{axis}, with tracker", x, curve(study.aided, i), f"axis {'xyz'[i]}, tracker",
                   "INS [B-7]") for i, axis in enumerate(axes)),
        ),
        spans=boost(study),
        knowledge=f"{note} {page.how}.",
    )  # fmt: skip


def inertial_attitude_chart(page: Content) -> Chart:
    """Attitude error on inertial axes: what the gyros or the tracker did."""
    return _attitude(
        page, "attitude-inertial", "Attitude error, inertial frame", "attitude_inertial_rad", ("x", "y", "z"),
        "Rotation from true to estimated body attitude on inertial axes; a perfect camera brings it to zero.",
    )  # fmt: skip


def navigation_attitude_chart(page: Content) -> Chart:
    """Attitude error in the navigation frame, which holds the position error."""
    return _attitude(
        page, "attitude-navigation", "Attitude error, navigation frame", "attitude_navigation_rad",
        ("north", "east", "down"),
        "About the north, east and down axes. With the tracker, the error is the position error divided by the "
        "radius, dr/r [B-7].",
    )  # fmt: skip


def star_chart(page: Content) -> Chart:
    """The camera's square at one instant, with the stars identified."""
    frame, camera = page.star_frame, page.survey.settings.camera()
    edge = camera.pixels - 0.5
    square = np.array([-0.5, edge, edge, -0.5, -0.5])
    names = tuple(
        f"HIP {star}, Hp {number(magnitude)}" if page.survey.settings["sky.stars"] == "Hipparcos"
        else f"star {star}, magnitude {number(magnitude)}"
        for star, magnitude in zip(frame.identifier, frame.magnitude, strict=True)
    )  # fmt: skip
    faintest = page.survey.settings["sky.magnitude_limit"]
    sizes = np.clip(6.0 + 2.5 * (faintest - frame.magnitude), 6.0, 24.0)
    ra, dec = math.degrees(frame.boresight_ra_rad) / 15.0, math.degrees(frame.boresight_dec_rad)
    verdict = "used" if frame.used else f"not used: {frame.reason}"
    margin = 0.04 * camera.pixels
    focal_length = show_in(camera.focal_length_m, "mm", "length", given=True)
    lens = f"field {show(camera.field_of_view_rad, 'angle', given=True)}, focal length {focal_length}"
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
        f"{number(ra)} h, {number(dec)}° on the flight's inertial axes; {lens}.",
    )  # fmt: skip

"""The tables of the suborbital study, told once for page and report: the paper's four for these sensors, every
source, methods, gravity."""

from collections.abc import Iterable

import numpy as np

from app.document.blocks import Cell, Column, TableBlock, numbers, table
from app.document.numbers import DIGITS, NONE, number, percent
from app.subjects.suborbital.charts.content import CHANNELS, SUM, Content, called
from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.star_camera import StarFrame
from nav_model.suborbital.summary import PAPER_FINAL_M
from nav_model.suborbital.survey import Survey

Entry = str | float | None
"""A text, a number in the unit of its column's head, or nothing."""
Entries = tuple[Entry, ...]

_LEAST = 1e-3  # in the units of the columns: what is smaller is rounding of the integration
_PROMISED = 0.005  # of the exact error: what S p should hold
_PIXEL_DIGITS = 6  # a measured place differs from the true one by hundredths of a pixel in a thousand


def _table(
    key: str, caption: str, heads: tuple[str, ...], rows: Iterable[Entries], note: str, digits: int = DIGITS
) -> TableBlock:
    """A table to sort, by the size of numbers, whatever their sign; the more columns, the narrower each."""
    first, *others = heads
    columns = (
        Column(first, width=max(1.9, 0.28 * len(heads)), sortable=True),
        *numbers(*others, width=1, sortable=True),
    )
    return table(key, caption, columns, (tuple(_cell(entry, digits) for entry in row) for row in rows), note)


def _cell(entry: Entry, digits: int) -> Cell:
    if entry is None:
        return Cell(NONE, tone="quiet", sort="")
    if isinstance(entry, str):
        return Cell(entry)
    small = 0 < abs(entry) < _LEAST
    return Cell(f"< {number(_LEAST, given=True)}" if small else number(entry, digits), sort=abs(entry))


_PAPER_GROUPS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("accelerometers", "Accelerometer errors",
     ("accelerometer bias", "accelerometer instability", "accelerometer total")),
    ("gyros", "Gyro errors", ("gyro bias", "gyro instability", "gyro total")),
    ("initial", "Initial conditions", ("initial position and velocity", "initial attitude")),
)  # fmt: skip
PAPER_NOTE = (
    "The paper's values are read from its figures. Its sensors and trajectory are not published, and its x and y are "
    "not north and east: compare orders of magnitude only."
)


def _heads(*words: str) -> tuple[str, ...]:
    return tuple(f"{word} {channel} [m]" for word in words for channel in CHANNELS)


_PAPER_HEADS = ("paper x [m]", "paper y [m]", "paper height [m]")


def _paper(name: str) -> Entries:
    """The paper's readings, a range where that is all that can be read."""
    printed = PAPER_FINAL_M.get(name)
    if printed is None:
        return (None, None, None)
    pairs = (printed[axis] for axis in ("x", "y", "height"))
    return tuple(
        float(low) if low == high else f"{number(low, given=True)} to {number(high, given=True)}"
        for low, high in pairs
    )


def paper_tables(page: Content) -> tuple[TableBlock, ...]:
    """The paper's four tables for these sensors: final errors, m, the paper's readings beside them."""
    final = page.study.final_m
    how = f"Final errors at {page.study.flight.time_s[-1]:.0f} s. {page.how}. {PAPER_NOTE}"
    tables = [
        _table(
            key,
            title,
            ("source", *_heads("INS", "tracker"), *_PAPER_HEADS),
            tuple((name, *map(float, np.concatenate(final(name))), *_paper(name)) for name in names),
            how,
        )
        for key, title, names in _PAPER_GROUPS
    ]
    pure, aided = final("all")
    lines: tuple[Entries, ...] = (
        ("INS alone", *map(float, pure), None, None, None),
        ("INS with star tracker", *map(float, aided), None, None, None),
        ("improvement in size", *map(float, abs(pure) - abs(aided)), *_paper("improvement by the star tracker")),
    )
    heads = (SUM, *(f"{channel} [m]" for channel in CHANNELS), *_PAPER_HEADS)
    return (*tables, _table("tracker", "INS alone vs with star tracker", heads, lines, how))


def source_table(page: Content) -> TableBlock:
    """Every case: single sources, classes, tracker and gravity, with down-range and cross-range."""

    def line(k: int) -> Entries:
        ends = (
            (*e.position_m[k, -1], e.down_range_m[k, -1], e.cross_range_m[k, -1]) for e in (study.pure, study.aided)
        )
        return (called(study.names[k]), *(float(value) for end in ends for value in end))

    names = (*CHANNELS, "down-range", "cross-range")
    study = page.study
    noise: Entries = (
        "white noise, 1σ", *map(float, study.pure_noise.position_sigma_m[-1]), None, None,
        *map(float, study.aided_noise.position_sigma_m[-1]), None, None,
    )  # fmt: skip
    gravity = dict(zip(study.names, study.marks, strict=True))["gravity model"]
    return _table(
        "sources",
        "Every error source, one at a time and by class",
        ("source", *(f"INS {n} [m]" for n in names), *(f"tracker {n} [m]" for n in names)),
        (*map(line, range(len(study.names))), noise),
        f"{page.how}. Gravity row: {gravity}. White noise: covariance of [B-4].",
    )


def gap_table(page: Content) -> TableBlock:
    """Distance of the linear answers from the integrated ones."""
    plain = page.matrix_gap
    study = page.survey.study
    rows = [k for k, kind in enumerate(study.kinds) if kind != "gravity"]
    worst = max(rows, key=lambda k: max(plain.pure_share[k], plain.aided_share[k]))
    beyond = [k for k in rows if max(plain.pure_share[k], plain.aided_share[k]) > _PROMISED]
    agreement = f"within {percent(_PROMISED)} on every row"
    if beyond:
        off = percent(float(max(plain.pure_share[worst], plain.aided_share[worst])))
        agreement = (
            f"within {percent(_PROMISED)} on {len(rows) - len(beyond)} of {len(rows)} rows; "
            f"{called(study.names[worst])} is off by {off}"
        )
    return _table(
        "linear",
        "Linear answers against the integrated INS",
        ("source", "linear, INS [m]", "linear, INS [%]", "linear, tracker [m]", "linear, tracker [%]"),
        tuple(
            (called(study.names[k]), float(plain.pure_m[k]), float(100 * plain.pure_share[k]),
             float(plain.aided_m[k]), float(100 * plain.aided_share[k]))
            for k in rows
        ),
        "Distance at the end of the flight from the last full simulation, and its share of the error. The linear "
        f"answer alone [B-4] is {agreement}. The page never shows that alone: curves start at the full simulation, "
        "and the linear part adds the change.",
    )  # fmt: skip


def method_table(page: Content) -> TableBlock:
    """The attitude methods on this flight's images."""
    sigma = page.survey.settings["camera.centroid_noise"] / ARCSECOND
    return _table(
        "methods",
        "Attitude methods compared",
        ("method", "mean error [arcsec]", "rms about x [arcsec]", "rms about y [arcsec]",
         "rms about boresight [arcsec]", "mean NEES (3 expected)"),
        tuple(
            (s.method, s.mean_error_rad / ARCSECOND, *(rms / ARCSECOND for rms in s.axis_rms_rad), s.mean_nees)
            for s in page.survey.scores
        ),
        "The same images of this flight for every method, one a second, centroid noise "
        f"{number(sigma, given=True)} arcsec per axis; {page.survey.scenes_refused} rejected. "
        "Covariances [B-9]. TRIAD uses only two stars, the "
        "brightest: its error is large where these are close together, so a few scenes decide its mean. Over 1000 "
        "random scenes of five stars at 10 arcsec, twenty seeds give means of 207 to 362 arcsec; SVD, the least "
        "squares, gives 72 to 78.",
    )  # fmt: skip


def gravity_table(page: Content) -> TableBlock:
    """Cost of a wrong gravity model for an otherwise perfect INS."""
    return _table(
        "gravity-mismatch",
        "Cost of a mismatched gravity model",
        ("truth / INS", *(f"{channel} [m]" for channel in CHANNELS)),
        tuple((f"{truth} / {model}", *map(float, error)) for truth, model, error in page.survey.gravity),
        "Final error of an otherwise perfect INS on the reference flight in each true gravity field; integrated "
        "[B-3]."
        if page.survey.gravity
        else "Not available for a trajectory from a file.",
    )


def star_table(page: Content) -> TableBlock:
    """The stars of the image looked at."""
    frame = page.star_frame
    real = page.survey.settings["sky.stars"] == "Hipparcos"
    return _table(
        "stars",
        f"Identified stars at {frame.time_s:.0f} s",
        ("star", "Hp magnitude", "x [pixel]", "y [pixel]", "x measured [pixel]", "y measured [pixel]"),
        tuple(
            (f"{'HIP ' if real else ''}{identifier}", *map(float, values))
            for identifier, *values in zip(
                frame.identifier, frame.magnitude, frame.pixel_x, frame.pixel_y, frame.measured_x, frame.measured_y,
                strict=True,
            )
        ),
        f"{_attitude_text(frame)} {_stars_of(page.survey)}",
        _PIXEL_DIGITS,
    )  # fmt: skip


def _attitude_text(frame: StarFrame) -> str:
    if frame.error_rad is None or frame.sigma_rad is None:
        return f"Frame not used: {frame.reason}. {frame.source}."
    error, sigma = (
        ", ".join(number(angle / ARCSECOND) for angle in angles) for angles in (frame.error_rad, frame.sigma_rad)
    )
    return (
        f"Attitude error about body x, y, boresight: {error} arcsec; predicted 1σ {sigma} arcsec [B-9]. "
        f"{frame.source}."
    )


def _stars_of(survey: Survey) -> str:
    """The star frames of the whole flight in a sentence."""
    frames, settings = survey.star_frames, survey.settings
    mean = sum(frame.stars_in_field for frame in frames) / len(frames)
    refused = sum(not frame.used for frame in frames)
    return (
        f"Along the flight: mean {number(mean)} of {len(settings.sky())} stars at Hp ≤ "
        f"{number(settings['sky.magnitude_limit'], given=True)} in the field; {refused} of {len(frames)} frames "
        f"rejected (fewer than {settings.camera().least_stars} stars, or roll too uncertain)."
    )

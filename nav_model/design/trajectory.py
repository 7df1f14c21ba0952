"""Inputs of the flight plan: the flight, its lines with limits of their own, and aiding beyond the fixes."""

import math
import re
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from nav_model.base.constants import DEGREE
from nav_model.base.units import to_si
from nav_model.design.declaration import Choice, OptionalQuantity, Quantity
from nav_model.design.figures import FIGURES, IN_FLIGHT
from nav_model.design.part import Part
from nav_model.design.requirements import Requirements
from nav_model.design.table import Table

NO_PLAN, LINES, WAYPOINTS = "none", "lines", "waypoints"
MOST_WAYPOINTS = 200  # more make a link too long
FLIGHT_FILES = (
    ".kml", ".kmz", ".gpx", ".plan", ".waypoints", ".wpml", ".csv", ".txt", ".pos", ".out", ".sbet", ".nav", ".log",
    ".asc", ".nmea", ".ulg",
)  # fmt: skip
"""Usual ends of the names of files of flights; what a file is, its content says."""

Row = tuple[float, float, float, str, float | None]
Rows = tuple[Row, ...]
"""Waypoints as a design has them."""

LIMITED = tuple(name for name in IN_FLIGHT if FIGURES[name].requirement)
"""Figures that a line may have a limit of its own on."""
AIDING = (
    "bank_limit", "after_loss", "lever_arm_error", "time_offset", "radar_time_offset", "heading_noise",
    "heading_slow_noise", "heading_correlation_time", "barometer_noise", "barometer_slow_noise",
    "barometer_correlation_time",
)  # fmt: skip
"""Inputs of what aids the INS, and of its constant errors."""


def row_of(latitude: float, longitude: float, height: float, line: str = "", speed: float | None = None) -> Row:
    """A place to a millimetre as a row of the design's waypoints.

    Parameters
    ----------
    latitude, longitude : float
        rad.
    height : float
        m.
    line : str, optional
        Name of the line that begins there; loses what parts cells.
    speed : float, optional
        Of the leg that begins there, m/s.
    """
    north, east = (to_si(Fraction(f"{math.degrees(angle):.8f}"), "°", "angle") for angle in (latitude, longitude))
    return north, east, round(height, 3), " ".join(re.sub(r"[,;=\s]+", " ", line).split()), speed


def lines_in_words(names: Sequence[str]) -> str:
    """Names of lines in a sentence; of many their number.

    >>> lines_in_words(["line 1", "line 4"]), lines_in_words(["a"] * 5)
    ('line 1 and line 4', '5 lines')
    """
    if len(names) > 3:
        return f"{len(names)} lines"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _number(
    default: float | None, unit: str, dimension: str, bounds: tuple[float, float], short: str, label: str, doc: str,
    typical: str, soft: tuple[float, float] | None = None, datasheet: str = "From the flight plan.",
    since: str = "0.1.0", needs: tuple[str, ...] = (),
) -> Any:  # fmt: skip
    """A number of the plan; it may be left out if its default is None."""
    given: dict[str, Any] = {} if default is None else {"default": default}
    return (OptionalQuantity if default is None else Quantity)(
        **given, dimension=dimension, unit=unit, bounds=bounds, softbounds=soft, short=short, label=label, doc=doc,
        typical=typical, datasheet=datasheet, variable=False, since=since, needs=needs,
    )  # fmt: skip


def _column(dimension: str, unit: str, bounds: tuple[float, float], label: str) -> Any:
    default = min(max(bounds[0], 0.0), bounds[1])
    return Quantity(default=default, dimension=dimension, unit=unit, short="", bounds=bounds, label=label)


_LIMIT_COLUMNS: dict[str, Any] = {"line": None, **{name: Requirements.param[name] for name in LIMITED}}
_INSTALLED = "Measured at installation."
_TIME = (0.0, 360_000.0)
_HEIGHT = (-500.0, 1e5)


class Trajectory(Part):
    """The flight that is planned. Left out, the verdict is that of a straight leg."""

    section = "trajectory"
    title = "Flight plan"
    optional = True

    flight = Choice(
        default=NO_PLAN,
        options={
            NO_PLAN: "straight leg, no plan",
            "wandering": "nearly straight",
            "straight": "exactly straight",
            "turns": "turns, then a long leg",
            "climb": "a climb half way",
            LINES: "parallel lines",
            WAYPOINTS: "waypoints",
        },
        short="tfl",
        label="Flight",
        doc="The plan, flown at the design's speed. What is known along a flight is judged on it, line by line; "
        "without a plan, on a straight leg.",
        since="0.1.0",
    )
    duration = _number(
        500.0, "s", "time", (1.0, 360_000.0), "tdu", "Flight time",
        "Length of a flight without lines or waypoints.", "300 to 3600 s",
    )  # fmt: skip
    lines = _number(
        4.0, "", "", (1.0, 100.0), "tn", "Lines",
        "Number of parallel lines. The first starts at the first waypoint, or at the flight's latitude.",
        "1 to 20",
    )  # fmt: skip
    length = _number(5000.0, "km", "length", (1.0, 1e6), "tle", "Line length", "Of the parallel lines.", "2 to 50 km")
    spacing = _number(
        1000.0, "km", "length", (-1e6, 1e6), "tsp", "Line spacing",
        "Spacing of parallel lines, to the right of the first; negative: to the left.",
        "0.5 to 5 km",
    )  # fmt: skip
    bank = _number(
        25 * DEGREE, "°", "angle", (1 * DEGREE, 80 * DEGREE), "tba", "Bank", "Bank angle of the turns.", "10° to 30°"
    )
    climb_rate = _number(
        5.0, "m/s", "speed", (0.01, 500.0), "tcl", "Climb rate",
        "Highest rate of climb and descent between waypoints.",
        "2 to 10 m/s",
    )  # fmt: skip
    acceleration = _number(
        1.0, "m/s²", "acceleration", (0.01, 50.0), "tac", "Change of speed",
        "Largest acceleration along the track, where waypoints have speeds of their own.", "0.5 to 3 m/s²",
        since="0.2.0",
    )  # fmt: skip
    ground = _number(
        0.0, "m", "length", _HEIGHT, "tgr", "Ground height",
        "Highest terrain under the flight, above the ellipsoid. Every waypoint must be above it.", "0 to 3000 m",
    )  # fmt: skip
    waypoints = Table(
        columns={
            "latitude": _column("angle", "°", (-85 * DEGREE, 85 * DEGREE), "latitude"),
            "longitude": _column("angle", "°", (-360 * DEGREE, 360 * DEGREE), "longitude"),
            "height": _column("length", "m", _HEIGHT, "height"),
            "line": None,
            "speed": OptionalQuantity(
                dimension="speed", unit="m/s", short="", bounds=(1.0, 3000.0), label="speed", since="0.2.0"
            ),
        },
        most=MOST_WAYPOINTS,
        short="twp",
        example="45, 11, 3000, line 1; 45.05, 11, 3000; 45.05, 11.05, 3000",
        label="Waypoints",
        doc="Latitude [°], longitude [°] and height above the ellipsoid [m]. Name a waypoint to start a line there; "
        "it ends at the next one. Speed [m/s]: of the leg that begins there, unless it is the design's.",
        since="0.1.0",
    )
    outages = Table(
        columns={name: _column("time", "s", _TIME, name) for name in ("start", "stop")},
        short="tou",
        example="200, 260; 400, 430",
        label="Outages",
        doc="Start and stop of each outage, in seconds of the flight.",
        since="0.1.0",
    )
    limits = Table(
        columns=_LIMIT_COLUMNS,
        short="tli",
        example="line 1, detrended_phase=10°; line 2, ce90=2 m, tilt=0.01°",
        label="Line limits",
        doc="Stricter or looser limits for single lines, at the same confidence.",
        since="0.1.0",
    )
    bank_limit = _number(
        None, "°", "angle", (1 * DEGREE, 90 * DEGREE), "tbl", "Fixes lost above bank angle",
        "Bank angle beyond which the antenna loses the satellites.", "20° to 45°", (10 * DEGREE, 60 * DEGREE),
    )  # fmt: skip
    after_loss = Table(
        columns={
            "duration": _column("time", "s", (1e-3, 36_000.0), "duration"),
            "noise": _column("length", "m", (1e-4, 1e4), "noise"),
        },
        most=5,
        short="tal",
        example="10, 1.5; 30, 0.3",
        label="Outage after each loss",
        doc=(
            "Duration [s] and position noise [m] of each solution after an outage, such as code, then float, "
            "until fixed ambiguities return."
        ),
        since="0.1.0",
    )
    heading_noise = _number(
        None, "°", "angle", (1e-5 * DEGREE, 90 * DEGREE), "thn", "Heading of two antennas",
        "1σ of the white noise of the two-antenna heading at each fix: √2 times the carrier-phase noise over the "
        "baseline.",
        "0.3° at 1 m, 0.1° at 3 m",
        (0.01 * DEGREE, 1 * DEGREE), 'Receiver table: "heading accuracy".',
    )  # fmt: skip
    heading_slow_noise = _number(
        0.0, "°", "angle", (0.0, 90 * DEGREE), "ths", "Slow heading error",
        "1σ of what the two-antenna heading is off by for a time, beside its white noise: multipath above all. The "
        "filter takes the root of both variances as white.",
        "0.2° at 1 m, 0.07° at 3 m", (0.0, 1 * DEGREE),
        'Most of the "heading accuracy" of a receiver table, which averages away only where it is white.', "0.2.0",
    )  # fmt: skip
    heading_correlation_time = _number(
        60.0, "s", "time", (1.0, 1e6), "tht", "Heading correlation time",
        "Time constant of the slow heading error, a first-order Gauss-Markov process.",
        "multipath 30 to 100 s in flight, up to 300 s straight ahead", (10.0, 1000.0),
        "Not on data sheets: from a log at rest or on a straight line.", "0.2.0", ("heading_slow_noise",),
    )  # fmt: skip
    barometer_noise = _number(
        None, "m", "length", (1e-3, 1e4), "tbn", "Barometer",
        "1σ of the barometric height's white noise at each fix; it is available in an outage.", "0.1 to 10 m",
        (0.1, 100.0), "Noise of the air data, as height.",
    )  # fmt: skip
    barometer_slow_noise = _number(
        0.0, "m", "length", (0.0, 1e4), "tbs", "Slow barometer error",
        "1σ of what the barometric height is off by for a time, beside its white noise: weather, and the pressure "
        "about the aircraft. The filter takes the root of both variances as white.",
        "1 to 3 m with a station on the ground, 10 to 100 m without", (0.0, 100.0),
        '"Accuracy" of the air data, less its noise.', "0.2.0",
    )  # fmt: skip
    barometer_correlation_time = _number(
        3600.0, "min", "time", (1.0, 1e6), "tbt", "Barometer correlation time",
        "Time constant of the slow barometer error, a first-order Gauss-Markov process.", "30 min to 3 h",
        (300.0, 20_000.0), "Not on data sheets: weather.", "0.2.0", ("barometer_slow_noise",),
    )  # fmt: skip
    lever_arm_error = _number(
        0.0, "cm", "length", (0.0, 100.0), "tla", "Lever arm error",
        "1σ per axis of the lever arm's error, constant through the flight; the filter does not estimate it.",
        "0.5 to 5 cm", datasheet=_INSTALLED,
    )  # fmt: skip
    time_offset = _number(
        0.0, "ms", "time", (0.0, 10.0), "tto", "Time offset",
        "1σ of the fixes' time offset against the IMU, constant through the flight; the filter does not estimate it.",
        "0.01 to 10 ms", datasheet=_INSTALLED,
    )  # fmt: skip
    radar_time_offset = _number(
        0.0, "ms", "time", (0.0, 10.0), "trt", "Radar time offset",
        "1σ of the radar's time offset against the IMU, constant through the flight: motion compensation uses "
        "navigation of the wrong time.",
        "0.01 to 10 ms", datasheet=_INSTALLED,
    )  # fmt: skip

    @property
    def planned(self) -> bool:
        """True if the design has a plan, on which its figures are judged."""
        return bool(self.flight != NO_PLAN)

    @property
    def lowest_limits(self) -> dict[str, float]:
        """The lowest limit [SI] of single lines on each figure that one of them limits."""
        least: dict[str, float] = {}
        for _, *values in self.limits:
            given = dict(zip(LIMITED, values, strict=True))
            for name, limit in given.items():
                if limit is not None:
                    least[name] = min(limit, least.get(name, limit))
        return least


def line_names(design: Any) -> tuple[str, ...]:
    """Names of the lines of a design's plan, in their order."""
    plan = design.trajectory
    if plan.flight == LINES:
        return tuple(f"line {number + 1}" for number in range(int(plan.lines)))
    return tuple(filter(None, (row[3] for row in plan.waypoints))) if plan.flight == WAYPOINTS else ()

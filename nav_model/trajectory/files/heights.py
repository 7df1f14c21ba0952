"""Heights and names of the places of a file, and what was read by convention."""

import html
import math
import re

from nav_model.base.errors import InputError, quoted
from nav_model.base.number_table import seconds_of
from nav_model.trajectory.plan import Waypoint

MOST_WAYPOINTS = 2000
_MOST_NAME = 80
NO_HEIGHT, ABOVE_HOME, ABOVE_GROUND, ABOVE_SEA, ABOVE_ELLIPSOID = "none", "home", "ground", "sea", "ellipsoid"


class Heights:
    """Brings the heights of one file above the ellipsoid, and collects what was read by convention in `notes`.

    height: of places that have none; ground: of the ground, or of the place of take-off, where heights are above it;
    both [m above the ellipsoid]. home: of the place of take-off, as the file has it [m above sea level].
    """

    def __init__(self, file_name: str, height: float | None = None, ground: float | None = None) -> None:
        self.file_name, self.height, self.ground = file_name, height, ground
        self.home: float | None = None
        self.notes: list[str] = []
        self._waypoints = 0

    def note(self, text: str) -> None:
        """Say something once."""
        if text not in self.notes:
            self.notes.append(text)

    def refuse(self, reason: str) -> InputError:
        """The error for the file."""
        return InputError(self.file_name, reason)

    def above_ellipsoid(self, up: float | None, reference: str, where: str) -> float:
        """A height [m] above the ellipsoid. reference: what `up` is above.

        Raises InputError where the height, or that of the ground, is not known.
        """
        if up is None or reference == NO_HEIGHT:
            if self.height is None:
                unused = f" ({up:g} m is clamped to the ground, which is not used)" if up else ""
                raise self.refuse(f"{where} has no height{unused}. Give one for all places (--height).")
            self.note(f"places without a height are at {self.height:g} m")
            return self.height
        if reference == ABOVE_HOME and self.ground is None and self.home is not None:
            self.note(f"heights above home, which the plan puts at {self.home:g} m")
            up, reference = up + self.home, ABOVE_SEA
        if reference in (ABOVE_GROUND, ABOVE_HOME):
            if self.ground is None:
                asked = "Give the height of the ground: --ground, or the plan's Ground height, other than 0."
                raise self.refuse(f"{where} is {up:g} m above the ground. {asked}")
            self.note(f"heights above the ground, which is at {self.ground:g} m")
            return self.ground + up
        if reference == ABOVE_SEA:
            self.note("heights above sea level taken as above the ellipsoid")
        return up

    def waypoint(
        self, north: object, east: object, up: object, reference: str, where: str, line: str = ""
    ) -> Waypoint:
        """The next waypoint of a plan, as `place` reads it. Raises InputError where a plan has too many."""
        self._waypoints += 1
        if self._waypoints > MOST_WAYPOINTS:
            raise self.refuse(f"more than {MOST_WAYPOINTS} points are too many for a plan. Thin them out.")
        latitude, longitude, height = self.place(north, east, up, reference, where)
        return Waypoint(math.radians(latitude), math.radians(longitude), height, line)

    def place(
        self, north: object, east: object, up: object, reference: str, where: str
    ) -> tuple[float, float, float]:
        """Latitude, longitude [°] and height above the ellipsoid [m], from texts or numbers in degrees and metres;
        None or an empty text: no height. Raises InputError for what is no place."""
        latitude, longitude = (self.number(value, where) for value in (north, east))
        if abs(latitude) > 90.0 or abs(longitude) > 360.0:
            raise self.refuse(f"{where}: {latitude:g}, {longitude:g} is not a place on the Earth")
        height = None if up is None or not str(up).strip() else self.number(up, where)
        return latitude, longitude, self.above_ellipsoid(height, reference, where)

    def number(self, value: object, where: str) -> float:
        """A finite number of a file."""
        try:
            number = float(str(value).strip())
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise self.refuse(f"{where}: {quoted(value)} must be a finite number")
        return number

    def seconds(self, text: str | None, where: str) -> float:
        """Seconds of a date and time, or of a time of day."""
        seconds = seconds_of(text or "")
        if math.isnan(seconds):
            raise self.refuse(f"{where}: {quoted(text)} is not a date and time")
        return seconds


def plain_name(text: str | None) -> str:
    """A name without the HTML that some programs put into it."""
    bare = re.sub(r"<[^<>]*>", " ", html.unescape((text or "")[: 20 * _MOST_NAME]))
    return " ".join(html.unescape(bare).split())[:_MOST_NAME]


def counted(count: int, noun: str) -> str:
    """The count with its noun: "1 point", "2 points"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"

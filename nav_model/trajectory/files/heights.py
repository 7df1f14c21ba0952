"""Heights and names of the places of a file, and what was read by convention."""

import html
import math
import re
from typing import Literal

from nav_model.base.errors import InputError, quoted
from nav_model.trajectory.waypoints import Waypoint

MOST_WAYPOINTS = 2000
_MOST_NAME = 80
Reference = Literal["none", "home", "ground", "sea", "ellipsoid"]
"""Zero of a height; "none": it does not count."""


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

    def above_ellipsoid(self, up: float | None, reference: Reference, where: str) -> float:
        """A height [m] above the ellipsoid. Raises InputError where it, or that of the ground, is not known."""
        if up is None or reference == "none":
            if self.height is None:
                unused = f" ({up:g} m is clamped to the ground, which is not used)" if up else ""
                raise self.refuse(f"{where} has no height{unused}. Give one for all places (--height).")
            self.note(f"places without a height are at {self.height:g} m")
            return self.height
        if reference == "home" and self.ground is None and self.home is not None:
            self.note(f"heights above home, which the plan puts at {self.home:g} m")
            up, reference = up + self.home, "sea"
        if reference in ("ground", "home"):
            if self.ground is None:
                asked = "Give the height of the ground: --ground, or the plan's Ground height, other than 0."
                raise self.refuse(f"{where} is {up:g} m above the ground. {asked}")
            self.note(f"heights above the ground, which is at {self.ground:g} m")
            return self.ground + up
        if reference == "sea":
            self.note("heights above sea level used as ellipsoidal")
        return up

    def waypoint(self, place: tuple[object, ...], reference: Reference, where: str, line: str = "") -> Waypoint:
        """The next waypoint of a plan.

        Parameters
        ----------
        place : tuple
            As `Heights.place` reads it.
        reference : Reference
            Zero of its height.
        where : str
            Its name in messages.
        line : str, optional
            Name of the line that begins there.

        Raises
        ------
        InputError
            Where a plan has too many.
        """
        self._waypoints += 1
        if self._waypoints > MOST_WAYPOINTS:
            raise self.refuse(f"more than {MOST_WAYPOINTS} points are too many for a plan. Thin them out.")
        latitude, longitude, height = self.place(place, reference, where)
        return Waypoint(math.radians(latitude), math.radians(longitude), height, line)

    def place(self, place: tuple[object, ...], reference: Reference, where: str) -> tuple[float, float, float]:
        """Latitude, longitude [°] and height above the ellipsoid [m], from texts or numbers of the three; None or an
        empty text: no height. Raises InputError for what is no place."""
        north, east, up = place
        latitude, longitude = self.number(north, where), self.number(east, where)
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


def plain_name(text: str | None) -> str:
    """A name without the HTML that some programs put into it."""
    bare = re.sub(r"<[^<>]*>", " ", html.unescape((text or "")[: 20 * _MOST_NAME]))
    return " ".join(html.unescape(bare).split())[:_MOST_NAME]


def counted(count: int, noun: str) -> str:
    """The count with its noun: "1 point", "2 points"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"

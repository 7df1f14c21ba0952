"""A plan as QGroundControl reads it, with the lines and their verdicts."""

import json
import math
from collections.abc import Iterator
from itertools import count

from app.subjects.trajectory.kml import line_verdict
from app.subjects.trajectory.run import waypoints_of_lines
from app.work.flight import Followed
from nav_model.base.errors import InputError
from nav_model.design.trajectory import LINES, WAYPOINTS, Rows

_NAVIGATE, _CHANGE_SPEED, _ABSOLUTE, _PLANE, _GENERIC = 16, 178, 2, 1, 0  # of MAVLink and QGroundControl


def as_plan(followed: Followed) -> bytes:
    """The waypoints as a mission; the name of a line and its verdict stand at the waypoint where it begins.

    Heights above the ellipsoid are written as above sea level, as they are read. Raises InputError for a flight that
    has no waypoints.
    """
    design = followed.design
    if followed.file or design.trajectory.flight not in (LINES, WAYPOINTS):
        raise InputError("Flight", "only waypoints and parallel lines are a plan. Export this flight as KML.")
    rows = waypoints_of_lines(design) if design.trajectory.flight == LINES else design.trajectory.waypoints
    first = [math.degrees(rows[0][0]), math.degrees(rows[0][1]), design.trajectory.ground]
    mission = {
        "version": 2, "firmwareType": _GENERIC, "vehicleType": _PLANE, "globalPlanAltitudeMode": _ABSOLUTE,
        "cruiseSpeed": design.flight.speed, "hoverSpeed": design.flight.speed, "plannedHomePosition": first,
        "items": list(_items(followed, rows)),
    }  # fmt: skip
    plan = {
        "fileType": "Plan", "version": 1, "groundStation": "NavBudget", "mission": mission,
        "geoFence": {"circles": [], "polygons": [], "version": 2}, "rallyPoints": {"points": [], "version": 2},
    }  # fmt: skip
    return json.dumps(plan, ensure_ascii=False, indent=1).encode()


def _items(followed: Followed, rows: Rows) -> Iterator[dict[str, object]]:
    flown = iter(followed.result.lines if followed.result.spec.lines else ())
    numbers, usual = count(1), followed.design.flight.speed
    now = usual
    for latitude, longitude, height, name, speed in rows:
        place = [math.degrees(latitude), math.degrees(longitude), height]
        line = next(flown, None) if name else None  # lines are flown in the order of the plan
        yield {
            "type": "SimpleItem", "command": _NAVIGATE, "frame": 0, "autoContinue": True, "doJumpId": next(numbers),
            "AMSLAltAboveTerrain": None, "Altitude": height, "AltitudeMode": _ABSOLUTE,
            "params": [0, 0, 0, None, *place], "line": name,
            "verdict": line_verdict(followed, line) if line else "",
        }  # fmt: skip
        if (speed or usual) != now:  # it holds until the next change
            now = speed or usual
            yield {
                "type": "SimpleItem", "command": _CHANGE_SPEED, "frame": 2, "autoContinue": True,
                "doJumpId": next(numbers), "params": [1, now, -1, 0, 0, 0, 0],
            }  # fmt: skip

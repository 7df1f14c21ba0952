"""Plans of ground stations: QGroundControl's .plan and the .waypoints of Mission Planner (QGC WPL 110)."""

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import Any

from nav_model.base.errors import quoted
from nav_model.trajectory.files.heights import ABOVE_GROUND, ABOVE_SEA, Heights, counted, plain_name
from nav_model.trajectory.plan import Waypoint

MOST_TEXT = 5_000_000  # bytes
WAYPOINT_LIST = b"QGC WPL"
_PASSED = {16, 17, 18, 19, 31, 82}  # waypoints, places to loiter at
_NOT_FLOWN = {20: "return", 21: "landing", 22: "take-off", 84: "take-off", 85: "landing", 177: "jump"}
_CAMERA_DISTANCE, _CAMERA_START, _CAMERA_STOP = 206, 2000, 2001
_REFERENCES = {0: ABOVE_SEA, 5: ABOVE_SEA, 3: "home", 6: "home", 10: ABOVE_GROUND, 11: ABOVE_GROUND}
"""Of MAVLink's frames."""
Item = tuple[str, int, int, list[Any], Any]
"""Where it is in the file, its command, its frame and its seven parameters (MAVLink's mission items), and the name of
the line that begins there; None where the plan names none."""


def read_plan(content: bytes, heights: Heights) -> tuple[Waypoint, ...]:
    """The waypoints of a plan of QGroundControl, with the lines of its surveys.

    Raises InputError under the file's name.
    """
    try:
        plan = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise heights.refuse(f"is JSON that cannot be read: {error}") from error
    mission = plan.get("mission") if isinstance(plan, dict) else None
    if not isinstance(mission, dict) or not isinstance(mission.get("items"), list):
        raise heights.refuse("is JSON, but no plan of QGroundControl with a mission. Give a plan or a KML file.")
    home = mission.get("plannedHomePosition")
    height = home[2] if isinstance(home, list) and len(home) == 3 else None
    waypoints = _flown(_items(mission["items"], heights), height, heights)
    heights.note(f"plan of QGroundControl, {counted(len(waypoints), 'waypoint')}")
    if "cruiseSpeed" in mission:
        heights.note("flown at the design's speed, not the plan's")
    return waypoints


def read_waypoint_list(content: bytes, heights: Heights) -> tuple[Waypoint, ...]:
    """The waypoints of a QGC WPL file. Item 0, where it is above sea level, is home. Raises as `read_plan`."""
    items = _listed(content, heights)
    first = next(items, None)
    home = None
    if first is not None and first[1:3] == (16, 0):
        home = first[3][6]
    elif first is not None:
        items = chain([first], items)
    waypoints = _flown(items, home, heights)
    heights.note(f"waypoints of a ground station, {counted(len(waypoints), 'waypoint')}")
    return waypoints


def _listed(content: bytes, heights: Heights) -> Iterator[Item]:
    for number, line in enumerate(content.decode("utf-8", "replace").splitlines()[1:], 2):
        cells, where = line.split(), f"line {number}"
        if cells and len(cells) != 12:
            raise heights.refuse(f"{where}: {len(cells)} columns, 12 belong there")
        if cells:
            frame, command = (int(heights.number(cell, where)) for cell in cells[2:4])
            yield where, command, frame, [*cells[4:11]], None


def _items(items: list[Any], heights: Heights) -> Iterator[Item]:
    """All mission items in turn, those of surveys too."""
    for number, item in enumerate(items, 1):
        where = f"item {number}"
        if not isinstance(item, dict):
            raise heights.refuse(f"{where} is not a mission item")
        if item.get("type") != "ComplexItem":
            yield _item(item, where, heights)
        elif isinstance(transects := item.get("TransectStyleComplexItem"), dict) and isinstance(
            transects.get("Items"), list
        ):
            for part, inner in enumerate(transects["Items"], 1):
                yield _item(inner, f"{where}, part {part}", heights)
        else:
            problem = "holds no lines. Open the plan in QGroundControl and save it again"
            raise heights.refuse(f"{where} ({quoted(item.get('complexItemType'))}) {problem}.")


def _item(item: Any, where: str, heights: Heights) -> Item:
    params = item.get("params") if isinstance(item, dict) else None
    if not isinstance(params, list) or len(params) != 7:
        raise heights.refuse(f"{where} has no seven parameters")
    command, frame = (int(heights.number(item.get(key), f"{where}, {key}")) for key in ("command", "frame"))
    return where, command, frame, params, item.get("line")


def _flown(items: Iterator[Item], home: Any, heights: Heights) -> tuple[Waypoint, ...]:
    """The places of the items; a line begins at each while the camera is triggered, or at all without triggers."""
    unused: Counter[str] = Counter()
    triggered, shooting = False, False
    places: list[tuple[Waypoint, bool]] = []
    names: dict[int, str] = {}
    for where, command, frame, params, name in items:
        if command in (_CAMERA_DISTANCE, _CAMERA_START, _CAMERA_STOP):
            distance = params[0] is not None and heights.number(params[0], where) > 0.0
            shooting = command == _CAMERA_START or (command == _CAMERA_DISTANCE and distance)
            triggered = triggered or shooting
            if places:  # triggers follow the place where they are
                places[-1] = places[-1][0], shooting
        elif command in _PASSED:
            up, reference = params[6], _REFERENCES.get(frame, "")
            if not reference:
                raise heights.refuse(f"{where}: frame {frame} of its height is not known")
            if reference == "home":
                up, reference = _above_home(up, home, heights, where)
            if isinstance(name, str):
                names[len(places)] = plain_name(name)
            places.append((heights.waypoint(params[4], params[5], up, reference, where), shooting))
        else:
            unused[_NOT_FLOWN.get(command, f"command {command}")] += 1
    if unused:
        heights.note("not used: " + ", ".join(counted(number, name) for name, number in unused.items()))
    count, named = 0, []
    for number, (point, on) in enumerate(places):
        line = on if triggered else number < len(places) - 1
        count += line
        name = names.get(number, "") if names else f"line {count}" if line else ""
        named.append(replace(point, line=name))
    return tuple(named)


def _above_home(up: Any, home: Any, heights: Heights, where: str) -> tuple[Any, str]:
    """A height above the place of take-off: above sea level where the plan says how high that is and nobody else
    does."""
    if heights.ground is not None or home is None:
        return up, ABOVE_GROUND
    height = heights.number(home, "home")
    heights.note(f"heights above home, which the plan puts at {height:g} m")
    return heights.number(up, where) + height, ABOVE_SEA

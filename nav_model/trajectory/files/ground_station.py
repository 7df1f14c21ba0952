"""Plans of ground stations: QGroundControl's .plan and the .waypoints of Mission Planner (QGC WPL 110)."""

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from nav_model.base.errors import quoted
from nav_model.base.text.column_names import listed
from nav_model.trajectory.files.heights import Heights, Reference, counted, plain_name
from nav_model.trajectory.waypoints import Waypoint

_MOST_TEXT = 5_000_000  # bytes
WAYPOINT_LIST = b"QGC WPL"
# Commands and frames of MAVLink.
_PASSED = {16, 17, 18, 19, 31, 82}  # waypoints, places to loiter at
_NOT_FLOWN = {
    20: "return", 21: "landing", 22: "take-off", 84: "take-off", 85: "landing", 177: "jump",
    195: "region of interest", 203: "picture",
}  # fmt: skip
_CAMERA_DISTANCE, _CAMERA_START, _CAMERA_STOP = 206, 2000, 2001
_CHANGE_SPEED, _USUAL = 178, -2.0
_REFERENCES: dict[int, Reference] = {0: "sea", 5: "sea", 3: "home", 6: "home", 10: "ground", 11: "ground"}


class _Item(NamedTuple):
    """A mission item with its seven parameters; line: name of the line that begins there, None where there are no
    such names."""

    where: str
    command: int
    frame: int
    params: list[Any]
    line: Any = None


def read_ground_station(content: bytes, heights: Heights) -> tuple[Waypoint, ...]:
    """The waypoints of a plan of QGroundControl with the lines of its surveys, or of a QGC WPL file.

    Raises InputError under the file's name.
    """
    if len(content) > _MOST_TEXT:
        raise heights.refuse(f"has more than {_MOST_TEXT // 1_000_000} MB, which is too much for a plan")
    if content.startswith(WAYPOINT_LIST):
        items, program = _listed(content, heights), "waypoints of a ground station"
    else:
        try:
            plan = json.loads(content)
        except (ValueError, RecursionError) as error:
            raise heights.refuse(f"is JSON that cannot be read: {error}") from error
        match plan:
            case {"mission": {"items": [*parts], **mission}}:
                items, program = _items(parts, heights), "plan of QGroundControl"
            case _:
                reason = "is JSON, but not a plan of QGroundControl with a mission. Give a plan or a KML file."
                raise heights.refuse(reason)
        match mission.get("plannedHomePosition"):
            case [_, _, float() | int() as home]:
                heights.home = heights.number(home, "home")
        if "cruiseSpeed" in mission:
            heights.note("flown at the design's speed, not the plan's usual one")
    waypoints = _flown(items, heights)
    heights.note(f"{program}, {counted(len(waypoints), 'waypoint')}")
    return waypoints


def _listed(content: bytes, heights: Heights) -> Iterator[_Item]:
    lines = enumerate(content.decode("utf-8", "replace").splitlines(), 1)
    rows = ((f"line {number}", line.split()) for number, line in lines if number > 1 and line.strip())
    for number, (where, cells) in enumerate(rows):
        if len(cells) != 12:
            raise heights.refuse(f"{where}: {len(cells)} columns, 12 belong there")
        frame, command = (int(heights.number(cell, where)) for cell in cells[2:4])
        if number == 0 and (command, frame) == (16, 0):  # home, where it is above sea level
            heights.home = heights.number(cells[10], where)
        else:
            yield _Item(where, command, frame, [*cells[4:11]])


def _items(items: Iterable[Any], heights: Heights, of: str = "item") -> Iterator[_Item]:
    """All mission items in turn, those of surveys too."""
    for number, item in enumerate(items, 1):
        where = f"{of} {number}"
        match item:
            case {"type": "ComplexItem", "TransectStyleComplexItem": {"Items": [*parts]}} if of == "item":
                yield from _items(parts, heights, f"{where}, part")
            case {"type": "ComplexItem", "complexItemType": str(kind)} if "Landing" in kind:
                yield _Item(where, 21, 0, [])
            case {"type": "ComplexItem"}:
                reason = "holds no lines. Open the plan in QGroundControl and save it again."
                raise heights.refuse(f"{where} ({quoted(item.get('complexItemType'))}) {reason}")
            case {"command": command, "frame": frame, "params": [*params]}:
                if isinstance(place := item.get("coordinate"), list):  # as older plans have it
                    params = [*params, *place]
                if len(params) != 7:
                    raise heights.refuse(f"{where} has {len(params)} parameters, seven belong there")
                command, frame = (int(heights.number(number, where)) for number in (command, frame))
                yield _Item(where, command, frame, params, item.get("line"))
            case _:
                raise heights.refuse(f"{where} is not a mission item with command, frame and parameters")


def _flown(items: Iterable[_Item], heights: Heights) -> tuple[Waypoint, ...]:
    """The places of the items; a line begins at each while the camera is triggered, or at all without triggers."""
    unused: Counter[str] = Counter()
    triggered, shooting = False, False
    speed: float | None = None
    places: list[tuple[Waypoint, bool]] = []
    names: dict[int, str] = {}
    for where, command, frame, params, line in items:
        if command in (_CAMERA_DISTANCE, _CAMERA_START, _CAMERA_STOP):
            distance = params[0] is not None and heights.number(params[0], where) > 0.0
            shooting = command == _CAMERA_START or (command == _CAMERA_DISTANCE and distance)
            triggered = triggered or shooting
            if places:  # triggers follow the place where they are
                places[-1] = places[-1][0], shooting
        elif command in _PASSED:
            if frame not in _REFERENCES:
                raise heights.refuse(f"{where}: frame {quoted(frame)} of its height is not known")
            if isinstance(line, str):
                names[len(places)] = plain_name(line)
            place = heights.waypoint(tuple(params[4:7]), _REFERENCES[frame], where)
            places.append((replace(place, speed=speed), shooting))
        elif command == _CHANGE_SPEED:
            wanted = -1.0 if params[1] is None else heights.number(params[1], where)
            if wanted > 0.0 or wanted == _USUAL:  # any other: without a change
                speed = wanted if wanted > 0.0 else None
                places[-1:] = [(replace(place, speed=speed), on) for place, on in places[-1:]]
                heights.note("its changes of speed are flown")
        else:
            unused[_NOT_FLOWN.get(command, f"item of command {command}")] += 1
    if unused:
        heights.note(f"not used: {listed([counted(number, noun) for noun, number in unused.items()])}")
    if not names:
        begins = [on if triggered else number < len(places) - 1 for number, (_, on) in enumerate(places)]
        starts = [number for number, begin in enumerate(begins) if begin]
        names = {number: f"line {count}" for count, number in enumerate(starts, 1)}
    return tuple(replace(point, line=names.get(number, "")) for number, (point, _) in enumerate(places))

"""Logs of PX4 (ULog): the estimator's places, velocities and attitude, else the fixes of its receiver."""

import io
import math
import struct
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import replace
from typing import Any

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, quoted
from nav_model.trajectory.files.bounded_ulog import Messages, bounded
from nav_model.trajectory.files.epochs import Epochs, at_times, coded
from nav_model.trajectory.files.heights import Heights, counted

SIGNATURE = b"ULog\x01\x12\x35"
_TOPICS = ("vehicle_local_position", "vehicle_attitude", "vehicle_gps_position", "sensor_gps")
_RADIUS = 6_371_000.0
"""Of the sphere on which PX4 puts its local places [m]."""
_FIXES = {2: "2D", 3: "single", 4: "dgps", 5: "float", 6: "fixed"}
_DAMAGED = (
    TypeError, ValueError, IndexError, KeyError, AttributeError, struct.error, OverflowError, RecursionError,
)  # fmt: skip
Topic = Mapping[str, Array]


def read_ulog(content: bytes, heights: Heights) -> Epochs:
    """The epochs of a log.

    Raises InputError under the file's name: pyulog is not installed, the log is damaged, or it has no place on the
    Earth.
    """
    try:
        from pyulog import ULog, ULogException
    except ImportError as error:
        advice = "Install it: pip install navbudget[ulog]."
        raise heights.refuse(f"is a PX4 log (ULog), for which pyulog is needed. {advice}") from error
    try:
        with redirect_stdout(io.StringIO()):  # what it prints of each damaged message
            log = bounded(ULog)(Messages(content, heights), list(_TOPICS))
        return _epochs(log, heights)
    except InputError:
        raise
    except (*_DAMAGED, ULogException) as error:
        raise heights.refuse(f"is a PX4 log (ULog) that is damaged: {quoted(str(error))}") from error


def _epochs(log: Any, heights: Heights) -> Epochs:
    local, attitude, gps, newer = (_largest(log, topic, heights) for topic in _TOPICS)
    gps = gps or newer
    if gps and (fixed := np.isin(gps.get("fix_type", np.zeros(0)), (3, 4, 5, 6))).any():
        gps = {name: values[fixed] for name, values in gps.items()}
    else:
        gps = {}
    if local and (placed := _placed(local)).any():
        epochs = _estimated({name: values[placed] for name, values in local.items()}, gps, heights)
        if attitude:
            epochs = replace(epochs, attitude=_attitude(attitude, epochs.time, heights))
    elif gps:
        heights.note("the estimator has no place on the Earth, so the fixes of the receiver")
        epochs = _fixed(gps)
    else:
        raise heights.refuse(
            "is a PX4 log (ULog) that holds no flight: no fix of a receiver, and no place on the Earth"
        )
    if gps and (utc := gps.get("time_utc_usec", np.zeros(1))).all():
        start = float(np.median(1e-6 * (utc.astype(np.float64) - gps["timestamp"].astype(np.float64))))
        epochs = replace(epochs, clock="utc", time=epochs.time + start)
    return replace(epochs, format="ulog", kind="real-time")


def _largest(log: Any, topic: str, heights: Heights) -> Topic:
    """The instance of a topic with the most messages; empty where there is none."""
    instances = [data for data in log.data_list if data.name == topic and len(data.data["timestamp"])]
    if not instances:
        return {}
    chosen = max(instances, key=lambda data: len(data.data["timestamp"]))
    if len(instances) > 1:
        heights.note(f"{topic} {chosen.multi_id} of {len(instances)}, which has the most messages")
    return dict(chosen.data)


def _placed(local: Topic) -> Array:
    """True where local places have an origin on the Earth."""
    valid = local.get("xy_global", np.zeros(1)).astype(bool) & local.get("z_global", np.zeros(1)).astype(bool)
    origin = local["ref_lat"].astype(np.float64) != 0.0
    return np.asarray(valid & origin & np.isfinite(local["ref_lat"]))


def _seconds(topic: Topic) -> Array:
    """Times that the values are of [s]."""
    sampled = topic.get("timestamp_sample", topic["timestamp"])
    return 1e-6 * (sampled if sampled.all() else topic["timestamp"]).astype(np.float64)


def _estimated(local: Topic, gps: Topic, heights: Heights) -> Epochs:
    """Places of the estimator: from north and east of an origin, on PX4's sphere (azimuthal equidistant)."""
    north, east = (local[axis].astype(np.float64) / _RADIUS for axis in "xy")
    latitude, longitude = (np.radians(local[f"ref_{axis}"].astype(np.float64)) for axis in ("lat", "lon"))
    away = np.hypot(north, east)
    ratio = np.sinc(away / math.pi)
    sine = np.cos(away) * np.sin(latitude) + north * ratio * np.cos(latitude)
    across = np.cos(latitude) * np.cos(away) - north * ratio * np.sin(latitude)
    up = local["ref_alt"].astype(np.float64) - local["z"]
    heights.note(f"{counted(len(up), 'place')} of the estimator")
    if gps and {"alt_ellipsoid", "alt"} <= gps.keys():
        up = up + 1e-3 * float(np.median(gps["alt_ellipsoid"].astype(np.float64) - gps["alt"]))
        heights.note("heights above the sea with the receiver's undulation added")
    elif gps and {"altitude_ellipsoid_m", "altitude_msl_m"} <= gps.keys():
        up = up + float(np.median(gps["altitude_ellipsoid_m"] - gps["altitude_msl_m"]))
        heights.note("heights above the sea with the receiver's undulation added")
    else:
        up = up + heights.above_ellipsoid(0.0, "sea", "ref_alt")
    place = np.column_stack([np.arcsin(np.clip(sine, -1.0, 1.0)), longitude + np.arctan2(east * ratio, across), up])
    velocity = np.column_stack([local[axis].astype(np.float64) for axis in ("vx", "vy", "vz")])
    position, fast = (
        _drms(local[h], local[v]) if {h, v} <= local.keys() else None for h, v in (("eph", "epv"), ("evh", "evv"))
    )
    heights.note("horizontal accuracies (eph, evh) taken as DRMS, brought to one sigma per axis")
    return Epochs(
        "", "", _seconds(local), place, velocity, sigma_position=position, sigma_velocity=fast, accuracy="drms"
    )


def _drms(horizontal: Array, vertical: Array) -> Array:
    """Sigmas north, east, down of an accuracy in the plane and one of the height; NaN where one is not finite."""
    plane = horizontal.astype(np.float64) / math.sqrt(2.0)
    sigmas = np.column_stack([plane, plane, vertical.astype(np.float64)])
    return np.where(np.isfinite(sigmas), sigmas, np.nan)


def _fixed(gps: Topic) -> Epochs:
    """Fixes of a receiver: in 1e-7 degrees and mm, of newer logs in degrees and metres."""
    if "latitude_deg" in gps:
        places = [gps["latitude_deg"], gps["longitude_deg"], gps["altitude_ellipsoid_m"]]
    else:
        places = [1e-7 * gps["lat"], 1e-7 * gps["lon"], 1e-3 * gps["alt_ellipsoid"]]
    fix, names = coded([_FIXES.get(int(kind), f"{kind}") for kind in gps["fix_type"]])
    speed = gps["s_variance_m_s"].astype(np.float64)  # a sigma, for all its name
    return Epochs(
        "", "", _seconds(gps), np.column_stack([np.radians(places[0]), np.radians(places[1]), places[2]]),
        np.column_stack([gps[f"vel_{axis}_m_s"].astype(np.float64) for axis in "ned"]),
        sigma_position=_drms(gps["eph"], gps["epv"]), sigma_velocity=np.column_stack([speed / math.sqrt(3.0)] * 3),
        accuracy="drms", fix=fix, fix_names=names,
    )  # fmt: skip


def _attitude(topic: Topic, time: Array, heights: Heights) -> Array:
    """Roll, pitch, heading at the times of the places, from quaternions."""
    w, x, y, z = (topic[f"q[{at}]"].astype(np.float64) for at in range(4))
    angles = [
        np.unwrap(np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))),
        np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))),
    ]
    return at_times(time, _seconds(topic), np.column_stack(angles), heights, "vehicle_attitude")

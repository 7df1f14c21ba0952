"""NMEA 0183 sentences of a receiver: GGA with its fix, GST with its sigmas, RMC with the date."""

import re
from datetime import date
from functools import reduce
from operator import xor

import numpy as np

from nav_model.trajectory.files.epochs import Epochs, coded
from nav_model.trajectory.files.heights import Heights, counted

_LINE = re.compile(rb"\$([A-Z]{2}(GGA|RMC|GST),[^$*\r\n]*)(?:\*([0-9a-fA-F]{2}))?")
NAMES = re.compile(rb"\$[A-Z]{2}(GGA|RMC),")
FIXES = {
    0: "none", 1: "single", 2: "dgps", 3: "pps", 4: "fixed", 5: "float", 6: "dead reckoning", 7: "manual",
    8: "simulator",
}  # fmt: skip
"""Quality in a GGA sentence -> its name."""
_DAY = 86_400.0
_LAST_CENTURY = 80  # years of two digits from here on


def read_nmea(content: bytes, heights: Heights) -> Epochs:
    """The epochs of GGA sentences; the sigmas of a GST belong to the GGA of the same time.

    Raises InputError under the file's name where no GGA has a place and the right checksum.
    """
    wrong = unfixed = 0
    day, before, started = 0, 0.0, None
    rows, fixes, sigmas = list[list[float]](), list[int](), dict[float, list[float]]()
    for match in _LINE.finditer(content):
        if match[3] is None or reduce(xor, match[1]) != int(match[3], 16):
            wrong += 1
            continue
        _, clock, *fields = match[1].decode("latin-1").split(",")
        try:
            seconds = 3600.0 * int(clock[:2]) + 60.0 * int(clock[2:4]) + float(clock[4:])
            day += seconds < before - 0.5 * _DAY
            time, before = day * _DAY + seconds, seconds
            if match[2] == b"GST":
                sigmas[time] = [float(text) for text in fields[4:7]]
            elif match[2] == b"RMC" and started is None:
                started = _date(fields[7]) - day
            elif match[2] == b"GGA":
                latitude, longitude = (_degrees(fields[at], fields[at + 1]) for at in (0, 2))
                quality = int(fields[4])
                unfixed += quality == 0
                if quality:
                    separation = float(fields[9]) if fields[9] else np.nan
                    rows.append([time, latitude, longitude, float(fields[7]), separation])
                    fixes.append(quality)
        except (ValueError, IndexError):  # empty fields, before there is a fix
            unfixed += match[2] == b"GGA"
    if wrong:
        heights.note(f"{counted(wrong, 'sentence')} with a wrong checksum, or cut off, left out")
    if unfixed:
        heights.note(f"{counted(unfixed, 'GGA sentence')} without a fix left out")
    if not rows:
        raise heights.refuse("holds no GGA sentence with a fix and the right checksum. RMC alone has no heights.")
    time, latitude, longitude, up, separation = np.array(rows).T
    heights.note(f"{counted(len(rows), 'GGA sentence')}")
    if np.isfinite(separation).all():
        heights.note("heights above the sea with the geoid separation added")
        up = up + separation
    else:
        up = up + heights.above_ellipsoid(0.0, "sea", "GGA")
    none = [np.nan] * 3
    fix, names = coded([FIXES.get(quality, f"{quality}") for quality in fixes])
    return Epochs(
        "nmea", "day seconds" if started is None else "utc", time + _DAY * (started or 0),
        np.column_stack([np.radians(latitude), np.radians(longitude), up]),
        sigma_position=np.array([sigmas.get(at, none) for at in time.tolist()]) if sigmas else None,
        fix=fix, fix_names=names, kind="real-time",
    )  # fmt: skip


def _degrees(text: str, side: str) -> float:
    """Degrees of "4724.5000", "N": two digits before the point are minutes."""
    degrees, minutes = divmod(float(text), 100.0)
    return (degrees + minutes / 60.0) * (-1.0 if side in ("S", "W") else 1.0)


def _date(text: str) -> int:
    """Days since 1970 of "ddmmyy"."""
    year = int(text[4:6])
    century = 1900 if year >= _LAST_CENTURY else 2000
    return (date(century + year, int(text[2:4]), int(text[:2])) - date(1970, 1, 1)).days

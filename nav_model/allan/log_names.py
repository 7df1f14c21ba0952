"""Names and units of the columns or arrays of an inertial log, in the layouts that are in use.

Understood: `gyro_x [deg/s]`, `gx_dps`, `wx(rad/s)`, `acc_x_g`, `az`, EuRoC's `w_RS_S_x [rad s^-1]`, ROS's
`angular_velocity.x` (SI by REP 103), increments `dtheta_x`, `dvel_z`, counts with `gyro_dps_per_count`.
"""

import math
import re
from dataclasses import dataclass
from typing import Final

from nav_model.base.constants import DEGREE, STANDARD_GRAVITY
from nav_model.base.errors import InputError


@dataclass(frozen=True)
class Scale:
    """`factor` to SI; `per_sample` when the values are increments over one sample."""

    factor: float
    per_sample: bool
    symbol: str


@dataclass(frozen=True)
class Meaning:
    """Role ("time", "gyro", "accelerometer", "temperature"), axis 0..2 or None, unit text or None."""

    role: str
    axis: int | None
    unit: str | None


_G = STANDARD_GRAVITY

# unit -> (factor to SI, increments per sample)
_UNITS: Final[dict[str, dict[str, tuple[float, bool]]]] = {
    "gyro": {
        "rad/s": (1.0, False),
        "mrad/s": (1e-3, False),
        "deg/s": (DEGREE, False),
        "mdeg/s": (DEGREE * 1e-3, False),
        "deg/h": (DEGREE / 3600.0, False),
        "rad": (1.0, True),
        "mrad": (1e-3, True),
        "urad": (1e-6, True),
        "deg": (DEGREE, True),
        "arcsec": (DEGREE / 3600.0, True),
    },
    "accelerometer": {
        "m/s2": (1.0, False),
        "g": (_G, False),
        "mg": (_G * 1e-3, False),
        "ug": (_G * 1e-6, False),
        "m/s": (1.0, True),
        "mm/s": (1e-3, True),
        "g.s": (_G, True),
        "ug.s": (_G * 1e-6, True),
    },
    "time": {"s": (1.0, False), "ms": (1e-3, False), "us": (1e-6, False), "ns": (1e-9, False)},
    "temperature": {"degc": (1.0, False)},
}

_UNIT_SPELLINGS: Final = {
    "dps": "deg/s",
    "mdps": "mdeg/s",
    "dph": "deg/h",
    "rads": "rad/s",
    "radps": "rad/s",
    "rps": "rad/s",
    "mps2": "m/s2",
    "ms2": "m/s2",
    "mss": "m/s2",
    "m/s/s": "m/s2",
    "mps": "m/s",
    "ugs": "ug.s",
    "gs": "g.s",
    "sec": "s",
    "seconds": "s",
    "c": "degc",
    "celsius": "degc",
}

_ROLES: Final = (
    ("time", r"(imu|sensor)?(t|time|timestamp|stamp|tow|timeofweek|seconds|sec)"),
    ("temperature", r"(imu|gyro|acc|sensor)?(temp|temperature)"),
    ("gyro", r"(imu)?(g|gyr|gyro|gyroscope|gyros|w|omega|angularvelocity|angularrate|wrss|wibb)"),
    ("gyro", r"(imu)?(dtheta|dang|dangle|deltatheta|deltaangle|dth)"),
    ("accelerometer", r"(imu)?(a|f|acc|accel|accelerometer|accelerometers|acceleration|linearacceleration)"),
    ("accelerometer", r"(imu)?(specificforce|force|arss|fib|fibb|dvel|dv|deltav|deltavelocity)"),
)
_SI_BY_STANDARD: Final = {"angularvelocity": "rad/s", "linearacceleration": "m/s2"}


def units_of(role: str) -> dict[str, bool]:
    """Units that the values of a role may have -> whether they are increments over one sample."""
    return {unit: per_sample for unit, (_, per_sample) in _UNITS[role].items()}


def scale_of(role: str, unit: str) -> Scale:
    """Scale of a unit text such as "deg/s", "°/s", "0.05 deg/s" (counts of 0.05 deg/s) or "0.1 arcsec"
    (increments). That a number is of a count may be said: "0.05 deg/s a count", "0.05 deg/s per count".

    Raises InputError under ``gyro_unit`` or ``accelerometer_unit``, with the units allowed.
    """
    match = re.fullmatch(r"\s*([0-9.]+(?:[eE][-+]?[0-9]+)?)?\s*(.+?)(?:(?:\s+a|\s+per|\s*/)\s*count)?\s*", unit)
    text = _normal_unit(match.group(2)) if match else ""
    number = 1.0
    if match and match.group(1):
        try:
            number = float(match.group(1))
        except ValueError:
            text = ""
    allowed = _UNITS[role]
    if text not in allowed or not 0.0 < number < math.inf:
        raise InputError(
            f"{role}_unit",
            f"{unit!r} is not understood; allowed: {', '.join(allowed)}, or a number and one of these per count",
            unit,
        )
    factor, per_sample = allowed[text]
    return Scale(number * factor, per_sample, unit.strip())


def meaning_of(name: str) -> Meaning | None:
    """Meaning of a column or array name, None when it is not one of an inertial log's quantities."""
    bare, unit = _split_unit(name.strip().strip('"').lstrip("#%").strip())
    words = [word for word in re.split(r"[^a-zA-Z0-9]+", bare.lower()) if word]
    if not words:
        return None
    found = _from_words(words, unit)
    if found is None and unit is None:
        # The unit may be at the end of the name: gyro_x_dps, acc_g, imu_ms.
        for count in (1, 2):
            text = _normal_unit("_".join(words[-count:]))
            shorter = _from_words(words[:-count], text) if len(words) > count else None
            if shorter is not None and (text in _UNITS[shorter.role] or text in ("counts", "raw")):
                return shorter if text in _UNITS[shorter.role] else Meaning(shorter.role, shorter.axis, "counts")
    return found


def _from_words(words: list[str], unit: str | None) -> Meaning | None:
    joined = "".join(words)
    for stem, axis in _stems(joined):
        for role, pattern in _ROLES:
            if re.fullmatch(pattern, stem) is None:
                continue
            if len(stem) == 1 and role in ("gyro", "accelerometer") and axis is None:
                continue
            if unit is not None and unit not in _UNITS[role] and unit not in ("counts", "raw"):
                continue
            return Meaning(role, axis, unit or _SI_BY_STANDARD.get(stem))
    return None


def _stems(joined: str) -> list[tuple[str, int | None]]:
    stems: list[tuple[str, int | None]] = [(joined, None)]
    if len(joined) > 1 and joined[-1] in "xyz":
        stems.append((joined[:-1], "xyz".index(joined[-1])))
    elif len(joined) > 2 and joined[0] in "xyz":
        stems.append((joined[1:], "xyz".index(joined[0])))
    return stems


def _split_unit(name: str) -> tuple[str, str | None]:
    match = re.fullmatch(r"(.*?)[\s_]*[\[(]([^\])]*)[\])]\s*", name)
    if match is None or not match.group(1):
        return name, None
    return match.group(1), _normal_unit(match.group(2))


def _normal_unit(text: str) -> str:
    unit = text.strip().lower().replace("°", "deg").replace("µ", "u").replace("μ", "u").replace("²", "2")
    unit = re.sub(r"\s*(s|sec)\s*\^?\s*-\s*2$", "/s2", unit)
    unit = re.sub(r"\s*(s|sec)\s*\^?\s*-\s*1$", "/s", unit)
    unit = unit.replace("^", "").replace("**", "").replace("·", ".").replace("*", ".").replace(" ", "")
    unit = unit.replace("_", "").replace("sec2", "s2").replace("degrees", "deg").replace("hr", "h")
    unit = re.sub(r"/sec$", "/s", unit)
    return _UNIT_SPELLINGS.get(unit, unit)

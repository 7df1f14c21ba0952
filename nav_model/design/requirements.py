"""The requirements of a design: limits on its figures."""

import math
from typing import Any

from nav_model.base.constants import DEGREE
from nav_model.design.declaration import Choice, OptionalQuantity, Quantity
from nav_model.design.part import Part

_USUAL: dict[str, tuple[str, float, tuple[float, float]]] = {
    "angle": ("°", 1e6 * DEGREE, (1 * DEGREE, 360 * DEGREE)),
    "length": ("m", 1e6, (1e-3, 1e3)),
    "speed": ("m/s", 1e4, (1e-4, 10.0)),
    "level": ("dB", 10.0, (1e-3, 0.3)),
}
"""Dimension -> unit, highest limit, and what a slider spans."""
_GIVEN = "Not on data sheets: the requirement of the image product or of the mission."
_REACHED = "reached with 1.5 m fixes at 1 Hz: "


def _limit(dimension: str, short: str, label: str, doc: str, typical: str, since: str = "", **own: Any) -> Any:
    """A limit on a figure; `own` bounds in place of the usual ones."""
    unit, highest, soft = _USUAL[dimension]
    lowest = 1e-6 * DEGREE if dimension == "angle" else 1e-6
    given = {"bounds": (lowest, highest), "softbounds": soft} | own
    return OptionalQuantity(
        dimension=dimension, unit=unit, short=short, label=label, doc=doc, datasheet=_GIVEN, typical=typical,
        when_empty="not checked", variable=False, since=since, **given,
    )  # fmt: skip


_AFTER_OUTAGE: dict[str, Any] = {"bounds": (1e-6, 1e7), "softbounds": (1e-2, 1e4)}


class Requirements(Part):
    """Limits; one not given is not checked."""

    section = "requirements"
    title = "Requirements"

    confidence = Quantity(
        default=1.0,
        dimension="",
        unit="",
        short="k",
        bounds=(0.1, 6.0),
        softbounds=(1.0, 3.0),
        label="Confidence",
        doc="Number of sigmas that must stay within a limit.",
        datasheet="Not on data sheets: the requirement's own percentage.",
        typical="1 (68 %), 2 (95 %), 3 (99.7 %)",
        variable=False,
    )
    steady_state = Choice(
        default="prior",
        options={"prior": "before a fix", "closed": "average between fixes", "posterior": "after a fix"},
        short="ss",
        label="Steady state checked",
        doc="Which moment is checked: before a fix, where the error is largest, the average (rms) "
        "between fixes, or after a fix.",
    )
    quadratic_phase: Any = _limit(
        "angle", "qpe", "Quadratic phase",
        "Limit on quadratic phase error at the aperture's ends: 45° strict, 90° usual [S-4].",
        "45° to 90°; below 1 dB of peak loss up to 90°",
    )  # fmt: skip
    detrended_phase: Any = _limit(
        "angle", "dpe", "Detrended phase",
        "Limit on the rms phase that remains over the aperture after autofocus.",
        "6° keeps the integrated side lobes of wide-band phase at −20 dB, 20° costs 0.5 dB of the peak",
    )  # fmt: skip
    cubic_phase: Any = _limit(
        "angle", "cpe", "Cubic phase",
        "Limit on cubic phase error at the aperture's ends: 22.5° tight, 45° usual [S-4].",
        "22.5° to 45°; beyond, one side lobe rises", "0.1.0",
    )  # fmt: skip
    azimuth_shift: Any = _limit(
        "length", "azs", "Azimuth shift",
        "Image shift along track: the position error there and R/V times the line-of-sight velocity error.",
        f"{_REACHED}navigation 0.3 to 0.7, tactical 1 to 4, MEMS 2 to 6 m; a fifth of that post-processed", "0.1.0",
    )  # fmt: skip
    range_shift: Any = _limit(
        "length", "rgs", "Range shift",
        "Image shift along the line of sight: the mean position error over the aperture.",
        f"{_REACHED}navigation 0.2 to 0.3, tactical 0.3 to 0.6, MEMS 0.4 to 0.7 m", "0.1.0",
    )  # fmt: skip
    ce90: Any = _limit(
        "length", "ce", "CE90",
        "Radius on the ground that contains 90 % of images. The confidence does not multiply it, since it is "
        "already a percentage.",
        f"{_REACHED}navigation 0.6 to 1.2, tactical 2 to 7, MEMS 4 to 10 m", "0.1.0",
    )  # fmt: skip
    le90: Any = _limit(
        "length", "le", "LE90",
        "Height error that 90 % of images stay below. The confidence does not multiply it, since it is already a "
        "percentage.",
        f"{_REACHED}navigation 0.2 to 0.5, tactical 0.2 to 0.5, MEMS 0.4 to 0.7 m", "0.1.0",
    )  # fmt: skip
    paired_echo: Any = _limit(
        "level", "pe", "Paired echo",
        "Highest paired echo caused by a vibration line, relative to the target's peak [P-9].",
        "−25 to −40 dB; −30 dB is 0.157 mm along the line of sight at X band", "0.1.0",
    )  # fmt: skip
    islr: Any = _limit(
        "level", "isl", "ISLR of vibration and oscillator",
        "Energy outside the main lobe due to vibration, unsensed motion and oscillator, relative to the target's. "
        "The window's own side lobes are not included [P-11].",
        "−15 to −25 dB", "0.1.0",
    )  # fmt: skip
    horizontal_position: Any = _limit(
        "length",
        "rh",
        "Horizontal position",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.2 to 0.4, tactical 0.4 to 0.7, MEMS 0.5 to 0.8 m",
    )
    vertical_position: Any = _limit(
        "length",
        "rv",
        "Vertical position",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.1 to 0.3, tactical 0.1 to 0.3, MEMS 0.2 to 0.4 m",
    )
    horizontal_velocity: Any = _limit(
        "speed",
        "rvh",
        "Horizontal velocity",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.003 to 0.01, tactical 0.02 to 0.07, MEMS 0.04 to 0.1 m/s",
    )
    vertical_velocity: Any = _limit(
        "speed",
        "rvv",
        "Vertical velocity",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.0005 to 0.006, tactical 0.001 to 0.008, MEMS 0.004 to 0.02 m/s",
    )
    tilt: Any = _limit(
        "angle",
        "rt",
        "Tilt",
        "Roll and pitch, each, in steady state.",
        f"{_REACHED}navigation 0.0002 to 0.001, tactical 0.004 to 0.03, MEMS 0.01 to 0.05°",
        bounds=(1e-6 * DEGREE, math.pi),
        softbounds=(1e-4 * DEGREE, 1 * DEGREE),
    )
    coast_horizontal_position: Any = _limit(
        "length",
        "rch",
        "Horizontal position after the outage",
        "Free INS, per axis, when the outage ends.",
        f"after 60 s, {_REACHED}navigation 0.4 to 1, tactical 3 to 13, MEMS 7 to 25 m",
        **_AFTER_OUTAGE,
    )
    coast_vertical_position: Any = _limit(
        "length",
        "rcv",
        "Vertical position after the outage",
        "Free INS, when the outage ends.",
        f"after 60 s, {_REACHED}navigation 0.1 to 0.6, tactical 0.2 to 0.8, MEMS 0.4 to 2 m",
        **_AFTER_OUTAGE,
    )

"""The figures: every error that a budget gives, a requirement limits and a contributor enters, declared once.

A declaration says what a figure is called, its dimension, the marks of its equations and its requirement. Its formula
is the member of the same name of `nav_model.budget.real_time.RealTime`, and of `nav_model.budget.smoothed.Smoothed`
where post-processing changes it. Verdict, JSON, tables, tiles, sweeps, comparison and workbook read this tuple.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

from nav_model.base.constants import DEGREE
from nav_model.design.declaration import OptionalQuantity, in_sentence

Kind = Literal["phase", "place", "level", "steady", "outage", "response", "flight"]
"""Subject of a figure: phase over the aperture, place of the image, side lobes of fast errors, the settled filter,
a time after the last fix, the azimuth impulse response with the quadratic phase at one sigma; or of a flight alone,
as a straight leg does not tell it."""


@dataclass(frozen=True)
class Figure:
    """One figure.

    Attributes
    ----------
    name : str
        In files, links and JSON; its formula has the same name.
    label : str
    dimension : str
        "angle", "length", "speed", "level" (amplitude over the target's) or "loss" (decibels).
    kind : str
    mark : str
        Of its equation in real time.
    smoothed_mark : str
        Of its equation after post-processing; empty where both processings have the same figure.
    requirement : OptionalQuantity, optional
        Without it, only a limit of the user's own limits the figure.
    whole : str
        Of a part of a phase, the figure of the image that it is a part of: what enters the one enters the other.
    scaled : bool
        Whether a confidence multiplies it. A percentage, a level and a response at one sigma stay as they are.
    tile : bool
        Whether it always has a tile among the key figures.
    in_flight : bool
        Whether it is known along a flight too.
    follows : str
        Of a measure of the impulse response, the phase that it is read from.
    """

    name: str
    label: str
    dimension: str
    kind: Kind
    mark: str
    smoothed_mark: str = ""
    requirement: OptionalQuantity | None = None
    whole: str = ""
    scaled: bool = True
    tile: bool = False
    in_flight: bool = False
    follows: str = ""

    @property
    def accepts(self) -> tuple[str, ...]:
        """Dimensions of what may enter it: a length along the line of sight is a phase too."""
        return (self.dimension, "length") if self.kind == "phase" else (self.dimension,)

    @property
    def pair(self) -> bool:
        """True if it is one sigma of each of two horizontal axes."""
        return "horizontal" in self.name

    @property
    def column(self) -> str:
        """Its name with what it is and its SI unit, in JSON and in the columns of a sweep."""
        return column_of(self.name, self.dimension, self.scaled)


def column_of(name: str, dimension: str, scaled: bool = True) -> str:
    """A name with what its value is and its SI unit."""
    unit = {"length": "m", "speed": "m_s", "angle": "rad", "level": "ratio", "loss": "db"}[dimension]
    return f"{name}_sigma_{unit}" if scaled else f"{name}_{unit}"


_USUAL: dict[str, tuple[str, float, tuple[float, float]]] = {
    "angle": ("°", 1e6 * DEGREE, (1 * DEGREE, 360 * DEGREE)),
    "length": ("m", 1e6, (1e-3, 1e3)),
    "speed": ("m/s", 1e4, (1e-4, 10.0)),
    "level": ("dB", 10.0, (1e-3, 0.3)),
}
"""Dimension -> unit, highest limit, and what a slider spans."""
_GIVEN = "From the image or mission requirement."
_REACHED = "reached with 1.5 m fixes at 1 Hz: "
_AFTER_OUTAGE: dict[str, Any] = {"bounds": (1e-6, 1e7), "softbounds": (1e-2, 1e4)}


def _limited(
    name: str, label: str, dimension: str, kind: Kind, marks: str, short: str, doc: str, typical: str,
    since: str = "", requirement: Mapping[str, Any] = MappingProxyType({}), **flags: Any,
) -> Figure:  # fmt: skip
    """A figure with a requirement: `marks` in real time / post-processed, `short` its name in links, `requirement`
    bounds in place of the usual ones."""
    unit, highest, soft = _USUAL[dimension]
    lowest = 1e-6 * DEGREE if dimension == "angle" else 1e-6
    limit = OptionalQuantity(
        dimension=dimension, unit=unit, short=short, label=label, doc=doc, datasheet=_GIVEN, typical=typical,
        when_empty="not checked", variable=False, since=since,
        **({"bounds": (lowest, highest), "softbounds": soft} | dict(requirement)),
    )  # fmt: skip
    mark, _, smoothed_mark = marks.partition(" / ")
    return Figure(name, label, dimension, kind, mark, smoothed_mark, limit, **flags)


_DECLARED = (
    _limited(
        "quadratic_phase", "Quadratic phase", "angle", "phase", "[S-8] / [P-5]", "qpe",
        "Limit on quadratic phase error at the aperture's ends: 45° strict, 90° usual [S-4].",
        "45° to 90°; below 1 dB of peak loss up to 90°", tile=True, in_flight=True,
    ),
    _limited(
        "detrended_phase", "Detrended phase", "angle", "phase", "[S-8] / [P-5]", "dpe",
        "Limit on the rms phase that remains over the aperture after autofocus.",
        "6° keeps the integrated side lobes of wide-band phase at −20 dB, 20° costs 0.5 dB of the peak",
        tile=True, in_flight=True,
    ),
    _limited(
        "cubic_phase", "Cubic phase", "angle", "phase", "[S-8] / [P-5]", "cpe",
        "Limit on cubic phase error at the aperture's ends: 22.5° tight, 45° usual [S-4].",
        "22.5° to 45°; beyond, one side lobe rises", "0.1.0", in_flight=True,
    ),
    _limited(
        "phase_before_autofocus", "Phase before autofocus", "angle", "phase", "[S-8] / [P-5]", "pba",
        "Limit on quadratic phase error at the aperture's ends before autofocus. With an autofocus, three sigma must "
        "be below its capture too [S-9].",
        "720° to 2880°, the capture of a phase gradient of 16 to 64 blocks", "0.2.0", in_flight=True,
    ),
    _limited(
        "path_before_autofocus", "Path before autofocus", "length", "phase", "[S-8] / [P-5]", "ppa",
        "Limit on the path error at the aperture's ends before autofocus, the line removed. With an autofocus that "
        "leaves range migration, half a range cell is one too: a phase correction alone does not focus what "
        "migrates [S-9].",
        "half a range cell", "0.2.0", in_flight=True,
    ),
    _limited(
        "autofocus_estimation", "Autofocus estimation", "angle", "phase", "[S-10]", "afe",
        "Limit on the phase error of one estimate of the autofocus, from the points and the clutter of the scene. "
        "With an autofocus, 0.3 rad is one too: beyond, it fails [S-10]. The confidence does not multiply it.",
        "1° in a town, 10° on five reflectors; above 17.2° it fails", "0.2.0", scaled=False,
    ),
    _limited(
        "azimuth_shift", "Azimuth shift", "length", "place", "[P-7] / [P-7]", "azs",
        "Image shift along track: the position error there and R/V times the line-of-sight velocity error.",
        f"{_REACHED}navigation 0.3 to 0.7, tactical 1 to 4, MEMS 2 to 6 m; a fifth of that post-processed", "0.1.0",
        in_flight=True,
    ),
    _limited(
        "range_shift", "Range shift", "length", "place", "[P-7] / [P-7]", "rgs",
        "Image shift along the line of sight: the mean position error over the aperture.",
        f"{_REACHED}navigation 0.2 to 0.3, tactical 0.3 to 0.6, MEMS 0.4 to 0.7 m", "0.1.0", in_flight=True,
    ),
    _limited(
        "ce90", "CE90", "length", "place", "[P-7] / [P-7]", "ce",
        "Radius on the ground that contains 90 % of images. The confidence does not multiply it, since it is "
        "already a percentage.",
        f"{_REACHED}navigation 0.6 to 1.2, tactical 2 to 7, MEMS 4 to 10 m", "0.1.0", scaled=False, in_flight=True,
    ),
    _limited(
        "le90", "LE90", "length", "place", "[P-7] / [P-7]", "le",
        "Height error that 90 % of images stay below. The confidence does not multiply it, since it is already a "
        "percentage.",
        f"{_REACHED}navigation 0.2 to 0.5, tactical 0.2 to 0.5, MEMS 0.4 to 0.7 m", "0.1.0", scaled=False,
    ),
    _limited(
        "paired_echo", "Paired echo", "level", "level", "[P-9]", "pe",
        "Highest paired echo caused by a vibration line, relative to the target's peak [P-9].",
        "−25 to −40 dB; −30 dB is 0.157 mm along the line of sight at X band", "0.1.0", scaled=False,
    ),
    _limited(
        "islr", "ISLR of fast phase errors", "level", "level", "[P-11]", "isl",
        "Energy outside the main lobe due to vibration, unsensed motion, oscillator and the error of estimation of a "
        "phase gradient, relative to the target's. The window's own side lobes are not included [P-11].",
        "−15 to −25 dB", "0.1.0", scaled=False,
    ),
    _limited(
        "horizontal_position", "Horizontal position", "length", "steady", "[T-8] / [P-3]", "rh",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.2 to 0.4, tactical 0.4 to 0.7, MEMS 0.5 to 0.8 m", tile=True, in_flight=True,
    ),
    _limited(
        "vertical_position", "Vertical position", "length", "steady", "[T-8] / [P-3]", "rv",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.1 to 0.3, tactical 0.1 to 0.3, MEMS 0.2 to 0.4 m", tile=True, in_flight=True,
    ),
    _limited(
        "horizontal_velocity", "Horizontal velocity", "speed", "steady", "[T-8] / [P-3]", "rvh",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.003 to 0.01, tactical 0.02 to 0.07, MEMS 0.04 to 0.1 m/s", tile=True, in_flight=True,
    ),
    _limited(
        "vertical_velocity", "Vertical velocity", "speed", "steady", "[T-8] / [P-3]", "rvv",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.0005 to 0.006, tactical 0.001 to 0.008, MEMS 0.004 to 0.02 m/s", in_flight=True,
    ),
    _limited(
        "tilt", "Tilt", "angle", "steady", "[T-8] / [P-3]", "rt", "Roll and pitch, each, in steady state.",
        f"{_REACHED}navigation 0.0002 to 0.001, tactical 0.004 to 0.03, MEMS 0.01 to 0.05°",
        requirement={"bounds": (1e-6 * DEGREE, math.pi), "softbounds": (1e-4 * DEGREE, 1 * DEGREE)},
        tile=True, in_flight=True,
    ),
    _limited(
        "coast_horizontal_position", "Horizontal position after the outage", "length", "outage", "[T-17]", "rch",
        "Free INS, per axis, when the outage ends.",
        f"after 60 s, {_REACHED}navigation 0.4 to 1, tactical 3 to 13, MEMS 7 to 25 m",
        requirement=_AFTER_OUTAGE, tile=True,
    ),
    _limited(
        "coast_vertical_position", "Vertical position after the outage", "length", "outage", "[T-17]", "rcv",
        "Free INS, when the outage ends.",
        f"after 60 s, {_REACHED}navigation 0.1 to 0.6, tactical 0.2 to 0.8, MEMS 0.4 to 2 m",
        requirement=_AFTER_OUTAGE,
    ),
    Figure("coast_horizontal_velocity", "Horizontal velocity after the outage", "speed", "outage", "[T-9]"),
    Figure("coast_vertical_velocity", "Vertical velocity after the outage", "speed", "outage", "[T-17]"),
    Figure("coast_tilt", "Tilt after the outage", "angle", "outage", "[T-9]"),
    Figure("coast_heading", "Heading growth in the outage", "angle", "outage", "[T-5]"),
    _limited(
        "heading", "Heading", "angle", "flight", "", "rhd",
        "Heading error on each line of the flight plan, or without one on a straight flight of its flight time, as a "
        "straight leg does not observe it.",
        "0.005 to 0.05° for a lidar or a camera", "0.2.0",
        requirement={"bounds": (1e-6 * DEGREE, math.pi), "softbounds": (1e-3 * DEGREE, 1 * DEGREE)}, in_flight=True,
    ),
    Figure("cep", "CEP", "length", "place", "[P-7]", "[P-7]", scaled=False),
    *(
        Figure(
            f"detrended_phase_{order}", f"Detrended phase, autofocus order {order}", "angle", "phase",
            "[S-8]", "[P-5]",
        )
        for order in (1, 2, 3)
    ),
    *(
        Figure(f"{part}_{name}", f"{label} {what}", "angle", "phase", mark, "[P-5]", whole=name, in_flight=True)
        for part, label, marks in (
            ("line_of_sight", "Line-of-sight", ("[S-5]", "[S-6]", "[T-15], [S-6]")),
            ("along_track", "Along-track", ("[S-2]", "[S-8]", "[S-8]")),
        )
        for name, what, mark in zip(
            ("quadratic_phase", "cubic_phase", "detrended_phase"),
            ("quadratic phase", "cubic phase", "detrended phase"), marks, strict=True,
        )
    ),
    *(
        Figure(name, label, dimension, "response", "[S-8]", "[P-5]", scaled=False, follows="quadratic_phase")
        for name, label, dimension in (
            ("response_width", "Response width", "length"),
            ("pslr", "Peak side-lobe ratio", "level"),
            ("response_islr", "Integrated side-lobe ratio", "level"),
            ("peak_loss", "Peak loss", "loss"),
        )
    ),
)  # fmt: skip

FIGURES: Mapping[str, Figure] = MappingProxyType({figure.name: figure for figure in _DECLARED})
"""Name -> declaration, in the order of a verdict."""


def of_kind(*kinds: Kind) -> tuple[str, ...]:
    """Names of the figures of some kinds."""
    return tuple(name for name, figure in FIGURES.items() if figure.kind in kinds)


OF_BUDGET = tuple(name for name, figure in FIGURES.items() if figure.kind != "flight")
"""Figures that a budget has; the others are known along a flight alone."""

REQUIRED = tuple(name for name in OF_BUDGET if FIGURES[name].requirement)
"""Figures of a budget that a requirement limits, each by its own name."""

IN_FLIGHT = tuple(name for name, figure in FIGURES.items() if figure.in_flight)
"""Figures that are known along a flight."""

STEADY, RESPONSE, LEVELS = of_kind("steady"), of_kind("response"), of_kind("level")

PHASES = QUADRATIC, CUBIC, DETRENDED = "quadratic_phase", "cubic_phase", "detrended_phase"
"""The phases of the image, along the turning line of sight."""

PARTS_OF_PHASES = tuple(name for name, figure in FIGURES.items() if figure.whole)
"""Figures of errors along the line of sight of mid-aperture and along the track, each by itself."""


def label_of(name: str) -> str:
    """A figure's label; a name of the user's own stays."""
    return FIGURES[name].label if name in FIGURES else name


def figure_in_sentence(name: str) -> str:
    """Name of a figure within a sentence, where a name of the user's own stays as it was written."""
    return in_sentence(FIGURES[name].label) if name in FIGURES else name

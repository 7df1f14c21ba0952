"""Ready-made contributors: common errors beside the navigation, each by a formula of one or two numbers. [P-16]

What is made is a contributor like any other: its `source` says the formula and the numbers. Sources: JCGM 100:2008,
5.1 (products and sums of independent errors); P. Prats, A. Reigber and J. Mallorqui, IEEE Geoscience and Remote
Sensing Letters 2(2), 2005, for motion compensation to a wrong height.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from nav_model.base.errors import InputError, not_a_choice, quoted
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.design.contributors import RANDOM, SYSTEMATIC, Contributor


class Box(NamedTuple):
    """A number that a formula takes: its label, dimension and an example."""

    label: str
    dimension: str
    example: str


class ReadyMade(NamedTuple):
    """A formula of the numbers in boxes, in SI, and of a design: the 1σ of a contributor in `unit` of `dimension`."""

    boxes: tuple[Box, ...]
    formula: str
    dimension: str
    unit: str
    enters: str
    kind: str
    of: Callable[..., float]


def _slant(design: Design, a: float) -> float:
    upward = math.sin(design.radar.grazing_angle)
    return a / upward if upward else math.inf


READY_MADE: Mapping[str, ReadyMade] = MappingProxyType({
    "lever arm, measured": ReadyMade(
        (Box("Measurement error", "length", "2 mm"), Box("Attitude motion over the aperture, rms", "angle", "0.1°")),
        "error × attitude motion", "length", "mm", "detrended_phase", RANDOM,
        lambda _, error, motion: error * motion,
    ),
    "lever arm, flexure": ReadyMade(
        (Box("Flexure", "length", "1 mm"), Box("Attitude rate", "angular rate", "1 °/s")),
        "flexure × attitude rate", "speed", "mm/s", "horizontal_velocity", RANDOM,
        lambda _, flexure, rate: flexure * rate,
    ),
    "time tag, offset": ReadyMade(
        (Box("Offset", "time", "0.1 ms"),),
        "offset × speed of the flight", "length", "mm", "horizontal_position", SYSTEMATIC,
        lambda design, offset: offset * design.flight.speed,
    ),
    "time tag, jitter": ReadyMade(
        (Box("Jitter, 1σ", "time", "0.1 ms"), Box("Acceleration, rms", "acceleration", "1 m/s²")),
        "jitter × acceleration", "speed", "mm/s", "horizontal_velocity", RANDOM,
        lambda _, jitter, acceleration: jitter * acceleration,
    ),
    "boresight": ReadyMade(
        (Box("Calibration error", "angle", "0.01°"), Box("Drift since calibration", "angle", "0.005°")),
        "√(error² + drift²)", "angle", "mrad", "tilt", RANDOM, lambda _, error, drift: math.hypot(error, drift),
    ),
    "antenna phase centre": ReadyMade(
        (Box("Variation with look angle, rms", "length", "0.2 mm"), Box("Drift, rms", "length", "0.1 mm")),
        "√(variation² + drift²)", "length", "mm", "detrended_phase", RANDOM,
        lambda _, variation, drift: math.hypot(variation, drift),
    ),
    "atmospheric path": ReadyMade(
        (Box("Vertical path error", "length", "5 mm"),),
        "vertical error / sin(grazing angle)", "length", "mm", "range_shift", SYSTEMATIC, _slant,
    ),
    "scene height": ReadyMade(
        (Box("Height error", "length", "10 m"), Box("Deviation across the line of sight, rms", "length", "0.5 m")),
        "height error × deviation / (slant range × cos(grazing angle))", "length", "mm", "detrended_phase", RANDOM,
        lambda design, error, deviation: (
            error * deviation / (design.radar.slant_range * math.cos(design.radar.grazing_angle))
        ),
    ),
})  # fmt: skip
"""Name -> formula."""


def ready_made(name: str, texts: Sequence[str], design: Design) -> Contributor:
    """A contributor of the list for a design, from the texts of its boxes.

    Raises
    ------
    InputError
        If the name is not in the list or a text does not fit its box.
    """
    if name not in READY_MADE:
        raise InputError("contributor", not_a_choice(name, READY_MADE), name)
    made = READY_MADE[name]
    values, parts = [], []
    for box, text in zip(made.boxes, texts, strict=True):
        try:
            values.append(parse_quantity(text, box.dimension).value)
        except InputError as error:
            reason = f"{quoted(text)} does not fit. Write for example {box.example}."
            raise InputError(box.label, reason, text) from error
        parts.append(f"{box.label.lower()} {text.strip()}")
    taken = {contributor.name for contributor in design.contributors}
    unused = next(each for n in range(1, len(taken) + 2) if (each := name if n == 1 else f"{name} {n}") not in taken)
    value = float(f"{made.of(design, *values):.4g}")  # what is shown is what counts
    source = f"{made.formula}: {', '.join(parts)} [P-16]"
    return Contributor(unused, value, made.enters, made.dimension, made.kind, source=source, unit=made.unit)

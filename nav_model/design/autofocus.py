"""Inputs of the autofocus: the method, and the scene that it works in."""

import math
from collections.abc import Mapping
from types import MappingProxyType

from nav_model.base.constants import DEGREE
from nav_model.design.declaration import Choice, OptionalQuantity
from nav_model.design.part import Part

NONE, MAP_DRIFT, PHASE_GRADIENT = "none", "map drift", "phase gradient"
SEA = "sea"
SCENES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"urban": (500.0, 15.0), "farmland": (5.0, 20.0), "forest": (200.0, 3.0)}
)
"""Scene -> range bins that have a point, and its signal to clutter [dB]. All are assumed; over the sea there are
none."""


class Autofocus(Part):
    """Autofocus as a step of the processing with its own limits, in place of the radar's polynomial."""

    section = "autofocus"
    title = "Autofocus"
    optional = True

    method = Choice(
        default=NONE,
        options={NONE: "none", MAP_DRIFT: "map drift", PHASE_GRADIENT: "phase gradient"},
        short="afm",
        label="Autofocus",
        doc="Map drift removes a polynomial, phase gradient any phase that is slower than a block of the aperture "
        "[S-9]; both add an error of estimation [S-10]. It takes the place of what autofocus removes under Radar.",
        since="0.2.0",
    )
    order = Choice(
        default=2,
        options={2: "quadratic", 3: "quadratic and cubic"},
        short="afo",
        label="Map drift removes",
        doc="The polynomial that map drift fits, from as many looks of the aperture as its order.",
        since="0.2.0",
    )
    blocks = Choice(
        default=32,
        options={8: "8", 16: "16", 32: "32", 64: "64", 128: "128"},
        short="afb",
        label="Blocks",
        doc="Blocks of the aperture whose phases a phase gradient tells apart, which is the width of its window in "
        "cells. More follow faster errors and capture more, and each has more noise.",
        since="0.2.0",
    )
    scene = Choice(
        default="farmland",
        options={
            "urban": "urban (500 points, 15 dB)",
            "farmland": "farmland with corner reflectors (5 points, 20 dB)",
            "forest": "forest (200 points, 3 dB)",
            SEA: "sea (no autofocus)",
        },
        short="afs",
        label="Scene",
        doc="How many range bins have a prominent point, and how far it stands out. The values are assumed; enter "
        "those of your own images in their place. Over the sea nothing is removed.",
        since="0.2.0",
    )
    range_bins = OptionalQuantity(
        dimension="",
        unit="",
        short="afn",
        bounds=(1.0, 1e6),
        softbounds=(1.0, 1000.0),
        label="Range bins with a point",
        doc="Range bins that have a prominent point. Map drift takes one cell of each.",
        datasheet="From images of such a scene.",
        typical="5 reflectors to 500 in a town",
        when_empty="the scene's",
        since="0.2.0",
    )
    signal_to_clutter = OptionalQuantity(
        dimension="level",
        unit="dB",
        short="afc",
        bounds=(0.1, 1e4),
        softbounds=(1.0, 30.0),
        label="Signal to clutter",
        doc="Peak of a focused point over the mean clutter of one cell.",
        datasheet="From images of such a scene.",
        typical="3 to 25 dB",
        when_empty="the scene's",
        since="0.2.0",
    )
    capture = OptionalQuantity(
        dimension="angle",
        unit="°",
        short="afq",
        bounds=(1 * DEGREE, 1e6 * DEGREE),
        softbounds=(90 * DEGREE, 1e4 * DEGREE),
        label="Capture",
        doc="Quadratic phase up to which the autofocus works at all: the limit on three sigma of the phase before "
        "autofocus.",
        datasheet="From trials of the image processor.",
        typical="map drift of two looks 1440°, phase gradient of 32 blocks 1440°",
        when_empty="π/4 for each block, or 2π for each look squared",
        variable=False,
        since="0.2.0",
    )
    migration = Choice(
        default="stays",
        options={"stays": "stays", "corrected": "corrected (two-dimensional)"},
        short="afr",
        label="Range migration",
        doc="A phase correction leaves the path error in range: beyond half a range cell the image is smeared. A "
        "two-dimensional autofocus removes it too.",
        since="0.2.0",
    )

    @property
    def works(self) -> bool:
        """True if something is removed."""
        return bool(self.method != NONE and self.scene != SEA)

    @property
    def points(self) -> tuple[float, float]:
        """Range bins that have a point, and the amplitude of its signal over the clutter's, where none are given."""
        bins, decibels = SCENES.get(self.scene, (1.0, 0.0))
        return bins, 10 ** (decibels / 20)

    @property
    def captured(self) -> float:
        """Quadratic phase [rad] that three sigma must be below. [S-9]"""
        if self.capture is not None:
            return float(self.capture)
        return float(math.pi / 4 * self.blocks if self.method == PHASE_GRADIENT else 2 * math.pi * self.order**2)

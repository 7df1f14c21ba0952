"""Effects of vibration, unsensed motion and oscillator outside the main lobe. [P-9], [P-11]"""

from dataclasses import dataclass

import numpy as np

from nav_model.aperture.window import ideal_null_cells
from nav_model.base.arrays import Array
from nav_model.budget.fast import levels, power_at_target
from nav_model.budget.inputs import Inputs
from nav_model.processing.paired_echo import NOTHING, echo, fast_lines


@dataclass(frozen=True)
class Echo:
    """A paired echo that a line makes on both sides of a target. [P-9]

    ``frequency`` [Hz] of the line and its ``phase`` [rad, peak]; ``level`` is the echo's amplitude over the
    target's, ``offset`` its distance from it [m].
    """

    source: str
    frequency: float
    phase: float
    level: float
    offset: float


@dataclass(frozen=True)
class Spectral:
    """Effects of vibration, unsensed motion and oscillator outside the main lobe. [P-9], [P-11]

    ``power_at_target`` is the power that stays there, 1 without sources; ``random`` the variance of the phase [rad²]
    that spectra scatter beyond the main lobe. ``shows`` says whether there is anything of it.
    """

    echoes: tuple[Echo, ...] = ()
    power_at_target: float = 1.0
    random: float = 0.0
    shows: bool = False

    def phase(self, x: Array, aperture: float) -> Array:
        """Phase of the lines [rad] at places x in [-1, 1] of an aperture [s], as far as its samples resolve them."""
        lines = [line for line in self.echoes if line.frequency * aperture < len(x) / 4]
        return sum((line.phase * np.cos(np.pi * line.frequency * aperture * x) for line in lines), start=0 * x)


def spectral_of(x: Inputs, cell: float) -> Spectral:
    """Echoes beyond the main lobe, the highest first, and scattered energy; `cell` [m] is one in azimuth."""
    if not x.fast:
        return Spectral()
    lobe = ideal_null_cells(x.window)
    echoes = [
        Echo(name, float(at), float(phase), float(level), float(at * x.aperture * cell))
        for name, effect in x.fast.items()
        for at, phase, level, beside in zip(
            effect.frequency,
            x.to_phase * effect.amplitude,
            echo(x.to_phase * effect.amplitude),
            fast_lines(effect, x.aperture, lobe),
            strict=True,
        )
        if beside and level > NOTHING
    ]
    sources = x.fast.values()
    return Spectral(
        tuple(sorted(echoes, key=lambda item: -item.level)),
        float(power_at_target(sources, x.to_phase, x.aperture, x.window)[0]),
        float(x.to_phase**2 * sum(effect.scattered for effect in sources)),
        bool(echoes or levels(sources, x.to_phase, x.aperture, x.window)["islr"] > NOTHING),
    )

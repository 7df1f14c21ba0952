"""Where printed figures and the derivation part: both, and which holds and why. The figures of ours are computed."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from nav_model.analytic.coast import perfect_start
from nav_model.analytic.discrete import cycle
from nav_model.sar.axis_model import STANDARD_GRAVITY_M_S2
from nav_model.sar.geometry import phase_to_metres
from nav_model.sar.impulse_response import aperture_positions, impulse_response
from nav_model.sar.phase import along_track_quadratic
from nav_model.sar.strategy_forms import exact_corrected_variance, fit_quadratic_sigma
from nav_model.sar.winners import MAP_STRATEGIES, Conditions, strategy_variances


class Disagreement(NamedTuple):
    """One figure or statement: as printed and where, as computed here, and which holds and why."""

    what: str
    printed: str
    source: str
    ours: str
    holds: str


@cache
def disagreements() -> tuple[Disagreement, ...]:
    """All that are known of the image part."""
    return (*_ten_nulls(), _root_of_21(), _first_order(), _shrunk(), _fixes(), _few_fixes())


def _ten_nulls() -> tuple[Disagreement, ...]:
    x = aperture_positions(1024)
    found = []
    for name, quadratic, printed in (("π/4", np.pi / 4, "−8.925 dB"), ("π/2", np.pi / 2, "−6.489 dB")):
        ours = float(impulse_response(np.exp(1j * quadratic * x**2)).islr_null_ten_db)
        found.append(
            Disagreement(
                f"ISLR over ten null distances, QPE {name}, uniform aperture",
                printed,
                "sar.md, check values",
                f"{ours:.3f} dB".replace("-", "−"),
                "Ours: the energies are integrals up to the minima. The printed figure comes out exactly when both "
                "end samples of the main lobe are counted in full, which matters once the minima are filled.",
            )
        )
    return tuple(found)


def _root_of_21() -> Disagreement:
    density, span = 1e-4, 20.0
    ours = float(np.sqrt(perfect_start(0.0, density, STANDARD_GRAVITY_M_S2, span)[0]))
    printed = density * STANDARD_GRAVITY_M_S2 * span**2.5 / np.sqrt(21)
    return Disagreement(
        "Position error of gyro noise alone, 1e-4 rad/√s over 20 s",
        f"{printed:.3f} m (√21)",
        "[C]",
        f"{ours:.3f} m (√20)",
        "Ours: g² σ² t⁵/20 is the integral of the thrice integrated noise [T-11]; the simulator agrees.",
    )


def _first_order() -> Disagreement:
    phase = float(along_track_quadratic(0.0655**2, 90.0, 5.4, 0.0312, 6500.0))
    length = 1000 * float(phase_to_metres(phase, 0.0312))
    return Disagreement(
        "A constant velocity error along the track, 0.0655 m/s, X band, 6.5 km, 5.4 s",
        "shifts and scales the image only",
        "[C]",
        f"{np.degrees(phase):.0f}° of quadratic phase ({length:.2g} mm)",
        "Ours: the line of sight turns over the aperture and bends a first-order error [S-2]; exact ranges agree.",
    )


def _shrunk() -> Disagreement:
    sigma_a, sigma_w = 0.06 / 60, np.radians(0.15) / 60
    start = cycle(sigma_a, sigma_w, STANDARD_GRAVITY_M_S2, 1.0, 1.0, 1.0).posterior
    inputs = Conditions(
        5.38, 1.0, 1.0, sigma_a, sigma_w, start.horizontal, grazing_angle=np.radians(35.0), turn_rate=90 / 6500,
        start_vertical=start.vertical,
    )  # fmt: skip
    sigma = dict(zip(MAP_STRATEGIES, 1000 * np.sqrt(strategy_variances(inputs).detrended), strict=True))
    return Disagreement(
        "Strategy 5w against strategy 2, MEMS unit, 1 m fixes, X band, 5.4 s",
        "5w never loses",
        "sar.md, from runs of one axis",
        f"5w leaves {sigma['5w']:.2g} mm, 2 leaves {sigma['2']:.2g} mm",
        "Both: on each axis alone 5w loses to neither. Along the line of sight the line fitted along the track has "
        "the fixes' velocity noise, which the turn bends into a quadratic that the weight does not know.",
    )


def _fixes() -> Disagreement:
    few, more = (1000 * float(fit_quadratic_sigma(0.13, 1.0, 20.0, n)) for n in (20, 21))
    return Disagreement(
        "Quadratic that 0.13 m fixes at 1 Hz leave over 20 s",
        f"{few:.3g} mm (N = T/dt = 20)",
        "[C], [S-7]",
        f"{more:.3g} mm (N = T/dt + 1 = 21)",
        "Ours where a fix falls on both ends of the aperture, as in the runs; [C]'s where the first comes an "
        "interval after the start. The formula is the same.",
    )


def _few_fixes() -> Disagreement:
    def low(first: float, count: int) -> float:
        times = first + np.arange(count)
        inertial = exact_corrected_variance(count - 1 + first, 0.0, 1e-4, 1e-9, times)
        return float(inertial * 55440 / (STANDARD_GRAVITY_M_S2**2 * 1e-8 * (count - 1 + first) ** 5))

    return Disagreement(
        "Inertial part of strategy 5's variance, gyro noise",
        "taken as continuous",
        "[T-16]",
        f"{low(0.0, 3):.3f} times that with 3 fixes, one at each end; {low(1.0, 3):.2g} times with the first an "
        f"interval late; {low(1.0, 21):.3f} times with 21",
        "The exact one, with the fit at the fixes themselves; [T-16] is a good guide from some ten fixes on.",
    )

"""The literature: works, which equation comes from which, and which work describes a method."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

WORKS: Mapping[str, str] = MappingProxyType(
    {
        "A": "[A] Makarem and Cheraghi Mahmudabadi, Accuracy analysis of integrated INS/GNSS navigation in a "
        "straight path with constant velocity for airborne SAR. Journal of Radar 7(2), 2019.",
        "B": "[B] Moghtadaei Rad, Heyrani Nobari and Nikkhah, Error analysis and compensation of INS height channel "
        "in high altitudes aiding star tracker. Its printed equations, sensors and trajectory are lost.",
        "C": "[C] Cheraghi Mahmudabadi, Makarem and Hatam, Challenges of inertial and integrated navigation systems "
        "in SAR application. Its gyro term is printed with √21 where the integral gives √20, which is used here.",
        "Anderson and Moore 1979": "Anderson and Moore, Optimal Filtering. Prentice-Hall, 1979.",
        "Bar-Shalom 2001": "Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation. "
        "Wiley, 2001.",
        "Bryson 1963": "Bryson and Frazier, Smoothing for linear and nonlinear dynamic systems. Proceedings of the "
        "Optimum System Synthesis Conference, Wright-Patterson AFB, 1963.",
        "Chu 2004": "Chu, Fan, Lin and Wang, Structure-preserving algorithms for periodic discrete-time algebraic "
        "Riccati equations. International Journal of Control 77(8), 2004.",
        "Harris 1978": "Harris, On the use of windows for harmonic analysis with the discrete Fourier transform. "
        "Proceedings of the IEEE 66(1), 1978.",
        "IEEE 952": "IEEE Std 952-1997, Specification format guide and test procedure for single-axis "
        "interferometric fiber optic gyros, annex C; IEEE Std 1293 for accelerometers.",
        "NIMA 1997": "NIMA TR8350.2, Department of Defense World Geodetic System 1984, 3rd edition.",
        "Rauch 1965": "Rauch, Tung and Striebel, Maximum likelihood estimates of linear dynamic systems. AIAA "
        "Journal 3(8), 1965.",
        "Savage 1998": "Savage, Strapdown inertial navigation integration algorithm design. Journal of Guidance, "
        "Control, and Dynamics 21, 1998.",
        "SICD": "NGA.STND.0024, Sensor Independent Complex Data, volume 3: image projections description.",
        "Shuster 1993": "Shuster, A survey of attitude representations. Journal of the Astronautical Sciences 41, "
        "1993.",
        "Squire 1998": "Squire and Trapp, Using complex variables to estimate derivatives of real functions. SIAM "
        "Review 40(1), 1998.",
        "Taylor 1955": "Taylor, Design of line-source antennas for narrow beamwidth and low side lobes. IRE "
        "Transactions on Antennas and Propagation 3(1), 1955.",
        "van Leeuwen 2007": "van Leeuwen, Hipparcos, the New Reduction of the Raw Data. Springer, 2007; CDS I/311.",
    }
)
"""Short name -> full reference."""

METHODS: tuple[tuple[str, str], ...] = (
    ("Sampled filter in steady state, spectral factorisation", "Anderson and Moore 1979"),
    ("Settled filters and many fixes by doubling", "Chu 2004"),
    ("Fixed-interval smoother of the simulator", "Rauch 1965"),
    ("Fixed-interval smoother along a flight, by source", "Bryson 1963"),
    ("Windows of the aperture", "Harris 1978"),
    ("Taylor window", "Taylor 1955"),
    ("Shares and sensitivities by a complex step", "Squire 1998"),
    ("Strapdown mechanisation of the simulator", "Savage 1998"),
    ("NEES, NIS and their chi-square bands", "Bar-Shalom 2001"),
    ("Noise parameters from the Allan deviation", "IEEE 952"),
    ("Ellipsoid and normal gravity", "NIMA 1997"),
    ("Attitude representations", "Shuster 1993"),
    ("Composite error of an image", "SICD"),
    ("The star camera's stars", "van Leeuwen 2007"),
)
"""What the product does beside its equations, and the work that describes it."""

REFERENCES: tuple[str, ...] = (
    f"{WORKS['A']} Source of [T-1] to [T-7] and [T-9] to [T-12].",
    f"{WORKS['C']} Source of [T-13] and of the correction limits.",
    "[T-8], [T-15], [T-17], [T-18] and [S-1] to [S-6] are derived in NavBudget and verified against Riccati and "
    "covariance solutions and Monte Carlo runs in its test suite.",
    "The table of inputs gives the source of each sensor and radar value.",
)
"""What every report cites."""

_FOUND_IN: Mapping[str, str] = MappingProxyType(
    {
        **{f"T-{n}": "A" for n in (*range(1, 8), *range(9, 13))},
        "T-13": "C",
    }
)
"""Mark -> the work that has the equation."""

_CORRECTION = "derived here for the correction of [C] Cheraghi Mahmudabadi, Makarem and Hatam"
_DERIVED: Mapping[str, str] = MappingProxyType(
    {
        "T-8": "derived here by spectral factorisation, as in Anderson and Moore 1979",
        "T-16": _CORRECTION,
        "S-7": _CORRECTION,
    }
)
"""Mark -> what a derivation of ours follows."""


def source_of(mark: str) -> str:
    """Where an equation comes from."""
    if mark in _FOUND_IN:
        return WORKS[_FOUND_IN[mark]].partition(". ")[0]
    if mark.startswith("B-"):
        return "derived here after [B] Moghtadaei Rad, Heyrani Nobari and Nikkhah, whose printed equations are lost"
    return _DERIVED.get(mark, "derived here")

"""Statements of the literature about the image, beside what exact ranges and plain least squares give."""

import numpy as np
import pytest

from nav_model.sar.phase import along_track_quadratic
from nav_model.sar.strategy_forms import fit_quadratic_sigma


def test_a_constant_velocity_error_bends_the_phase(differs):
    time = np.linspace(-2.7, 2.7, 4001)
    error = np.hypot(6500.0, 90 * time + 0.0655 * time) - np.hypot(6500.0, 90 * time)
    quadratic = np.polynomial.polynomial.polyfit(time / 2.7, error, 2)[2] * 4 * np.pi / 0.0312
    ours = float(along_track_quadratic(0.0655**2, 90.0, 5.4, 0.0312, 6500.0))
    assert ours == pytest.approx(quadratic, abs=0.01)
    differs(
        "Velocity error along the track, constant 0.0655 m/s, X band, 6.5 km, 5.4 s", "S-2",
        "it shifts and scales the image only [C]", f"{np.degrees(ours):.0f}° of quadratic phase", "ours",
        "the line of sight turns over the aperture and bends a first-order error, as exact ranges show",
    )  # fmt: skip


def test_the_quadratic_of_fixes_depends_on_where_they_fall(differs):
    sigma = []
    for fixes in (np.arange(1, 21), np.arange(21)):
        x = (fixes - fixes.mean()) / 10
        by_least_squares = 0.13 * np.linalg.norm(np.linalg.pinv(np.vander(x, 3))[0])
        sigma.append(float(fit_quadratic_sigma(0.13, 1.0, 20.0, len(fixes))))
        assert sigma[-1] == pytest.approx(by_least_squares, rel=0.005)
    differs(
        "Quadratic that fixes of 0.13 m at 1 Hz leave over 20 s", "S-7", f"{1000 * sigma[0]:.3g} mm, 20 fixes [C]",
        f"{1000 * sigma[1]:.3g} mm, 21 fixes", "both",
        "ours where a fix falls on both ends of the aperture, as in the runs; [C]'s where the first comes an "
        "interval after the start. The formula is the same",
    )  # fmt: skip

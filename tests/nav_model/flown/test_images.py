"""Sums of recorded errors over apertures against polynomials fitted by NumPy."""

import numpy as np
import pytest

from nav_model.budget.inputs import inputs_of
from nav_model.design.file import parse_design
from nav_model.flown.images import sums_of_samples
from nav_model.trajectory import aperture


@pytest.mark.parametrize("rate", [20.0, 200.0])
def test_phases_are_those_of_fitted_polynomials(rate) -> None:
    """Flying north, looking right: quadratic at the ends and rms beyond it, along a sight that turns little."""
    x = inputs_of(
        parse_design(
            "flight.altitude = '10 m'\n[radar]\nslant_range = '900 km'\naperture_time = '4 s'\nautofocus_order = 2"
        )
    )
    time = np.arange(0.0, 30.0, 1.0 / rate)
    height = 0.002 * np.sin(1.7 * time) + 0.004 * np.cos(0.9 * time)
    error = np.column_stack([0.0 * time, 0.01 * np.sin(0.8 * time), 0.5 + 0.02 * time + height])
    track = np.tile([100.0, 0.0, 0.0], (len(time), 1))
    begin = np.array([3.0, 9.5, 17.25])
    columns, rest = sums_of_samples(time, error, track, begin, x)
    figures = aperture.figures((columns**2)[None], x, rest[None])
    dense = np.linspace(-1.0, 1.0, 4001)
    for n, start in enumerate(begin):
        at = start + 2.0 * (dense + 1.0)
        sight = np.array([0.0, np.cos(x.grazing_angle), np.sin(x.grazing_angle)])
        r = np.column_stack([np.interp(at, time, axis) for axis in error.T]) @ sight
        parabola = np.polynomial.legendre.legfit(dense, r, 2)
        residual = r - np.polynomial.legendre.legval(dense, parabola)
        assert np.sqrt(figures["quadratic_phase"][0, n]) == pytest.approx(
            float(x.to_phase) * abs(1.5 * parabola[2]), rel=0.02
        )
        assert np.sqrt(figures["detrended_phase"][0, n]) == pytest.approx(
            float(x.to_phase) * np.sqrt(np.mean(residual**2)), rel=0.05
        )

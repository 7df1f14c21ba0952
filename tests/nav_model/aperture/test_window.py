"""Windows against the literature."""

import pytest
from scipy.signal import windows

from nav_model.aperture.impulse_response import aperture_positions
from nav_model.aperture.window import ideal_null_cells, weights_of


def test_windows_are_those_of_the_literature(compared, ratio_off):
    taylor = windows.taylor(1024, nbar=5, sll=35, norm=False)
    off = ratio_off(weights_of("taylor", aperture_positions(1024)), taylor)
    compared(
        "Taylor window",
        "S-3",
        "solver written by others",
        "SciPy's signal.windows.taylor",
        off,
        1e-12,
    )
    assert weights_of("hamming", 0.0) == pytest.approx(1.0)
    assert weights_of("hamming", [-1.0, 1.0]) == pytest.approx([0.08, 0.08])
    assert ideal_null_cells("hamming") == pytest.approx(2.0, abs=1e-6)
    assert ideal_null_cells("uniform") == pytest.approx(1.0, abs=1e-6)

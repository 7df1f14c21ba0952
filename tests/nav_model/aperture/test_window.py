"""Windows against the literature."""

import pytest
from scipy.signal import windows

from nav_model.aperture.impulse_response import aperture_positions
from nav_model.aperture.window import Taper, as_taper, ideal_null_cells


def test_windows_are_those_of_the_literature(compared, ratio_off):
    taylor = windows.taylor(1024, nbar=6, sll=40, norm=False)
    off = ratio_off(Taper("taylor", -40, 6).weights(aperture_positions(1024)), taylor)
    compared(
        "Taylor window",
        "S-3",
        "solver written by others",
        "SciPy's signal.windows.taylor",
        off,
        1e-12,
        "largest ratio − 1",
    )
    assert Taper("hamming").weights(0.0) == pytest.approx(1.0)
    assert Taper("hamming").weights([-1.0, 1.0]) == pytest.approx([0.08, 0.08])
    assert ideal_null_cells("hamming") == pytest.approx(2.0, abs=1e-6)
    assert ideal_null_cells("uniform") == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: as_taper("kaiser"), "'kaiser' is not one of"),
        (lambda: Taper("taylor", 35.0), "level_db"),
        (lambda: Taper("taylor", -35.0, 0), "nbar"),
    ],
)
def test_bad_windows_are_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()

"""Responses of quadratic and cubic phase by quadrature, against the transform of the sampled aperture."""

import numpy as np
import pytest

from nav_model.aperture.impulse_response import aperture_positions, impulse_response, response_curve
from nav_model.aperture.polynomial_response import half_power_extent, polynomial_curve, quadratic_response
from nav_model.aperture.window import WINDOWS

X = aperture_positions(1024)
RATIOS = ("pslr_null_db", "pslr_fixed_db", "islr_null_db", "islr_fixed_db", "islr_fixed_ten_db")


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("cubic", [0.0, 0.5])
@pytest.mark.parametrize("quadratic", [0.0, np.pi / 4, np.pi / 2, -np.pi / 2, 2.5, 4.0, 9.0])
def test_fast_route_equals_the_full_one(quadratic, cubic, window):
    fast = quadratic_response(quadratic, window, cubic)
    full = impulse_response(np.exp(1j * (quadratic * X**2 + cubic * X**3)), window)
    assert fast.width_cells == pytest.approx(full.width_cells, abs=1e-3)
    assert fast.half_power_extent_cells == pytest.approx(full.half_power_extent_cells, abs=1e-3)
    assert fast.peak_loss_db == pytest.approx(full.peak_loss_db, abs=1e-3)
    assert abs(fast.shift_cells) == pytest.approx(abs(full.shift_cells), abs=1e-3)
    for name in RATIOS:
        assert getattr(fast, name) == pytest.approx(getattr(full, name), abs=0.005), name


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("quadratic", [0.0, 0.7, -1.5, 1.58, 4.7, 4.8, 12.5, 13.0, 60.0, 300.0])
def test_the_extent_alone_is_that_of_the_response(quadratic, window):
    whole = quadratic_response(quadratic, window).half_power_extent_cells
    assert half_power_extent(quadratic, window) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize(("quadratic", "cubic"), [(0.0, 0.0), (1.5, 0.5), (4.0, -1.5), (9.0, 1.0), (14.0, 2.0)])
def test_the_curve_of_a_polynomial_is_that_of_its_samples(quadratic, cubic, window):
    phases = np.stack([quadratic * X**2, quadratic * X**2 + cubic * X**3])
    cells, sampled = response_curve(np.exp(1j * phases), window, 6.0)
    places, power = polynomial_curve(quadratic, cubic, window, 6.0)
    assert np.array_equal(places, cells)
    assert 10 ** (power / 20) == pytest.approx(10 ** (sampled / 20), abs=1e-5)


def test_fast_route_beyond_its_line_is_the_sampled_one():
    far = quadratic_response(400.0)
    assert far.width_cells == pytest.approx(
        impulse_response(np.exp(400j * aperture_positions(8192) ** 2), zero_padding=16).width_cells, rel=0.02
    )


@pytest.mark.parametrize(("quadratic", "message"), [(np.inf, "finite"), (1e9, "no image is left")])
def test_a_phase_without_an_image_is_refused(quadratic, message):
    with pytest.raises(ValueError, match=message):
        quadratic_response(quadratic)

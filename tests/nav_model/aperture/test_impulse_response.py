"""Impulse response against published check values, Fresnel and Bessel functions, and direct quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar
from scipy.special import fresnel, jv

from nav_model.aperture.impulse_response import (
    aperture_of_phase,
    aperture_positions,
    impulse_response,
    response_curve,
)
from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.aperture.window import WINDOWS

X = aperture_positions(1024)

# sar.md, "Impulse response": phase, width, PSLR, ISLR over the whole line and over ten nulls, loss, shift.
PUBLISHED = {
    "none": (0 * X, 0.8859, -13.264, -9.680, -10.113, 0.0, 0.0),
    "QPE pi/4": (np.pi / 4 * X**2, 0.8975, -12.035, -8.567, -8.925, -0.239, 0.0),
    "QPE pi/2": (np.pi / 2 * X**2, 0.9404, -9.035, -6.234, -6.489, -0.967, 0.0),
    "CPE pi/4": (np.pi / 4 * X**3, 0.8880, -10.678, -9.214, -9.575, -0.061, 0.150),
}
# The ten-null figures of these two were summed with both end samples of a filled main lobe in full.
COUNTED_BY_SAMPLES = {"QPE pi/4", "QPE pi/2"}


@pytest.mark.parametrize("case", PUBLISHED)
def test_published_check_values(case):
    phase, width, pslr, whole, ten, loss, shift = PUBLISHED[case]
    response = impulse_response(np.exp(1j * phase))
    assert response.width_cells == pytest.approx(width, abs=1e-3)
    assert response.pslr_null_db == pytest.approx(pslr, abs=0.01)
    assert response.islr_null_db == pytest.approx(whole, abs=0.01)
    assert response.peak_loss_db == pytest.approx(loss, abs=0.01)
    assert response.shift_cells == pytest.approx(shift, abs=1e-3)
    if case not in COUNTED_BY_SAMPLES:
        assert response.islr_null_ten_db == pytest.approx(ten, abs=0.01)


def _power(cells, quadratic):
    """Power of a quadratic phase over a uniform aperture, that of none 1 at its peak, by adaptive quadrature."""
    parts = [quad(lambda x, f=f: f(quadratic * x**2) * np.cos(np.pi * cells * x), 0, 1)[0] for f in (np.cos, np.sin)]
    return parts[0] ** 2 + parts[1] ** 2


@pytest.mark.parametrize("case", sorted(COUNTED_BY_SAMPLES))
def test_ten_null_islr_is_the_integral_and_explains_the_published_figure(case, compared, differs):
    phase, *_, ten, _, _ = PUBLISHED[case]
    quadratic = phase[0] / X[0] ** 2
    null = minimize_scalar(
        lambda u: _power(u, quadratic), bounds=(0.7, 1.3), method="bounded", options={"xatol": 1e-9}
    ).x
    lobe = quad(lambda u: _power(u, quadratic), 0, null, epsabs=1e-7)[0]
    grid = np.linspace(0, 11 * null, 2201)
    near = np.trapezoid([_power(u, quadratic) for u in grid], grid)
    response = impulse_response(np.exp(1j * phase))
    compared(
        "Integrated side lobe ratio over ten nulls",
        "S-3",
        "solver written by others",
        "SciPy's adaptive quadrature of the uniform aperture, written out in the test",
        response.islr_null_ten_db - 10 * np.log10(near / lobe - 1),
        0.002,
        "difference, dB",
    )

    sampled = np.abs(np.fft.fft(np.exp(1j * phase), 1024 * 64)) ** 2
    one_side = sampled[: 11 * 64 + 1]
    total = 2 * one_side.sum() - one_side[0]
    with_both_ends = 2 * one_side[:65].sum() - one_side[0]
    assert 10 * np.log10(total / with_both_ends - 1) == pytest.approx(ten, abs=0.001)
    differs(
        f"Integrated side lobe ratio over ten nulls, quadratic phase {quadratic / np.pi:g} π", "S-3",
        f"{ten} dB, unpublished", f"{float(response.islr_null_ten_db):.3f} dB", "ours",
        "the integral by adaptive quadrature; the printed figure is the sum over samples with both end samples of "
        "the main lobe counted in full, which this test reproduces to 0.001 dB",
    )  # fmt: skip


def test_white_phase_noise_check_values():
    rng = np.random.default_rng(20240501)
    response = impulse_response(np.exp(1j * 0.3 * rng.standard_normal((200, 1024))), zero_padding=16)
    published = {
        "width_cells": 0.8859,
        "pslr_null_db": -13.04,
        "islr_null_db": -6.754,
        "islr_null_ten_db": -10.02,
        "peak_loss_db": -0.388,
    }
    for name, value in published.items():
        sample = getattr(response, name)
        # Two means of 200: four standard errors of their difference.
        assert np.mean(sample) == pytest.approx(value, abs=4 * np.std(sample) / 10 + 5e-4), name


@pytest.mark.parametrize("quadratic", [0.2, np.pi / 4, np.pi / 2, 2.0])
def test_peak_loss_is_the_fresnel_integral(quadratic, compared):
    sine, cosine = fresnel(np.sqrt(2 * quadratic / np.pi))
    expected = 10 * np.log10((sine**2 + cosine**2) * np.pi / (2 * quadratic))
    result = (impulse_response(np.exp(1j * quadratic * X**2)), quadratic_response(quadratic))
    compared(
        "Peak loss under a quadratic phase", "S-5", "solver written by others", "SciPy's Fresnel integrals",
        [float(response.peak_loss_db) - expected for response in result], 1e-3, "largest difference, dB",
    )  # fmt: skip


@pytest.mark.parametrize(("cycles", "amplitude"), [(3, 0.1), (7, 0.4), (25, 1.2)])
def test_paired_echoes_are_bessel_functions(cycles, amplitude, compared):
    off = []
    cells, power = response_curve(np.exp(1j * amplitude * np.sin(np.pi * cycles * X)), extent_cells=60)
    for order in (0, 1, 2):
        for side in (-1, 1):
            echo = power[np.argmin(np.abs(cells - side * order * cycles))]
            off.append(echo - 20 * np.log10(abs(jv(order, amplitude))))
    compared(
        "Paired echoes of a sinusoidal phase",
        "",
        "solver written by others",
        "SciPy's Bessel functions in the Jacobi-Anger expansion",
        off,
        1e-3,
        "largest difference, dB",
    )


@settings(max_examples=25)
@given(
    shift=st.floats(-600, 600),
    quadratic=st.floats(0, 2.5),
    window=st.sampled_from(WINDOWS),
)
def test_a_linear_phase_only_shifts_even_across_the_ends_of_the_line(shift, quadratic, window):
    still = impulse_response(np.exp(1j * quadratic * X**2), window)
    moved = impulse_response(np.exp(1j * (quadratic * X**2 + np.pi * shift * X)), window)
    wrapped = (shift + 512) % 1024 - 512
    difference = (moved.shift_cells - wrapped + 512) % 1024 - 512
    assert difference == pytest.approx(0, abs=2e-4)
    assert moved.width_cells == pytest.approx(still.width_cells, abs=1e-4)
    for name in ("pslr_fixed_db", "islr_fixed_db", "islr_fixed_ten_db", "peak_loss_db"):
        assert getattr(moved, name) == pytest.approx(getattr(still, name), abs=0.01), name


def test_a_split_lobe_is_measured_at_one_half_and_over_both():
    def power(u):
        return ((1 - np.cos(np.pi * u)) / (np.pi * u)) ** 2

    search = {"bounds": (0.5, 1.0), "method": "bounded", "options": {"xatol": 1e-10}}
    top = minimize_scalar(lambda u: -power(u), **search).x
    inner = brentq(lambda u: power(u) - power(top) / 2, 0.01, top)
    outer = brentq(lambda u: power(u) - power(top) / 2, top, 2.0)
    response = impulse_response(np.sign(X).astype(complex))
    assert abs(response.shift_cells) == pytest.approx(top, abs=1e-3)
    assert response.width_cells == pytest.approx(outer - inner, abs=1e-4)
    assert response.half_power_extent_cells == pytest.approx(2 * outer, abs=1e-4)
    assert response.pslr_null_db == pytest.approx(0.0, abs=1e-3)


def test_histories_are_interpolated_and_broadcast():
    coarse = np.linspace(-1, 1, 501)
    phases = np.stack([np.pi / 4 * coarse**2, np.pi / 4 * coarse**3]).reshape(2, 1, 501)
    response = impulse_response(aperture_of_phase(phases))
    assert response.width_cells.shape == (2, 1)
    np.testing.assert_allclose(response.width_cells[:, 0], [0.8975, 0.8880], atol=1e-3)
    np.testing.assert_allclose(response.islr_fixed_db[:, 0], [-8.567, -9.213], atol=0.01)
    assert aperture_of_phase(np.zeros(5000)).shape == (5000,)
    ends = aperture_of_phase([0.0, 1.0], 1024)
    np.testing.assert_allclose(np.angle(ends), (X + 1) / 2, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: impulse_response(np.ones(1000)), "1000 samples"),
        (lambda: impulse_response(np.full(1024, np.nan)), "not finite"),
        (lambda: impulse_response(np.zeros(1024)), "all samples are zero"),
        (lambda: impulse_response(np.ones(1024), zero_padding=1), "zero_padding"),
        (lambda: aperture_of_phase(3.0), "at least 2 samples"),
    ],
)
def test_bad_input_is_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()

"""The two faces of each noise term against integrals and exact covariance matrices."""

import numpy as np
import pytest
from scipy.fft import dct
from scipy.integrate import quad

from nav_model.allan.noise_terms import allan_variance, cosine_ramp, cosine_variances

SAMPLES, INTERVAL = 400, 0.25


@pytest.mark.parametrize(
    ("term", "density"),
    [
        ("random_walk", lambda f: 1.0),
        ("bias_instability", lambda f: 1.0 / (2.0 * np.pi * f)),
        ("rate_random_walk", lambda f: 1.0 / (2.0 * np.pi * f) ** 2),
    ],
)
def test_allan_variance_is_the_filtered_density(term: str, density, compared, ratio_off):
    """AVAR = 4 ∫ S(f) sin⁴(πfτ)/(πfτ)² df, done in pieces by quadrature."""
    tau = 3.0

    def integrand(u: float) -> float:
        return 4.0 * density(u / (np.pi * tau)) * np.sin(u) ** 4 / u**2 / (np.pi * tau)

    total = sum(quad(integrand, n * np.pi + (1e-9 if n == 0 else 0.0), (n + 1) * np.pi)[0] for n in range(4000))
    compared(
        "Allan variance of three kinds of noise",
        "",
        "solver written by others",
        "SciPy's quadrature of each noise's spectrum through the Allan filter of NIST SP 1065",
        ratio_off(allan_variance(term, 1.0, np.array(tau)), total),
        2e-4,
    )


def test_allan_variance_of_a_ramp_and_of_rounded_angles():
    from nav_model.allan.deviation import overlapping_allan_deviation

    taus = np.array([1.0, 5.0, 25.0])
    ramp = overlapping_allan_deviation(0.3 * np.arange(2000.0), 1.0, taus)
    np.testing.assert_allclose(ramp.deviation**2, allan_variance("ramp", 0.3, taus), rtol=1e-9)
    angle = np.cumsum(np.random.default_rng(0).normal(0.0, 3.0, 200_001))
    rounding = np.diff(np.round(angle) - angle)
    result = overlapping_allan_deviation(rounding, 1.0, taus)
    np.testing.assert_allclose(
        result.deviation**2, allan_variance("quantization", 1 / np.sqrt(12.0), taus), rtol=0.02
    )


def test_unknown_term_is_refused():
    with pytest.raises(ValueError, match="pink"):
        allan_variance("pink", 1.0, np.array(1.0))


def covariance(term: int) -> np.ndarray:
    """Covariance of averaged rate samples for unit coefficient, up to terms constant along a row or column.

    From the generalised covariance of the integral of each noise: -|t|/2 (white), t² ln|t| / 2π (1/f),
    |t|³/12 (walk).
    """
    time = np.arange(SAMPLES + 1) * INTERVAL
    lag = np.abs(time[:, None] - time[None, :])
    if term == 0:
        phase = np.eye(SAMPLES + 1)
    elif term == 1:
        phase = -lag / 2.0
    elif term == 2:
        phase = lag**2 * np.log(np.where(lag > 0.0, lag, 1.0)) / (2.0 * np.pi)
    else:
        phase = lag**3 / 12.0
    return np.diff(np.diff(phase, axis=0), axis=1) / INTERVAL**2


@pytest.mark.parametrize(("term", "tolerance"), [(1, 1e-9), (2, 0.02), (3, 1e-6)])
def test_cosine_variances_equal_the_exact_transform(term: int, tolerance: float, compared, ratio_off):
    exact = np.diag(dct(dct(covariance(term), norm="ortho", axis=0), norm="ortho", axis=1))[1:]
    index = np.arange(1.0, SAMPLES)
    off = ratio_off(cosine_variances(index, SAMPLES, INTERVAL)[term], exact)
    assert np.max(np.abs(off)) <= tolerance
    compared(
        "Spectra the noise terms are fitted to",
        "",
        "our own derivation",
        "exact covariance of each noise, cosine-transformed by SciPy",
        off,
        0.02,
    )


def test_cosine_variance_of_quantization_but_for_the_ends():
    exact = np.diag(dct(dct(covariance(0), norm="ortho", axis=0), norm="ortho", axis=1))[1:]
    index = np.arange(1.0, SAMPLES)
    approximate = cosine_variances(index, SAMPLES, INTERVAL)[0]
    assert np.max(np.abs(approximate - exact)) <= 6.0 / SAMPLES / INTERVAL**2


def test_cosine_ramp_is_the_transform_of_a_ramp():
    exact = dct(np.arange(SAMPLES) * INTERVAL, norm="ortho")[1:]
    np.testing.assert_allclose(cosine_ramp(np.arange(1.0, SAMPLES), SAMPLES, INTERVAL), exact, atol=1e-9)

"""Degrees of freedom of the Allan variance against the covariance matrix of its pairs, and against allantools."""

import numpy as np
import pytest

from nav_model.allan.degrees import degrees_of_freedom


def of_covariance(alpha: int, factor: int, samples: int) -> float:
    """tr(C)²/tr(C²) of the pairs' covariance matrix C: 2 E²/Var of a mean of squares of Gaussian numbers.

    White phase (alpha 2), and rates that are white (0) or walk (-2), as sums of independent numbers.
    """
    phases = samples + 1
    phase = np.eye(phases)
    for _ in range((2 - alpha) // 2):
        phase = np.cumsum(phase, axis=0)
    second = phase[2 * factor :] - 2.0 * phase[factor:-factor] + phase[: -2 * factor]
    covariance = second @ second.T
    return float(np.trace(covariance) ** 2 / np.sum(covariance**2))


@pytest.mark.parametrize(("samples", "factor"), [(9, 3), (30, 1), (30, 9), (90, 25), (300, 2), (600, 60)])
def test_white_phase_is_exact(samples: int, factor: int):
    assert degrees_of_freedom(2, factor, samples) == pytest.approx(of_covariance(2, factor, samples), rel=1e-12)


@pytest.mark.parametrize("alpha", [0, -2])
@pytest.mark.parametrize(("samples", "factor"), [(600, 40), (600, 60), (600, 190)])
def test_long_averages_of_a_rate(alpha: int, samples: int, factor: int):
    """At short ones the paper's phases are averages over a sample, and its degrees up to a quarter other ones."""
    result = degrees_of_freedom(alpha, factor, samples)
    assert result == pytest.approx(of_covariance(alpha, factor, samples), rel=1e-3)


@pytest.mark.parametrize("alpha", [2, 1, 0, -1, -2])
def test_equals_allantools(alpha: int):
    from allantools import edf_greenhall

    compared = 0
    for samples in (9, 30, 100, 1000, 12_345, 1_000_000):
        for factor in np.unique(np.geomspace(1, samples // 3, 40).astype(int)):
            if alpha == 2 and samples + 1 <= 4 * factor:
                continue  # allantools has none there; the covariance matrix has, above
            theirs = edf_greenhall(alpha, 2, factor, samples + 1, overlapping=True, modified=False)
            assert degrees_of_freedom(alpha, int(factor), samples) == pytest.approx(theirs, rel=1e-11)
            compared += 1
    assert compared > 100

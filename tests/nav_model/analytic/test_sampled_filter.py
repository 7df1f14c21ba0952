"""The sampled filter in closed form: against its own equation, and against doubling in 60 digits."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.analytic.sampled_filter import horizontal_cycle

LOW = np.log([1e-6, 1e-9, 0.1, 1e-3, 1e-4])
HIGH = np.log([1.0, 1e-1, 30.0, 3600.0, 1e4])


@settings(max_examples=300)
@given(st.lists(st.floats(0, 1), min_size=5, max_size=5))
def test_solves_its_riccati_equation_over_the_whole_range_of_designs(reference, fractions):
    a, w, g, dt, r = np.exp(LOW + np.array(fractions) * (HIGH - LOW))
    prior, posterior = (x.matrix() for x in horizontal_cycle(a, w, g, dt, r))
    q, phi = map(np.array, reference.exact_channel(a, w, g, dt))
    gain = prior[:, 0] / (prior[0, 0] + r**2)
    keep = np.eye(3) - np.outer(gain, [1, 0, 0])
    again = keep @ prior @ keep.T + r**2 * np.outer(gain, gain)  # Joseph form
    unit = np.sqrt(np.diag(prior))
    np.testing.assert_allclose(
        (phi @ again @ phi.T + q) / np.outer(unit, unit), prior / np.outer(unit, unit), atol=2e-13
    )
    unit = np.sqrt(np.diag(posterior))
    np.testing.assert_allclose(posterior / np.outer(unit, unit), again / np.outer(unit, unit), atol=1e-7)


@pytest.mark.parametrize(
    "case",
    [
        (8.3e-4, 1.45e-4, 9.80665, 1.0, 1.0),
        (1e-6, 1e-9, 9.8, 1.0, 5.0),
        (0.5, 2e-3, 9.8, 100.0, 1e-3),
        (1e-2, 1e-9, 9.8, 300.0, 1e-2),
        (1e-5, 1e-2, 9.8, 600.0, 1e-2),
    ],
)
def test_against_sixty_digits(case, reference, compared):
    exact, _ = reference.doubled(*case)
    ours = horizontal_cycle(*case)[0].matrix()
    with mpmath.workdps(60):
        off = [
            float((mpmath.mpf(float(ours[i, j])) - exact[i, j]) / mpmath.sqrt(exact[i, i] * exact[j, j]))
            for i in range(3)
            for j in range(3)
        ]
    compared(
        "Covariance before a fix by formula, extreme designs",
        "T-8",
        "our own derivation",
        "the doubling of Chu, Fan, Lin and Wang 2004, written out in the test in 60 digits",
        off,
        3e-15,
        "largest difference, in sigmas",
    )

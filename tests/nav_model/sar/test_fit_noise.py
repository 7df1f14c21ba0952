"""The slow error in the fit against the sum over all pairs of fixes, and against draws."""

import numpy as np
import pytest

from nav_model.sar.fit_noise import slow_fit


def pairwise(n, dt, span, tau):
    """Least squares at the fixes, the covariance of the errors written out in full; for 1 m."""
    time = dt * (np.arange(n) - (n - 1) / 2)
    covariance = np.exp(-np.abs(time[:, None] - time) / tau)
    line = np.linalg.pinv(np.vander(time, 2))[0]
    quadratic = np.linalg.pinv(np.vander(time / (span / 2), 3))[0]
    return line @ covariance @ line, quadratic @ covariance @ quadratic, quadratic @ np.exp(-(time - time[0]) / tau)


# The last two go beyond the lags summed one by one: a slow error, and one that is gone within them.
@pytest.mark.parametrize(
    ("n", "dt", "tau", "accuracy"),
    [
        (3, 1.0, 5.0, 1e-8),
        (6, 1.0, 300.0, 1e-7),
        (40, 0.5, 3.0, 1e-8),
        (2500, 0.02, 60.0, 1e-4),
        (2500, 0.1, 3.0, 1e-8),
    ],
)
def test_fit_of_a_slow_error(n, dt, tau, accuracy):
    span = (n - 0.7) * dt
    result = slow_fit(tau, dt, span, n + 0.3)
    np.testing.assert_allclose(result, pairwise(n, dt, span, tau), rtol=accuracy)


def test_it_broadcasts_and_needs_fixes():
    spans = np.array([[0.5, 1.5, 2.5, 9.5]])
    result = slow_fit(20.0, np.array([[1.0], [0.5]]), spans, spans / np.array([[1.0], [0.5]]) + 1)
    assert result.quadratic.shape == (2, 4)
    assert result.quadratic[0, 1] == 0.0  # two fixes: no quadratic
    assert result.quadratic[0, 3] == pytest.approx(pairwise(10, 1.0, 9.5, 20.0)[1])
    assert result.quadratic[1, 3] == pytest.approx(pairwise(20, 0.5, 9.5, 20.0)[1])
    assert not np.any(slow_fit(None, 1.0, spans, spans + 1))

"""The filter with a slow GNSS error, in closed form: against doubling in 80 digits, far apart and near together."""

import mpmath
import numpy as np
import pytest

from nav_model.analytic.sampled_filter import horizontal_cycle
from nav_model.analytic.slow_error_filter import horizontal_cycle_slow, vertical_cycle_slow

# sigma_a, sigma_w, g, interval, sigma_fix, sigma_slow, correlation_time
CASES = [
    (8.3e-4, 1.45e-4, 9.80665, 1.0, 1.0, 1.0, 300.0),
    (5e-4, 3.4e-7, 9.8, 1.0, 0.02, 0.02, 30.0),
    (2.2e-4, 4.1e-6, 9.8, 0.076, 0.0081, 4.04, 2627.0),  # the error outweighs the fixes; poles far apart
    (1.6e-3, 7.7e-6, 9.8, 0.70, 0.034, 0.34, 2543.0),  # the quadratic's roots beyond both real ones
    (1.7e-5, 1.04e-3, 9.8, 16.1, 0.0058, 1.25, 3629.0),
    (1e-6, 1e-8, 9.8, 1.0, 5.0, 1e4, 1e5),
    (0.5, 1e-2, 9.8, 3600.0, 1e-3, 1e4, 0.1),  # forgotten between fixes: white
    (1e-3, 1e-4, 9.8, 1.0, 1.0, 1e-6, 10.0),  # as good as none
]


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_against_eighty_digits(case, reference):
    a, w, g, h, r, slow, tau = case
    exact = reference.doubled(a, w, g, h, r, (slow, tau), digits=80)
    *ends, slow_with_tilt = horizontal_cycle_slow(*case)
    for ours, matrix in zip(ends, exact, strict=True):
        _close(ours.matrix(), matrix, 3)
    # The error itself is its estimate minus the error of that estimate, of which alone the tilt knows.
    with mpmath.workdps(60):
        unit = mpmath.sqrt(exact[1][2, 2] * exact[1][3, 3])
        assert abs(mpmath.mpf(float(slow_with_tilt)) + exact[1][2, 3]) / unit < 1e-11
    exact = reference.doubled(a, 1e-40, g, h, r, (slow, tau), digits=110)
    for ours, matrix in zip(vertical_cycle_slow(a, h, r, slow, tau), exact, strict=True):
        _close(np.array([[ours.v11, ours.v12], [ours.v12, ours.v22]]), matrix, 2)


def _close(ours, exact, size):
    with mpmath.workdps(60):
        for i in range(size):
            for j in range(size):
                unit = mpmath.sqrt(exact[i, i] * exact[j, j])
                assert abs(mpmath.mpf(float(ours[i, j])) - exact[i, j]) / unit < 1e-11


def test_no_design_is_out_of_reach():
    """20,000 designs over all that inputs may be: posterior below prior, never better than without the error."""
    rng = np.random.default_rng(3)
    low, high = np.log([1e-6, 1e-8, 1e-3, 1e-3, 1e-6, 0.1]), np.log([1.0, 1.0, 3600.0, 1e4, 1e4, 1e5])
    a, w, h, r, slow, tau = np.exp(low + rng.random((20_000, 6)) * (high - low)).T
    prior, posterior, _ = horizontal_cycle_slow(a, w, 9.8, h, r, slow, tau)
    least, _ = horizontal_cycle(a, w, 9.8, h, r)
    up, down = vertical_cycle_slow(a, h, r, slow, tau)
    for before, after in ((prior.p11, posterior.p11), (prior.p22, posterior.p22), (prior.p33, posterior.p33),
                          (up.v11, down.v11), (up.v22, down.v22)):  # fmt: skip
        assert np.all(after > 0)
        assert np.all(after <= before * (1 + 1e-9))
    for without, here in ((least.p11, prior.p11), (least.p22, prior.p22), (least.p33, prior.p33)):
        assert np.all(here >= without * (1 - 1e-9))


def test_a_complex_step_gives_the_derivative():
    case = np.array(CASES[0])
    for i in range(7):
        stepped = case.astype(complex)
        stepped[i] *= 1 + 1e-20j
        prior, *_ = horizontal_cycle_slow(*stepped)
        slope = prior.p33.imag / prior.p33.real / 1e-20
        values = [
            float(horizontal_cycle_slow(*(case * (1 + k * 1e-3 * (np.arange(7) == i))))[0].p33)
            for k in (-2, -1, 1, 2)
        ]
        f = np.log(values)
        assert slope == pytest.approx((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / 12e-3, abs=1e-8)

"""The settled filter with a slow GNSS error and velocity fixes: against doubling in 80 digits, and 4,000 designs."""

import mpmath
import numpy as np
import pytest

from nav_model.analytic.sampled_filter import horizontal_cycle, vertical_cycle
from nav_model.analytic.settled_filter import settled_cycle

# sigma_a, sigma_w, g, interval, sigma_fix, slow error and its correlation time, velocity of a fix
CASES = [
    (8.3e-4, 1.45e-4, 9.80665, 1.0, 1.0, (1.0, 300.0), None),
    (5e-4, 3.4e-7, 9.8, 1.0, 0.02, (0.02, 30.0), None),
    (2.2e-4, 4.1e-6, 9.8, 0.076, 0.0081, (4.04, 2627.0), None),  # the error outweighs the fixes; poles far apart
    (1.6e-3, 7.7e-6, 9.8, 0.70, 0.034, (0.34, 2543.0), None),
    (1.7e-5, 1.04e-3, 9.8, 16.1, 0.0058, (1.25, 3629.0), None),
    (1e-6, 1e-8, 9.8, 1.0, 5.0, (1e4, 1e5), None),
    (0.5, 1e-2, 9.8, 3600.0, 1e-3, (1e4, 0.1), None),  # forgotten between fixes: white
    (1e-3, 1e-4, 9.8, 1.0, 1.0, (1e-6, 10.0), None),  # as good as none
    (8.3e-4, 1.45e-4, 9.80665, 1.0, 1.0, None, 0.03),
    (8.4e-5, 7.8e-6, 9.8, 0.14, 4.9, (2.9, 1.8), 0.01),
    (3.4e-3, 1.2e-7, 9.8, 0.093, 0.06, (0.38, 8.4), 0.005),
    (2.4e-4, 2e-4, 9.8, 0.11, 3.5, (6.5, 878.0), 0.015),
]
# Position settles long after the slow error has, and is a small part of it.
LATE = (8.3e-4, 1.45e-4, 9.8, 0.1, 30.0, (30.0, 3.0), 0.001)


@pytest.mark.long
@pytest.mark.parametrize(("case", "off"), [*((case, 1e-9) for case in CASES), (LATE, 1e-5)])
def test_against_eighty_digits(case, off, reference):
    a, w, g, h, r, slow, v = case
    rising = None if slow is None else (1.7 * slow[0], slow[1])  # of heights
    both = None if rising is None else (slow[0], *rising)
    before, after, slow_with_tilt = settled_cycle(a, w, g, h, (r, r), None if v is None else (v, v), both)
    exact = reference.doubled(a, w, g, h, r, slow, 80, v)
    upright = reference.doubled(a, None, g, h, r, rising, 110, v)
    for (level, vertical), matrix, other in zip((before, after), exact, upright, strict=True):
        _close(level.matrix(), matrix, 3, off)
        # A slow error of 10 km over a day, beside which gravity by height grows as fast, costs three digits more.
        _close(np.array([[vertical.v11, vertical.v12], [vertical.v12, vertical.v22]]), other, 2, max(off, 1e-6))
    if slow is not None:
        # The error itself is its estimate minus the error of that estimate, of which alone the tilt knows.
        with mpmath.workdps(60):
            unit = mpmath.sqrt(exact[1][2, 2] * exact[1][3, 3])
            assert abs(mpmath.mpf(float(slow_with_tilt)) + exact[1][2, 3]) / unit < 1e-9


def _close(ours, exact, size, off):
    with mpmath.workdps(60):
        for i in range(size):
            for j in range(size):
                unit = mpmath.sqrt(exact[i, i] * exact[j, j])
                assert abs(mpmath.mpf(float(ours[i, j])) - exact[i, j]) / unit < off


def test_doubling_agrees_with_the_factorisation_for_white_position_fixes():
    """The two ways to [T-8] where both hold: 5,000 designs, every element in units of its two sigmas."""
    rng = np.random.default_rng(5)
    low, high = np.log([1e-5, 1e-8, 0.01, 0.01]), np.log([1e-2, 1e-2, 100.0, 100.0])
    a, w, h, r = np.exp(low + rng.random((5_000, 4)) * (high - low)).T
    for doubled, level, upright in zip(
        settled_cycle(a, w, 9.8, h, (r, r))[:2],
        horizontal_cycle(a, w, 9.8, h, r),
        vertical_cycle(a, 9.8, h, r),
        strict=True,
    ):
        p, sigmas = level.matrix(), np.sqrt(np.diagonal(level.matrix(), axis1=1, axis2=2))
        assert np.max(np.abs(doubled[0].matrix() - p) / sigmas[:, :, None] / sigmas[:, None, :]) < 1e-9
        units = upright.v11, np.sqrt(upright.v11 * upright.v22), upright.v22
        for ours, exact, unit in zip(doubled[1], upright, units, strict=True):
            assert np.max(np.abs(ours - exact) / unit) < 1e-9


def variances(moment):
    level, upright = moment
    return [level.p11, level.p22, level.p33, upright.v11, upright.v22]


@pytest.mark.long
def test_no_design_is_out_of_reach():
    """4,000 designs: posterior below prior, never better than without the error.

    Over all that inputs may be, but for a slow error beyond a kilometre with velocity fixes below a millimetre a
    second: of the difference of two such numbers no digit is left.
    """
    rng = np.random.default_rng(3)
    low, high = np.log([1e-6, 1e-8, 1e-3, 1e-3, 1e-3, 0.1, 1e-3]), np.log([1.0, 1.0, 3600.0, 1e4, 1e3, 1e5, 1e2])
    a, w, h, r, share, tau, v = np.exp(low + rng.random((4_000, 7)) * (high - low)).T
    both = horizontal_cycle(a, w, 9.8, h, r), vertical_cycle(a, 9.8, h, r)
    white = [variances(ends) for ends in zip(*both, strict=True)]
    slow = *[np.minimum(share * r, 1e3)] * 2, tau
    fixes = (r, r), (v, v)
    with_velocity = [variances(ends) for ends in settled_cycle(a, w, 9.8, h, *fixes)[:2]]
    for least, result in (
        (white, settled_cycle(a, w, 9.8, h, (r, r), None, slow)),
        (with_velocity, settled_cycle(a, w, 9.8, h, *fixes, slow)),
    ):
        prior, posterior = map(variances, result[:2])
        for before, after, without in zip(prior, posterior, least[0], strict=True):
            assert np.all(after > 0)
            assert np.all(after <= before * (1 + 1e-7))
            assert np.mean(before >= without * (1 - 1e-7)) >= 0.998
            # Millimetres a second under fixes of kilometres show the height through gravity, to the centimetre: of a
            # slow error of hundreds of metres few digits of it are left.
            assert np.all(before >= without * (1 - 5e-3))
    for before, without in zip(with_velocity[0], white[0], strict=True):
        assert np.all(before <= without * (1 + 1e-7))


@pytest.mark.parametrize("velocity", [None, 0.03])
def test_a_complex_step_gives_the_derivative(velocity):
    case = np.array([*CASES[0][:5], *[CASES[0][5][0]] * 2, CASES[0][5][1]])

    def tilt(x):
        fixes = (x[4], x[4]), None if velocity is None else (velocity, velocity)
        return settled_cycle(*x[:4], *fixes, tuple(x[5:]))[0][0].p33

    for i in range(8):
        stepped = case.astype(complex)
        stepped[i] *= 1 + 1e-20j
        slope = tilt(stepped).imag / tilt(stepped).real / 1e-20
        f = np.log([float(tilt(case * (1 + k * 1e-3 * (np.arange(8) == i)))) for k in (-2, -1, 1, 2)])
        assert slope == pytest.approx((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / 12e-3, abs=1e-8)


def test_a_row_that_settles_late_or_never_leaves_the_others():
    fixes = np.array([1.0, 1e-6, 1e4, 1e200, 1e-200, 0.02])
    arguments = 8.3e-4, 1.45e-4, 9.8, 1.0
    with np.errstate(all="ignore"):
        together = settled_cycle(*arguments, (fixes, fixes), (0.05, 0.05), (3.0, 3.0, 600.0))
    for n in (0, 1, 2, 5):
        alone = settled_cycle(*arguments, (fixes[n], fixes[n]), (0.05, 0.05), (3.0, 3.0, 600.0))
        for some, single in zip(together[:2], alone[:2], strict=True):
            for array, value in zip(variances(some), variances(single), strict=True):
                assert array[n] == pytest.approx(float(value), rel=1e-9)

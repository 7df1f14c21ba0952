"""The sampled filter in closed form: against the doubling, against its own equation, against 60 digits."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.analytic.discrete import after_fix, process_noise, steady_prior, transition
from nav_model.analytic.sampled_filter import horizontal_cycle, vertical_cycle

LOW = np.log([1e-6, 1e-9, 0.1, 1e-3, 1e-4])
HIGH = np.log([1.0, 1e-1, 30.0, 3600.0, 1e4])


@settings(max_examples=300, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=5, max_size=5))
def test_solves_its_riccati_equation_over_the_whole_range_of_designs(fractions):
    a, w, g, dt, r = np.exp(LOW + np.array(fractions) * (HIGH - LOW))
    prior, posterior = (x.matrix() for x in horizontal_cycle(a, w, g, dt, r))
    row = np.array([1.0, 0, 0])
    phi, q = transition(g, dt), process_noise(a, w, g, dt)
    again = after_fix(prior, row, np.array(r**2))
    unit = np.sqrt(np.diag(prior))
    np.testing.assert_allclose(
        (phi @ again @ phi.T + q) / np.outer(unit, unit), prior / np.outer(unit, unit), atol=2e-13
    )
    unit = np.sqrt(np.diag(posterior))
    np.testing.assert_allclose(posterior / np.outer(unit, unit), again / np.outer(unit, unit), atol=1e-7)


def test_agrees_with_doubling(fleet):
    f = fleet
    prior, _ = horizontal_cycle(f.sigma_a, f.sigma_w, f.g, f.interval, f.sigma)
    ours = prior.matrix()
    unit = np.sqrt(np.einsum("nii->ni", ours))
    phi = transition(f.g, f.interval) * unit[:, None, :] / unit[:, :, None]
    q = process_noise(f.sigma_a, f.sigma_w, f.g, f.interval) / (unit[:, None, :] * unit[:, :, None])
    row = np.zeros((f.size, 3))
    row[:, 0] = 1
    doubled = steady_prior(phi, q, row, (f.sigma / unit[:, 0]) ** 2)
    np.testing.assert_allclose(doubled, ours / (unit[:, None, :] * unit[:, :, None]), atol=1e-9)


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
def test_against_sixty_digits(case, validated):
    with mpmath.workdps(60):
        exact = _doubling(*(mpmath.mpf(x) for x in case))
        ours = horizontal_cycle(*case)[0].matrix()
        off = [
            float((mpmath.mpf(float(ours[i, j])) - exact[i, j]) / mpmath.sqrt(exact[i, i] * exact[j, j]))
            for i in range(3)
            for j in range(3)
        ]
    validated(
        "Covariance before a fix in closed form, extreme designs", "T-8", "mpmath, doubling in 60 digits", off, 3e-15,
        "largest difference, in sigmas",
    )  # fmt: skip


def _doubling(a, w, g, h, r):
    f = mpmath.matrix([[1, h, g * h**2 / 2], [0, 1, g * h], [0, 0, 1]])
    qa, qw = a**2, w**2
    x = mpmath.matrix(
        [
            [qa * h**3 / 3 + g**2 * qw * h**5 / 20, qa * h**2 / 2 + g**2 * qw * h**4 / 8, g * qw * h**3 / 6],
            [qa * h**2 / 2 + g**2 * qw * h**4 / 8, qa * h + g**2 * qw * h**3 / 3, g * qw * h**2 / 2],
            [g * qw * h**3 / 6, g * qw * h**2 / 2, qw * h],
        ]
    )
    at, gain = f.T, mpmath.zeros(3)
    gain[0, 0] = 1 / r**2
    for _ in range(200):
        inverse = (mpmath.eye(3) + gain * x) ** -1
        step = at.T * x * inverse * at
        gain, at = gain + at * inverse * gain * at.T, at * inverse * at
        x = x + step
        if all(step[i, i] <= x[i, i] * mpmath.mpf(10) ** -45 for i in range(3)):
            return x
    raise ArithmeticError


def test_vertical_is_the_horizontal_without_a_gyro(fleet):
    f = fleet
    ours = vertical_cycle(f.sigma_a, f.interval, f.sigma)
    level = horizontal_cycle(f.sigma_a, 1e-30, 1.0, f.interval, f.sigma)
    for vertical, horizontal in zip(ours, level, strict=True):
        np.testing.assert_allclose(vertical.v11, horizontal.p11, rtol=1e-12)
        np.testing.assert_allclose(vertical.v12, horizontal.p12, rtol=1e-12)
        np.testing.assert_allclose(vertical.v22, horizontal.p22, rtol=1e-12)

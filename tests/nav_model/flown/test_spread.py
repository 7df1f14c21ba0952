"""Covariances of errors over time, and their freedom, against drawn errors of a textbook filter and smoother."""

import numpy as np
import pytest
from scipy.stats import chi2

from nav_model.design.file import parse_design
from nav_model.flown import spread
from nav_model.trajectory import aperture
from tests.support import made_flights as made

RUNS = 300
DESIGN = parse_design("""
imu.angle_random_walk = "0.1 °/√h"
imu.velocity_random_walk = "0.03 m/s/√h"
trajectory.flight = "straight"
trajectory.duration = "300 s"
""")
PICTURE = {"quadratic": 2, "cubic": 3, "shift": aperture.ORDERS}


@pytest.fixture(scope="module")
def flights():
    return made.fly(DESIGN, RUNS, seed=4)


@pytest.mark.parametrize("error", ["output", "smoothed", "difference"])
def test_sums_of_apertures_are_as_drawn(flights, error) -> None:
    """Mean square and freedom of each: within 95 % of what so many runs give, with five sums at a time in mind."""
    model, run, x = flights.model, flights.run, flights.spec.inputs
    begin = np.arange(100.0, 160.0, float(x.aperture) / 4)
    sums = spread.of_images(model, x, aperture.apertures_at(model, x, begin, np.arange(len(begin))))
    C = spread.covariance_of(model, run, spread.later_fixes(model, run), sums, error)
    of_error = {"output": (0.0, 1.0), "smoothed": (1.0, 0.0), "difference": (-1.0, 1.0)}[error]
    drawn = np.zeros((len(begin), aperture.COLUMNS, RUNS))
    for part, states in ((sums.before, flights.before), (sums.after, flights.after)):
        errors = of_error[0] * flights.smoothed + of_error[1] * states
        for n in range(part.shape[1]):
            nodes = np.minimum(sums.first + n, len(states) - 1)
            drawn += part[:, n] @ errors[nodes]
    for column in PICTURE.values():
        factors = np.eye(aperture.COLUMNS)[column]
        square = (drawn[:, column] ** 2).mean(axis=0)
        degrees = spread.freedom(C, factors)
        low, high = chi2.ppf([0.001, 0.999], degrees * RUNS) / (degrees * RUNS)
        assert low < square.mean() / (spread.mean_square(C) @ factors) < high
        assert 2 * square.mean() ** 2 / square.var() == pytest.approx(degrees, rel=0.35)


@pytest.mark.parametrize("error", ["output", "smoothed", "difference"])
def test_states_are_as_drawn(flights, error) -> None:
    """var(filter less smoother) is the difference of their variances, state by state."""
    model, run = flights.model, flights.run
    outputs = np.arange(100, 200, 5)
    C = spread.covariance_of(model, run, spread.later_fixes(model, run), spread.of_states(model, outputs), error)
    nodes = model.outputs[outputs]
    states = {"output": flights.after, "smoothed": flights.smoothed, "difference": flights.after - flights.smoothed}
    drawn = model.output_rows[outputs][:, :, : model.states.estimated] @ states[error][nodes]
    for axis in range(8):
        factors = np.eye(9)[axis]
        degrees = spread.freedom(C, factors)
        low, high = chi2.ppf([0.0005, 0.9995], degrees * RUNS) / (degrees * RUNS)
        assert low < (drawn[:, axis] ** 2).mean() / (spread.mean_square(C)[axis]) < high

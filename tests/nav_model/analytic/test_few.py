"""Maps from few of their designs against every design of them."""

import numpy as np
import pytest

from nav_model.analytic.few import BOUND, from_few
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.explore.trade_map import trade_map

ARW, FIX = "imu.angle_random_walk", "gnss.position_noise"
SHORT = {"processing.mode": "post-processed", "processing.leg_before": 20.0, "processing.leg_after": 10.0}


def worked_out(function, wanted, jumps=(False, False), at=None):
    """Values of a map, and at how many places they were worked out."""
    count = 0

    def exact(kind, rows, columns):
        nonlocal count
        count += len(rows)
        assert not kind.any()
        return function(rows, columns)[None]

    return from_few([wanted], [jumps], 1, exact, at)[0][0], count


@pytest.mark.parametrize(
    ("function", "jumps", "share"),
    [
        (lambda i, j: np.log(np.exp(i / 30) + np.exp(j / 25)), (False, False), 0.06),
        (lambda i, j: np.log(1 + 1 / (1 + i)) * np.cos(j / 40), (False, False), 0.1),
        (lambda i, j: np.floor(i / 7) + np.sin(j / 50), (True, False), 0.25),
        (lambda i, j: np.where(i == 77, 1.0, np.cos(j / 40)), (True, False), 0.2),
        (lambda i, j: np.sin(i / 50) + (j > 100), (False, True), 0.2),
        (lambda i, j: np.sin(np.floor(i / 7) + np.floor(j / 9)), (True, True), 1.0),
        (lambda i, j: np.where(i > 90, np.nan, i + j), (False, False), 1.0),
    ],
)
def test_within_the_bound_from_fewer_places(function, jumps, share):
    rows, columns = np.indices((200, 180))
    wanted = rows + columns > 60
    found, count = worked_out(function, wanted, jumps)
    off = np.abs(found - function(rows, columns))[wanted]
    assert np.nanmax(off) < BOUND
    np.testing.assert_array_equal(np.isnan(found), wanted & np.isnan(function(rows, columns)))
    assert count <= share * wanted.size


def test_places_need_not_be_evenly_spaced():
    rng = np.random.default_rng(3)
    at = np.cumsum(rng.uniform(0.1, 1.9, 200)), np.log(np.arange(3, 183))
    wanted = np.ones((200, 180), bool)

    def function(i, j):
        return np.sin(at[0][i] / 40) * np.cos(at[1][j])

    found, count = worked_out(function, wanted, at=at)
    assert np.abs(found - function(*np.indices(wanted.shape))).max() < BOUND
    assert count < 0.05 * wanted.size < worked_out(function, wanted)[1]


def test_nothing_wanted_is_nothing_worked_out():
    assert worked_out(lambda i, j: i + j, np.zeros((50, 60), bool))[1] == 0


@pytest.mark.long
@pytest.mark.parametrize(
    ("x", "y", "changes"),
    [
        (ARW, FIX, SHORT),
        (ARW, "gnss.interval", SHORT | {"gnss.velocity_noise": 0.03}),
        (ARW, FIX, SHORT | {"gnss.correlated": True, "gnss.velocity_noise": 0.03, "gnss.velocity_interval": 0.1}),
        ("gnss.correlated_noise", "gnss.correlation_time", SHORT | {"gnss.correlated": True}),
        (ARW, FIX, {"processing.mode": "post-processed", "gnss.interval": 10.0}),  # sparse; in parts by spectrum
        (ARW, "processing.leg_after", {"processing.mode": "post-processed"}),
        ("processing.leg_before", "processing.leg_after", {"processing.mode": "post-processed"}),
        ("radar.aperture_time", "gnss.interval", SHORT),
        (ARW, "gnss.interval", {"gnss.velocity_noise": 0.03}),  # in real time, velocity takes the doubling
        (ARW, FIX, {"gnss.velocity_noise": 0.03, "gnss.correlated": True}),
    ],
)
def test_cells_of_a_map_are_designs(open_design, x, y, changes):
    design = open_design.replace(changes)
    names = ("quadratic_phase", "detrended_phase", "azimuth_shift", "ce90", "horizontal_position", "tilt",
             "coast_vertical_position")  # fmt: skip
    trade = trade_map(design, x, y, "horizontal_position")
    grid = figures(inputs_of(design, {x: trade.x, y: trade.y[:, None]}), names)
    rng = np.random.default_rng(7)
    for i, j in rng.integers(200, size=(25, 2)):
        one = figures(inputs_of(design.replace({x: float(trade.x[i]), y: float(trade.y[j])})), names)
        for name in names:
            value = np.broadcast_to(grid[name], (200, 200))[j, i]
            assert value == pytest.approx(float(one[name]), rel=1e-4), (name, trade.x[i], trade.y[j])
    assert trade.z == pytest.approx(np.broadcast_to(grid["horizontal_position"], (200, 200)), rel=1e-4)

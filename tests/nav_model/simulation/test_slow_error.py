"""The slow GNSS error in the simulated filter: the budget's value by Monte Carlo, and a filter without it."""

import numpy as np
import pytest
from entered import entered

from nav_model.base.errors import InputError
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.design.file import read_design
from nav_model.simulation.design_study import specification
from nav_model.simulation.monte_carlo import simulate
from nav_model.simulation.result import chi_square_band
from nav_model.simulation.single_run import POSTERIOR, PRIOR

MEMS = read_design("examples/mems_x_band.toml")
RUNS, SETTLED = 100, 200.0
AXES = [0, 1, 2, 3, 4, 5, 6, 7]  # all but yaw, which no straight leg shows


@pytest.mark.long
@pytest.mark.parametrize(("sigma", "time"), [(1.0, 60.0), pytest.param(0.3, 300.0, marks=pytest.mark.slow)])
def test_the_filter_that_knows_the_slow_error_has_the_budgets_sigmas_and_is_consistent(
    sigma: float, time: float
) -> None:
    slow = {"correlated": True, "correlated_noise": sigma, "correlation_time": time}
    design = MEMS.replace({f"gnss.{key}": value for key, value in slow.items()} | {"imu.rate": 20.0})
    spec = specification(design, trajectory="straight", runs=RUNS, duration=300.0, every=10.0)
    assert spec.filter.states == 12
    result = simulate(spec)
    # Errors of one time are independent from run to run: chi-square of RUNS degrees, all inside with 99.9 %.
    settled = result.time_s >= SETTLED
    low, high = np.sqrt(chi_square_band(RUNS, 1 - 1e-3 / (2 * len(AXES) * settled.sum())))
    for moment, cycle in (
        (PRIOR, RealTime(inputs_of(design)).cycle.prior),
        (POSTERIOR, RealTime(inputs_of(design)).cycle.posterior),
    ):
        level, upright = cycle.horizontal, cycle.vertical
        variances = [level.p11, level.p11, upright.v11, level.p22, level.p22, upright.v22, level.p33, level.p33]
        budget = np.sqrt(np.array([float(value) for value in variances]))
        filters = result.nominal_sigma[moment][settled][:, AXES] / budget
        np.testing.assert_allclose(filters[:, [0, 1, 3, 4, 6, 7]], 1.0, rtol=2e-3)
        np.testing.assert_allclose(filters[:, [2, 5]], 1.0, rtol=0.05)  # down settles within many minutes
        simulated = result.rms[moment][settled][:, AXES] / budget
        assert np.all((simulated > low) & (simulated < high * 1.05))
    assert result.nees.inside
    assert result.nis is not None
    assert result.nis.inside
    # The choice that does not know it believes in the white noise alone.
    nine = design.replace({"filter.states": 9})
    unaware = simulate(specification(nine, trajectory="straight", runs=20, duration=300.0, every=10.0))
    assert unaware.nees.mean > 1.5 * unaware.nees.high


def test_states_for_a_slow_error_are_those_of_the_design() -> None:
    slow = MEMS.replace({"gnss.correlated": True})
    assert specification(slow).filter.states == 12
    assert specification(entered(slow, {"gyro.turn_on_bias": "0.2 °/h"})).filter.states == 18
    assert specification(slow.replace({"filter.states": 9})).filter.slow == 0
    with pytest.raises(
        InputError, match="states: 18 cannot be simulated; must be 9, 15 or 21 without a slow GNSS error"
    ):
        specification(MEMS.replace({"filter.states": 18}))

"""The filter's covariance on a straight flight, against another navigation program: pyins, by Nikolay Mayorov.

pyins has another error model (Scherzinger and Reid's, where a velocity error is counted in the axes the INS believes
in), its own Earth, its own fixes and its own filter. Both programs get the same flight, noise, fixes and start.
"""

import math

import numpy as np
import pandas as pd
import pytest
from pyins import earth
from pyins.error_model import InsErrorModel
from pyins.filters import run_feedforward_filter
from pyins.inertial_sensor import EstimationModel
from pyins.measurements import Position
from pyins.util import skew_matrix

from nav_model.simulation.single_run import POSTERIOR, fly_without_errors
from nav_model.simulation.specification import GnssModel, ImuModel, SimulationSpec, TrajectorySpec

pytestmark = pytest.mark.long

LAST_FIX, END = 60, 120  # s: a fix of 1 m each second, then none
HORIZONTAL, VERTICAL, HEADING = [0, 1, 3, 4, 6, 7], [2, 5], [8]


def ours(imu: ImuModel, speed: float) -> np.ndarray:
    """Sigmas each second from the last fix on: position, velocity (north, east, down), roll, pitch, yaw; SI."""
    spec = SimulationSpec(
        imu,
        GnssModel(position_noise=1.0),
        TrajectorySpec("straight", speed=speed),
        duration=float(END),
        outages=((LAST_FIX, END),),
    )
    return fly_without_errors(spec).filter_sigma[POSTERIOR, LAST_FIX:]


def theirs(imu: ImuModel, speed: float) -> np.ndarray:
    """The same from pyins: north at 3000 m from 45 degrees, level, with the simulator's initial errors."""
    time = np.arange(END + 2.0)
    latitude = np.full(len(time), 45.0)
    for k in range(1, len(time)):
        middle = latitude[k - 1] + math.degrees(speed / 2 / earth.principal_radii(latitude[k - 1], 3000.0)[0])
        latitude[k] = latitude[k - 1] + math.degrees(speed / earth.principal_radii(middle, 3000.0)[0])
    level = dict.fromkeys(("VE", "VD", "roll", "pitch", "heading"), 0.0)
    flight = pd.DataFrame({"lat": latitude, "lon": 0.0, "alt": 3000.0, "VN": speed, **level}, index=time)
    sigma = run_feedforward_filter(
        flight,
        flight,
        position_sd=1.0,
        velocity_sd=0.1,
        level_sd=0.05,
        azimuth_sd=0.1,
        gyro_model=EstimationModel(noise=imu.gyro.random_walk),
        accel_model=EstimationModel(noise=imu.accelerometer.random_walk),
        measurements=[Position(flight.loc[1.0:LAST_FIX], 1.0)],
        time_step=1.0,
    ).trajectory_sd.to_numpy(copy=True)
    sigma[:, 6:] = np.radians(sigma[:, 6:])
    return sigma[LAST_FIX : END + 1]


def test_at_rest_every_sigma_is_that_of_another_program(paper_imu, compared, ratio_off):
    compared(
        "Filter covariance after 60 fixes and 60 s without, at rest",
        "",
        "another program",
        "pyins 1.0.1: position, velocity and attitude of its feedforward filter",
        ratio_off(ours(paper_imu, 0.0), theirs(paper_imu, 0.0)),
        2e-5,
    )


def test_in_flight_the_sigmas_are_those_of_another_program(paper_imu, compared, differs, ratio_off, monkeypatch):
    """North at 50 m/s. What pyins leaves out of its velocity equation is put in, to see that it is all there is."""
    mine, plain = ours(paper_imu, 50.0), theirs(paper_imu, 50.0)
    off = ratio_off(mine, plain)
    for states, name, limit in (
        (HORIZONTAL, "horizontal position, velocity and tilt", 3e-4),
        (VERTICAL, "vertical position and velocity", 2e-3),
        (HEADING, "heading", 1e-4),
    ):
        compared(
            f"Filter covariance after 60 fixes and 60 s without, 50 m/s: {name}",
            "",
            "another program",
            f"pyins 1.0.1: {name} of its feedforward filter",
            off[:, states],
            limit,
        )

    shipped = InsErrorModel.system_matrices

    def with_the_turning_earth(self, pva):
        f, gyro, accelerometer = shipped(self, pva)
        bend = skew_matrix(pva[["VN", "VE", "VD"]]) @ skew_matrix(earth.rate_n(pva.lat))
        f[3:6, 6:9] -= bend
        f[3:6, 0:3] += bend @ earth.curvature_matrix(pva.lat, pva.alt)
        return f, gyro, accelerometer

    monkeypatch.setattr(InsErrorModel, "system_matrices", with_the_turning_earth)
    whole = ratio_off(mine, theirs(paper_imu, 50.0))[:, VERTICAL + HEADING]
    assert np.max(np.abs(whole)) < 2e-5
    assert np.max(np.abs(off[:, VERTICAL])) > 100 * np.max(np.abs(whole[:, :2]))
    worst = np.unravel_index(np.argmax(np.abs(off)), off.shape)
    assert worst[1] == 5
    differs(
        "Vertical velocity 60 s after the last fix, 50 m/s north at 45° latitude",
        "T-17",
        f"{1e3 * plain[-1, 5]:.4g} mm/s in pyins 1.0.1",
        f"{1e3 * mine[-1, 5]:.4g} mm/s",
        "ours",
        "pyins leaves the Earth's rate, as the tilted axes see it, out of its velocity equation; with that term put "
        "in it gives our figure to 0.002 %",
    )
    assert plain[-1, 5] == pytest.approx(mine[-1, 5], rel=2e-3)

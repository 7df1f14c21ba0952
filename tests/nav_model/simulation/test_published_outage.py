"""Thirty seconds without centimetre fixes: the figure of a real sensor's biases beside the noise alone.

0.06 deg/sqrt(h), 0.06 m/s/sqrt(h), 2 cm at 1 Hz, biases 25 deg/h over 1000 s and 0.6 mg over 4 h. Real
arrays show about 2 m at 30 s where noise alone says 0.3 m. The independent figure is a five-state channel
on a flat Earth.
"""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import riccati
from entered import entered

from nav_model.design.file import read_design
from nav_model.simulation.design_study import closed_form, specification
from nav_model.simulation.single_run import POSTERIOR, fly_without_errors
from nav_model.simulation.specification import FilterModel, GnssModel, SimulationSpec, TrajectorySpec

EXAMPLES = Path(__file__).parents[3] / "examples" / "outage"

G = 9.797
SIGMA_A, SIGMA_W = 0.06 / 60, math.radians(0.06) / 60
BIAS_A, BIAS_W = 0.6 * 9.80665e-3, math.radians(25.0) / 3600


def channel(with_biases: bool) -> np.ndarray:
    """Position sigma [m] at 0 .. 30 s after the last of 600 fixes: position, velocity, tilt, two biases."""
    share = 1.0 if with_biases else 1e-9
    f = np.zeros((5, 5))
    f[0, 1], f[1, 2], f[1, 3], f[2, 4] = 1.0, G, 1.0, 1.0
    f[3, 3], f[4, 4] = -1.0 / 14_400.0, -1.0 / 1000.0
    drive = [0.0, SIGMA_A**2, SIGMA_W**2, 2 * (share * BIAS_A) ** 2 / 14_400.0, 2 * (share * BIAS_W) ** 2 / 1000.0]
    phi, noise = riccati.van_loan(f, np.diag(drive), 1.0)
    p = np.diag([1.0, 0.1**2, math.radians(0.05) ** 2, (share * BIAS_A) ** 2, (share * BIAS_W) ** 2])
    h = np.eye(5)[:1]
    for _ in range(600):
        p = phi @ p @ phi.T + noise
        gain = p @ h.T / (p[0, 0] + 0.02**2)
        p = (np.eye(5) - gain @ h) @ p @ (np.eye(5) - gain @ h).T + gain @ gain.T * 0.02**2
    sigma = [math.sqrt(p[0, 0])]
    for _ in range(30):
        p = phi @ p @ phi.T + noise
        sigma.append(math.sqrt(p[0, 0]))
    return np.array(sigma)


def test_each_second_of_the_outage_with_biases_and_with_noise_alone(make_imu, compared, ratio_off):
    spec = SimulationSpec(
        make_imu(0.06, 0.06, 25.0, 0.6, 1000.0, 14_400.0),
        GnssModel(position_noise=0.02),
        TrajectorySpec("straight"),
        FilterModel(states=15),
        duration=630.0,
        outages=((600.0, 630.0),),
    )
    biased = fly_without_errors(spec).filter_sigma[POSTERIOR, 600:, 0]
    quiet = replace(spec, imu=make_imu(0.06, 0.06), filter=FilterModel(states=9))
    noise_only = fly_without_errors(quiet).filter_sigma[POSTERIOR, 600:, 0]
    off = [ratio_off(biased, channel(True)), ratio_off(noise_only, channel(False))]
    compared(
        "Filter's sigma through an outage of 30 s, with and without biases",
        "",
        "solver written by others",
        "SciPy's matrix exponential of a five-state channel on a flat Earth, written out in the test",
        off,
        0.02,
    )
    assert biased[-1] == pytest.approx(1.58, abs=0.03)
    assert noise_only[-1] == pytest.approx(0.406, abs=0.008)


def test_the_table_of_the_example_is_what_its_command_gives():
    """Second by second against the five-state channel, and to the last printed digit against the command's study."""
    text = (EXAMPLES / "README.md").read_text("utf-8")
    table = np.array(
        [[float(x) for x in row] for row in re.findall(r"^\| (\d+) \|" + r" ([\d.]+) \|" * 4, text, re.M)]
    )
    assert table[:, 0].tolist() == list(range(31))
    assert table[:, 1] == pytest.approx(channel(True), rel=0.02, abs=0.0006)
    assert table[:, 2] == pytest.approx(channel(False), rel=0.02, abs=0.0006)
    perfect = np.sqrt(SIGMA_A**2 * table[:, 0] ** 3 / 3 + (9.80665 * SIGMA_W) ** 2 * table[:, 0] ** 5 / 20)
    assert table[:, 4] == pytest.approx(perfect, abs=0.0006)

    plain = read_design(EXAMPLES / "array.toml")
    biases = dict(re.findall(r'(\w+\.\w+)="([^"]+)"', text))
    assert len(biases) == 4
    options = {"duration": 630.0, "outages": [(600, 630)], "trajectory": "straight"}
    for column, design in ((1, entered(plain, biases)), (2, plain)):
        spec = specification(design, **options)
        assert spec.filter.states == (15 if column == 1 else 9)
        assert table[:, column] == pytest.approx(fly_without_errors(spec).filter_sigma[POSTERIOR, 600:, 0], abs=6e-4)
    noise = closed_form(design, spec)(np.arange(31.0), np.arange(600.0, 631.0))[:, 0]
    assert table[:, 3] == pytest.approx(noise, abs=6e-4)

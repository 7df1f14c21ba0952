"""A receiver's accuracy that is taken for white noise: said, with the figure of an own filter of a slow error."""

import math

import numpy as np
import pytest
import scipy.linalg

from app.examples import EXAMPLES, example
from nav_model.budget import analyse
from nav_model.budget.provenance import cautions
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

MEMS = example("mems_x_band")
WORDS = "counts as white"


def white_caution(design: Design) -> str:
    return " ".join(caution for caution in cautions(analyse(design)) if WORDS in caution)


def just_before_a_fix(design: Design, white: float, slow: float, time: float) -> float:
    """Position of a settled filter that knows position, velocity, tilt as an acceleration, and the slow error, m."""
    g, step = design.flight.gravity, design.gnss.interval
    f = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0], [0, 0, 0, -1 / time]])
    density = [0, design.imu.velocity_random_walk**2, (g * design.imu.angle_random_walk) ** 2, 2 * slow**2 / time]
    whole = scipy.linalg.expm(np.block([[-f, np.diag(density)], [np.zeros((4, 4)), f.T]]) * step)
    phi = whole[4:, 4:].T
    h = np.array([[1.0, 0, 0, 1]])
    prior = scipy.linalg.solve_discrete_are(phi.T, h.T, phi @ whole[:4, 4:], np.array([[white**2]]))
    return math.sqrt(prior[0, 0])


def test_two_examples_take_an_accuracy_for_white_and_are_told_what_it_would_be() -> None:
    assert [name for name in EXAMPLES if white_caution(example(name))] == ["mems_x_band", "l_band_jet"]
    other = just_before_a_fix(MEMS, 0.1, 1.0, 60.0)
    assert f"white, that is {other:.3g} m. Take a receiver class (gnss.preset, the nearest is" in white_caution(MEMS)


@pytest.mark.parametrize(
    "changes",
    [
        {"gnss.position_noise": 0.1},
        {"gnss.correlated": True},
        {"gnss.preset": "SBAS"},
    ],
)
def test_carrier_phase_a_slow_error_and_a_class_are_no_such_case(changes: dict[str, float | str]) -> None:
    assert white_caution(MEMS.replace(changes)) == ""


def test_noise_with_an_origin_is_taken_as_it_is() -> None:
    assert white_caution(MEMS.replace({}, origins={"gnss.position_noise": "second differences of a log"})) == ""


@pytest.mark.parametrize(
    ("noise", "mode", "nearest"),
    [(1.0, REAL_TIME, "Single point, two frequencies"), (0.5, REAL_TIME, "SBAS"), (0.12, REAL_TIME, "Float"),
     (9.0, POST_PROCESSED, "Single point, one frequency")],
)  # fmt: skip
def test_the_class_of_the_nearest_accuracy_is_named(noise: float, mode: str, nearest: str) -> None:
    """By the sizes that the catalogue's sources print: 1.5, 1.2, 0.6, 0.26, 0.25 m and centimetres."""
    design = MEMS.replace({"gnss.position_noise": noise, "processing.mode": mode})
    assert f'(gnss.preset, the nearest is "{nearest}")' in white_caution(design)

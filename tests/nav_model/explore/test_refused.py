"""What `analyse` refuses, every answer about a design refuses, with the same words."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.explore.rank import rank
from nav_model.explore.search import own_candidate, search
from nav_model.explore.solve import solve
from nav_model.explore.supplier import required
from nav_model.explore.trade_map import trade_map
from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict
from nav_model.explore.vendor_table import invert, vendor_table
from nav_model.simulation.design_study import specification

LIMITS = {"requirements.quadratic_phase": 1.0, "requirements.horizontal_position": 1.0}
REFUSED = {
    "radar.squint_angle": {"radar.squint_angle": math.radians(60), "radar.grazing_angle": math.radians(35)},
    "radar.azimuth_resolution": {"flight.speed": 1.0, "radar.azimuth_resolution": 0.02, "radar.slant_range": 1e5},
    "motion.delay": {"radar.aperture_time": 0.5, "motion.delay": 0.9},
}
ANSWERS = {
    "rank": lambda design: rank(design, "quadratic_phase"),
    "search": lambda design: search(design, catalogue("imu"), catalogue("gnss")),
    "own candidate": own_candidate,
    "solve": solve,
    "map": lambda design: trade_map(design, "imu.angle_random_walk", "gnss.position_noise", size=3),
    "uncertainty": lambda design: uncertain_verdict(
        design, {"gnss.position_noise": read_uncertain("gnss.position_noise", "0.5 m .. 2 m")}
    ),
    "table": vendor_table,
    "invert": lambda design: invert(design, ["60 s: horizontal 3 m"]),
    "required": lambda design: required(design, "imu"),
    "simulate": specification,
}


@pytest.mark.parametrize("key", REFUSED)
@pytest.mark.parametrize("answer", ANSWERS)
def test_every_answer_refuses_what_the_budget_refuses(answer: str, key: str) -> None:
    design = Design(LIMITS | REFUSED[key])
    with pytest.raises(InputError) as by_budget:
        analyse(design)
    with pytest.raises(InputError) as refused:
        ANSWERS[answer](design)
    assert (refused.value.key, str(refused.value)) == (by_budget.value.key, str(by_budget.value))
    assert by_budget.value.key == key


def test_a_range_that_leaves_no_image_is_refused() -> None:
    hidden = {"radar.squint_angle": read_uncertain("radar.squint_angle", "57° .. 60°")}
    with pytest.raises(InputError, match="leaves an image"):
        uncertain_verdict(Design(LIMITS | {"radar.grazing_angle": math.radians(35)}), hidden)

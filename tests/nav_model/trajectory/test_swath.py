"""Near and far range: flown again on both sides of each end, and against the budget's formulas at that range."""

import math
from pathlib import Path

import pytest

from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.trajectory import verdict
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import along_flight, planned
from nav_model.trajectory.result import Swath, TrajectoryResult, to_json
from nav_model.trajectory.swath import swath_in_words, with_swath

pytestmark = pytest.mark.long
SHORT = ("trajectory.flight=wandering", "trajectory.duration=60 s")


def example(name: str, *changes: str) -> Design:
    return parse_design(Path(f"examples/{name}.toml").read_bytes(), changes=[*SHORT, *changes])


def flown(design: Design) -> TrajectoryResult:
    return covariance(along_flight(design, planned(design)))


def closes(design: Design) -> bool:
    return verdict.with_flight(analyse(design)).verdict.closes


def seen_from(design: Design, slant_range: float) -> Design:
    """As high above the scene as the design, from another range."""
    sine = design.radar.slant_range * math.sin(design.radar.grazing_angle) / slant_range
    return design.replace({"radar.slant_range": slant_range, "radar.grazing_angle": math.asin(sine)})


POST = ("gnss.velocity_noise=3 cm/s", "processing.mode=post-processed")


@pytest.mark.parametrize(
    ("name", "changes"), [("tactical_x_band", ()), ("mems_x_band", ()), ("mems_x_band", POST), ("l_band_jet", ())]
)
def test_a_flight_closes_up_to_its_far_range_and_not_beyond(name: str, changes: tuple[str, ...]) -> None:
    design = example(name, *changes)
    swath = with_swath(flown(design), design).swath
    assert swath is not None
    assert swath.near_m is not None
    assert swath.far_m is not None
    assert closes(seen_from(design, 0.999 * swath.far_m))
    assert not closes(seen_from(design, 1.02 * swath.far_m))
    # What fails beyond is at its limit there, by the budget's formulas to what a flight differs from them. A smoother
    # has no fixes after the flight.
    budget = analyse(seen_from(design, swath.far_m))
    tightest = budget.straight_leg().tightest
    assert tightest is not None
    assert swath.far_by == f"{tightest.label.lower()} of flight fails first"
    if not budget.post_processed:
        assert tightest.value == pytest.approx(tightest.limit, rel=0.09)
    # Near range is as near as is searched: an aperture there is shorter.
    assert (swath.near_by, math.asin(swath.height_m / swath.near_m)) == ("", pytest.approx(math.radians(70)))


def test_a_range_shift_that_grows_upwards_has_a_near_range() -> None:
    """The vertical position, worse than the horizontal, counts by the sine of the grazing angle: steep looks fail."""
    design = example("tactical_x_band", "gnss.vertical_position_noise=1 m")
    design = design.replace({"requirements.quadratic_phase": None})
    shift = flown(design).lines[0].worst["range_shift"]
    design = design.replace({"requirements.range_shift": 1.15 * shift})
    swath = with_swath(flown(design), design).swath
    assert swath is not None
    assert swath.near_m is not None
    assert swath.near_by == "range shift of flight fails first"
    assert closes(seen_from(design, 1.001 * swath.near_m))
    assert not closes(seen_from(design, 0.98 * swath.near_m))


def test_a_flight_without_a_range_says_so_and_one_without_limits_has_none() -> None:
    design = example("mems_x_band", "requirements.horizontal_position=1 mm")
    result = with_swath(flown(design), design)
    assert result.swath == Swath(pytest.approx(7000 * math.sin(math.radians(35))))
    assert to_json(result, verdict.with_flight(analyse(design)).verdict)["swath"]["far_m"] is None
    assert swath_in_words(result.swath) == "No slant range from 20° to 70° of grazing angle meets the limits."
    free = Design({"trajectory.duration": 60.0})
    assert with_swath(flown(free), free).swath is None
    assert swath_in_words(None) == ""

"""The name of the compared design."""

from typing import Any

import pytest

from app.dashboard.comparison import ComparisonChoice
from app.session import Session
from nav_model.design import Design


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"imu.vibration_factor": 3.0}, "Vibration factor 1"),
        ({"gnss.interval": 0.5}, "Fix interval 1 s"),
        ({"trajectory.flight": "lines"}, "Flight straight leg, no plan"),  # not "none", the file's word
        ({"gnss.velocity_noise": 0.1}, "Velocity noise not given"),
        ({"motion.lines": ((30.0, 1e-4, "length"),)}, "Vibration lines not given"),
        ({"gnss.interval": 0.5, "imu.vibration_factor": 3.0}, "the previous version"),
    ],
)
def test_the_design_before_a_change_is_called_by_the_value_that_was_there(changes: dict[str, Any], name: str) -> None:
    session = Session(Design())
    choice = ComparisonChoice(session)
    assert session.change(changes) is None
    assert choice.compared == name
    session.compare(None)
    assert choice.compared == ""

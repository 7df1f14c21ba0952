"""Every input says what it is, where to find it and what is typical; what grades reach is what they reach."""

import math
import re

import pytest

from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import BaseQuantity
from nav_model.design.figures import LEVELS
from nav_model.design.parts import INPUTS
from nav_model.design.presets import preset_fill

EVERY = [(section, name) for section, names in INPUTS.items() for name in names]
_NO_GRADE = {"confidence", "steady_state", "heading", *LEVELS}
REACHED = [key for key in INPUTS["requirements"] if key not in _NO_GRADE and "phase" not in key]


@pytest.mark.parametrize(("section", "name"), EVERY)
def test_every_input_is_explained(section, name):
    declaration = INPUTS[section][name]
    assert declaration.label
    assert len(declaration.doc) > 15
    if isinstance(declaration, BaseQuantity):
        assert declaration.datasheet.endswith((".", "σ."))
        assert declaration.typical
        assert not declaration.typical.endswith(".")


@pytest.fixture(scope="module")
def fleet():
    """(grade, figures) of every unit of the catalogue that has both random walks, with 1.5 m fixes at 1 Hz."""
    result = []
    for name, entry in catalogue("imu").items():
        if {"velocity_random_walk", "angle_random_walk"} <= set(entry.values):
            values, _ = preset_fill("imu", name)
            changes = {"gnss.position_noise": 1.5, "gnss.interval": 1.0, "coast.duration": 60.0}
            budget = analyse(Design({**values, **changes}))
            prior = budget.steady_state.prior
            figures = {
                "horizontal_position": prior["horizontal_position"],
                "vertical_position": prior["vertical_position"],
                "horizontal_velocity": prior["horizontal_velocity"],
                "vertical_velocity": prior["vertical_velocity"],
                "tilt": math.degrees(prior["tilt"]),
                "azimuth_shift": budget["azimuth_shift", "real time"].sigma,
                "range_shift": budget["range_shift", "real time"].sigma,
                "ce90": budget["ce90", "real time"].sigma,
                "le90": budget["le90", "real time"].sigma,
                "coast_horizontal_position": budget["coast_horizontal_position", "real time"].sigma,
                "coast_vertical_position": budget["coast_vertical_position", "real time"].sigma,
            }
            grade = next(g for g in ("navigation", "tactical", "MEMS") if g in entry.grade)
            result.append((grade, figures))
    return result


@pytest.mark.parametrize("key", REACHED)
def test_what_a_grade_is_said_to_reach_it_reaches(key, fleet):
    text = INPUTS["requirements"][key].typical
    assert "reached with 1.5 m fixes at 1 Hz" in text
    for grade in ("navigation", "tactical", "MEMS"):
        low, high = (float(x) for x in re.search(rf"{grade} ([\d.]+) to ([\d.]+)", text).groups())
        values = [figures[key] for of, figures in fleet if of == grade]
        assert low <= min(values)
        assert max(values) <= high
        assert max(values) > 0.5 * high  # a range that says something

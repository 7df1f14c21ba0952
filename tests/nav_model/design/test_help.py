"""Every input says what it is, where to find it and what is typical; what grades reach is what they reach."""

import math
import re

import pytest

from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import BaseQuantity
from nav_model.design.figures import FIGURES, REQUIRED
from nav_model.design.parts import INPUTS
from nav_model.design.presets import preset_fill

EVERY = [(section, name) for section, names in INPUTS.items() for name in names]
REACHED = [name for name in REQUIRED if "reached with" in INPUTS["requirements"][name].typical]


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
            sigmas = {key: budget[key, "real time"].sigma for key in REACHED}
            figures = {
                key: math.degrees(sigma) if FIGURES[key].dimension == "angle" else sigma
                for key, sigma in sigmas.items()
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

"""Every declared source of error has its size among the inputs of the closed forms."""

import pytest

from nav_model.budget.inputs import VARIABLES
from nav_model.budget.shares import ESTIMATION, SIZES, sizes_of
from nav_model.design.parts import quantity


def test_every_declared_source_has_a_size() -> None:
    declared = {source for key in VARIABLES if (source := quantity(key).source)}
    assert declared | {ESTIMATION} == set(SIZES)  # which follows from the scene


def test_fields_of_the_names_of_the_declarations_are_a_size() -> None:
    sizes = sizes_of({"scene_height_error": "scenery", "slant_range": "scenery"})
    assert sizes["scenery"] == ("scene_height_error", "slant_range")


def test_a_source_without_a_field_is_refused_by_name() -> None:
    with pytest.raises(LookupError, match=r"'timing error' has no size .*Inputs: give it the field 'radar_timing'"):
        sizes_of({"radar_timing": "timing error"})

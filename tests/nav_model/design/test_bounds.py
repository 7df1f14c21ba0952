"""Every bound that a message prints can be entered as it is printed there."""

import math
import re

import pytest

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design, parts
from nav_model.design.declaration import BaseQuantity
from nav_model.design.rows import Rows
from nav_model.design.several import Axes
from nav_model.sar.flown_engine import flight_of
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.suborbital.input_table import INPUTS

EVERY = {f"design {key}": parts.declaration_of(key) for key in parts.all_keys()}
EVERY |= {f"suborbital {key}": declared for key, declared in INPUTS.items()}


def _of(kind):
    result = {name: declared for name, declared in EVERY.items() if isinstance(declared, kind)}
    return pytest.mark.parametrize("declared", result.values(), ids=result)


def _refusal(read, text):
    with pytest.raises(InputError) as refused:
        read(text)
    return refused.value.reason


@_of(BaseQuantity)
def test_a_bound_is_accepted_as_printed(declared):
    dimension, low, high = declared.dimension, *declared.limits
    if not dimension:
        for bound in declared.limits:
            assert declared.read(declared.show(bound, None)).value == bound
        return
    names = [(None, dimension)]
    if declared.alternative:
        names.append((declared.alternative.key, declared.alternative.dimension))
    for key, kind in names:
        for unit in DIMENSIONS[kind].units:
            message = _refusal(lambda text, key=key: declared.read(text, key), f"1e300 {unit}")
            printed = re.fullmatch(r".* (at least|more than) (.+) and (at most|less than) (.+)\.", message)
            assert printed, message
            for taken, text in (("at least", printed[2]), ("at most", printed[4])):
                assert taken in message
                assert low <= declared.read(text, key).value <= high


@_of(Axes)
def test_the_largest_size_on_an_axis_is_accepted_as_printed(declared):
    for unit in DIMENSIONS[declared.dimension].units:
        most = re.search(r"at most (.+) in size", _refusal(declared.read, f"1e300 {unit}"))[1]
        assert max(declared.read(most)) <= declared.limits[1]
        assert declared.read(f"-{most}")


@_of(Rows)
def test_the_bounds_of_a_row_are_accepted_as_printed(declared):
    amount = re.search(r"Hz (.+?)(;|$)", declared.example)[1]
    least, highest = re.search(r"from (.+) to (.+)\.$", _refusal(declared.read, f"1e20 Hz {amount}")).groups()
    for dimension in declared.dimensions:
        far = 3000 if DIMENSIONS[dimension].decibels else 1e300
        for unit in DIMENSIONS[dimension].units:
            message = _refusal(declared.read, f"{least} {far} {unit}; {highest} {far} {unit}")
            most = re.search(r"at most (.+)\.$", message)[1]
            assert declared.read(f"{least} {most}; {highest} {most}")


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("grazing", [35.123456, 61.0, 74.99995])
def test_the_largest_squint_is_accepted_as_printed(way, grazing):
    design = Design({"radar.grazing_angle": math.radians(grazing)})
    with pytest.raises(InputError) as refused:
        analyse(design.replace({"radar.squint_angle": way * math.radians(59.9)}))
    text = re.search(r"Enter at (?:most|least) (\S+°)", refused.value.reason)[1]
    squint = parts.declaration_of("radar.squint_angle").read(text).value
    assert math.degrees(abs(squint)) == pytest.approx(90 - grazing, abs=1e-3)
    analyse(design.replace({"radar.squint_angle": squint}))


def test_the_highest_rate_that_a_strategy_is_flown_at_is_accepted_as_printed():
    fast = Design({"imu.rate": 1e5})
    with pytest.raises(InputError) as refused:
        flight_of(fast, 1.0, 0.0)
    most = parts.declaration_of("imu.rate").read(re.search(r"at most (.+?),", refused.value.reason)[1])
    flight_of(fast.replace({"imu.rate": most.value}), 1.0, 0.0)


@pytest.mark.parametrize("kind", ["turns", "climb"])
def test_the_least_duration_of_a_trajectory_is_accepted_as_printed(kind):
    spec = TrajectorySpec(kind=kind, turn_rate=0.0731, climb_rate=7.3)
    with pytest.raises(InputError) as refused:
        plan_trajectory(spec, 10.0)
    plan_trajectory(spec, float(re.search(r"at least (\d+) s", refused.value.reason)[1]))

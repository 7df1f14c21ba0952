"""Designs and budgets between processes: equal after the journey, still immutable, and small."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.json import to_json
from nav_model.design import Design
from nav_model.design.file import format_design

pytestmark = pytest.mark.long

ORIGINS = {"imu.angle_random_walk": "static log bench.csv"}


def _same(first, second):
    assert first == second
    assert format_design(first) == format_design(second)  # units and origins too, which equality leaves out
    assert first.content_hash == second.content_hash


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_design_and_its_budget_come_back_equal(data, designs):
    design = data.draw(designs).replace({"name": "A"}, {"imu.angle_random_walk": "°/h/√Hz"}, ORIGINS)
    budget = analyse(design)
    for travelled in (pickle.loads(pickle.dumps(budget)), copy.deepcopy(budget)):
        _same(travelled.design, design)
        assert to_json(travelled) == to_json(budget)
        assert travelled.verdict == budget.verdict


def test_they_travel_to_a_spawned_process_and_back():
    design = Design({"name": "A", "requirements.tilt": 1e-3}, {"imu.angle_random_walk": "°/h/√Hz"}, ORIGINS)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        budget = pool.submit(analyse, design).result()
        document = pool.submit(to_json, budget).result()
    _same(budget.design, design)
    assert document == to_json(budget) == to_json(analyse(design))


def test_what_comes_back_is_as_immutable():
    budget = pickle.loads(pickle.dumps(analyse(Design(origins=ORIGINS))))
    design, coast = budget.design, budget.coast
    for mapping in (design.written, design.origins, budget.steady_state.prior, budget["tilt", "real time"].shares):
        with pytest.raises(TypeError):
            mapping["imu.rate"] = "forged"
    with pytest.raises(AttributeError):
        design.imu = None
    with pytest.raises(TypeError):
        design.imu.rate = 5.0
    curves = [value for value in vars(coast).values() if isinstance(value, np.ndarray)]
    assert len(curves) == 12
    for curve in curves:
        with pytest.raises(ValueError, match="read-only"):
            curve[0] = 1.0


def test_the_callers_times_stay_writable():
    times = np.array([0.0, 10.0])
    assert analyse(Design(), times).coast.time is not times
    times[0] = 1.0


def test_they_are_small():
    """Twelve curves of 300 points are 29 kB; a design's keys and values are some kilobytes."""
    design = Design()
    assert len(pickle.dumps(design)) < 5_000
    assert len(pickle.dumps(analyse(design))) < 12 * 300 * 8 + 10_000


def test_a_forged_pickle_is_checked_like_any_other_input():
    kind, (values, *others) = Design().__reduce__()
    with pytest.raises(InputError, match=r"imu\.rate"):
        kind({**values, "imu.rate": -1.0}, *others)

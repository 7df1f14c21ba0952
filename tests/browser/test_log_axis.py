"""The ticks of a logarithmic axis, run where they run: in the browser."""

import itertools
import math

import pytest
from bokeh.models import LogAxis
from bokeh.plotting import figure
from playwright.sync_api import Page

from app.charts.screen.axes import mark_in_powers

_RUN = "([code, start, end]) => new Function('cb_data', code)({start, end})"


_LOWS = (1e-9, 0.0113, 1.0, 7e5)
_DECADES = (0.01, 0.3, 0.79, 0.81, 1.5, 2.5, 2.7, 5.0, 9.0, 30.0)


@pytest.fixture
def axis() -> LogAxis:
    made = figure(y_axis_type="log").yaxis[0]
    mark_in_powers(made)
    return made


def test_an_axis_of_any_length_has_enough_ticks_and_not_too_many(page: Page, axis: LogAxis) -> None:
    for low, decades in itertools.product(_LOWS, _DECADES):
        high = low * 10**decades
        for start, end in ((low, high), (high, low)):
            ticks = page.evaluate(_RUN, [axis.ticker.major_code, start, end])
            assert 2 <= len(ticks) <= 11, (low, decades)
            assert ticks == sorted(set(ticks))
            assert all(low <= tick <= high for tick in ticks)
    for start, end in ((0.0, 1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, math.inf)):  # none can be logarithmic
        assert page.evaluate(_RUN, [axis.ticker.major_code, start, end]) == []


def test_labels(page: Page, axis: LogAxis) -> None:
    run = "([code, tick]) => new Function('tick', 'ticks', code)(tick, [tick])"
    labels = {
        0.1: "0.1", 100.0: "100", 1e-6: "10⁻⁶", 0.2: "0.2", 50.0: "50", 2e-5: "2·10⁻⁵", 2.34e7: "2.34·10⁷",
        1.25: "1.25",
    }  # fmt: skip
    assert {tick: page.evaluate(run, [axis.formatter.code, tick]) for tick in labels} == labels

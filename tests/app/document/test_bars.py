"""Pairs of bars as HTML."""

import re
from math import nan

import pytest

from app.charts.kinds import Bar, BarChart, RankBar, RankChart
from app.document.bars import bars_html, effects_html


def phases(total: float, limit: float) -> str:
    """A chart in radians whose total is the longer of two bars; only the first kind has values."""
    bars = (Bar("gyro noise", 0.3, nan, 1.0, nan, "[S-5]"), Bar("total", total, nan, 2.0, nan, "[S-5]", limited=True))
    return bars_html(BarChart("phase", "Phase", "phase [rad]", "quadratic", "residual", bars, limit, nan))


def test_a_number_begins_where_its_bar_ends_and_has_room_after_the_longest():
    html = phases(5.56, 1.57)
    ends = re.findall(r'<i style="width:([\d.]+%)"', html)
    assert re.findall(r'class="num" style="left:([^"]+)"', html) == ends
    assert ends[1] == f"{100 * 5.56 / 6:.2f}%"
    assert html.count("padding-right:62px") == 3  # "0.300 rad": the bars and the axis have one scale


def test_a_number_that_its_limits_line_would_run_through_is_after_the_line():
    assert 'class="num" style="left:100.00%"' in phases(2.5, 3.0)
    assert 'class="num" style="left:33.33%"' in phases(1.0, 3.0)


@pytest.mark.parametrize(
    ("total", "limit", "beside"), [(5.56, 1.5, "left:25.00%"), (1.0, 4.0, "right:calc(100% - 100.00%)")]
)
def test_a_limit_is_named_after_its_line_unless_that_is_near_the_end(total: float, limit: float, beside: str):
    assert f'<em style="{beside}">' in phases(total, limit)


def test_a_long_number_gets_the_room_it_takes():
    assert phases(12_300.0, 1.57).count("padding-right:64px") == 3  # "12300 rad"


def test_a_ranking_says_each_effect_and_hatches_what_is_doubled():
    speed = RankBar("2 × speed", 74.0, True, "Doubling & more", -1.0)
    noise = RankBar("½ × noise", 4.7, False, "Halving", 0.1)
    html = effects_html(RankChart("ranking", "What helps", "reduction [%]", (speed, noise), ""))
    first, second = re.findall(r"<tr.*?</tr>", html.partition("<tbody>")[2])
    for row, texts in (
        (first, ("2 × speed", "Doubling &amp; more", "74 %")),
        (second, ("½ × noise", "Halving", "4.7 %")),
    ):
        assert all(text in row for text in texts)
    assert ("doubled" in first, "doubled" in second) == (True, False)
    widths = [float(re.search(r"width:([\d.]+)%", row)[1]) for row in (first, second)]
    assert widths == [100.0, pytest.approx(100 * 4.7 / 74, abs=0.05)]

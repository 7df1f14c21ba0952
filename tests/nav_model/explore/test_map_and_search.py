"""Maps and the catalogue search against one analysis at a time."""

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design.catalogue import catalogue, read_catalogue
from nav_model.explore.margins import ALL
from nav_model.explore.search import OWN_GNSS, left_out, search
from nav_model.explore.trade_map import SIZE, changes_at, place, trade_map

ARW, VRW, GNSS = "imu.angle_random_walk", "imu.velocity_random_walk", "gnss.position_noise"
OWN = """
[[imu]]
name = "Ours"
angle_random_walk = { value = "0.01 °/√h", status = "confirmed", source = "our bench" }
velocity_random_walk = { value = "0.005 m/s/√h", status = "confirmed", source = "our bench" }
"""


def test_cells_are_analysed_designs(open_design):
    trade = trade_map(open_design, ARW, GNSS, size=7)
    for j in (0, 3, 6):
        for i in (0, 3, 6):
            verdict = analyse(open_design.replace({ARW: float(trade.x[i]), GNSS: float(trade.y[j])})).verdict
            assert trade.z[j, i] == pytest.approx(1 - verdict.tightest.margin, rel=1e-12)
    figure = trade_map(open_design, ARW, "coast.duration", "coast_horizontal_position", size=3)
    budget = analyse(open_design.replace({ARW: float(figure.x[2]), "coast.duration": float(figure.y[1])}))
    assert figure.z[1, 2] == pytest.approx(budget["coast_horizontal_position", "real time"].sigma, rel=1e-12)
    assert figure.limit == 50.0


def test_catalogue_points_are_judged_with_their_whole_sheet(open_design):
    trade = trade_map(open_design, ARW, VRW)
    assert len(trade.points) >= 12
    for point in trade.points:
        values = {f"imu.{name}": item.value for name, item in catalogue("imu")[point.name].values.items()}
        verdict = analyse(open_design.replace(values)).verdict
        assert point.met is verdict.closes
        assert point.value == pytest.approx(1 - verdict.tightest.margin, rel=1e-12)
        assert (point.x, point.y) == (values[ARW], values[VRW])


def test_the_cross_and_a_click(open_design):
    trade = trade_map(open_design, ARW, "radar.aperture_time", size=5)
    here = place(open_design, trade)
    assert here == (open_design[ARW], pytest.approx(analyse(open_design).sar.aperture_time))
    assert trade.x[0] < here[0] < trade.x[-1]
    assert trade.y[0] < here[1] < trade.y[-1]
    adopted = open_design.replace(changes_at(trade, 1e9, 2.0))
    assert adopted["radar.aperture_time"] == 2.0
    assert adopted[ARW] == pytest.approx(360 * np.pi / 180 / 60)


def test_a_slow_error_takes_the_same_grid(open_design):
    slow = open_design.replace({"gnss.correlated": True})
    trade = trade_map(slow, ARW, GNSS)
    assert trade.z.shape == (SIZE, SIZE)
    for j, i in ((0, 0), (19, 41), (SIZE - 1, SIZE - 1)):
        verdict = analyse(slow.replace({ARW: float(trade.x[i]), GNSS: float(trade.y[j])})).verdict
        assert trade.z[j, i] == pytest.approx(1 - verdict.tightest.margin, rel=1e-12)


@pytest.mark.parametrize(
    ("x", "y", "result", "message"),
    [
        (ARW, ARW, ALL, "both axes"),
        (ARW, "imu.bandwidth", ALL, "has none"),
        (ARW, "radar.window", ALL, "axis"),
        (ARW, GNSS, "weight", "Choose "),
    ],
)
def test_maps_that_make_no_sense(open_design, x, y, result, message):
    with pytest.raises(InputError, match=message):
        trade_map(open_design, x, y, result)


def test_search_rows_are_analysed_designs(open_design):
    ranking = search(open_design, catalogue("imu"), catalogue("gnss"))
    assert [row.margin for row in ranking] == sorted((row.margin for row in ranking), reverse=True)
    assert len(ranking) == (len(catalogue("imu")) - len(left_out(catalogue("imu")))) * (1 + len(catalogue("gnss")))
    for row in ranking:
        verdict = analyse(open_design.replace(row.changes)).verdict
        assert row.closes is verdict.closes
        assert row.margin == pytest.approx(verdict.tightest.margin, rel=1e-10)
        assert row.tightest == verdict.tightest.name
        assert row.margins[row.tightest] == row.margin
        if verdict.tightest.dominant_share > 0.6 and "phase" in row.tightest:
            assert row.dominant == verdict.tightest.dominant
            assert row.share == pytest.approx(verdict.tightest.dominant_share, abs=0.02)


def test_own_sensors_in_the_same_format(open_design):
    sensors = read_catalogue(OWN, "imu")
    row = next(r for r in search(open_design, sensors, {}) if r.gnss == OWN_GNSS)
    assert row.imu == "Ours"
    assert row.doubts == ()
    with pytest.raises(InputError, match="both random walks"):
        search(open_design, {"KVH": catalogue("imu")["KVH FOG (SPAN-CPT)"]}, {})


def test_a_pair_that_is_adopted_has_the_margin_it_was_ranked_by(open_design):
    few = {name: catalogue("imu")[name] for name in ("STIM300", "LN-200")}
    for base in ({}, {"gnss.baseline": 30e3, "gnss.correlated": True}):
        design = open_design.replace(base)
        for row in search(design, few, catalogue("gnss")):
            adopted = design.replace(row.changes, row.written)
            assert adopted.gnss.preset == (None if row.gnss == OWN_GNSS else row.gnss)
            margins = {check.name: check.margin for check in analyse(adopted).verdict.checks}
            assert row.margins == pytest.approx(margins, rel=1e-9)

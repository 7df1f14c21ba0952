"""The Sensors page without a browser: logs in, results and offers out, nothing lost on the way."""

import asyncio
import math
import re
from collections.abc import Iterator
from html import unescape

import numpy as np
import panel as pn
import pytest
from bench_log import ANGLE_WALK, VELOCITY_WALK, log, table
from bokeh.models import ColumnDataSource

from app.document.pane import html_of
from app.serving.server import first_design
from app.session import Session
from app.subjects.sensors.catalogue import catalogue_table
from app.subjects.sensors.charts import axis_chart, triad_chart
from app.subjects.sensors.page import SensorsPage
from app.subjects.sensors.tables import coefficient_tables, origin_answer
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_names import scale_of
from nav_model.allan.static_log import analyse_log
from nav_model.base.errors import InputError
from nav_model.design.catalogue import catalogue

pytestmark = pytest.mark.long


@pytest.fixture
def sensors() -> Iterator[SensorsPage]:
    made = SensorsPage(Session(first_design()))
    yield made
    made.log.close()


def test_a_log_at_rest_is_shown_and_taken_over(sensors: SensorsPage):
    panel = sensors.log
    session = panel.session
    asyncio.run(panel.take("bench.csv", log(6000)))
    assert "does not give the rate" in panel.run.message  # asked for, the upload is kept
    assert panel.boxes["rate"].error_state  # where it is to be mended
    assert "does not give the rate" in panel.boxes["rate"].helper_text
    assert not panel.boxes["gyro_unit"].error_state
    assert panel.static.analysis is None
    panel.boxes["rate"].value = "100 Hz"  # as the message says
    assert not panel.boxes["rate"].error_state
    asyncio.run(panel.analyse())
    analysis = panel.static.analysis
    assert panel.static.__panel__().visible
    assert not panel.message.visible
    assert not session.running
    assert "bench.csv" in panel.static.head.object
    for text in ("bench.csv", analysis.provenance.sha256, "100\xa0Hz"):
        assert text in panel.static.head.object + panel.static.tables.object
    assert "&lt; " in panel.static.tables.object  # a limit for what the log does not resolve
    assert "Which log would resolve the rest" in panel.static.tables.object
    before = session.budget
    panel.static.use.clicks += 1
    assert session.design.imu.angle_random_walk == pytest.approx(ANGLE_WALK, rel=0.03)
    assert session.design.imu.velocity_random_walk == pytest.approx(VELOCITY_WALK, rel=0.03)
    assert session.budget["quadratic_phase", "real time"].sigma != before["quadratic_phase", "real time"].sigma
    sensors.show(session.budget)
    assert "from static log bench.csv" in sensors._strip._text.object
    session.undo()
    assert session.design == before.design


def test_the_unit_of_a_log_is_chosen_and_may_be_of_counts(sensors: SensorsPage):
    panel = sensors.log
    asyncio.run(panel.take("bench.csv", log(6000)))
    panel.counts["gyro_unit"].value = "0.05"
    with pytest.raises(InputError, match="choose the unit"):
        panel._options()
    panel.boxes["gyro_unit"].value = "deg/s"
    panel.boxes["accelerometer_unit"].value = "mg"
    options = panel._options()
    assert scale_of("gyro", options.gyro_unit).factor == pytest.approx(math.radians(0.05))
    assert options.accelerometer_unit == "mg"


def test_the_sensor_of_a_log_with_several_is_chosen(sensors: SensorsPage):
    panel = sensors.log
    panel.boxes["rate"].value = "100"
    assert not panel.boxes["sensor"].visible
    header, *lines = log(3000).splitlines()
    both = [name + b"," + line for line in lines for name in (b"left", b"right")]
    asyncio.run(panel.take("both.csv", b"\n".join([b"device," + header, *both])))
    assert panel.static.analysis is None
    assert "tells 2 sensors apart: left and right" in panel.run.message
    assert panel.boxes["sensor"].visible
    assert panel.boxes["sensor"].error_state
    assert panel.boxes["sensor"].options == ["", "left", "right"]
    panel.boxes["sensor"].value = "right"
    asyncio.run(panel.analyse())
    assert panel.static.analysis.provenance.samples == 3000
    asyncio.run(panel.take("one.csv", log(3000)))  # the next file is asked anew
    assert not panel.boxes["sensor"].visible
    assert panel.static.analysis.provenance.file_name == "one.csv"


def test_the_bandwidth_of_a_low_pass_ends_the_fitted_band(sensors: SensorsPage):
    panel = sensors.log
    panel.boxes["rate"].value, panel.boxes["bandwidth"].value = "100", "wide"
    asyncio.run(panel.take("bench.csv", log(6000)))
    assert panel.boxes["bandwidth"].error_state
    assert panel.static.analysis is None
    for text, of_design, top in (("100", 200.0, 10.0), ("80 Hz", 200.0, 8.0), ("", 200.0, 20.0), ("", None, 50.0)):
        panel.session.change({"imu.bandwidth": of_design})
        panel.boxes["bandwidth"].value = text
        asyncio.run(panel.analyse())
        assert [axis.band_hz for axis in panel.static.analysis.axes] == pytest.approx([top] * 6)


def test_a_malformed_log_loses_nothing(sensors: SensorsPage):
    panel = sensors.log
    panel.boxes["rate"].value = "100"
    asyncio.run(panel.take("good.csv", log(6000)))
    head = panel.static.head.object
    asyncio.run(panel.take("bad.csv", log(6000).replace(b"\n", b"\n<script>,1,1,1,1,1\n", 2)))
    assert "bad.csv" in panel.run.message
    assert "&lt;script&gt;" not in panel.static.head.object
    assert "&lt;script&gt;" in panel.bar.state.object
    assert "<script>" not in panel.bar.state.object
    assert panel.static.head.object == head


def test_another_log_feeds_the_same_figures(sensors: SensorsPage):
    panel = sensors.log
    panel.boxes["rate"].value = "100"
    asyncio.run(panel.take("one.csv", log(6000)))
    plots = [pane.object for pane in panel.static._view.select(pn.pane.Bokeh)]
    assert len(plots) == 3
    curves = [curve for plot in plots for curve in plot.select({"type": ColumnDataSource})]
    old = [dict(curve.data) for curve in curves]
    asyncio.run(panel.take("two.csv", log(9000, 2.0, 2.0)))
    assert [pane.object for pane in panel.static._view.select(pn.pane.Bokeh)] == plots
    assert all(not np.array_equal(curve.data["x"], was["x"]) for curve, was in zip(curves, old, strict=True))


def test_a_log_in_motion_offers_a_qualified_factor(sensors: SensorsPage):
    panel = sensors.log
    session = panel.session
    session.change({"imu.angle_random_walk": ANGLE_WALK, "imu.velocity_random_walk": VELOCITY_WALK})
    panel.boxes["rate"].value, panel.motion.value = "100", "motion"
    asyncio.run(panel.take("drive.csv", log(6000, 3.0, 3.0)))
    assert "as white noise" in panel.moving.head.object
    panel.moving.use.clicks += 1
    assert session.design.imu.vibration_factor == pytest.approx(3.0, rel=0.05)
    panel.moving.spectrum.clicks += 1
    assert session.design.motion.spectrum == panel.moving.analysis.spectrum != ()
    session.change({"imu.angle_random_walk": 0.5 * ANGLE_WALK})
    sensors.show(session.budget)
    result = panel.moving.analysis
    assert result.gyro_factor == pytest.approx(6.0, rel=0.05)
    assert f"Vibration factor {result.gyro_factor:.3g}" in panel.moving.head.object  # it follows the design
    assert f"{result.axes[0].factor:.3g}</td>" in panel.moving.table.object
    panel.moving.use.clicks += 1
    assert session.design.imu.vibration_factor == pytest.approx(6.0, rel=0.05)


def test_catalogue_marks_what_is_not_confirmed():
    for kind in ("imu", "radar"):
        html = html_of(catalogue_table(kind, "STIM300"))
        rows = re.findall(r"<tr><th scope=\"row\".*?</tr>", html)
        assert len(rows) == len(catalogue(kind))
        for row, entry in zip(rows, catalogue(kind).values(), strict=True):
            cells = re.findall(r'<td class="num.*?</td>', row)
            doubtful = [item for item in (*entry.values.values(), *entry.extra.values()) if not item.confirmed]
            assert sum("⚠" in cell for cell in cells) == len(doubtful)
            assert all(item.source in unescape(row).replace("\xa0", " ") for item in entry.values.values())
    assert "● in the design" in html_of(catalogue_table("imu", "STIM300"))


def test_origin_says_catalogue_hand_or_log():
    design = first_design()
    by_hand = design.replace({"imu.angle_random_walk": 1e-5, "imu.vibration_factor": 2.0})
    walk, _, factor = origin_answer(design).sentences
    assert (walk.rpartition(": ")[2], factor.partition(": ")[2]) == (
        "catalogue, STIM300 ⚠ secondary source.", "bench value; a log in motion gives a better one.",
    )  # fmt: skip
    assert [text.rpartition(": ")[2] for text in origin_answer(by_hand).sentences[::2]] == ["set by hand."] * 2


def test_charts_carry_confidence_and_fit():
    rates, forces = np.hsplit(table(6000), 2)
    analysis = analyse_log(ImuLog(rates, forces, 100.0))
    for quantity, truth in (("gyro", 0.3 * 60.0), ("accelerometer", VELOCITY_WALK / 9.80665e-6)):
        chart = triad_chart(analysis, quantity)
        assert len(chart.bands) == 3
        fitted = next(line for line in chart.lines if line.key == "fx")
        # White noise alone: the fitted line at 1 s is the random walk, in °/h and µg.
        assert np.interp(1.0, fitted.x, fitted.y) == pytest.approx(truth, rel=0.04)
    single = axis_chart(analysis, "gyro_x")
    assert np.isnan(next(line for line in single.lines if line.key == "ramp").y).all()
    assert single.knowledge.startswith("Gyro x. ")
    assert "ramp" in single.knowledge
    assert "95\xa0% confidence" not in html_of(*coefficient_tables(analysis))


def test_a_reading_at_1_s_stands_beside_its_white_floor():
    """A line at 0.6 Hz, as a real accelerometer log has it: both figures on the page, each under its name."""
    noise = np.random.default_rng(5).standard_normal((60_000, 3)) * 1e-2
    sway = 2e-3 * np.sin(2 * np.pi * 0.6 * np.arange(60_000) / 100.0)
    result = analyse_log(ImuLog(None, noise + sway[:, None] + [0, 0, 9.8], 100.0))
    cells = unescape(html_of(*coefficient_tables(result)))
    for axis in result.axes:
        walk = axis.coefficients["random_walk"]
        assert walk.reading
        assert axis.white_floor < walk.value
        for value in (f"{60 * walk.value:.3g}", f"{60 * axis.white_floor:.3g}"):
            assert value in cells
    assert "read at 1\xa0s; white-noise floor" in cells
    assert "not a confidence interval" in cells


def test_rows_of_a_data_sheet_are_filled_in(sensors: SensorsPage):
    box, session = sensors.sheet, sensors.session
    box.rows.value = "Angle random walk 0.15 °/√h, bias instability (3σ) 0.3 °/h; <b>scale</b> factor 100 ppm"
    box.fill.clicks += 1
    assert session.design.imu.angle_random_walk == pytest.approx(math.radians(0.15) / 60)
    assert session.design.gyro.bias_instability == pytest.approx(math.radians(0.1) / 3600)
    assert session.design.origins["imu.angle_random_walk"] == "data sheet: Angle random walk 0.15 °/√h"
    text = " ".join(unescape(re.sub("<[^>]+>", " ", box.answer.object)).split())
    assert "0.3 °/h 3σ 0.1 °/h bias instability (3σ) 0.3 °/h" in text
    assert "<b>scale</b> factor 100 ppm: not known" in text
    assert "<b>" not in box.answer.object
    session.undo()
    box.rows.value = "nothing of use"
    budget = session.budget
    box.fill.clicks += 1
    assert session.budget is budget
    assert "Not understood" in box.answer.object

"""The whole sheet of a catalogue's unit in a design: in a file, a link, a search, and with another unit."""

import math

import pytest

from nav_model.base.constants import DEGREE_PER_HOUR, MILLI_G
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.presets import SHEET_KEYS
from nav_model.explore.search import search

HG1700 = {"gyro.turn_on_bias": DEGREE_PER_HOUR, "accelerometer.turn_on_bias": MILLI_G}
STIM300 = '[imu]\npreset = "STIM300"\nsheet = true\n[requirements]\nhorizontal_position = "2 m"\n'


def printed(design: Design) -> dict[str, float]:
    """Values of the sensors beside their defaults."""
    plain = Design()
    return {key: design[key] for key in SHEET_KEYS if design[key] != plain[key]}


def test_a_sheet_fills_what_it_prints_with_its_source_and_what_it_does_not_print_is_nothing() -> None:
    """As TS1524 has it: 0.5 °/h and 0.05 mg in run; the correlation time is assumed."""
    design = parse_design(STIM300)
    assert printed(design) == pytest.approx(
        {
            "gyro.bias_instability": 0.5 * DEGREE_PER_HOUR,
            "gyro.correlation_time": 300.0,
            "accelerometer.bias_instability": 0.05 * MILLI_G,
            "accelerometer.correlation_time": 300.0,
        }
    )
    assert "TS1524" in design.origins["gyro.bias_instability"]
    assert design.origins["gyro.correlation_time"].endswith("(assumed)")
    assert printed(parse_design(STIM300.replace("sheet = true", "sheet = false"))) == {}
    laser = parse_design(STIM300.replace("STIM300", "HG1700"))
    assert printed(laser) == pytest.approx(
        {"gyro.turn_on_bias": DEGREE_PER_HOUR, "accelerometer.turn_on_bias": MILLI_G}
    )
    navigation = parse_design(STIM300.replace("STIM300", "LN-100"))
    assert navigation.accelerometer.correlation_time == 3600.0


def test_it_is_kept_in_files_and_links_and_a_given_value_stands_above_it() -> None:
    overridden = parse_design(f'{STIM300}[gyro]\nbias_instability = "2 °/h"\n')
    assert overridden.gyro.bias_instability == pytest.approx(2 * DEGREE_PER_HOUR)
    assert "gyro.bias_instability" not in overridden.origins
    for design in (parse_design(STIM300), overridden):
        assert parse_design(format_design(design)) == design == from_query(to_query(design))
        assert parse_design(format_design(design)).origins == design.origins
    assert "gbi=" not in to_query(parse_design(STIM300)).split("origin.")[0]


def test_another_unit_brings_its_own_sheet() -> None:
    moved = parse_design(format_design(parse_design(STIM300)), changes=["imu.preset=HG1700"])
    assert printed(moved) == pytest.approx(
        {"gyro.turn_on_bias": DEGREE_PER_HOUR, "accelerometer.turn_on_bias": MILLI_G}
    )
    assert set(moved.origins) == {"gyro.turn_on_bias", "accelerometer.turn_on_bias"}


@pytest.mark.parametrize("whole", [False, True])
def test_a_search_takes_each_unit_with_its_sheet_where_it_is_asked_or_the_design_does(whole: bool) -> None:
    design = parse_design(STIM300 if whole else STIM300.replace("sheet = true", "sheet = false"))
    rows = {row.imu: row for row in search(design, catalogue("imu"), {}, "design" if whole else "sheet")}
    assert rows["HG1700"].changes["gyro.turn_on_bias"] == pytest.approx(DEGREE_PER_HOUR)
    assert rows["HG1700"].changes["gyro.bias_instability"] == 0.0
    taken = design.replace(rows["ADIS16488"].changes, rows["ADIS16488"].written)
    assert taken.imu.sheet
    assert taken.gyro.bias_instability == pytest.approx(6.5 * DEGREE_PER_HOUR)
    assert any("gyro bias instability (secondary)" in doubt for doubt in rows["STIM300"].doubts)
    assert math.isfinite(rows["STIM300"].margin)

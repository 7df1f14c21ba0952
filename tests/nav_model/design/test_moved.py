"""Inputs that have another key than when designs were saved: files and commands of before, and hashes."""

import pytest

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query

OF_BEFORE = """
[motion]
lines = [{frequency = "20 Hz", amplitude = "0.1 g"}]
imu_bandwidth = "200 Hz"
delay = "2 ms"
[origins]
"motion.imu_bandwidth" = "sheet"
"""


def test_a_bandwidth_among_the_vibration_is_the_unit_s():
    design = parse_design(OF_BEFORE)
    assert design.imu.bandwidth == 200.0
    assert design.origins == {"imu.bandwidth": "sheet"}
    # as saved before the input moved
    assert design.content_hash == "4e3a4b226ec5439602ae59bb89744424c09084bdc13275141d35e029de3f9e6c"
    assert "imu_bandwidth" not in format_design(design)
    assert parse_design(format_design(design)) == design
    assert parse_design("name = 'x'", changes=["motion.imu_bandwidth=47 Hz"]).imu.bandwidth == 47.0
    assert parse_design(OF_BEFORE, changes=["motion.imu_bandwidth=47 Hz"]).imu.bandwidth == 47.0
    assert from_query("bw=47Hz").imu.bandwidth == 47.0


def test_under_both_keys_it_is_refused():
    with pytest.raises(InputError, match=r"means the same as imu\.bandwidth"):
        parse_design('[imu]\nbandwidth = "100 Hz"\n' + OF_BEFORE)


def test_a_hash_has_it_once_where_it_was():
    assert Design({"imu.bandwidth": 1.0}).content_hash != Design({"imu.bandwidth": 2.0}).content_hash

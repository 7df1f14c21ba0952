"""Where a value came from: in the file, in a link, through changes, and as files of before told it."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.parts import LONGEST_ORIGIN

ARW, RATE = "imu.angle_random_walk", "imu.rate"
LOG = 'rms of gyro x, y, z (0.11 to 0.13, 95 %), from static log "bench 7.csv" & more = öß'
HALF = 0.5 * math.pi / 180 / 60  # 0.5 °/√h


def test_file_and_link_carry_it():
    design = Design({ARW: HALF, RATE: 250.0}, {ARW: "°/√h"}, {ARW: LOG, RATE: "data sheet, page 3"})
    text = format_design(design)
    assert text.endswith(
        "[origins]\n"
        "\"imu.angle_random_walk\" = \"rms of gyro x, y, z (0.11 to 0.13, 95 %), from static log "
        "\\\"bench 7.csv\\\" & more = öß\"\n"
        "\"imu.rate\" = \"data sheet, page 3\"\n"
    )  # fmt: skip
    for back in (parse_design(text), from_query(to_query(design))):
        assert back == design
        assert back.origins == design.origins == {ARW: LOG, RATE: "data sheet, page 3"}
    assert "origin.fs=data+sheet" in to_query(design)
    assert "[origins]" not in format_design(Design({ARW: HALF}))


def test_a_value_that_changes_loses_it():
    design = Design({ARW: HALF, RATE: 250.0}, origins={ARW: LOG, RATE: "data sheet"})
    assert design.replace({ARW: 2 * HALF}).origins == {RATE: "data sheet"}
    assert design.replace({ARW: HALF, "name": "b"}).origins == design.origins
    assert design.replace({ARW: 2 * HALF}, origins={ARW: "another log"}).origins[ARW] == "another log"
    assert design.origins[ARW] == LOG
    text = format_design(design)
    assert parse_design(text, changes=["imu.angle_random_walk=0.7 °/√h"]).origins == {RATE: "data sheet"}
    assert ARW not in parse_design(text, changes=["imu.preset=ADIS16495-1"]).origins


def test_it_is_no_part_of_the_identity():
    plain, noted = Design({ARW: HALF}), Design({ARW: HALF}, origins={ARW: LOG})
    assert plain == noted
    assert hash(plain) == hash(noted)
    assert plain.content_hash == noted.content_hash
    with pytest.raises(TypeError):
        noted.origins[ARW] = "forged"


@pytest.mark.parametrize(
    ("origins", "key"),
    [
        ({"imu.bogus": "log"}, "origins.imu.bogus"),
        ({"name": "log"}, "origins.name"),
        ({ARW: ""}, f"origins.{ARW}"),
        ({ARW: " "}, f"origins.{ARW}"),
        ({ARW: "two\nlines"}, f"origins.{ARW}"),
        ({ARW: "two\u2028lines"}, f"origins.{ARW}"),
        ({ARW: 3}, f"origins.{ARW}"),
        ({ARW: "x" * (LONGEST_ORIGIN + 1)}, f"origins.{ARW}"),
    ],
)
def test_what_is_no_origin_is_refused_by_its_key(origins, key):
    for make in (lambda: Design({}, {}, origins), lambda: Design().replace({}, origins=origins)):
        with pytest.raises(InputError) as caught:
            make()
        assert caught.value.key == key
    assert Design(origins={ARW: "x" * LONGEST_ORIGIN}).origins


def test_a_wrong_table_of_origins_in_a_file():
    for text, key in (
        ("origins = 3", "origins"),
        ('[origins]\n"imu.bogus" = "log"', "origins.imu.bogus"),
        ('[origins]\n"imu.rate" = 3', "origins.imu.rate"),
        ('[origins.imu]\nrate = "log"', "origins.imu"),
    ):
        with pytest.raises(InputError) as caught:
            parse_design(text)
        assert caught.value.key == key
    with pytest.raises(InputError, match="line of text"):
        from_query("origin.arw=")
    with pytest.raises(InputError, match="unknown in a link"):
        from_query("origin.bogus=log")


BEFORE = """
description = '''
survey pod
imu.angle_random_walk = 0.5 °/√h: rms of gyro x, y, z, from static log bench.csv
imu.rate = 100 Hz: the sheet of another unit
imu.velocity_random_walk = nonsense: no quantity
gnss.bogus = 1 m: no key
coast.duration = 100 s
imu.angle_random_walk = 0.5 °/√h: a second line'''
[imu]
angle_random_walk = "30 °/h/√Hz"
rate = "250 Hz"
"""


def test_a_file_of_before_told_it_in_its_description():
    """A line counts while it quotes the value the design has, in whatever unit; the description stays as it is."""
    design = parse_design(BEFORE)
    assert design.origins == {ARW: "rms of gyro x, y, z, from static log bench.csv"}
    assert design.description.startswith("survey pod\nimu.angle_random_walk = 0.5")
    assert from_query(to_query(Design(dict(design.items())))).origins == design.origins
    assert parse_design(format_design(design)).origins == design.origins
    assert parse_design(BEFORE, changes=["imu.angle_random_walk=0.6 °/√h"]).origins == {}
    assert parse_design(BEFORE + '[origins]\n"imu.rate" = "log"').origins == {RATE: "log"}


def test_an_unknown_key_is_told_without_all_the_others():
    for read, text in ((from_query, "bogus=1"), (parse_design, '[origins]\n"bogus" = "log"')):
        with pytest.raises(InputError, match="bogus: unknown") as refused:
            read(text)
        assert len(str(refused.value)) < 150

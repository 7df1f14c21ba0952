"""Links: a design survives the address bar, and a forged address is refused by name."""

import string

import pytest
from design_tables import any_design
from hypothesis import given, settings

from nav_model.base.errors import InputError
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.design.link import from_query, to_query


@pytest.mark.long
@settings(max_examples=60)
@given(any_design())
def test_round_trip(design: Design) -> None:
    assert from_query(to_query(design)) == design


def test_a_link_is_short() -> None:
    arw = parse_quantity("0.3 °/√h", "angle random walk").value
    query = to_query(Design({"imu.angle_random_walk": arw, "radar.frequency": 1.3e9}))
    assert query == "arw=0.3deg/sqrt(h)&f=1.3GHz"
    assert to_query(Design()) == ""


def test_a_link_needs_no_escaping_beyond_letters_and_marks_of_an_address() -> None:
    query = to_query(Design({"imu.velocity_random_walk": 1e-3}, {"imu.velocity_random_walk": "µg/√Hz"}))
    assert set(query) <= set(string.ascii_letters + string.digits + "=&+%()/^-._:")


@pytest.mark.parametrize(
    ("query", "named"),
    [
        ("arw=5kg", "imu.angle_random_walk"),
        ("arw=-1deg/sqrt(h)", "imu.angle_random_walk"),
        ("arw=nan", "imu.angle_random_walk"),
        ("arw=0.1deg/sqrt(h)&arw=0.2deg/sqrt(h)", "arw"),
        ("bogus=1", "bogus"),
        ("imu=Nonesuch", "imu.preset"),
        ("win=square", "radar.window"),
        ("af=9", "radar.autofocus_order"),
        ("f=none", "radar.frequency"),
        ("k=lots", "requirements.confidence"),
        ("arw", "link"),
        ("&&", "link"),
        ("name=%ff", "link"),
        ("name=" + "x" * 20_000, "link"),
    ],
)
def test_a_forged_link_is_refused_by_name(query: str, named: str) -> None:
    with pytest.raises(InputError) as caught:
        from_query(query)
    assert caught.value.key == named

"""Links: a design survives the address bar, and a forged address is refused by name."""

import string
from typing import Any

import pytest
from design_tables import rows_of
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.units import parse_quantity
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import BaseQuantity
from nav_model.design.link import from_query, to_query
from nav_model.design.parts import INPUTS
from nav_model.design.presets import preset_fill
from nav_model.design.table import Table


@st.composite
def designs(draw: st.DrawFn) -> Design:
    values: dict[str, Any] = {"name": draw(st.text(max_size=30)), "description": draw(st.text(max_size=30))}
    written: dict[str, str] = {}
    for section in ("imu", "radar"):
        names = [n for n, e in catalogue(section).items() if section == "radar" or len(e.values) == 2]
        if name := draw(st.none() | st.sampled_from(names)):
            values |= preset_fill(section, name)[0]
    for section, inputs in INPUTS.items():
        for name, declaration in inputs.items():
            if not draw(st.booleans()):
                continue
            key = f"{section}.{name}"
            if isinstance(declaration, BaseQuantity):
                low, high = declaration.limits
                include_low, include_high = declaration.inclusive_bounds
                values[key] = draw(st.floats(low, high, exclude_min=not include_low, exclude_max=not include_high))
                if declaration.dimension:
                    written[key] = draw(st.sampled_from(list(DIMENSIONS[declaration.dimension].units)))
            else:
                table = isinstance(declaration, Table)
                values[key] = draw(rows_of(declaration, 9) if table else st.sampled_from(declaration.objects))
    return Design(values, written)


@settings(max_examples=60)
@given(designs())
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

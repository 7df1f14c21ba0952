"""Offers: what a catalogue file may say of price, mass and power, and the order that comes of it."""

import pytest

from nav_model import read_design
from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry, read_catalogue
from nav_model.explore.search import search

_UNIT = """
[[imu]]
name = "{name}"
angle_random_walk = {{ value = "{arw} °/√h", status = "confirmed", source = "sheet" }}
velocity_random_walk = {{ value = "0.03 m/s/√h", status = "confirmed", source = "sheet" }}
{more}
"""


def field(key: str, value: str) -> str:
    return f'{key} = {{ value = "{value}", status = "confirmed", source = "offer 7" }}'


def offer(name: str, arw: float, *more: str) -> dict[str, Entry]:
    return dict(read_catalogue(_UNIT.format(name=name, arw=arw, more="\n".join(more)), "imu"))


def test_the_cheapest_that_passes_is_first_and_a_cheap_failure_is_not() -> None:
    design = read_design("examples/tactical_x_band.toml")
    imus = {
        **offer("best", 0.001, field("price", "90000 EUR"), field("mass", "2 kg")),
        **offer("good", 0.01, field("price", "8 kEUR"), field("mass", "300 g"), field("power", "900 mW")),
        **offer("no price", 0.005),
        **offer("bad", 5.0, field("price", "10 EUR")),
    }
    rows = search(design, imus, {})
    assert [row.imu for row in rows] == ["good", "best", "no price", "bad"]
    assert [row.closes for row in rows] == [True, True, True, False]
    first = rows[0]
    assert (first.price, first.currency, first.mass, first.power) == (8000.0, "EUR", pytest.approx(0.3), 0.9)
    assert rows[2].price is None
    assert rows[1].mass == 2.0
    assert rows[1].power is None


def test_a_pair_costs_both_or_is_not_priced() -> None:
    receivers = read_catalogue(
        '[[gnss]]\nname = "rx"\nposition_noise = { value = "1 m", status = "assumed", source = "s" }\n'
        + field("price", "500 EUR"),
        "gnss",
    )
    imus = {**offer("priced", 0.01, field("price", "1000 EUR")), **offer("free", 0.01)}
    rows = {row.pair: row for row in search(read_design("examples/tactical_x_band.toml"), imus, receivers)}
    assert rows["priced with rx"].price == 1500.0
    assert rows["free with rx"].price is None
    assert rows["priced with your receiver"].price == 1000.0


@pytest.mark.parametrize(
    ("key", "value"),
    [("price", "4200"), ("price", "4200 euro"), ("price", "EUR"), ("price", "-3 EUR"), ("mass", "55"),
     ("mass", "55 m"), ("power", "1.5"), ("power", "1,5 W"), ("power", "nan W")],
)  # fmt: skip
def test_an_offer_without_a_unit_or_with_a_bad_one_is_refused_by_name(key: str, value: str) -> None:
    with pytest.raises(InputError) as refused:
        offer("Our unit", 0.1, field(key, value))
    assert refused.value.key == f"imu.Our unit.{key}"


def test_an_offer_without_a_source_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="has no source"):
        offer("Our unit", 0.1, 'price = { value = "1 EUR", status = "confirmed", source = "" }')


def test_prices_in_two_currencies_are_refused_by_name() -> None:
    imus = {**offer("one", 0.1, field("price", "1 EUR")), **offer("other", 0.1, field("price", "1 USD"))}
    with pytest.raises(InputError) as refused:
        search(read_design("examples/tactical_x_band.toml"), imus, {})
    assert refused.value.key == "other.price"

"""Offers that the library keeps."""

import pytest
from sqlalchemy import text

from app.library.offers import keep_offers, library_files, remove_offers
from app.library.store import Library
from nav_model.base.errors import InputError
from nav_model.design.offers import merged_offers

_OFFER = """
[[imu]]
name = "Unit"
angle_random_walk = {{ value = "0.1 °/√h", status = "confirmed", source = "sheet" }}
price = {{ value = "{price}", status = "confirmed", source = "offer" }}
"""


def _file(unit: str = "Unit", price: str = "10 EUR") -> str:
    return _OFFER.format(price=price).replace("Unit", unit)


def test_a_file_is_kept_and_one_of_the_same_name_replaces_it(library: Library) -> None:
    assert library_files(library) == []
    for price in ("10 EUR", "20 EUR"):
        keep_offers(library, "spring.toml", _file(price=price))
    keep_offers(library, "other.toml", _file("Other", "30 EUR"))
    assert library_files(library) == [
        ("spring.toml", _file(price="20 EUR")),
        ("other.toml", _file("Other", "30 EUR")),
    ]
    remove_offers(library, "spring.toml")
    assert [name for name, _ in library_files(library)] == ["other.toml"]


def test_offers_merge_by_name_and_damaged_files_are_named(library: Library) -> None:
    for name, unit, price in (("a", "Unit", "10 EUR"), ("b", "Unit", "20 EUR"), ("c", "Other", "30 EUR")):
        keep_offers(library, name, _file(unit, price))
    with library.write() as connection:
        connection.execute(text("UPDATE offers SET text = x'ff' WHERE name = 'c'"))
    offers, damaged, repeated = merged_offers(library_files(library))
    prices = {name: entry.offer["price"].value for name, entry in offers["imu"].items()}
    assert (prices, damaged, repeated) == ({"Unit": 20.0}, ("c",), ("Unit",))


@pytest.mark.parametrize("content", ["", _OFFER.format(price="10"), "[[imu"])
def test_what_is_no_file_of_offers_is_not_kept(library: Library, content: str) -> None:
    with pytest.raises(InputError):
        keep_offers(library, "bad.toml", content)
    assert not library_files(library)


def test_all_files_together_have_a_bound_and_a_refusal_loses_nothing(library: Library) -> None:
    padded = _file() + "#" * 600_000
    keep_offers(library, "large.toml", padded)
    with pytest.raises(InputError, match="1,000,000 characters together at most; remove one first"):
        keep_offers(library, "second.toml", _file("Second") + "#" * 400_000)
    keep_offers(library, "second.toml", _file("Second") + "#" * 300_000)
    keep_offers(library, "large.toml", padded + "#" * 50_000)  # in its own place
    with pytest.raises(InputError, match="remove one first"):
        keep_offers(library, "large.toml", padded + "#" * 150_000)
    sizes = {name: len(content) for name, content in library_files(library)}
    assert sizes["large.toml"] == len(padded) + 50_000

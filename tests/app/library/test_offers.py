"""Offers that the library keeps."""

import pytest
from sqlalchemy import text

from app.library.offers import keep_offers, kept_offers
from app.library.store import Library
from nav_model.base.errors import InputError

_OFFER = """
[[imu]]
name = "Unit"
angle_random_walk = {{ value = "0.1 °/√h", status = "confirmed", source = "sheet" }}
price = {{ value = "{price}", status = "confirmed", source = "offer" }}
"""


def test_a_file_is_kept_and_one_of_the_same_name_replaces_it(library: Library) -> None:
    assert not any(kept_offers(library)[0].values())
    for price in ("10 EUR", "20 EUR"):
        keep_offers(library, "spring.toml", _OFFER.format(price=price))
    keep_offers(library, "other.toml", _OFFER.format(price="30 EUR").replace("Unit", "Other"))
    imus = kept_offers(library)[0]["imu"]
    assert {name: entry.offer["price"].value for name, entry in imus.items()} == {"Unit": 20.0, "Other": 30.0}
    with library.write() as connection:
        connection.execute(text("UPDATE offers SET text = x'ff' WHERE name = 'spring.toml'"))
    found, damaged = kept_offers(library)
    assert (set(found["imu"]), damaged) == ({"Other"}, ("spring.toml",))


@pytest.mark.parametrize("content", ["", _OFFER.format(price="10"), "[[imu"])
def test_what_is_no_file_of_offers_is_not_kept(library: Library, content: str) -> None:
    with pytest.raises(InputError):
        keep_offers(library, "bad.toml", content)
    assert not any(kept_offers(library)[0].values())

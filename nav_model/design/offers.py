"""Files of offers: units and receivers of a user's own, with price, mass and power."""

from collections.abc import Iterable, Mapping

from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry, Kind, catalogue, read_catalogue

KINDS: tuple[Kind, ...] = ("imu", "gnss")

Offers = Mapping[Kind, Mapping[str, Entry]]


def read_offers(content: str) -> Offers:
    """The units and receivers of a file.

    Raises
    ------
    InputError
        Naming the entry and the key that is wrong, a name that the product's catalogue has, or if the file has no
        entry.
    """
    offers = {kind: read_catalogue(content, kind) for kind in KINDS}
    if not any(offers.values()):
        raise InputError("file", "has neither [[imu]] nor [[gnss]] entries; see the example file")
    for kind, entries in offers.items():
        not_of_the_product(kind, entries)
    return offers


def not_of_the_product(kind: Kind, names: Iterable[str]) -> None:
    """Refuse a name that would be mistaken for a unit of the product's catalogue.

    Raises
    ------
    InputError
        Naming it.
    """
    shipped = {name.casefold() for name in catalogue(kind)}
    for name in names:
        if name.casefold() in shipped:
            raise InputError(f"{kind}.{name}", "is the name of a unit of the product's catalogue; give it another")


def merged_offers(files: Iterable[tuple[str, str]]) -> tuple[Offers, tuple[str, ...], tuple[str, ...]]:
    """All offers of files (name, content), of one name the unit of the last file; names of the files that cannot be
    read, and of the units that are in several."""
    merged: dict[Kind, dict[str, Entry]] = {kind: {} for kind in KINDS}
    damaged, repeated = [], []
    for file, content in files:
        try:
            offers = read_offers(content)
        except InputError:
            damaged.append(file)
            continue
        for kind, entries in offers.items():
            repeated += [name for name in entries if name in merged[kind]]
            merged[kind] |= entries
    return merged, tuple(damaged), tuple(dict.fromkeys(repeated))

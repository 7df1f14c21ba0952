"""Files of offers: units and receivers of a user's own, with price, mass and power."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry, Kind, catalogue, read_catalogue

KINDS: tuple[Kind, ...] = ("imu", "gnss")
_OFFER = " (offer)"

Offers = Mapping[Kind, Mapping[str, Entry]]


def read_offers(content: str) -> Offers:
    """The units and receivers of a file.

    Raises
    ------
    InputError
        Naming the entry and the key that is wrong, or if the file has no entry.
    """
    offers = {kind: offered(content, kind) for kind in KINDS}
    if not any(offers.values()):
        raise InputError("file", "has neither [[imu]] nor [[gnss]] entries; see the example file")
    return offers


def offered(content: str, kind: Kind) -> Mapping[str, Entry]:
    """The entries of a file of one kind; of a name that the product's catalogue has, it is called "RTK (offer)".

    Raises
    ------
    InputError
        As `read_catalogue`, or where that is the name of another.
    """
    entries, shipped = read_catalogue(content, kind), {name.casefold() for name in catalogue(kind)}
    apart: dict[str, Entry] = {}
    for name, entry in entries.items():
        if name.casefold() in shipped:
            name += _OFFER
            if name in entries:
                raise InputError(f"{kind}.{name}", "is what another is called: its name is of the catalogue")
        apart[name] = replace(entry, name=name)
    return apart


def named_apart(names: Iterable[str]) -> str:
    """A sentence with those of the names that `offered` gave; empty where none."""
    apart = [name for name in names if name.endswith(_OFFER)]
    has = ", ".join(name.removesuffix(_OFFER) for name in apart)
    return f"The product's catalogue has {has}; yours: {', '.join(apart)}." if apart else ""


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

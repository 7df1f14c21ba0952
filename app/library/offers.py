"""Files of offers in the library: catalogue files of units with price, mass and power, by name."""

from collections.abc import Mapping

from sqlalchemy import text

from app.library.store import Library, insert, now
from nav_model.base.errors import InputError
from nav_model.design.catalogue import Entry, Kind, read_catalogue

KINDS: tuple[Kind, ...] = ("imu", "gnss")

_LONGEST_NAME = 100

Offers = Mapping[Kind, Mapping[str, Entry]]


def read_offers(content: str) -> Offers:
    """The units and receivers of a file.

    Raises
    ------
    InputError
        Naming the entry and the key that is wrong, or if the file has no entry.
    """
    found = {kind: read_catalogue(content, kind) for kind in KINDS}
    if not any(found.values()):
        raise InputError("file", "has neither [[imu]] nor [[gnss]] entries; see the example file")
    return found


def keep_offers(library: Library, name: str, content: str) -> None:
    """Keep a file, in place of one of the same name.

    Raises
    ------
    InputError
        As `read_offers`, or if the library does not confirm it.
    """
    read_offers(content)
    with library.write() as connection:
        connection.execute(text("DELETE FROM offers WHERE name = :name"), {"name": name[:_LONGEST_NAME]})
        insert(connection, "offers", {"name": name[:_LONGEST_NAME], "kept": now(), "text": content})


def kept_offers(library: Library) -> tuple[Offers, tuple[str, ...]]:
    """All that is kept, of one name the unit that was kept last; and the files that cannot be read any more."""
    with library.read() as connection:
        rows = connection.execute(text("SELECT name, text FROM offers ORDER BY kept, name")).all()
    found: dict[Kind, dict[str, Entry]] = {kind: {} for kind in KINDS}
    damaged = []
    for name, content in rows:
        try:
            for kind, entries in read_offers(content).items():
                found[kind] |= entries
        except InputError:
            damaged.append(name)
    return found, tuple(damaged)

"""Files of offers in the library: catalogue files of units with price, mass and power, by name."""

from sqlalchemy import text

from app.library.store import Library, insert, now
from nav_model.base.errors import InputError
from nav_model.design.offers import read_offers

_LONGEST_NAME = 100
_MOST = 1_000_000  # characters of all files: who asks for the offers reads them all


def keep_offers(library: Library, name: str, content: str) -> None:
    """Keep a file, in place of one of the same name.

    Raises
    ------
    InputError
        As `read_offers`, where the files become too many, or if the library does not confirm it.
    """
    read_offers(content)
    name = name[:_LONGEST_NAME]
    with library.write() as connection:
        connection.execute(text("DELETE FROM offers WHERE name = :name"), {"name": name})
        others = connection.execute(text("SELECT SUM(LENGTH(text)) FROM offers")).scalar() or 0
        if int(others) + len(content) > _MOST:
            reason = f"keeps files of offers of {_MOST:,} characters together at most; remove one first"
            raise InputError("library", reason)
        insert(connection, "offers", {"name": name, "kept": now(), "text": content})


def library_files(library: Library) -> list[tuple[str, str]]:
    """Name and content of each file, the one that was kept last at the end."""
    with library.read() as connection:
        rows = connection.execute(text("SELECT name, text FROM offers ORDER BY kept, name")).all()
    return [(str(name), str(content)) for name, content in rows]


def remove_offers(library: Library, name: str) -> None:
    """Remove a file.

    Raises
    ------
    InputError
        If the library does not confirm it.
    """
    with library.write() as connection:
        connection.execute(text("DELETE FROM offers WHERE name = :name"), {"name": name})

"""Flown flights beside the revision that they were held against: verdict, sentence, and the files by their hashes."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import text

from app.library.store import Library, find, insert, now
from app.library.texts import clean
from nav_model.base.errors import InputError

_MOST = 100  # flights of a revision
_LONGEST = 4000  # characters of a sentence


@dataclass(frozen=True)
class KeptFlight:
    """A flown flight of a revision. files: name and SHA-256 of each."""

    key: str
    author: str
    saved: str
    verdict: str
    sentence: str
    files: tuple[tuple[str, str], ...]


def keep_flight(
    library: Library, key: str, author: str, verdict: str, sentence: str, files: Sequence[tuple[str, str]]
) -> KeptFlight:
    """Keep a flight with a revision; what is kept is never changed.

    Parameters
    ----------
    library : Library
    key : str
        Of the revision.
    author : str
        Who keeps it.
    verdict, sentence : str
        As the page says them.
    files : sequence of (str, str)
        Name and SHA-256 of each file.

    Raises
    ------
    InputError
        For an unknown revision, an author missing, too many flights, or if the library does not confirm it.
    """
    row = {
        "author": clean("author", author, required=True), "saved": now(), "verdict": verdict,
        "sentence": clean("note", sentence[:_LONGEST]),
        "files": json.dumps([[clean("name", name[-100:]), digest] for name, digest in files], ensure_ascii=False),
    }  # fmt: skip
    with library.write() as connection:
        revision = find(connection, key)
        of_revision = {"design": revision.design, "number": revision.number}
        query = text("SELECT COUNT(*) FROM flights WHERE design = :design AND number = :number")
        place = int(connection.execute(query, of_revision).scalar_one()) + 1
        if place > _MOST:
            raise InputError("library", f"keeps {_MOST} flights of a revision at most; save the next one")
        insert(connection, "flights", {**of_revision, "place": place, **row})
    return flights_of(library, [key])[-1]


def flights_of(library: Library, keys: Sequence[str]) -> list[KeptFlight]:
    """The flights of some revisions, in the order of these and then of time."""
    flights = []
    with library.read() as connection:
        for key in keys:
            revision = find(connection, key)
            query = text("SELECT * FROM flights WHERE design = :design AND number = :number ORDER BY place")
            for row in connection.execute(query, {"design": revision.design, "number": revision.number}).mappings():
                files = tuple((str(name), str(digest)) for name, digest in json.loads(row["files"]))
                texts = {name: str(row[name]) for name in ("author", "saved", "verdict", "sentence")}
                flights.append(KeptFlight(key, files=files, **texts))
    return flights

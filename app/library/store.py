"""Designs and their revisions. A revision is never changed or removed; saving adds one.

Every write is one transaction that is on the disk before the call returns (SQLite: write-ahead log, synchronous
FULL). If two people save the same design, the second, whose base is no longer the latest revision, gets `Conflict`
and loses nothing.
"""

import functools
import secrets
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, RowMapping, text

from app.document.verdict import verdict_of
from app.library.engine import database_faults, engine_at, is_read_only
from app.library.schema import is_current, migrate, version_of
from app.library.texts import clean, clean_tags
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import Check, check_names, flies
from nav_model.design.file import format_design, parse_design

MOST = {"designs": 5_000, "revisions": 20_000, "reviews": 2_000, "bytes": 200_000_000}
"""Bounds of a library. The list of 5,000 designs takes half a second, and nothing is ever removed."""
LONGEST_SEARCH = 100
"""Characters of a search, each word of which is looked for in every revision; the rest does not count."""


class Conflict(InputError):
    """Somebody saved in between; nothing was written."""


@dataclass(frozen=True)
class Revision:
    """One revision: the design file's text, author, date and note, its hash, and its verdict at that time.

    ``closes`` is None without a requirement and where the verdict is open, ``saved`` is ISO 8601 in UTC, ``product``
    the version of the program that judged it, ``origin`` is "import" when author and date come from a file.
    """

    design: str
    number: int
    name: str
    author: str
    note: str
    saved: str
    text: str
    content_hash: str
    closes: bool | None
    verdict: str
    product: str
    origin: str

    @property
    def key(self) -> str:
        """Its address in the library, such as ``0123456789abcdef.3``."""
        return f"{self.design}.{self.number}"

    def budget(self) -> Budget:
        """The budget of the revision, computed by this version of the program."""
        return _worked_out(self.text, f"revision {self.number} of {self.name!r}")

    def checks(self) -> tuple[str, ...]:
        """Names of the checks of its verdict, without computing it."""
        return _checks(self.text, f"revision {self.number} of {self.name!r}")


@dataclass(frozen=True)
class Saved(Revision):
    """A design of the library: its latest revision, and its tags."""

    tags: tuple[str, ...]


Flight = Mapping[str, tuple[Check, ...]]
_MOST_FLIGHTS = 256
_flights: dict[str, Flight | None] = {}  # text of a design -> the checks of its flight, None where it cannot be flown


def flight_of(budget: Budget) -> Flight | None:
    """The checks of a design's flight; None where it has none, or one that cannot be flown. For a worker: seconds."""
    if budget.flight is not None or not flies(budget.design):
        return budget.flight
    from nav_model.trajectory.verdict import with_flight  # with Numba, which takes a second

    try:
        return with_flight(budget).flight
    except InputError:
        return None


async def fly_ahead(revisions: Iterable[Revision]) -> None:
    """Have the flights of some revisions flown by a worker, so that their `budget` is there at once."""
    for revision in revisions:
        if revision.text in _flights:
            continue
        with suppress(InputError):  # whoever asks for its budget is told
            budget = analyse(parse_design(revision.text, revision.name))
            _keep_flight(revision.text, await run_in_pool(flight_of, budget) if flies(budget.design) else None)


def _keep_flight(content: str, flight: Flight | None) -> None:
    _flights[content] = flight
    while len(_flights) > _MOST_FLIGHTS:
        del _flights[next(iter(_flights))]


# A revision never changes, and one review asks for its budget a dozen times, a list of reviews for all their checks.
@functools.lru_cache(maxsize=64)
def _worked_out(content: str, where: str) -> Budget:
    budget = analyse(parse_design(content, where))
    if content not in _flights:
        _keep_flight(content, flight_of(budget))
    return replace(budget, flight=_flights[content])


@functools.lru_cache(maxsize=4096)
def _checks(content: str, where: str) -> tuple[str, ...]:
    return check_names(parse_design(content, where))


class Library:
    """A library at an address: a file's path, or a database URL that SQLAlchemy takes.

    ``read_only`` says that its file or folder refuses writing. To open one of this version takes no lock.

    Raises
    ------
    InputError
        If it cannot be opened, or was written by a newer program.
    """

    def __init__(self, address: str | Path) -> None:
        self.engine = engine_at(address)
        self.read_only = is_read_only(self.engine)
        with database_faults("cannot be opened: {}"):
            with self._transaction(writes=False) as connection:
                current = is_current(version_of(connection))
            if not current and self.read_only:
                raise InputError(
                    "library", "cannot be opened: it must first be upgraded to this version, and it is read-only here"
                )
            if not current:
                with self._transaction(writes=True) as connection:
                    migrate(connection)

    def close(self) -> None:
        """Close the file or the connections."""
        self.engine.dispose()

    @contextmanager
    def _transaction(self, *, writes: bool) -> Iterator[Connection]:
        with self.engine.connect().execution_options(writes=writes) as connection, connection.begin():
            yield connection

    @contextmanager
    def write(self) -> Iterator[Connection]:
        """A transaction that writes, completely or not at all.

        Raises
        ------
        InputError
            If the library would hold more than `MOST`, or did not confirm it: its disk is full, it is locked for too
            long, or its server has gone.
        """
        if self.read_only:
            raise InputError("library", "is read-only: its file or folder cannot be written; nothing was saved")
        # A server that goes while it confirms may have written.
        faults = database_faults("did not confirm this: {}; check before you do it again")
        with faults, self._transaction(writes=True) as connection:
            before = _sizes(connection)
            yield connection
            for what, size in _sizes(connection).items():
                if before[what] < size > MOST[what]:  # a fuller one, of an older version, can still be tidied
                    raise InputError(
                        "library",
                        f"would hold {size:,} {what}, {MOST[what]:,} at most; nothing was saved. Export the designs "
                        "in use and import them into another library (`--library`)",
                    )

    @contextmanager
    def read(self) -> Iterator[Connection]:
        """A transaction that reads one state of the library.

        Raises
        ------
        InputError
            If it cannot be read.
        """
        with database_faults("cannot be read: {}"), self._transaction(writes=False) as connection:
            yield connection

    # --- saving ----------------------------------------------------------------------------------------

    def save(self, budget: Budget, author: str, note: str = "", *, design: str = "", base: int = 0) -> Revision:
        """Save a design: a new one, or the revision after `base` of the one with the id `design`.

        Returns when the revision is on the disk.

        Raises
        ------
        Conflict
            If `base` is not the latest revision any more; the message says who saved what.
        InputError
            For a text too long or an author missing, or an unknown design.
        """
        revision = _revision(budget, author, note, saved=now())
        with self.write() as connection:
            return _append(connection, revision, design, base)

    def retag(self, design: str, tags: str) -> tuple[str, ...]:
        """Give a design these tags, separated by commas, instead of the ones it has."""
        wanted = clean_tags(tags)
        with self.write() as connection:
            _existing(connection, design)
            connection.execute(text("DELETE FROM tags WHERE design = :design"), {"design": design})
            put_tags(connection, design, wanted)
        return wanted

    def archive(self, design: str, archived: bool = True) -> None:
        """Archive a design, or restore it."""
        with self.write() as connection:
            _existing(connection, design)
            connection.execute(
                text("UPDATE designs SET archived = :archived WHERE id = :design"),
                {"archived": int(archived), "design": design},
            )

    # --- looking ---------------------------------------------------------------------------------------

    def designs(self, search: str = "", tag: str = "", *, archived: bool = False) -> tuple[Saved, ...]:
        """The designs, latest first, that hold every word of `search` in their tags or in the name, note or author of
        any revision."""
        with self.read() as connection:
            tags: dict[str, list[str]] = {}
            for design, tagged in connection.execute(text("SELECT design, tag FROM tags ORDER BY tag")):
                tags.setdefault(design, []).append(tagged)
            rows = connection.execute(
                text(
                    "SELECT r.* FROM designs d JOIN revisions r ON r.design = d.id "
                    "AND r.number = d.head WHERE d.archived = :archived ORDER BY r.saved DESC, d.id"
                ),
                {"archived": int(archived)},
            ).mappings()
            words = search[:LONGEST_SEARCH].lower().split()
            words_of: dict[str, list[str]] = {design: list(texts) for design, texts in tags.items()}
            if words:
                for design, *texts in connection.execute(text("SELECT design, name, note, author FROM revisions")):
                    words_of.setdefault(design, []).extend(texts)
            return tuple(
                Saved(**vars(latest), tags=tuple(tags.get(latest.design, ())))
                for latest in map(as_revision, rows)
                if (not tag or tag in tags.get(latest.design, ())) and _holds(words, words_of.get(latest.design, []))
            )

    def tags(self) -> tuple[str, ...]:
        """Every tag in use."""
        with self.read() as connection:
            return tuple(connection.execute(text("SELECT DISTINCT tag FROM tags ORDER BY tag")).scalars())

    def revisions(self, design: str) -> tuple[Revision, ...]:
        """Every revision of a design, latest first.

        Raises
        ------
        InputError
            If there is no such design.
        """
        with self.read() as connection:
            _existing(connection, design)
            query = text("SELECT * FROM revisions WHERE design = :design ORDER BY number DESC")
            return tuple(as_revision(row) for row in connection.execute(query, {"design": design}).mappings())

    def revision(self, key: str) -> Revision:
        """One revision by its key, such as ``0123456789abcdef.3``.

        Raises
        ------
        InputError
            If there is no such revision.
        """
        with self.read() as connection:
            return find(connection, key)


def _sizes(connection: Connection) -> dict[str, int]:
    """Counts of what the library holds, by the names of `MOST`."""
    tables = [what for what in MOST if what != "bytes"]
    queries = {what: f"SELECT COUNT(*) FROM {what}" for what in tables}
    if connection.dialect.name == "sqlite":
        size = "(page_count - freelist_count) * page_size"
        queries["bytes"] = f"SELECT {size} FROM pragma_page_count, pragma_freelist_count, pragma_page_size"
    else:
        written = ("revisions", "tags", "review_comments", "review_decisions", "offers", "flights")
        queries["bytes"] = "SELECT " + " + ".join(f"pg_total_relation_size('{table}')" for table in written)
    return {what: int(connection.execute(text(query)).scalar_one()) for what, query in queries.items()}


def now() -> str:
    """This moment, as the library writes it."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def new_id() -> str:
    """A new id that cannot be guessed."""
    return secrets.token_hex(8)


def insert(connection: Connection, table: str, row: dict[str, Any]) -> None:
    """Add a row, as column -> value, to a table."""
    values = ", ".join(f":{column}" for column in row)
    connection.execute(text(f"INSERT INTO {table} ({', '.join(row)}) VALUES ({values})"), row)


def find(connection: Connection, key: str) -> Revision:
    """One revision by its key, inside a transaction.

    Raises
    ------
    InputError
        If there is no such revision.
    """
    design, _, number = key.partition(".")
    row = None
    if number.isascii() and number.isdigit() and len(number) < 10 and "\0" not in design:
        query = text("SELECT * FROM revisions WHERE design = :design AND number = :number")
        row = connection.execute(query, {"design": design, "number": int(number)}).mappings().first()
    if row is None:
        raise InputError("library", f"has no revision {key[:60]!r}")
    return as_revision(row)


def put_tags(connection: Connection, design: str, tags: Iterable[str]) -> None:
    """Add tags that a design does not have yet."""
    for tag in tags:
        insert(connection, "tags", {"design": design, "tag": tag})


def put_history(connection: Connection, design: str, history: Sequence[Revision]) -> None:
    """Add a design with its revisions, numbered from 1 on."""
    last = history[-1]
    insert(connection, "designs", {"id": design, "name": last.name, "head": len(history)})
    for number, revision in enumerate(history, start=1):
        _insert(connection, revision, design, number)


def revision_from_file(data: bytes | str, where: str, author: str, note: str, saved: str, name: str = "") -> Revision:
    """A revision from a file, with the verdict of this program; it is not in a library yet.

    Raises
    ------
    InputError
        If the text is not a design, or a text is too long.
    """
    budget = analyse(parse_design(data, where))
    return _revision(budget, author or "not stated", note, name=name, saved=saved, origin="import")


def _revision(budget: Budget, author: str, note: str, *, saved: str, name: str = "", origin: str = "") -> Revision:
    budget = replace(budget, flight=flight_of(budget))
    verdict = budget.verdict
    answer = verdict_of(budget)
    return Revision(
        design="",
        number=0,
        name=clean("name", name or budget.design.name) or "Untitled design",
        author=clean("author", author, required=True),
        note=clean("note", note),
        saved=saved,
        text=format_design(budget.design),
        content_hash=budget.design.content_hash,
        closes=verdict.closes if verdict.checks and verdict.state != "open" else None,
        verdict=" ".join((f"{answer.word}.", *answer.sentences)),
        product=version("navbudget"),
        origin=origin,
    )


def _append(connection: Connection, revision: Revision, design: str, base: int) -> Revision:
    if not design:
        design = new_id()
        put_history(connection, design, [revision])
        return find(connection, f"{design}.1")
    moved = connection.execute(
        text("UPDATE designs SET head = head + 1, name = :name WHERE id = :design AND head = :base"),
        {"name": revision.name, "design": design, "base": base},
    )
    if moved.rowcount != 1:
        last = find(connection, f"{design}.{_existing(connection, design)}")
        raise Conflict(
            "library",
            f"{last.author} saved revision {last.number} of {last.name!r} at {last.saved}, after revision {base} "
            "that this change started from; nothing was overwritten. Save on top of it, or as a new design",
        )
    _insert(connection, revision, design, base + 1)
    return find(connection, f"{design}.{base + 1}")


def _insert(connection: Connection, revision: Revision, design: str, number: int) -> None:
    closes = None if revision.closes is None else int(revision.closes)
    insert(connection, "revisions", {**vars(revision), "design": design, "number": number, "closes": closes})


def _existing(connection: Connection, design: str) -> int:
    """The latest revision's number of a design that must be there."""
    head = None
    if "\0" not in design:
        head = connection.execute(text("SELECT head FROM designs WHERE id = :id"), {"id": design}).scalar()
    if not isinstance(head, int):
        raise InputError("library", f"has no design {design[:60]!r}")
    return head


def _holds(words: Sequence[str], texts: Sequence[str]) -> bool:
    all_text = "\n".join(texts).lower()
    return all(word in all_text for word in words)


def as_revision(row: RowMapping) -> Revision:
    """A row of the table of revisions."""
    closes = None if row["closes"] is None else bool(row["closes"])
    return Revision(**{**{name: row[name] for name in Revision.__dataclass_fields__}, "closes": closes})

"""The database of a library: SQLite in a file, or PostgreSQL; and messages for its faults."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from nav_model.base.errors import InputError, quoted

_WAIT = 15.0  # seconds that a writer waits for another before it gets an error
_POSTGRESQL = {
    "connect_timeout": 5,
    "tcp_user_timeout": 15_000,
    "options": "-c lock_timeout=15s",
    "client_encoding": "utf8",
}
"""As libpq takes them, unless the address says otherwise. A server that is out of reach must not hold up every page;
and from a database without an encoding (SQL_ASCII) the driver would hand out bytes for text."""


def engine_at(address: str | Path) -> Engine:
    """The engine of a library: a file's path, or a database URL that SQLAlchemy takes.

    Raises
    ------
    InputError
        If the address is of another kind, or its place cannot be used.
    """
    try:
        url = make_url(address) if isinstance(address, str) and "://" in address else None
        if url is None:
            path = Path(address).expanduser()
            path.parent.mkdir(parents=True, exist_ok=True)
            url = make_url("sqlite://").set(database=str(path))
        if "\0" in str(url.database):
            raise InputError("library", "cannot be used: its name holds a NUL character")
        elif url.drivername in ("postgres", "postgresql"):
            url = url.set(drivername="postgresql+psycopg")
        if url.get_backend_name() == "postgresql":
            arguments = {name: value for name, value in _POSTGRESQL.items() if name not in url.query}
            return create_engine(url, pool_pre_ping=True, connect_args=arguments)
        if url.get_backend_name() != "sqlite" or not url.database or url.database == ":memory:":
            raise InputError("library", "is neither the path of a file nor a sqlite or postgresql address")
        reading = _is_read_only(Path(url.database))
        if reading:
            url = url.set(database=f"file:{quote(url.database)}", query={"mode": "ro", "uri": "true", **reading})
        engine = create_engine(url, connect_args={"timeout": _WAIT})
    except ValueError as error:  # a NUL in a folder's name
        if isinstance(error, InputError):
            raise
        raise InputError("library", f"{quoted(str(address))} cannot be used: {error}") from error
    except (ArgumentError, NoSuchModuleError, ImportError) as error:
        raise InputError("library", f"cannot be used: {error}") from error
    except OSError as error:
        raise InputError("library", f"{str(address)!r} cannot be used: {error.strerror or error}") from error
    event.listen(engine, "connect", _set_up_to_read if reading else _set_up)
    event.listen(engine, "begin", _begin)
    return engine


def is_read_only(engine: Engine) -> bool:
    """True if an engine only reads, because its file or folder refuses writing."""
    return engine.url.query.get("mode") == "ro"


def _is_read_only(path: Path) -> dict[str, str]:
    """Options to open a read-only file; none for one that can be written, or does not exist yet.

    A write-ahead log needs files beside the database to be read as well; if they cannot be made and none exists,
    nobody writes, and the file can be read as it is.
    """
    options = {"effective_ids": True} if os.access in os.supports_effective_ids else {}
    if not path.exists() or (os.access(path, os.W_OK, **options) and os.access(path.parent, os.W_OK, **options)):
        return {}
    log = path.with_name(path.name + "-wal")
    return {"mode": "ro"} if log.exists() and log.stat().st_size else {"mode": "ro", "immutable": "1"}


def _set_up_to_read(connection: Any, _: Any) -> None:
    """Set up SQLite: transactions begin explicitly, not where the driver guesses; any row can be read."""
    connection.isolation_level = None
    connection.text_factory = bytes  # as text, one that is not UTF-8 would end the reading of all others
    connection.row_factory = _as_text


def _as_text(_: Any, row: tuple[Any, ...]) -> tuple[Any, ...]:
    """A row without bytes, which no column of ours holds."""
    return tuple(value.decode("utf-8", "replace") if isinstance(value, bytes) else value for value in row)


def _set_up(connection: Any, _: Any) -> None:
    """Set up SQLite also to write: durable when a save returns."""
    _set_up_to_read(connection, _)
    for setting in ("journal_mode = WAL", "synchronous = FULL", "foreign_keys = ON"):
        connection.execute(f"PRAGMA {setting}")


def _begin(connection: Connection) -> None:
    # A writer takes its lock at once: one that read first could not upgrade when another wrote in between.
    connection.exec_driver_sql("BEGIN IMMEDIATE" if connection.get_execution_options().get("writes") else "BEGIN")


@contextmanager
def database_faults(message: str) -> Iterator[None]:
    """Turn a fault of the database into a message for the user, with its reason.

    Raises
    ------
    InputError
        Instead of the driver's own error.
    """
    try:
        yield
    except DBAPIError as error:
        raise InputError("library", message.format(_reason(error))) from error
    except PoolTimeout as error:
        raise InputError("library", message.format("too many people write at once")) from error


def _reason(error: DBAPIError) -> str:
    lines = str(error.orig).strip().splitlines()  # never the statement or the address, which may hold a password
    return lines[0] if lines else type(error.orig).__name__

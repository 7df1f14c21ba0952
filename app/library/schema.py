"""The tables of the database, as numbered migration steps, which `schema.sql` has.

The steps are in one file and not Alembic's folder of scripts: there are a handful of tables, every step
is plain SQL that SQLite and PostgreSQL both take, libraries migrate by themselves when opened (nobody runs a
command), and a step once released is never edited. A dependency with its own configuration, templates and
environment script would be larger than what it manages.
"""

import re
from pathlib import Path

from sqlalchemy import Connection, inspect, text

from nav_model.base.errors import InputError

_VERSION = re.compile(r"^-- version \d+\n", re.MULTILINE)

STEPS: tuple[tuple[str, ...], ...] = tuple(
    tuple(statement for part in step.split(";") if (statement := part.strip()))
    for step in _VERSION.split(Path(__file__).with_suffix(".sql").read_text("utf-8"))[1:]
)
"""Steps from each version to the next; version n is the first n steps. Released steps never change."""

_LOCK = 0x6E6176  # of PostgreSQL: one process migrates, the others wait


def version_of(connection: Connection) -> int:
    """The version of the existing tables; 0 for an empty database. Writes nothing.

    Raises
    ------
    InputError
        If it is no library, or one that a newer version of the product wrote.
    """
    tables = inspect(connection).get_table_names()
    if "schema_version" not in tables:
        # A database server may hold others' tables beside ours; a file of others' tables is somebody else's.
        if tables and connection.dialect.name == "sqlite":
            raise InputError("library", f"is a database of another program: it has the table {tables[0][:60]!r}")
        return 0
    stated = connection.execute(text("SELECT * FROM schema_version")).all()
    version = stated[0][0] if len(stated) == 1 and len(stated[0]) == 1 else None
    if not isinstance(version, int) or version < 0:
        content = "nothing" if not stated else f"{len(stated)} rows" if len(stated) > 1 else repr(stated[0])[:60]
        raise InputError("library", f"states {content} as its schema version, which must be one whole number")
    if version > len(STEPS):
        raise InputError(
            "library", f"has schema version {version}; this program knows up to {len(STEPS)}: use a newer one"
        )
    return version


def is_current(version: int) -> bool:
    """True if no migration is needed."""
    return version == len(STEPS)


def migrate(connection: Connection) -> None:
    """Bring the tables to this version, inside the caller's transaction: all steps or none.

    Raises
    ------
    InputError
        As `version_of`.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
    version = version_of(connection)
    if not inspect(connection).has_table("schema_version"):
        connection.execute(text("CREATE TABLE schema_version (version INTEGER NOT NULL)"))
        connection.execute(text("INSERT INTO schema_version (version) VALUES (0)"))
    for step in STEPS[version:]:
        for statement in step:
            connection.execute(text(statement))
    if not is_current(version):
        connection.execute(text("UPDATE schema_version SET version = :version"), {"version": len(STEPS)})

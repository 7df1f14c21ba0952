"""The tables of the database, as numbered migration steps.

The steps are a list in one file and not Alembic's folder of scripts: there are a handful of tables, every step
is plain SQL that SQLite and PostgreSQL both take, libraries migrate by themselves when opened (nobody runs a
command), and a step once released is never edited. A dependency with its own configuration, templates and
environment script would be larger than what it manages.
"""

from __future__ import annotations

from sqlalchemy import Connection, inspect, text

from nav_model.base.errors import InputError

STEPS: tuple[tuple[str, ...], ...] = (
    (
        """CREATE TABLE designs (
            id TEXT PRIMARY KEY,
            name TEXT NOT NULL,
            head INTEGER NOT NULL,
            archived INTEGER NOT NULL DEFAULT 0)""",
        """CREATE TABLE revisions (
            design TEXT NOT NULL REFERENCES designs(id),
            number INTEGER NOT NULL,
            name TEXT NOT NULL,
            author TEXT NOT NULL,
            note TEXT NOT NULL,
            saved TEXT NOT NULL,
            text TEXT NOT NULL,
            content_hash TEXT NOT NULL,
            closes INTEGER,
            verdict TEXT NOT NULL,
            product TEXT NOT NULL,
            PRIMARY KEY (design, number))""",
        """CREATE TABLE tags (
            design TEXT NOT NULL REFERENCES designs(id),
            tag TEXT NOT NULL,
            PRIMARY KEY (design, tag))""",
    ),
    ("ALTER TABLE revisions ADD COLUMN origin TEXT NOT NULL DEFAULT ''",),
    (
        """CREATE TABLE reviews (
            id TEXT PRIMARY KEY,
            title TEXT NOT NULL,
            author TEXT NOT NULL,
            opened TEXT NOT NULL,
            product TEXT NOT NULL,
            version INTEGER NOT NULL DEFAULT 1,
            signed_by TEXT,
            signed TEXT,
            seal TEXT)""",
        """CREATE TABLE review_items (
            review TEXT NOT NULL REFERENCES reviews(id),
            place INTEGER NOT NULL,
            design TEXT NOT NULL,
            number INTEGER NOT NULL,
            content_hash TEXT NOT NULL,
            text_hash TEXT NOT NULL,
            PRIMARY KEY (review, place),
            FOREIGN KEY (design, number) REFERENCES revisions(design, number))""",
        """CREATE TABLE review_comments (
            review TEXT NOT NULL,
            number INTEGER NOT NULL,
            place INTEGER NOT NULL,
            subject TEXT NOT NULL,
            author TEXT NOT NULL,
            written TEXT NOT NULL,
            comment TEXT NOT NULL,
            PRIMARY KEY (review, number),
            FOREIGN KEY (review, place) REFERENCES review_items(review, place))""",
        """CREATE TABLE review_decisions (
            review TEXT NOT NULL,
            number INTEGER NOT NULL,
            place INTEGER NOT NULL,
            requirement TEXT NOT NULL,
            accepted INTEGER NOT NULL,
            figure TEXT NOT NULL,
            author TEXT NOT NULL,
            decided TEXT NOT NULL,
            reason TEXT NOT NULL,
            PRIMARY KEY (review, number),
            FOREIGN KEY (review, place) REFERENCES review_items(review, place))""",
    ),
    ("ALTER TABLE reviews ADD COLUMN signature TEXT",),
    ("CREATE TABLE offers (name TEXT PRIMARY KEY, kept TEXT NOT NULL, text TEXT NOT NULL)",),
)
"""What each version adds to the one before; version n is the first n steps. Released steps never change."""

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
        said = "nothing" if not stated else f"{len(stated)} rows" if len(stated) > 1 else repr(stated[0])[:60]
        raise InputError("library", f"states {said} as its schema version, which must be one whole number")
    if version > len(STEPS):
        raise InputError(
            "library", f"has schema version {version}; this program knows up to {len(STEPS)}: use a newer one"
        )
    return version


def is_current(version: int) -> bool:
    """Whether no migration is needed."""
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

"""Libraries on read-only media, locked, owned by others, or under impossible names."""

import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from behind_its_back import sql

from app.library.place import look_at
from app.library.store import Library
from nav_model.base.errors import InputError
from nav_model.budget import Budget

pytestmark = pytest.mark.long

_NOBODY = 65534


@contextmanager
def _as_somebody_without_rights() -> Iterator[None]:
    """Root may write anything: step back from it."""
    before = os.geteuid()
    if before == 0:
        os.seteuid(_NOBODY)
    try:
        yield
    finally:
        os.seteuid(before)


@pytest.fixture
def shelf(tmp_path: Path, mems: Budget) -> Iterator[Path]:
    """A library that can only be read, in a folder that can only be read."""
    for folder in (tmp_path, *tmp_path.parents):
        if folder.stat().st_uid == os.getuid() and str(folder) not in ("/", "/tmp"):
            folder.chmod(0o755)
    place = tmp_path / "read only?"
    place.mkdir()
    library = Library(place / "library.db")
    library.save(mems, "Ann")
    library.close()
    (place / "library.db").chmod(0o444)
    place.chmod(0o555)
    yield place / "library.db"
    place.chmod(0o755)


def test_a_library_on_read_only_media_is_read_and_says_so(shelf: Path, mems: Budget) -> None:
    with _as_somebody_without_rights():
        library = Library(shelf)
        assert library.read_only
        (saved,) = library.designs()
        assert library.revisions(saved.design)[0].author == "Ann"
        with pytest.raises(InputError, match=r"is read-only: .*; nothing was saved"):
            library.save(mems, "Bob")
        library.close()
        assert "read-only" in look_at(str(shelf))
    assert sorted(path.name for path in shelf.parent.iterdir()) == ["library.db"]


def test_an_old_library_on_read_only_media_is_refused(shelf: Path) -> None:
    sql(shelf, "UPDATE schema_version SET version = 1")
    with _as_somebody_without_rights(), pytest.raises(InputError, match="upgraded to this version"):
        Library(shelf)


def test_a_locked_library_is_opened_and_read_at_once(tmp_path: Path, mems: Budget) -> None:
    first = Library(tmp_path / "library.db")
    first.save(mems, "Ann")
    raw = sqlite3.connect(tmp_path / "library.db", isolation_level=None)
    raw.execute("BEGIN IMMEDIATE")  # held to the end: whoever waits for it, waits in vain
    second = Library(tmp_path / "library.db")
    assert len(second.designs()) == 1
    assert not second.read_only
    raw.execute("ROLLBACK")
    raw.close()
    for library in (first, second):
        library.close()


@pytest.mark.parametrize(
    ("statements", "message"),
    [
        (["CREATE TABLE schema_version (version)"], "states nothing as its schema version"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES ('three')"], "'three'"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (NULL)"], "None"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (-1)"], "-1"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (2.5)"], "2.5"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (x'00ff')"], "states"),
        (["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (1), (2)"], "2 rows"),
        (["CREATE TABLE schema_version (a, b)", "INSERT INTO schema_version VALUES (1, 2)"], "states"),
        (
            ["CREATE TABLE schema_version (version)", "INSERT INTO schema_version VALUES (9223372036854775807)"],
            "newer",
        ),
        (["CREATE TABLE bookmarks (url)"], "of another program: it has the table 'bookmarks'"),
    ],
)
def test_what_is_no_library_is_refused_and_left_as_it_is(tmp_path: Path, statements: list[str], message: str) -> None:
    path = tmp_path / "odd.db"
    raw = sqlite3.connect(path)
    for statement in statements:
        raw.execute(statement)
    raw.commit()
    before = list(raw.iterdump())
    with pytest.raises(InputError) as caught:
        Library(path)
    assert caught.value.key == "library"
    assert message in caught.value.reason
    assert list(raw.iterdump()) == before
    raw.close()


@pytest.mark.parametrize("name", ["a\0b", "\0", "folder\0/library.db", "sqlite:///a\0b", "sqlite:////tmp\0/b.db"])
def test_a_nul_in_the_path_is_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"library: .*(NUL|null byte)"):
        Library(name if "://" in name else str(tmp_path / name))

"""Saving designs: nothing lost, nothing half written, nothing that a hostile text can do."""

import multiprocessing
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from behind_its_back import sql
from sqlalchemy import text as text_of
from waiting import PATIENCE

from app.library.exchange import add_histories, export_archive
from app.library.schema import STEPS
from app.library.store import MOST, Conflict, Library, now, revision_from_file
from app.library.texts import LIMITS
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design

HOSTILE = "<script>alert(1)</script> '; DROP TABLE designs; -- \" ${7*7} {{7*7}} =cmd|'/c calc'!A0 ../../etc/passwd"


def test_a_saved_design_comes_back_equal_with_its_verdict(library: Library, mems: Budget) -> None:
    saved = library.save(mems, "Ann", "first try")
    assert saved.number == 1
    assert saved.origin == ""
    back = library.revision(saved.key)
    assert back == saved
    assert parse_design(back.text) == mems.design
    assert back.content_hash == mems.design.content_hash
    assert back.closes is mems.verdict.closes
    (listed,) = library.designs()
    assert (listed.author, listed.number, listed.name) == ("Ann", 1, mems.design.name)


def test_a_design_without_requirements_has_no_verdict(library: Library) -> None:
    assert library.save(analyse(Design()), "Ann").closes is None


def test_every_save_is_a_revision_and_none_changes(library: Library, mems: Budget, tactical: Budget) -> None:
    first = library.save(mems, "Ann")
    second = library.save(tactical, "Bob", "better unit", design=first.design, base=1)
    assert [r.number for r in library.revisions(first.design)] == [2, 1]
    assert library.revision(first.key) == first
    assert library.designs()[0].name == second.name


def test_the_second_of_two_writers_is_told_and_nothing_is_lost(library: Library, mems: Budget) -> None:
    first = library.save(mems, "Ann")
    library.save(mems, "Bob", design=first.design, base=1)
    with pytest.raises(Conflict, match=r"Bob saved revision 2 .* after revision 1"):
        library.save(mems, "Eve", design=first.design, base=1)
    assert library.save(mems, "Eve", design=first.design, base=2).number == 3


def test_search_tags_and_archive(library: Library, mems: Budget, tactical: Budget) -> None:
    first, second = library.save(mems, "Ann", "for the coast guard"), library.save(tactical, "Bob")
    assert library.retag(first.design, "Maritime, x-band,, maritime") == ("maritime", "x-band")
    assert [s.design for s in library.designs("GUARD ann")] == [first.design]
    assert [s.design for s in library.designs("mari")] == [first.design]
    assert library.designs("guard bob") == ()
    later = library.save(first.budget(), "Zoe", "second thoughts", design=first.design, base=1)
    assert library.designs("guard zoe")[0].number == later.number  # found by what an older revision says
    assert [s.design for s in library.designs(tag="x-band")] == [first.design]
    assert library.tags() == ("maritime", "x-band")
    library.archive(first.design)
    assert [s.design for s in library.designs()] == [second.design]
    assert [s.design for s in library.designs(archived=True)] == [first.design]
    library.archive(first.design, False)
    assert len(library.designs()) == 2


@pytest.mark.parametrize("text", [HOSTILE, "\x00\x07\x1b[31mred", "\u202egnp.exe", "🛰️ Ω" * 20, "%s %(x)s :design"])
def test_hostile_texts_are_kept_as_text(library: Library, mems: Budget, text: str) -> None:
    design = analyse(mems.design.replace({"name": text}))
    saved = library.save(design, text[:100], text + "\nline two")
    library.retag(saved.design, text[:40].replace(",", ""))
    back = library.revision(saved.key)
    assert parse_design(back.text).name == text  # the design file escapes: exact
    joined = "".join((back.name, back.author, back.note, *library.designs()[0].tags))
    assert all(sign.isprintable() or sign == "\n" or ord(sign) in (0x200D, 0xFE0F) for sign in joined), repr(joined)
    if text == HOSTILE:
        assert back.name == text
        assert back.note.startswith(text)
    assert len(library.designs()) == 1


@pytest.mark.parametrize("field", ["author", "note"])
def test_huge_or_broken_texts_are_refused(library: Library, mems: Budget, field: str) -> None:
    texts = {"author": "Ann", "note": ""}
    with pytest.raises(InputError, match=rf"{field}: {LIMITS[field] + 1} characters"):
        library.save(mems, **{**texts, field: "x" * (LIMITS[field] + 1)})
    with pytest.raises(InputError, match="not Unicode"):
        library.save(mems, **{**texts, field: "\ud800"})
    with pytest.raises(InputError, match="author: Enter your name"):
        library.save(mems, " \n")
    with pytest.raises(InputError, match=rf"name: {LIMITS['name'] + 1} characters"):
        revision_from_file(format_design(mems.design), "a file", "Ann", "", now(), "x" * (LIMITS["name"] + 1))
    assert library.designs() == ()


@pytest.mark.parametrize("value", ["x'6fff'", "CAST(x'6fff' AS TEXT)", "CAST(x'6feda080' AS TEXT)"])
def test_a_row_that_holds_no_text_takes_no_other_design(
    library: Library, mems: Budget, tactical: Budget, value: str
) -> None:
    damaged, whole = library.save(mems, "Ann"), library.save(tactical, "Bob")
    library.retag(damaged.design, "air")
    library.retag(whole.design, "sea")
    texts = ("name", "author", "note", "saved", "text", "content_hash", "verdict", "product", "origin")
    with library.write() as connection:
        of_it = f"WHERE design = '{damaged.design}'"
        connection.execute(text_of(f"UPDATE tags SET tag = {value} {of_it}"))
        connection.execute(
            text_of(f"UPDATE revisions SET {', '.join(f'{name} = {value}' for name in texts)} {of_it}")
        )
    assert {saved.design for saved in library.designs()} == {damaged.design, whole.design}
    assert [saved.author for saved in library.designs("sea")] == ["Bob"]
    assert "sea" in library.tags()
    assert len(library.revisions(damaged.design)) == 1
    assert export_archive(library, [whole.design, damaged.design])


@pytest.mark.parametrize("key", ["", ".", "x.1", "x.99999999999999999999", "\0.1", "1' OR '1'='1.1", "x" * 10_000])
def test_a_forged_key_finds_nothing(library: Library, mems: Budget, key: str) -> None:
    library.save(mems, "Ann")
    with pytest.raises(InputError, match="no revision"):
        library.revision(key)
    with pytest.raises(InputError, match="no design"):
        library.revisions(key)
    with pytest.raises(InputError, match="no design"):
        library.save(mems, "Ann", design=key or "-", base=1)


# --- several writers ---------------------------------------------------------------------------------------


def _save_stubbornly(library: Library, design: str, budget: Budget, author: str, count: int) -> int:
    """Save `count` revisions, each on top of the latest; returns how often this writer was told."""
    conflicts = 0
    for i in range(count):
        while True:
            base = library.revisions(design)[0].number
            try:
                library.save(budget, author, str(i), design=design, base=base)
                break
            except Conflict:
                conflicts += 1
    return conflicts


def _process(path: Path, design: str, text: str, author: str, count: int) -> None:
    library = Library(path)
    _save_stubbornly(library, design, analyse(parse_design(text)), author, count)
    library.close()


def _check_history(library: Library, design: str, writers: int, count: int) -> None:
    history = library.revisions(design)
    assert [r.number for r in history] == list(range(writers * count + 1, 0, -1))
    for writer in range(writers):
        notes = [r.note for r in history[::-1] if r.author == f"writer {writer}"]
        assert notes == [str(i) for i in range(count)]


@pytest.mark.long
def test_processes_lose_no_revision(tmp_path: Path, mems: Budget) -> None:
    path = tmp_path / "library.db"
    library = Library(path)
    design = library.save(mems, "Ann").design
    context = multiprocessing.get_context("spawn")
    arguments = [(path, design, format_design(mems.design), f"writer {i}", 15) for i in range(2)]
    processes = [context.Process(target=_process, args=options) for options in arguments]
    for process in processes:
        process.start()
    for process in processes:
        process.join(PATIENCE)
        assert process.exitcode == 0
    _check_history(library, design, 2, 15)
    library.close()


@pytest.mark.parametrize(
    ("kills", "saves", "seed"),
    [pytest.param(5, 40, 6, marks=pytest.mark.long), pytest.param(200, 6, 7, marks=pytest.mark.slow)],
)
def test_kills_during_saves_lose_nothing_that_was_answered(
    tmp_path: Path,
    kill_during_saves: Callable[..., set[str]],
    check_whole: Callable[[Library, set[str]], None],
    kills: int,
    saves: int,
    seed: int,
) -> None:
    path = tmp_path / "library.db"
    answered = kill_during_saves(str(path), kills, saves, seed)
    assert sql(path, "PRAGMA integrity_check") == [("ok",)]
    library = Library(path)
    check_whole(library, answered)
    library.close()


def test_a_library_that_another_program_holds_is_said_so(library: Library, mems: Budget, tmp_path: Path) -> None:
    with library.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA busy_timeout = 50")
    raw = sqlite3.connect(tmp_path / "library.db", isolation_level=None)
    raw.execute("BEGIN EXCLUSIVE")
    with pytest.raises(InputError, match="did not confirm this: database is locked"):
        library.save(mems, "Ann")
    raw.execute("ROLLBACK")
    raw.close()
    assert library.save(mems, "Ann").number == 1


# --- schema ------------------------------------------------------------------------------------------------


def _old_library(path: Path, version: int) -> None:
    """A library as a program of that schema version left it, made with SQLite alone."""
    raw = sqlite3.connect(path)
    raw.execute("CREATE TABLE schema_version (version INTEGER NOT NULL)")
    raw.execute("INSERT INTO schema_version VALUES (?)", (version,))
    for step in STEPS[:version]:
        for statement in step:
            raw.execute(statement)
    raw.execute("INSERT INTO designs VALUES ('0123456789abcdef', 'Old one', 1, 0)")
    text = format_design(Design({"name": "Old one"}))
    row = {
        "design": "0123456789abcdef", "number": 1, "name": "Old one", "author": "Ann", "note": "",
        "saved": "2025-01-02T03:04:05.000+00:00", "text": text, "content_hash": "0" * 64, "verdict": "",
        "product": "0.0",
    }  # fmt: skip
    raw.execute(f"INSERT INTO revisions ({', '.join(row)}) VALUES ({', '.join(f':{name}' for name in row)})", row)
    raw.commit()
    raw.close()


@pytest.mark.parametrize("version", range(1, len(STEPS) + 1))
def test_an_older_library_is_brought_up_with_what_it_holds(tmp_path: Path, mems: Budget, version: int) -> None:
    path = tmp_path / "library.db"
    _old_library(path, version)
    for _ in range(2):  # the second opening finds nothing to do
        library = Library(path)
        (revision,) = library.revisions("0123456789abcdef")
        assert (revision.name, revision.author, revision.origin) == ("Old one", "Ann", "")
        library.close()
    library = Library(path)
    assert library.save(mems, "Bob", design="0123456789abcdef", base=1).number == 2
    library.close()


def test_old_and_new_libraries_end_with_the_same_tables(tmp_path: Path) -> None:
    def tables(path: Path) -> list[tuple[object, ...]]:
        Library(path).close()
        query = "SELECT m.name, c.name, c.type, c.[notnull], c.pk FROM sqlite_master m, pragma_table_info(m.name) c"
        return sorted(sql(path, query))

    _old_library(tmp_path / "old.db", 1)
    assert tables(tmp_path / "old.db") == tables(tmp_path / "new.db")


def test_a_migration_that_fails_leaves_the_old_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _old_library(tmp_path / "library.db", 1)
    monkeypatch.setattr(
        "app.library.schema.STEPS", (*STEPS, ("CREATE TABLE extra (x TEXT)", "CREATE TABLE tags (x)"))
    )
    with pytest.raises(InputError, match="already exists"):
        Library(tmp_path / "library.db")
    assert sql(tmp_path / "library.db", "SELECT version FROM schema_version") == [(1,)]
    assert not sql(tmp_path / "library.db", "SELECT * FROM sqlite_master WHERE name IN ('extra', 'reviews')")


def test_a_newer_or_foreign_file_is_refused(tmp_path: Path) -> None:
    _old_library(tmp_path / "library.db", len(STEPS))
    sql(tmp_path / "library.db", "UPDATE schema_version SET version = 99")
    with pytest.raises(InputError, match="schema version 99"):
        Library(tmp_path / "library.db")
    (tmp_path / "photo.db").write_bytes(b"\xff\xd8\xff" * 1000)
    with pytest.raises(InputError, match="not a database"):
        Library(tmp_path / "photo.db")
    with pytest.raises(InputError, match="cannot be used"):
        Library(tmp_path / "photo.db" / "below.db")


@pytest.mark.parametrize("address", ["mysql://h/x", "sqlite://", "nonsense://x", "sqlite:///:memory:"])
def test_an_address_of_another_kind_is_refused(address: str) -> None:
    with pytest.raises(InputError, match="library"):
        Library(address)


@pytest.mark.parametrize("what", ["designs", "revisions", "bytes"])
def test_a_full_library_takes_no_more_and_keeps_what_it_has(
    library: Library, mems: Budget, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    first = library.save(mems, "Ann")
    size = 1 if what != "bytes" else sql(tmp_path / "library.db", "PRAGMA page_count")[0][0] * 4096
    monkeypatch.setitem(MOST, what, size)
    refused = rf"would hold [\d,]+ {what}, {size:,} at most; nothing was saved\. Export"
    histories = [
        ([revision_from_file(format_design(Design({"flight.speed": 50.0 + n})), "", "Eve", "n" * 4000, now())], ())
        for n in range(20)
    ]
    with pytest.raises(InputError, match=refused):
        add_histories(library, histories)
    assert [saved.design for saved in library.designs()] == [first.design]

    def save_again() -> None:
        for base in range(1, 20):
            library.save(mems, "Bob", "n" * 4000, design="" if what == "designs" else first.design, base=base)

    with pytest.raises(InputError, match=refused):
        save_again()
    assert [revision.number for revision in library.revisions(first.design)][-1] == 1
    library.archive(first.design)  # what adds nothing still works, and so does reading
    assert library.revision(first.key) == first
    assert export_archive(library, [first.design])

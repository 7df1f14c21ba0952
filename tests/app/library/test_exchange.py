"""Export and import of a library; malicious archives."""

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from app.library.exchange import MAX_ARCHIVE, Imported, add_histories, export_archive, read_archive
from app.library.store import Library
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.design.file import format_design, parse_design


def _import(library: Library, data: bytes, author: str) -> Imported:
    return add_histories(library, read_archive(data, author))


def _zip(files: dict[str, bytes | str]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return data.getvalue()


@pytest.fixture
def other(tmp_path: Path) -> Library:
    return Library(tmp_path / "other.db")


def test_an_exported_library_comes_back_the_same(
    library: Library, other: Library, mems: Budget, tactical: Budget
) -> None:
    first = library.save(mems, "Ann", "a <b>note</b>")
    library.save(tactical, "Bob", design=first.design, base=1)
    library.save(analyse(tactical.design.replace({"name": "../../Ω/con.toml"})), "Eve")
    library.retag(first.design, "alpha, beta")
    data = export_archive(library, [saved.design for saved in library.designs()])
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        names = [name for name in archive.namelist() if name.endswith(".toml")]
        assert len(names) == 3
        assert all(".." not in name and name.isascii() and name.count("/") == 1 for name in names)
        assert parse_design(archive.read(names[-1])) in (mems.design, tactical.design)
    done = _import(other, data, "Zoe")
    assert (done.designs, done.revisions, done.known) == (2, 3, 0)

    def content(library: Library) -> list[object]:
        fields = ("number", "name", "author", "note", "saved", "text", "content_hash", "closes", "verdict")
        return sorted(
            (saved.tags, [tuple(getattr(r, field) for field in fields) for r in library.revisions(saved.design)])
            for saved in library.designs()
        )

    assert content(other) == content(library)
    assert {r.origin for saved in other.designs() for r in other.revisions(saved.design)} == {"import"}
    again = _import(other, data, "Zoe")
    assert (again.designs, again.known) == (0, 2)


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE revisions SET number = 'x'",
        "UPDATE designs SET head = 'x'",
        "ALTER TABLE revisions DROP COLUMN text; ALTER TABLE revisions ADD COLUMN text TEXT",
    ],
)
def test_a_design_changed_by_hand_is_refused_by_name(library: Library, mems: Budget, damage: str) -> None:
    design = library.save(mems, "Ann").design
    with library.write() as connection:
        for statement in damage.split("; "):
            connection.execute(text(statement))
    with pytest.raises(InputError, match=f"{design}|{mems.design.name} was changed"):
        export_archive(library, [design])


def test_loose_design_files_become_designs(other: Library, mems: Budget) -> None:
    done = _import(other, _zip({"team/mems.toml": format_design(mems.design)}), "Zoe")
    assert done.designs == 1
    (saved,) = other.designs()
    assert (saved.name, saved.author, saved.content_hash) == ("mems", "Zoe", mems.design.content_hash)


@pytest.mark.parametrize(
    "name",
    ["../x.toml", "/etc/x.toml", "a/../../x.toml", "..\\x.toml", "C:/x.toml", "a\nb.toml", "x" * 600 + ".toml"],
)
def test_paths_that_lead_outside_are_refused(library: Library, mems: Budget, name: str) -> None:
    good = format_design(mems.design)
    with pytest.raises(InputError, match=r"archive: "):
        _import(library, _zip({"good.toml": good, name: good}), "Zoe")
    assert library.designs() == ()


def test_bombs_are_refused_by_what_they_unpack_to(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"x\.toml: unpacks to more than 1000000 bytes"):
        _import(library, _zip({"x.toml": b"#" * 60_000_000}), "Zoe")
    lying = bytearray(_zip({"x.toml": b"#" * 5_000_000}))
    size = (5_000_000).to_bytes(4, "little")
    assert lying.count(size) == 2
    with pytest.raises(InputError):  # headers that state ten bytes
        _import(library, bytes(lying.replace(size, (10).to_bytes(4, "little"))), "Zoe")
    many = {f"{i}.toml": b"#" * 900_000 for i in range(60)}
    with pytest.raises(InputError, match="unpacks to more than"):
        _import(library, _zip(many), "Zoe")
    with pytest.raises(InputError, match="2001 files"):
        _import(library, _zip({f"{i}.toml": "" for i in range(2001)}), "Zoe")
    with pytest.raises(InputError, match="larger than"):
        _import(library, b"x" * (MAX_ARCHIVE + 1), "Zoe")
    assert library.designs() == ()


def _listed(mems: Budget, rows: int = 1, design: str = "x", **changes: object) -> bytes:
    row = {"file": "a/r.toml", "name": "n", "author": "a", "note": "", "saved": "2026-11-21T09:30:00.000+00:00"}
    content = {"format": 1, "designs": [{"id": design, "tags": [], "revisions": [{**row, **changes}] * rows}]}
    return _zip({"library.json": json.dumps(content), "a/r.toml": format_design(mems.design)})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"file": "other.toml"}, "not in the archive"),
        ({"saved": "yesterday"}, "not a date"),
        ({"saved": "9999-99-99T99:99:99+00:00"}, "not a date"),
        ({"saved": "9998-01-01T00:00:00+00:00"}, "not a date"),
        ({"rows": 2}, "more than once"),
        ({"author": "x" * 101}, "author: 101 characters"),
        ({"note": "x" * 4001}, "note: 4001"),
    ],
)
def test_a_forged_list_is_refused_whole(library: Library, mems: Budget, changes: dict[str, Any], words: str) -> None:
    assert _import(library, _listed(mems), "Zoe").designs == 1
    with pytest.raises(InputError, match=words):
        _import(library, _listed(mems, **changes), "Zoe")
    assert len(library.designs()) == 1


def test_an_archive_cannot_write_under_anothers_design(library: Library, mems: Budget, tactical: Budget) -> None:
    mine = library.save(tactical, "Ann")
    _import(library, _listed(mems, design=mine.design), "Zoe")
    assert [r.author for r in library.revisions(mine.design)] == ["Ann"]
    assert len(library.designs()) == 2


@pytest.mark.parametrize(
    "data",
    [b"", b"no zip", b"PK\x03\x04" + b"\0" * 40, _zip({}), _zip({"x.exe": "x"}), _zip({"library.json": "[1]"}),
     _zip({"library.json": "[" * 100_000}), _zip({"library.json": b"\xff"}), _zip({"x.toml": "imu = 3"}),
     _zip({"library.json": '{"format": 2, "designs": []}'})],
)  # fmt: skip
def test_what_is_no_archive_of_designs_is_refused(library: Library, data: bytes) -> None:
    with pytest.raises(InputError):
        _import(library, data, "Zoe")
    assert library.designs() == ()


@pytest.mark.parametrize("kind", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2, zipfile.ZIP_DEFLATED])
def test_a_damaged_entry_of_any_compression_is_refused(library: Library, mems: Budget, kind: int) -> None:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", kind) as archive:
        archive.writestr("a.toml", format_design(mems.design))
    broken = bytearray(data.getvalue())
    broken[45:120] = b"\xff" * 75
    with pytest.raises(InputError):
        _import(library, bytes(broken), "Eve")


def test_a_list_in_another_encoding_is_told_in_short() -> None:
    with pytest.raises(InputError, match="is not the list of an exported library: UnicodeDecodeError") as refused:
        read_archive(_zip({"library.json": ('{"format": 1, "designs": []}' * 20).encode("utf-16")}), "Eve")
    assert len(str(refused.value)) < 150

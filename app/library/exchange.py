"""Export and import of a library: a zip with one TOML file per revision and a list of who saved what.

Archives are never unpacked to the disk, and the sizes they state are not trusted.
"""

import io
import json
import re
import zipfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import PurePosixPath
from typing import IO, Any

from sqlalchemy import text

from app.document.wording import slug
from app.library.seal import CHANGED
from app.library.store import Library, Revision, new_id, now, put_history, put_tags, revision_from_file
from app.library.texts import clean_tags
from nav_model.base.errors import InputError, quoted, reason_of
from nav_model.base.text.npz_arrays import DAMAGED

MAX_ARCHIVE = 20_000_000
"""The largest archive taken, in bytes as it comes."""
_MAX_FILES = 2_000
_MAX_FILE = 1_000_000
_MAX_UNPACKED = 50_000_000
_LIST = "library.json"
_MAX_PARTS = 50 * _MAX_FILES  # objects, lists and what is in them
_QUOTED = re.compile(r'"(?:[^"\\]++|\\.?)*+"?', re.DOTALL)
_FORMAT = 1
_TOLD = ("name", "author", "note", "saved")  # by whoever saved a revision
_KEPT = ("file", *_TOLD)  # of the list, by an import; the rest is recomputed
_JUDGED = ("content_hash", "verdict", "product")


@dataclass(frozen=True)
class Imported:
    """Result of an import: designs and revisions added, designs that were there already."""

    designs: int
    revisions: int
    known: int


def export_archive(library: Library, designs: Sequence[str]) -> bytes:
    """The designs with these ids, every revision of each, as the bytes of a zip.

    Raises
    ------
    InputError
        If a design is not there or damaged, or there are more revisions than an import takes.
    """
    latest = {saved.design: saved for archived in (False, True) for saved in library.designs(archived=archived)}
    count = sum(latest[design].number for design in designs if design in latest)
    if count >= _MAX_FILES:
        raise InputError("export", f"{count} revisions; an archive takes {_MAX_FILES - 1}. Select fewer designs.")
    histories = {design: library.revisions(design)[::-1] for design in designs}
    listed = []
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for design, history in histories.items():
            try:
                folder = f"{slug(history[-1].name)}-{design[:8]}"
                rows = []
                for revision in history:
                    path = f"{folder}/revision-{revision.number:04d}.toml"
                    archive.writestr(path, revision.text)
                    rows.append({"file": path, **{name: getattr(revision, name) for name in (*_TOLD, *_JUDGED)}})
                listed.append({"id": design, "tags": list(latest[design].tags), "revisions": rows})
            except (LookupError, TypeError, ValueError) as error:  # no row of ours is without its text or number
                name = history[-1].name if history else ""
                raise InputError("export", f"{name or design} was {CHANGED}. Select other designs.") from error
        archive.writestr(_LIST, json.dumps({"format": _FORMAT, "designs": listed}, ensure_ascii=False, indent=1))
    return data.getvalue()


Histories = list[tuple[list[Revision], tuple[str, ...]]]
"""Designs to add: the revisions of each, first to last, and its tags."""


def read_archive(data: bytes, author: str) -> Histories:
    """Read an archive of `export_archive`, or any zip of design files; for a worker process.

    Every revision is judged anew, which takes seconds for a thousand; names and dates of an archive are kept, marked
    as imported. A file that is not in the list becomes a new design, saved by `author`.

    Raises
    ------
    InputError
        Naming the file that is wrong, too many or too large.
    """
    files = _unpack(data)
    listed = _listed(files)
    histories: Histories = [(_history(rows, files), tags) for rows, tags in listed]
    in_list = {row["file"] for rows, _ in listed for row in rows}
    for path, content in files.items():
        if path not in in_list:
            stem = PurePosixPath(path).stem
            histories.append(([revision_from_file(content, path, author, f"from {path}"[:4000], now(), stem)], ()))
    if not histories:
        raise InputError("archive", "holds no design file (*.toml)")
    return histories


def add_histories(library: Library, histories: Histories) -> Imported:
    """Add the designs of an archive: all of them or nothing.

    A design whose revisions are already here, with equal texts, is skipped.

    Raises
    ------
    InputError
        If the library does not confirm it.
    """
    added = revisions = 0
    with library.write() as connection:
        known = _fingerprints(connection.execute(text("SELECT design, text FROM revisions ORDER BY design, number")))
        for history, tags in histories:
            if tuple(revision.text for revision in history) in known:
                continue
            design = new_id()  # never the archive's own: a forged one could name somebody else's design
            put_history(connection, design, history)
            put_tags(connection, design, tags)
            added, revisions = added + 1, revisions + len(history)
    return Imported(added, revisions, len(histories) - added)


def _fingerprints(rows: Any) -> set[tuple[str, ...]]:
    texts: dict[str, tuple[str, ...]] = {}
    for design, content in rows:
        texts[design] = (*texts.get(design, ()), content)
    return set(texts.values())


def _unpack(data: bytes) -> dict[str, bytes]:
    """Path -> content of every file of interest, read up to bounds that are counted here."""
    if len(data) > MAX_ARCHIVE:
        raise InputError("archive", f"larger than {MAX_ARCHIVE} bytes")
    files: dict[str, bytes] = {}
    room = _MAX_UNPACKED
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = [entry for entry in archive.infolist() if not entry.is_dir()]
            if len(entries) > _MAX_FILES:
                raise InputError("archive", f"{len(entries)} files; at most {_MAX_FILES} are read")
            for entry in entries:
                path = _safe(entry.filename)
                if path in files:
                    raise InputError(path, "is twice in the archive")
                if path != _LIST and not path.lower().endswith(".toml"):
                    raise InputError(path, f"is neither a design file (*.toml) nor {_LIST}")
                with archive.open(entry) as file:
                    files[path] = _read(file, path, room)
                room -= len(files[path])
    except InputError:
        raise
    except DAMAGED as error:
        raise InputError("archive", f"is not a zip this program reads: {reason_of(error)}") from error
    return files


def _safe(path: str) -> str:
    parts = path.split("/")
    if path.startswith("/") or "\\" in path or ":" in path or ".." in parts or not path.isprintable():
        raise InputError("archive", f"{path[:80]!r} is not a path inside the archive")
    if len(path) > 500:
        raise InputError("archive", f"{path[:80]!r}... is longer than 500 characters")
    return path


def _read(file: IO[bytes], path: str, room: int) -> bytes:
    bound = min(MAX_ARCHIVE if path == _LIST else _MAX_FILE, room)
    content = file.read(bound + 1)
    if len(content) > bound:
        raise InputError(path, f"unpacks to more than {bound} bytes")
    return content


def _listed(files: dict[str, bytes]) -> list[tuple[list[dict[str, str]], tuple[str, ...]]]:
    """The list's rows and tags by design; removes the list from `files`."""
    if _LIST not in files:
        return []
    try:
        written = files.pop(_LIST).decode("utf-8")
        if len(re.findall(r"[\[{,]", _QUOTED.sub("", written))) > _MAX_PARTS:
            raise InputError(_LIST, f"has more than {_MAX_PARTS} parts; it is not the list of an exported library")
        content = json.loads(written)
        if content["format"] != _FORMAT:
            raise InputError(_LIST, f"has format {quoted(content['format'])}; this program reads {_FORMAT}")
        designs = []
        for design in content["designs"]:
            rows = [{key: str(row[key]) for key in _KEPT} for row in design["revisions"]]
            designs.append((rows, clean_tags(",".join(map(str, design["tags"])))))
    except InputError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(_LIST, f"is not the list of an exported library: {quoted(error)}") from error
    named = Counter(row["file"] for rows, _ in designs for row in rows)
    if twice := next((path for path, count in named.items() if count > 1), None):
        raise InputError(_LIST, f"names {twice[:80]!r} more than once; every revision has its own file")
    if any(not rows for rows, _ in designs):
        raise InputError(_LIST, "names a design without a revision")
    return designs


def _history(rows: Sequence[dict[str, str]], files: dict[str, bytes]) -> list[Revision]:
    history = []
    for row in rows:
        path = row["file"]
        if path not in files:
            raise InputError(_LIST, f"names {path[:80]!r}, which is not in the archive")
        saved = row["saved"]
        if not _is_past(saved):
            raise InputError(_LIST, f"{saved[:60]!r} is not a date up to today such as 2026-11-21T09:30:00.000+00:00")
        history.append(revision_from_file(files[path], path, row["author"], row["note"], saved, row["name"]))
    return history


def _is_past(saved: str) -> bool:
    """True for a past date as the library writes them; another machine's clock may be ahead by a day."""
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d{1,6})?\+00:00", saved):
        return False
    try:
        return datetime.fromisoformat(saved) <= datetime.now(UTC) + timedelta(days=1)
    except ValueError:
        return False

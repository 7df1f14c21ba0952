"""The library on a real PostgreSQL, started here from Debian's package."""

import os
import pwd
import random
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from sqlalchemy import text
from waiting import PATIENCE, refusing_port, until

from app.library.exchange import Imported, add_histories, export_archive, read_archive
from app.library.reviews import add_comment, decide, load_review, open_review, sign
from app.library.schema import STEPS
from app.library.store import MOST, Conflict, Library
from nav_model.base.errors import InputError
from nav_model.budget import Budget

pytestmark = [pytest.mark.long, pytest.mark.watches("app/library")]

_TABLES = (
    "flights", "offers", "review_decisions", "review_comments", "review_items", "reviews",
    "tags", "revisions", "designs", "schema_version",
)  # fmt: skip
_MISSING = "no PostgreSQL: `make test` installs it (`make postgresql`)"


def _import(library: Library, data: bytes, author: str) -> Imported:
    return add_histories(library, read_archive(data, author))


def _program(name: str) -> str:
    paths = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}")) or [Path(p) for p in [shutil.which(name)] if p]
    assert paths, _MISSING
    return str(paths[-1])


@dataclass(frozen=True)
class Server:
    """A database server of our own."""

    address: str
    crash: Callable[[], None]
    """End all its processes at once, as a power cut would, and start it again."""


@pytest.fixture(scope="module")
def cluster() -> Iterator[Server]:
    """An empty database server; it refuses to run as root, so root hands it to another user."""
    root = os.geteuid() == 0
    user = next((name for name in ("postgres", "nobody") if name in {p.pw_name for p in pwd.getpwall()}), "nobody")
    run = ["setpriv", f"--reuid={user}", f"--regid={pwd.getpwnam(user).pw_gid}", "--clear-groups"] if root else []
    folder = Path(tempfile.mkdtemp(prefix="navbudget-pg-"))
    if root:
        os.chown(folder, pwd.getpwnam(user).pw_uid, -1)
    folder.chmod(0o755)  # its socket is ours to use; a port could be taken by another between choosing and using it
    options = f"-c listen_addresses= -c unix_socket_directories={folder}"
    data = str(folder / "data")
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.STDOUT, "cwd": folder}
    try:
        initdb = [_program("initdb"), "-D", data, "-U", "nav", "--auth=trust"]
        subprocess.run([*run, *initdb, "-E", "UTF8", "--locale=C", "--no-sync"], **quiet)
        start = [_program("pg_ctl"), "-D", data, "-o", options, "-l", str(folder / "log"), "-w", "start"]
        stop = [_program("pg_ctl"), "-D", data, "-m", "immediate", "-w", "stop"]

        def crash() -> None:
            for process in (stop, start):
                subprocess.run([*run, *process], **quiet)

        subprocess.run([*run, *start], **quiet)
        try:
            yield Server(f"postgresql://nav@/postgres?host={folder}", crash)
        finally:
            subprocess.run([*run, *stop], **quiet)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def server(cluster: Server) -> str:
    """Its address."""
    return cluster.address


@pytest.fixture
def shared(server: str) -> Iterator[Library]:
    library = Library(server)
    yield library
    with library.engine.begin() as connection:
        for table in _TABLES:
            connection.execute(text(f"DROP TABLE {table}"))
    library.close()


def test_designs_reviews_and_archives_work_alike(shared: Library, library: Library, mems: Budget) -> None:
    first = shared.save(mems, "Ann \x00 <b>", "a\x00note 🛰️")
    shared.save(mems, "Bob", design=first.design, base=1)
    with pytest.raises(Conflict, match="Bob saved revision 2"):
        shared.save(mems, "Eve", design=first.design, base=1)
    assert shared.retag(first.design, "b, a") == ("a", "b")
    assert [s.number for s in shared.designs("bob", "a")] == [2]
    shared.archive(first.design)
    assert shared.designs() == ()
    data = export_archive(shared, [first.design])
    assert _import(library, data, "Zoe").revisions == 2
    review = open_review(shared, "PDR", "Ann", [first.key])
    review = add_comment(shared, review.id, 1, "tilt", "Bob", "\x00 hm")
    for item, name in review.open_points():
        review = decide(shared, review.id, item, name, True, "Bob", "as computed")
    review = sign(shared, review.id, "Chief", review.version)
    assert review.intact
    with pytest.raises(InputError, match="never changes"):
        add_comment(shared, review.id, 1, "", "Eve", "late")
    with shared.write() as connection:
        connection.execute(text("UPDATE review_comments SET comment = 'fine'"))
    assert not load_review(shared, review.id).intact
    with pytest.raises(InputError, match="no design"):
        shared.revisions("x\0y")


def test_writers_at_once_lose_no_revision(shared: Library, mems: Budget, at_once: Callable[..., None]) -> None:
    design = shared.save(mems, "Ann").design
    conflicts: list[str] = []
    met = threading.Barrier(4)

    def write(author: str) -> None:
        for i in range(15):
            first = i == 0
            while True:
                try:
                    base = shared.revisions(design)[0].number
                    if first:  # all have seen the same revision before one of them saves: the others are told
                        met.wait(PATIENCE)
                        first = False
                    shared.save(mems, author, str(i), design=design, base=base)
                    break
                except Conflict:
                    conflicts.append(author)

    at_once(write, *(f"writer {i}" for i in range(4)))
    history = shared.revisions(design)
    assert [r.number for r in history] == list(range(61, 0, -1))
    for i in range(4):
        assert [r.note for r in history[::-1] if r.author == f"writer {i}"] == [str(n) for n in range(15)]
    assert len(conflicts) >= 3


def test_kills_during_saves_lose_nothing_that_was_answered(
    shared: Library,
    server: str,
    kill_during_saves: Callable[..., set[str]],
    check_whole: Callable[[Library, set[str]], None],
) -> None:
    check_whole(shared, kill_during_saves(server, kills=4, saves=50, seed=8))


def test_a_crash_of_the_database_loses_nothing_that_was_answered(
    shared: Library, cluster: Server, mems: Budget, check_whole: Callable[[Library, set[str]], None]
) -> None:
    answered: set[str] = set()
    refused: list[str] = []
    over = threading.Event()

    def save() -> None:
        while not over.is_set():
            try:
                answered.add(shared.save(mems, "Ann", "n" * 4000).key)
            except InputError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=save) for _ in range(3)]
    for thread in threads:
        thread.start()
    draw = random.Random(9)
    for _ in range(2):
        enough = len(answered) + draw.randrange(5, 30)
        until(lambda enough=enough: len(answered) >= enough, "saves after the start")
        cluster.crash()
    over.set()
    for thread in threads:
        thread.join()
    assert refused, "no crash fell among the saves: the test shows nothing"
    assert all(message.startswith("library: ") for message in refused)
    check_whole(shared, answered)


def test_several_processes_that_open_an_old_library_migrate_it_once(
    shared: Library, server: str, at_once: Callable[..., None]
) -> None:
    with shared.engine.begin() as connection:
        for table in _TABLES[:6]:
            connection.execute(text(f"DROP TABLE {table}"))
        connection.execute(text("UPDATE schema_version SET version = 2"))
    failed: list[Exception] = []

    def open_it(_: int) -> None:
        try:
            Library(server).close()
        except InputError as error:
            failed.append(error)

    at_once(open_it, *range(4))
    assert not failed
    with shared.read() as connection:
        assert connection.execute(text("SELECT version FROM schema_version")).scalars().all() == [len(STEPS)]


def test_a_server_that_is_not_there_is_said_without_its_password() -> None:
    with refusing_port() as port, pytest.raises(InputError, match="cannot be opened") as refused:
        Library(f"postgresql://nav:sesame@127.0.0.1:{port}/x?connect_timeout=2")
    assert "sesame" not in str(refused.value)


def test_a_database_without_an_encoding_keeps_text(shared: Library, server: str, mems: Budget) -> None:
    """As `initdb` makes one where no locale is set."""
    with shared.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("CREATE DATABASE plain ENCODING 'SQL_ASCII' LOCALE 'C' TEMPLATE template0"))
    library = Library(server.replace("/postgres?", "/plain?"))
    try:
        library.save(mems, "Zoë 🛰️")
        assert library.designs("zoë")[0].author == "Zoë 🛰️"
    finally:
        library.close()
        with shared.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
            connection.execute(text("DROP DATABASE plain"))


def test_a_full_library_takes_no_more(shared: Library, mems: Budget, monkeypatch: pytest.MonkeyPatch) -> None:
    saved = shared.save(mems, "Ann")
    monkeypatch.setitem(MOST, "bytes", 1)
    shared.archive(saved.design)
    histories = [([saved] * 60, ())]  # more than a page of the database
    with pytest.raises(InputError, match=r"would hold [0-9,]+ bytes, 1 at most; nothing was saved"):
        add_histories(shared, histories)

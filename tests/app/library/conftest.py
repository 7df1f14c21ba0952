"""A library in a temporary folder, designs to put into it, and a process that saves until it is killed."""

import random
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from known_designs import MEMS, ROOT

from app.library.store import Library
from nav_model.design.file import parse_design

_SAVER = textwrap.dedent("""
    import sys
    from app.library.store import Library
    from nav_model.budget import analyse
    from nav_model.design.file import read_design
    budget = analyse(read_design(sys.argv[2]))
    library = Library(sys.argv[1])
    while True:
        saved = library.save(budget, "Ann", "n" * 4000)
        print(saved.key, flush=True)
""")


@pytest.fixture
def library(tmp_path: Path) -> Iterator[Library]:
    opened = Library(tmp_path / "library.db")
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def kill_during_saves() -> Callable[..., set[str]]:
    """A function that saves in a process and kills it (SIGKILL), again and again, at random moments.

    It comes back with the keys of the saves that were answered. The process saves without end, so that every kill
    falls among its saves: after a random number of answers, fewer than ``saves``, and up to 5 ms more.
    """

    def kill(address: str, kills: int, saves: int, seed: int) -> set[str]:
        draw, answered = random.Random(seed), []
        command = [sys.executable, "-c", _SAVER, address, MEMS]
        for _ in range(kills):
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as process:
                lines = [process.stdout.readline() for _ in range(draw.randrange(saves))]
                time.sleep(draw.uniform(0.0, 0.005))
                process.kill()
                lines += process.stdout.read().splitlines(keepends=True)
                answered += [line.strip() for line in lines if line.endswith("\n")]
        return set(answered)

    return kill


@pytest.fixture(scope="session")
def check_whole() -> Callable[[Library, set[str]], None]:
    """Every answered save is there, and whatever is there is whole."""

    def check(library: Library, answered: set[str]) -> None:
        assert answered
        stored = {saved.design for saved in library.designs()}
        assert {key.partition(".")[0] for key in answered} <= stored
        for design in stored:
            (revision,) = library.revisions(design)
            assert parse_design(revision.text).content_hash == revision.content_hash
            assert len(revision.note) == 4000

    return check


@pytest.fixture(scope="session")
def at_once() -> Callable[..., None]:
    """Call a function in a thread for each argument, and wait for their end."""

    def run(work: Callable[..., object], *arguments: object) -> None:
        threads = [threading.Thread(target=work, args=(argument,)) for argument in arguments]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    return run

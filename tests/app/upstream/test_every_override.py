"""Every override says what it must, and was written for what is installed."""

from __future__ import annotations

import re
from importlib.metadata import version
from pathlib import Path

import pytest

import app.upstream
import nav_model.base.compiled
import nav_model.base.numba_typing
from app.upstream.browser import Repairs, head_script

ROOT = Path(__file__).parents[3]
ROOM = Path(app.upstream.__file__).parent
SCRIPTS = sorted(ROOM.glob("*.js"))
OVERRIDES = [
    *(path for path in sorted(ROOM.glob("*.py")) if path.stem not in ("__init__", "browser")),
    *SCRIPTS,
    Path(nav_model.base.compiled.__file__),
    Path(nav_model.base.numba_typing.__file__),
]


@pytest.mark.parametrize("path", OVERRIDES, ids=lambda path: path.stem)
def test_it_says_version_source_and_end(path: Path) -> None:
    text = re.sub(r"^// ?", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    written = re.findall(r"^Written for: (.+)$", text, re.MULTILINE)
    assert written
    for name, number in re.findall(r"([\w-]+) (\d+(?:\.\d+)+)", " ".join(written)):
        same = number.split(".")[:2]
        assert version(name).split(".")[:2] == same, (
            f"{name} {version(name)}: see whether it still holds, then say so"
        )
    known = r"^Upstream: .*(?:[\w-]+/[\w-]+#\d+|none found, searched \d{4}-\d\d-\d\d)"
    assert len(re.findall(known, text, re.MULTILINE)) == len(written)
    ends = re.findall(r"^Needless when: (tests/\S+)::(\w+) fails$", text, re.MULTILINE)
    assert len(ends) == len(written)
    for file, test in ends:
        assert f"def {test}(" in (ROOT / file).read_text(encoding="utf-8")


def test_every_script_reaches_the_browser() -> None:
    assert all(path.read_text(encoding="utf-8") in Repairs._esm + head_script("TOKEN") for path in SCRIPTS)

"""Every override says what it must, fits what is installed, and has its reports upstream ready to be sent."""

import json
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from known_designs import ROOT

import app.upstream
import nav_model.base.compiled
import nav_model.base.numba_typing
import nav_model.trajectory.files.bounded_ulog
from app.upstream.browser import Repairs

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")

ROOM = Path(app.upstream.__file__).parent
SCRIPTS = sorted(ROOM.glob("*.js"))
IN_PYTHON = [path for path in sorted(ROOM.glob("*.py")) if path.stem not in ("__init__", "browser")]
IN_MODEL = [
    Path(module.__file__)
    for module in (nav_model.base.compiled, nav_model.base.numba_typing, nav_model.trajectory.files.bounded_ulog)
]
OVERRIDES = [*IN_PYTHON, *SCRIPTS, *IN_MODEL]
REPORTS = sorted(ROOT / "docs" / "upstream" / f"{path.stem}.md" for path in OVERRIDES)
_EACH = """
import json, os, sys, traceback
import panel, panel_material_ui
for code in json.load(sys.stdin):
    if not os.fork():
        try:
            exec(code, {"__name__": "__main__"})
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            os._exit(0)
    os.wait()
    print(end="\\0", flush=True)
"""


@pytest.mark.parametrize("path", REPORTS, ids=lambda path: path.stem)
def test_it_says_version_source_and_end(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
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


@pytest.mark.parametrize("path", OVERRIDES, ids=lambda path: path.stem)
def test_it_names_its_reports(path: Path) -> None:
    report = f"docs/upstream/{path.stem}.md"
    assert report in path.read_text(encoding="utf-8")
    _, *sections = re.split(r"^## .+$", (ROOT / report).read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sections
    for section in sections:
        for part in ("For", "Written for", "Upstream", "Needless when"):
            assert len(re.findall(rf"^{part}: .+$", section, re.MULTILINE)) == 1, part
        assert "\n**What happens.** " in section
        assert "\n**Expected.** " in section


def test_no_report_is_left_of_an_override_that_went() -> None:
    assert sorted((ROOT / "docs" / "upstream").glob("*")) == REPORTS


@pytest.mark.long
def test_its_reproductions_print_what_they_say() -> None:
    """In a process of another program, as the product replaces parts of the libraries; a fork of it for each."""
    result = [
        (path.stem, *block)
        for path in REPORTS
        for block in re.findall(r"^```python\n(.*?)^```\n```text\n(.*?)^```$", path.read_text("utf-8"), re.M | re.S)
    ]
    programs = json.dumps([code for _, code, _ in result])
    done = subprocess.run([sys.executable, "-c", _EACH], input=programs, capture_output=True, text=True, check=True)
    printed = done.stdout.split("\0")[:-1]
    differences = [(name, now) for (name, _, then), now in zip(result, printed, strict=True) if now != then]
    assert not differences, f"as shipped it is otherwise now: the override can go. {done.stderr}"


def test_every_script_reaches_the_browser() -> None:
    assert all(path.read_text(encoding="utf-8") in Repairs._esm for path in SCRIPTS)

"""What the documents name exists, what the code cites is in them, and what they print is what the command prints."""

import importlib
import re
import shlex
from pathlib import Path

import pytest

from app.cli import main
from nav_model.design.figures import FIGURES

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
WRITTEN = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md")))
FOLDERS = ("app", "nav_model", "tests", "docs", "benchmarks", "deploy", "examples", "requirements")

documents = pytest.mark.parametrize("document", WRITTEN, ids=lambda path: path.name)


def _code() -> list[Path]:
    result = (
        path for folder in FOLDERS for ending in ("py", "js", "css") for path in (ROOT / folder).rglob(f"*.{ending}")
    )
    return sorted(path for path in result if path != Path(__file__))


def test_documents_that_the_code_cites_are_there() -> None:
    known = {path.name for path in (*WRITTEN, ROOT / "CHANGELOG.md", *DOCS.glob("upstream/*.md"))}
    cited = {
        (name, path.relative_to(ROOT).as_posix())
        for path in _code()
        for name in re.findall(r"\b([A-Za-z_]+\.md)\b", path.read_text("utf-8"))
    }
    assert {"theory.md", "sar.md", "star_tracker.md", "contract.md"} <= {name for name, _ in cited}
    assert {(name, path) for name, path in cited if name not in known} == set()


def test_sections_that_the_code_cites_are_there() -> None:
    sections = re.compile(r'\b(\w+\.md),? (?:sections? (\d+)(?: and (\d+))?|"([^"\n]+)")')
    cited = {result for path in _code() for result in sections.findall(path.read_text("utf-8"))}
    assert len(cited) > 3
    for name, *parts in cited:
        text = (DOCS / name).read_text("utf-8")
        for part in filter(None, parts):
            heading = rf"{part}\." if part.isdigit() else rf"(?:\d+\. )?{re.escape(part)}"
            assert re.search(rf"^##+ {heading}", text, re.MULTILINE), f"{name} has no section {part}"


@documents
def test_files_that_a_document_names_are_there(document: Path) -> None:
    text = document.read_text("utf-8")
    named = set(re.findall(rf"(?<![\w./-])((?:{'|'.join(FOLDERS)})/[\w./-]*[\w/])", text))
    assert {name for name in named if not (ROOT / name).exists()} == set()
    single = set(re.findall(r"`([A-Z]\w+\.md|pyproject\.toml|Dockerfile|Makefile)`", text))
    assert {name for name in single if not (ROOT / name).exists()} == set()


@documents
def test_names_that_a_document_puts_in_a_file_are_in_it(document: Path) -> None:
    mentions = re.findall(r"`(\w+)`(?: and `(\w+)`)? (?:of|in)\s`([\w/]+/\w+\.py)`", document.read_text("utf-8"))
    missing = {
        (name, path) for *names, path in mentions for name in names if name not in (ROOT / path).read_text("utf-8")
    }
    assert missing == set()


def test_names_that_the_code_cites_are_there() -> None:
    cited = {
        name for path in _code() for name in re.findall(r"`((?:nav_model|app)(?:\.\w+)+)`", path.read_text("utf-8"))
    }
    assert len(cited) > 10
    assert {name for name in cited if not _resolves(name)} == set()


def _resolves(name: str) -> bool:
    """True where a dotted name is a module, or a name that one defines."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            result: object = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for part in parts[count:]:
            result = getattr(result, part, None)
        return result is not None
    return False


@documents
def test_links_of_a_document_lead_somewhere(document: Path) -> None:
    links = re.findall(r"\]\(([^)#:\s]+)\)", document.read_text("utf-8"))
    assert {link for link in links if not (document.parent / link).exists()} == set()


@pytest.mark.parametrize("document", [ROOT / "README.md", DOCS / "architecture.md"], ids=lambda path: path.name)
def test_the_tree_is_the_one_there_is(document: Path) -> None:
    (tree,) = re.findall(r"^```\n(nav_model/ .*?)^```", document.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    top, seen = ROOT, set()
    for line in tree.splitlines():
        folder, inside = re.match(r"(\w+)/", line), re.match(r"  ((?:[\w.]+(?:/|\.py) ?)+)", line)
        if folder:
            top = ROOT / folder[1]
        for name in inside[1].split() if inside else ():
            assert (top / name).exists(), f"{top.name}/{name}"
            seen.add(f"{top.name}/{name.rstrip('/')}")
    rooms = {
        path.parent.relative_to(ROOT).as_posix()
        for part in ("app", "nav_model")
        for path in ROOT.glob(f"{part}/*/__init__.py")
    }
    assert rooms <= seen


@pytest.mark.long
def test_the_readme_prints_what_the_command_prints(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```console\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    commands = re.findall(r"\$ \.venv/bin/navbudget (.+)\n((?:[^$].*\n)+)", "".join(blocks))
    assert len(commands) == 3
    for command, printed in commands:
        words, _, last = command.partition(" | tail -1")
        main(shlex.split(words))
        lines = capsys.readouterr().out.splitlines()
        assert printed.splitlines() == (lines[-1:] if last or command.endswith("tail -1") else lines)


def test_the_contract_names_every_figure() -> None:
    """Each in full, or as `detrended_phase_1`, `_2`: what follows a name of the same beginning."""
    text = (DOCS / "contract.md").read_text("utf-8")
    short = {f"detrended_phase_{order}" for order in (2, 3) if f"`_{order}`" in text}
    assert [name for name in FIGURES if name not in text and name not in short] == []

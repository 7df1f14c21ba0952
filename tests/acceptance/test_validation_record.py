"""The record of comparisons that the Theory page shows is that of the tests."""

import ast
import re
from pathlib import Path

import pytest

from app.subjects.theory.record import OURS, record
from nav_model.equations import ALL_EQUATIONS

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
SUPPORT = ROOT / "tests" / "support"


def test_every_equation_cited_is_on_the_theory_page():
    known = {equation.mark for equation in ALL_EQUATIONS}
    sources = [*ROOT.glob("nav_model/**/*.py"), *ROOT.glob("app/**/*.py")]
    cited = {mark for path in sources for mark in re.findall(r"\[([TSBP]-\d+)\]", path.read_text())}
    assert cited <= known
    assert known == {
        *(f"T-{i}" for i in range(1, 23)),
        *(f"S-{i}" for i in range(1, 11)),
        *(f"P-{i}" for i in range(1, 20)),
        *(f"B-{i}" for i in range(1, 10)),
    }


def test_the_committed_record_is_what_the_tests_make():
    """Every comparison of the tests has its row and every row its test; no row names a test that is gone."""
    for committed, recorder in ((record().rows, "compared"), (record().differences, "differs")):
        made = {
            (f"{path.relative_to(ROOT)}:{function.name}", _text(call.args[0]))
            for path, function, call in _calls(recorder)
        }
        assert len(made) > 1
        assert {row.test for row in committed} == {test for test, _ in made}
        for test, result in made:
            pattern = re.escape(result).replace("\x00", ".+")
            assert any(test == row.test and re.fullmatch(pattern, row.result) for row in committed), (test, result)


def _calls(recorder):
    """Path, function and call of every use of a recording fixture."""
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        if f"{recorder}(" not in (text := path.read_text()):
            continue
        for function in ast.walk(ast.parse(text)):
            if isinstance(function, ast.FunctionDef):
                for call in ast.walk(function):
                    if isinstance(call, ast.Call) and getattr(call.func, "id", "") == recorder:
                        yield path, function, call


def _text(node):
    """A result's name, with a zero byte where a formatted value stands."""
    if isinstance(node, ast.Constant):
        return node.value
    return "".join(part.value if isinstance(part, ast.Constant) else "\x00" for part in node.values)


WORDS = {
    "published figure": r"NIST|NIMA|SIMBAD|MathWorks",
    "real data": r"AFRL",
    "another program": r"Stable32|pyins|sarkit",
    "solver written by others": r"SciPy|mpmath",
}
"""What the text of an independent reference names, by its kind: others' work that the test imports or reads."""


def test_a_kind_counts_as_independent_only_with_the_work_of_others_in_it():
    for row in record().rows:
        assert 0 <= row.figure <= row.limit, row
        if row.kind == OURS:
            continue
        assert re.search(WORDS[row.kind], row.oracle), row
        assert not re.search(r"\bour own\b|\bour design notes\b|\bproduct's\b", row.oracle), row
        path = ROOT / row.test.partition(":")[0]
        source = path.read_text()
        conftest = path.parent / "conftest.py"
        text = source + (conftest.read_text() if conftest.exists() else "") + _of_support(source)
        for library in ("SciPy", "mpmath", "pyins"):
            if library in row.oracle:
                assert re.search(rf"^\s*(import|from) {library.lower()}", text, re.MULTILINE), row


def _of_support(source):
    """The files of tests/support that a test imports, and those that these import."""
    texts = {}
    while new := {
        file
        for file in SUPPORT.glob("*.py")
        if file not in texts
        and re.search(rf"^(?:import|from) {file.stem}\b", source + "".join(texts.values()), re.MULTILINE)
    }:
        texts |= {file: file.read_text() for file in new}
    return "".join(texts.values())


def test_the_same_result_is_not_listed_twice():
    for rows in (record().rows, record().differences):
        assert len({row.result for row in rows}) == len(rows)

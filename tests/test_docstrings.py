"""Docstrings begin with what a thing is or does, and public functions of many arguments describe each."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
_QUESTIONS = re.compile(r"(What|Whether|How|Those|That|Which|The same)\b")
_UNDESCRIBED = 3  # arguments that a docstring may tell in its sentences
_SECTION = re.compile(r"^Parameters\n-+$", re.MULTILINE)
_ROOMS = sorted(
    path.relative_to(ROOT)
    for root in ("app", "nav_model", "tests/support", "benchmarks", "deploy")
    for path in (ROOT / root, *(ROOT / root).iterdir())
    if path.is_dir() and any(path.glob("*.py"))
)


def _docstrings(tree):
    """Lines and texts: of the module, its classes and functions, and the strings below names that they set."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        for before, one in zip((None, *body), body, strict=False):
            text = one.value.value if isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant) else None
            if isinstance(text, str) and (before is None or isinstance(before, (ast.Assign, ast.AnnAssign))):
                yield one.lineno, text


def _files(room):
    """Python files of a room, those of its inner folders too, each with its syntax tree."""
    inner = (ROOT / room).glob("*.py") if len(room.parts) == 1 else (ROOT / room).rglob("*.py")
    return [(path.relative_to(ROOT), ast.parse(path.read_text("utf-8"))) for path in sorted(inner)]


@pytest.mark.parametrize("room", _ROOMS, ids=str)
def test_no_docstring_begins_like_a_question(room):
    riddles = [
        f"{path}:{line}: {text.strip().splitlines()[0]}"
        for path, tree in _files(room)
        for line, text in _docstrings(tree)
        if _QUESTIONS.match(text.strip())
    ]
    assert not riddles, "\n".join(riddles)


@pytest.mark.parametrize("room", [room for room in _ROOMS if room.parts[0] == "nav_model"], ids=str)
def test_public_functions_of_many_arguments_describe_them(room):
    bare = [
        f"{path}:{node.lineno}: {node.name}"
        for path, tree in _files(room)
        for node in _public_functions(tree)
        if _count(node.args) > _UNDESCRIBED and not _SECTION.search(ast.get_docstring(node) or "")
    ]
    assert not bare, "\n".join(bare)


def _public_functions(tree):
    classes = (node for node in tree.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_"))
    bodies = (tree.body, *(node.body for node in classes))
    return [
        node
        for body in bodies
        for node in body
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
    ]


def _count(arguments):
    names = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return len([name for name in names if name not in ("self", "cls")])
